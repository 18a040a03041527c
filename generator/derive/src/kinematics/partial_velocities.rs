//! Partial velocities of points: each rotating frame contributes its partial angular velocities crossed with
//! the whole arm that it carries.
//!
//! Theory: docs/theory.md, section 16.1.

use std::collections::BTreeMap;

use super::Kinematics;
use super::axes::AxesId;
use super::linear_forms::{self, LinearVector, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// The axes along which arms are crossed with partial angular velocities. Which choice takes fewer operations
/// depends on the mechanism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Along {
    /// Those of the result: arms and axes of rotation are converted by matrices between axes, which are
    /// shared by all.
    Result,
    /// The home axes of the frame, along which an axis of rotation mostly has one component: the products are
    /// converted joint by joint.
    Home,
}

impl Kinematics<'_> {
    /// Partial velocities and remainder of a point, along given axes.
    pub fn partial_velocities(&mut self, point: PointId, axes: AxesId, along: Along) -> LinearVector {
        self.partial_velocities_with(point, axes, along, BTreeMap::new())
    }

    /// Partial velocities of the material point of `frame` that coincides with `point`.
    pub fn partial_velocities_of_material_point(
        &mut self,
        point: PointId,
        centre: PointId,
        frame: FrameId,
        axes: AxesId,
        along: Along,
    ) -> LinearVector {
        let turning = self.turning(frame);
        let mut carried = BTreeMap::new();
        if turning != FrameId::N {
            let arm = self.position(point, centre);
            let arm = self.express(&arm, self.axes_of_arm(turning, axes, along));
            carried.insert(turning, arm);
        }
        self.partial_velocities_with(centre, axes, along, carried)
    }

    /// Partial velocities of a point at arms from another point that frames carry.
    fn partial_velocities_with(
        &mut self,
        point: PointId,
        axes: AxesId,
        along: Along,
        mut carried: BTreeMap<FrameId, Triple>,
    ) -> LinearVector {
        let mut sum = LinearVector::zero();
        let mut at = Some(point);
        while let Some(id) = at {
            let motion = self.points[id.0].clone();
            for arm in &motion.arms {
                let to = self.axes_of_arm(arm.frame, axes, along);
                let turned = self.expressed(&arm.arm, arm.axes, to, along);
                add(&mut carried, arm.frame, &turned);
            }
            for (from, relative) in &motion.relative {
                let part = relative.map(|p| self.expressed(p, *from, axes, along));
                sum = sum.add(&part);
            }
            at = motion.base;
        }
        carried.retain(|_, arm| !linear_forms::is_zero(arm));
        let turning = self.turning_parts(carried, axes, along);
        self.tidy(&sum.add(&turning))
    }

    /// The axes along which a frame carries its arm.
    fn axes_of_arm(&self, frame: FrameId, axes: AxesId, along: Along) -> AxesId {
        match along {
            Along::Result => axes,
            Along::Home => self.frames[frame.0].home,
        }
    }

    /// A vector along other axes.
    fn expressed(&mut self, v: &Triple, from: AxesId, to: AxesId, along: Along) -> Triple {
        match along {
            Along::Result => self.tree.convert_far(&mut self.z, v, from, to),
            Along::Home => self.tree.convert(&mut self.z, v, from, to),
        }
    }

    /// `sum over frames of (angular velocity x arm)` as a form, from the arms that each frame carries, along
    /// the axes that [`Along`] says.
    fn turning_parts(
        &mut self,
        mut carried: BTreeMap<FrameId, Triple>,
        axes: AxesId,
        along: Along,
    ) -> LinearVector {
        let mut sum = LinearVector::zero();
        // Deepest frames first, since the arm of a frame is carried by its base, too.
        let mut open: Vec<FrameId> = carried.keys().copied().collect();
        while !open.is_empty() {
            let deepest =
                (0..open.len()).max_by_key(|&i| (self.ancestry(open[i]).len(), open[i])).unwrap_or(0);
            let frame = open.swap_remove(deepest);
            let Some(arm) = carried.remove(&frame) else { continue };
            let arm = linear_forms::name(&mut self.z, arm);
            let motion = self.frames[frame.0].clone();
            let part = match along {
                Along::Result => motion.relative.map(|w| {
                    let w = self.expressed(w, motion.home, axes, along);
                    linear_forms::cross(&w, &arm)
                }),
                Along::Home => motion.relative.map(|w| {
                    let part = linear_forms::name(&mut self.z, linear_forms::cross(w, &arm));
                    self.expressed(&part, motion.home, axes, along)
                }),
            };
            sum = sum.add(&part);
            if motion.base != FrameId::N {
                let from = self.axes_of_arm(frame, axes, along);
                let to = self.axes_of_arm(motion.base, axes, along);
                let on_base = self.expressed(&arm, from, to, along);
                add(&mut carried, motion.base, &on_base);
                if !open.contains(&motion.base) {
                    open.push(motion.base);
                }
            }
        }
        sum
    }

    /// The form with its components simplified and named.
    pub(super) fn tidy(&mut self, form: &LinearVector) -> LinearVector {
        form.map(|p| {
            let simple = p.clone().map(|c| self.z.simplify(&c));
            linear_forms::name(&mut self.z, simple)
        })
    }
}

/// Adds to the arm that a frame carries.
fn add(carried: &mut BTreeMap<FrameId, Triple>, frame: FrameId, arm: &Triple) {
    let total = carried.get(&frame).map_or_else(|| arm.clone(), |have| linear_forms::add(have, arm));
    carried.insert(frame, total);
}
