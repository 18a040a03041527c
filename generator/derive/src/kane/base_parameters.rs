//! Base parameters of robot dynamics: combines and regroups the inertia parameters, so that fewer of them
//! describe the same mechanism.
//!
//! Mass that moves rigidly with a frame is described, about a reference point of the frame, by mass, first
//! moment and second moments (the matrix of `integral r r' dm`, the pseudo-inertia). Bodies with the same
//! frame and reference point are added. Mass on the axis of a revolute joint moves with the bodies on both
//! sides of it; its mass, first moment and second moment along the axis are therefore moved to the body on
//! the inner side. Mass on an axis that is fixed in N does not move and is dropped.

use std::collections::BTreeMap;

use crate::algebra::{Expr, Intermediates};
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{ENTRIES, Symmetric, entry, unit};
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};
use hodograph_model::number::Number;

/// Where lumped inertia is attached: the frame it turns with and its reference point (`None`: a point at rest).
pub type Attachment = (FrameId, Option<PointId>);

/// Mass that moves rigidly with a frame, about its reference point, along the home axes of the frame.
#[derive(Clone, Debug)]
pub struct LumpedInertia {
    /// kg
    pub mass: Expr,
    /// first moment, kg m
    pub moment: Triple,
    /// second moments xx, yy, zz, xy, yz, zx, kg m^2
    pub second: Symmetric,
}

impl LumpedInertia {
    fn empty() -> Self {
        LumpedInertia {
            mass: Expr::zero(),
            moment: linear_forms::zero(),
            second: std::array::from_fn(|_| Expr::zero()),
        }
    }

    /// Adds another inertia whose reference point is at `r`, along the same axes.
    fn add_at(&mut self, other: &LumpedInertia, r: &Triple) {
        for (i, j) in ENTRIES {
            let shift = other.mass.mul(&r[i]).mul(&r[j]);
            let mixed = other.moment[i].mul(&r[j]).add(&other.moment[j].mul(&r[i]));
            let at = entry(i, j);
            self.second[at] = self.second[at].add(&other.second[at]).add(&shift).add(&mixed);
        }
        let shifted = linear_forms::add(&other.moment, &linear_forms::scale(&other.mass, r));
        self.moment = linear_forms::add(&self.moment, &shifted);
        self.mass = self.mass.add(&other.mass);
    }

    fn tidy(&mut self, k: &mut Kinematics<'_>) {
        let mut tidy = |c: &Expr| {
            let c = k.z.simplify(c);
            k.z.name(c)
        };
        self.mass = tidy(&self.mass);
        self.moment = std::array::from_fn(|i| tidy(&self.moment[i]));
        self.second = std::array::from_fn(|i| tidy(&self.second[i]));
    }

    /// Inertia about the reference point: trace 1 - second.
    pub fn inertia(&self, k: &mut Kinematics<'_>) -> Symmetric {
        std::array::from_fn(|i| {
            if i < 3 {
                let value = self.second[(i + 1) % 3].add(&self.second[(i + 2) % 3]);
                gathered(&mut k.z, &value)
            } else {
                k.z.name(self.second[i].neg())
            }
        })
    }
}

/// A sum or difference of second moments by its parameters: what the model states as moments of inertia
/// stands there again, without the rounding errors of the way there and back. Larger sums stay in parts,
/// which round less than one long sum.
pub fn gathered(z: &mut Intermediates, value: &Expr) -> Expr {
    const LARGEST: usize = 40;
    let opened = z.opened(value, LARGEST);
    let simple = z.simplify(&opened);
    z.name(simple)
}

/// The body to which the mass on a joint axis is attributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Masses {
    /// on the other side of the joint, as everything that lies on its axis: fewest parameters
    Regrouped,
    /// in the body itself, as articulated inertias need it: regrouped, one number would hold the masses of all
    /// outer bodies. The recursion subtracts most of it again at the joints, and the small difference would
    /// carry the rounding error of the large number.
    InBody,
}

/// All inertia of the mechanism.
pub fn lumped_inertias(k: &mut Kinematics<'_>, masses: Masses) -> BTreeMap<Attachment, LumpedInertia> {
    let mut inertias: BTreeMap<Attachment, LumpedInertia> = BTreeMap::new();
    for body in &k.mechanism.bodies {
        let mut lumped = LumpedInertia::empty();
        let place = format!("body `{}`", body.name);
        let mass = k.within(place, |k| k.scalar(&body.mass));
        lumped.mass = k.z.name(mass);
        let own = body.frame.map(|frame| k.turning(frame)).filter(|&frame| frame != FrameId::N);
        let frame = own.or_else(|| carrier(k, body.centre)).unwrap_or(FrameId::N);
        if own.is_some()
            && let Some((inertia, axes)) = super::bodies::central_inertia(k, body)
        {
            let home = k.frames[frame.0].home;
            let inertia = k.tree.convert_symmetric(&mut k.z, &inertia, axes, home);
            // second moments: 1/2 trace 1 - I
            let half = Expr::number(&Number::ratio(1, 2));
            let trace = inertia[0].add(&inertia[1]).add(&inertia[2]).mul(&half);
            lumped.second =
                std::array::from_fn(|i| if i < 3 { trace.sub(&inertia[i]) } else { inertia[i].neg() });
        }
        let (reference, r) = rigid_way(k, frame, Some(body.centre));
        inertias.entry((frame, reference)).or_insert_with(LumpedInertia::empty).add_at(&lumped, &r);
    }
    regroup(k, &mut inertias, masses);
    for lumped in inertias.values_mut() {
        lumped.tidy(k);
    }
    inertias
}

