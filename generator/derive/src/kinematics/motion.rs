//! Builds the graph of velocities, one relation per frame and per point, and computes velocities and partial
//! velocities from it.

use std::collections::BTreeMap;

use super::axes::{AxesId, AxesTree, Turn};
use super::linear_forms::{self, LinearVector, Triple};
use super::partial_velocities::Along;
use super::vectors::{add_linear, scale_linear};
use super::{Arm, DeriveError, FrameMotion, Kinematics, MixedLinear, PointMotion};
use crate::algebra::Expr;
use hodograph_model::model::mechanism::{FrameId, Place, PointId};

impl Kinematics<'_> {
    /// Sets up the relations of all frames and points.
    pub(super) fn find_motion(&mut self) -> Result<(), DeriveError> {
        let mechanism = self.mechanism;
        for (id, frame) in mechanism.frames.iter().enumerate() {
            let id = FrameId(id);
            let home = self.home_axes(id);
            let motion = match &frame.angular_velocity {
                Some((base, declared)) => {
                    let declared = self.linear_vector(declared);
                    let home = self.stated_home(id, home, &declared);
                    FrameMotion { base: *base, home, relative: self.express_linear(&declared, home) }
                }
                None => {
                    let relative = self.derived_relative(id)?;
                    FrameMotion {
                        base: frame.parent.unwrap_or(FrameId::N),
                        home,
                        relative: self.tidy(&relative),
                    }
                }
            };
            self.frames.push(motion);
        }
        for id in self.points_in_order() {
            let motion = self.point_motion(id);
            if self.points.len() <= id.0 {
                let unset =
                    PointMotion { base: None, arms: Vec::new(), relative: Vec::new(), home: AxesTree::N };
                self.points.resize(mechanism.points.len(), unset);
            }
            self.points[id.0] = motion;
        }
        Ok(())
    }

    /// Axes for a stated angular velocity: those in which it is stated, if the axes of the frame itself are
    /// not needed.
    fn stated_home(&self, id: FrameId, home: AxesId, declared: &MixedLinear) -> AxesId {
        match declared.keys().collect::<Vec<_>>()[..] {
            [&axes] if !self.used_axes[id.0] => axes,
            _ => home,
        }
    }

    /// The points, each after the one relative to which it is defined.
    pub fn points_in_order(&self) -> Vec<PointId> {
        let mut order: Vec<PointId> = (0..self.mechanism.points.len()).map(PointId).collect();
        order.sort_by_key(|&point| (self.way(point).len(), point));
        order
    }

    /// The nearest frame towards N that rotates relative to its base, which has the angular velocity of this
    /// frame.
    pub fn turning(&self, frame: FrameId) -> FrameId {
        let mut at = frame;
        while at != FrameId::N && self.frames[at.0].relative.is_zero() {
            at = self.frames[at.0].base;
        }
        at
    }

    fn point_motion(&mut self, id: PointId) -> PointMotion {
        let mechanism = self.mechanism;
        let point = &mechanism.points[id.0];
        if let Some(declared) = point.velocity.as_ref().or(match &point.place {
            Place::Velocity(v) => Some(v),
            _ => None,
        }) {
            let relative: Vec<_> = self.linear_vector(declared).into_iter().collect();
            let home = relative
                .iter()
                .map(|(axes, _)| *axes)
                .reduce(|a, b| if self.tree.descends(a, b) { a } else { b });
            return PointMotion { base: None, arms: Vec::new(), relative, home: home.unwrap_or(AxesTree::N) };
        }
        let (from, frame) = match &point.place {
            Place::Offset { from, .. } => (*from, None),
            Place::Material { frame, from, .. } => (*from, Some(*frame)),
            Place::Origin | Place::Velocity(_) => {
                return PointMotion { base: None, arms: Vec::new(), relative: Vec::new(), home: AxesTree::N };
            }
        };
        let mut arms = Vec::new();
        let mut relative = Vec::new();
        for (axes, arm) in self.step(id) {
            let turning = self.turning(frame.unwrap_or_else(|| self.tree.owner(axes)));
            if turning != FrameId::N {
                arms.push(Arm { frame: turning, axes, arm: arm.clone() });
            }
            if frame.is_none() {
                let mut rate = LinearVector::zero();
                for (i, component) in arm.iter().enumerate() {
                    let change = self.rate_of(component);
                    rate = rate.add(&LinearVector::along(&change, &super::axes::unit(i)));
                }
                if !rate.is_zero() {
                    relative.push((axes, rate));
                }
            }
        }
        let moves = |k: &Self, point: PointId| {
            let motion = &k.points[point.0];
            motion.base.is_some() || !motion.arms.is_empty() || !motion.relative.is_empty()
        };
        let base = Some(from).filter(|&from| from != PointId::O && moves(self, from));
        let home = self.choose_home(base, &arms, &relative);
        PointMotion { base, arms, relative, home }
    }

    /// Axes for the value of a point's velocity: those of the frame that carries it, if a later frame rotates
    /// relative to that frame; otherwise the previous ones, which saves a rotation.
    fn choose_home(
        &self,
        base: Option<PointId>,
        arms: &[Arm],
        relative: &[(AxesId, LinearVector)],
    ) -> AxesId {
        let mut home = base.map(|base| self.points[base.0].home);
        let carried = arms.iter().map(|arm| {
            let axes = self.frames[arm.frame.0].home;
            if self.worth_turning(arm.frame) { axes } else { self.tree.parent(axes).unwrap_or(AxesTree::N) }
        });
        for axes in carried.chain(relative.iter().map(|(axes, _)| *axes)) {
            home = Some(match home {
                None => axes,
                Some(home) if self.tree.descends(axes, home) => axes,
                Some(home) if self.tree.descends(home, axes) => home,
                Some(home) => self.tree.common(home, axes),
            });
        }
        home.unwrap_or(AxesTree::N)
    }

    /// False if the frame rotates about an axis with constant direction in N and carries no other axes.
    fn worth_turning(&self, frame: FrameId) -> bool {
        let axes = self.frames[frame.0].home;
        let carries =
            self.frames.iter().any(|other| other.home != axes && self.tree.descends(other.home, axes));
        let planar = self.tree.parent(axes) == Some(AxesTree::N)
            && match self.tree.turn(axes) {
                Some(Turn::Simple { axis, .. }) => self.ancestry(frame).iter().all(|frame| {
                    let relative = &self.frames[frame.0].relative;
                    let partials = relative.terms.values().chain([&relative.rest]);
                    partials.into_iter().all(|p| (0..3).all(|i| i == *axis || p[i].is_zero()))
                }),
                _ => false,
            };
        carries || !planar
    }

    /// The frames whose relations add up to the angular velocity of a frame, itself first.
    pub fn ancestry(&self, frame: FrameId) -> Vec<FrameId> {
        let mut chain = Vec::new();
        let mut at = frame;
        while at != FrameId::N {
            chain.push(at);
            at = self.frames[at.0].base;
        }
        chain
    }

    /// Angular velocity as a form.
    pub fn linear_angular_velocity(&mut self, of: FrameId, in_frame: FrameId) -> MixedLinear {
        if !self.solved {
            let (of, base) = (self.derived_angular_velocity(of), self.derived_angular_velocity(in_frame));
            return add_linear(&of, &scale_linear(&Expr::integer(-1), &base));
        }
        let (ahead, behind) = (self.ancestry(of), self.ancestry(in_frame));
        let mut sum = MixedLinear::new();
        for (chain, other, sign) in [(&ahead, &behind, 1), (&behind, &ahead, -1)] {
            for frame in chain.iter().filter(|frame| !other.contains(frame)) {
                let motion = &self.frames[frame.0];
                let part: MixedLinear = [(motion.home, motion.relative.clone())].into();
                sum = add_linear(&sum, &scale_linear(&Expr::integer(sign), &part));
            }
        }
        sum
    }

    /// Velocity as a form.
    pub fn linear_velocity(&mut self, point: PointId) -> MixedLinear {
        if !self.solved {
            return self.derived_velocity(point);
        }
        let home = self.points[point.0].home;
        let form = self.partial_velocities(point, home, Along::Result);
        if form.is_zero() { MixedLinear::new() } else { [(home, form)].into() }
    }

    /// Value of a frame's angular velocity in N, in its home axes.
    pub fn angular_velocity(&mut self, frame: FrameId) -> Triple {
        if frame == FrameId::N {
            return linear_forms::zero();
        }
        if let Some(known) = self.angular_values.get(&frame) {
            return known.clone();
        }
        let motion = self.frames[frame.0].clone();
        let base = self.angular_velocity(motion.base);
        let base_home = self.frames[motion.base.0].home;
        let base = self.tree.convert(&mut self.z, &base, base_home, motion.home);
        let own = self.vector_value(&motion.relative);
        let value = linear_forms::name(&mut self.z, linear_forms::add(&base, &own));
        self.angular_values.insert(frame, value.clone());
        value
    }

    /// Value of the angular velocity of one frame in another.
    pub fn angular_velocity_value(&mut self, of: FrameId, in_frame: FrameId) -> (AxesId, Triple) {
        let home = self.frames[of.0].home;
        if in_frame == FrameId::N {
            return (home, self.angular_velocity(of));
        }
        let form = self.linear_angular_velocity(of, in_frame);
        let form = self.express_linear(&form, home);
        let value = self.vector_value(&form);
        (home, linear_forms::name(&mut self.z, value))
    }

    /// Value of the velocity of one point minus that of another, along N.x, N.y, N.z: the sum of the relations
    /// between them, from which what both have in common drops out.
    pub fn relative_velocity(&mut self, of: PointId, from: PointId) -> Triple {
        let (mut ahead, mut behind) = (self.bases(of), self.bases(from));
        if let Some(i) = ahead.iter().position(|point| behind.contains(point)) {
            behind.truncate(behind.iter().position(|point| *point == ahead[i]).unwrap_or(0));
            ahead.truncate(i);
        }
        let mut arms: BTreeMap<(FrameId, AxesId), Triple> = BTreeMap::new();
        let mut relative = MixedLinear::new();
        for (chain, sign) in [(ahead, 1), (behind, -1)] {
            let sign = Expr::integer(sign);
            for point in chain {
                let motion = self.points[point.0].clone();
                for arm in motion.arms {
                    let sum = arms.entry((arm.frame, arm.axes)).or_insert_with(linear_forms::zero);
                    *sum = linear_forms::add(sum, &linear_forms::scale(&sign, &arm.arm));
                }
                for (axes, form) in motion.relative {
                    relative = add_linear(&relative, &scale_linear(&sign, &[(axes, form)].into()));
                }
            }
        }
        let mut sum = linear_forms::zero();
        for ((frame, axes), arm) in arms {
            let frame_home = self.frames[frame.0].home;
            let w = self.angular_velocity(frame);
            let w = self.tree.convert(&mut self.z, &w, frame_home, axes);
            let arm = linear_forms::name(&mut self.z, arm);
            let part = linear_forms::name(&mut self.z, linear_forms::cross(&w, &arm));
            sum = linear_forms::add(&sum, &self.tree.convert(&mut self.z, &part, axes, AxesTree::N));
        }
        for (axes, form) in relative {
            let value = self.vector_value(&form);
            let value = linear_forms::name(&mut self.z, value);
            sum = linear_forms::add(&sum, &self.tree.convert(&mut self.z, &value, axes, AxesTree::N));
        }
        linear_forms::name(&mut self.z, sum)
    }

    /// The points whose relations add up to the velocity of a point, itself first.
    fn bases(&self, point: PointId) -> Vec<PointId> {
        std::iter::successors(Some(point), |point| self.points[point.0].base).collect()
    }

    /// Value of a point's velocity in N, in its home axes.
    pub fn velocity_value(&mut self, point: PointId) -> (AxesId, Triple) {
        if let Some(known) = self.velocity_values.get(&point) {
            return known.clone();
        }
        let motion = self.points[point.0].clone();
        let mut sum = linear_forms::zero();
        if let Some(base) = motion.base {
            let (from, value) = self.velocity_value(base);
            sum = linear_forms::add(&sum, &self.tree.convert(&mut self.z, &value, from, motion.home));
        }
        for arm in &motion.arms {
            let frame_home = self.frames[arm.frame.0].home;
            let w = self.angular_velocity(arm.frame);
            let w = self.tree.convert(&mut self.z, &w, frame_home, arm.axes);
            let part = linear_forms::name(&mut self.z, linear_forms::cross(&w, &arm.arm));
            sum = linear_forms::add(&sum, &self.tree.convert(&mut self.z, &part, arm.axes, motion.home));
        }
        for (axes, relative) in &motion.relative {
            let value = self.vector_value(relative);
            sum = linear_forms::add(&sum, &self.tree.convert(&mut self.z, &value, *axes, motion.home));
        }
        let value = (motion.home, linear_forms::name(&mut self.z, sum));
        self.velocity_values.insert(point, value.clone());
        value
    }
}