/// The frame that carries a particle rigidly from its base point, if one does.
fn carrier(k: &mut Kinematics<'_>, point: PointId) -> Option<FrameId> {
    let motion = &k.points[point.0];
    match &motion.arms[..] {
        [arm] if motion.relative.is_empty() => Some(arm.frame),
        _ => None,
    }
}

/// Follows a point back as long as each step is an arm fixed in the frame: the point reached (`None`: one at
/// rest) and the way from there, along the frame's home axes.
fn rigid_way(k: &mut Kinematics<'_>, frame: FrameId, from: Option<PointId>) -> (Option<PointId>, Triple) {
    let home = k.frames[frame.0].home;
    let mut way = linear_forms::zero();
    let mut at = from;
    while let Some(point) = at {
        let motion = k.points[point.0].clone();
        if motion.base.is_none() && motion.arms.is_empty() && motion.relative.is_empty() {
            return (None, way);
        }
        let mut step = linear_forms::zero();
        let mut rigid = motion.relative.is_empty();
        for arm in &motion.arms {
            rigid &= arm.frame == frame && k.turning(k.tree.owner(arm.axes)) == frame;
            rigid = rigid && linear_forms::is_zero(&k.change_of(&arm.arm));
            if rigid {
                let turned = k.tree.convert(&mut k.z, &arm.arm, arm.axes, home);
                rigid = linear_forms::is_zero(&k.change_of(&turned));
                step = linear_forms::add(&step, &turned);
            }
        }
        if !rigid {
            break;
        }
        way = linear_forms::add(&way, &step);
        at = motion.base;
    }
    (at, linear_forms::name(&mut k.z, way))
}

/// Moves mass on joint axes to the other side of the joint, from the leaves to the ground.
fn regroup(k: &mut Kinematics<'_>, inertias: &mut BTreeMap<Attachment, LumpedInertia>, masses: Masses) {
    let mut frames: Vec<FrameId> =
        inertias.keys().map(|attachment| attachment.0).filter(|&f| f != FrameId::N).collect();
    for frame in frames.clone() {
        frames.extend(k.ancestry(frame).into_iter().map(|frame| k.turning(frame)));
    }
    frames.retain(|&frame| frame != FrameId::N);
    frames.sort_by_key(|&frame| (std::cmp::Reverse(k.ancestry(frame).len()), frame));
    frames.dedup();
    for frame in frames {
        let Some(axis) = joint_axis(k, frame) else { continue };
        let base = k.turning(k.frames[frame.0].base);
        let attachments: Vec<Attachment> =
            inertias.keys().copied().filter(|attachment| attachment.0 == frame).collect();
        for attachment in attachments {
            // Points on the axis move with the base as they do with the frame, whether the joint is fixed in
            // the base or not; where it is, the way goes on to the base's own reference point.
            let (target, r) = if base == FrameId::N {
                (attachment.1, linear_forms::zero())
            } else {
                rigid_way(k, base, attachment.1)
            };
            let Some(lumped) = inertias.get_mut(&attachment) else { continue };
            let mut rod = LumpedInertia::empty();
            if masses == Masses::Regrouped {
                rod.mass = std::mem::replace(&mut lumped.mass, Expr::zero());
            }
            rod.moment[axis] = std::mem::replace(&mut lumped.moment[axis], Expr::zero());
            rod.second[axis] = std::mem::replace(&mut lumped.second[axis], Expr::zero());
            lumped.tidy(k);
            if base == FrameId::N {
                // about an axis that keeps its direction only the mass matters
                rod.moment[axis] = Expr::zero();
                rod.second[axis] = Expr::zero();
            }
            let (home, base_home) = (k.frames[frame.0].home, k.frames[base.0].home);
            let along = k.tree.convert(&mut k.z, &unit(axis), home, base_home);
            let turned = LumpedInertia {
                mass: rod.mass.clone(),
                moment: linear_forms::scale(&rod.moment[axis], &along),
                second: ENTRIES.map(|(i, j)| rod.second[axis].mul(&along[i]).mul(&along[j])),
            };
            inertias.entry((base, target)).or_insert_with(LumpedInertia::empty).add_at(&turned, &r);
        }
    }
}

/// The coordinate axis about which a frame turns against its base, if it is one that is fixed in both.
fn joint_axis(k: &mut Kinematics<'_>, frame: FrameId) -> Option<usize> {
    let motion = k.frames[frame.0].clone();
    let partials: Vec<&Triple> = motion.relative.terms.values().chain([&motion.relative.rest]).collect();
    let axis = (0..3).find(|&i| partials.iter().all(|p| (0..3).all(|j| j == i || p[j].is_zero())))?;
    let base = k.turning(motion.base);
    let base_home = k.frames[base.0].home;
    let along = k.tree.convert(&mut k.z, &unit(axis), motion.home, base_home);
    let back = k.tree.owner(motion.home);
    let fixed = linear_forms::is_zero(&k.change_of(&along)) && k.turning(back) == frame;
    fixed.then_some(axis)
}
