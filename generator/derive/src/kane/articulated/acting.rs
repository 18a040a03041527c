//! Passes forces and torques from the leaves to the ground while derivatives of speeds are eliminated: the
//! inward pass of the articulated body algorithm.
//!
//! Theory: docs/theory.md, section 16.2.

use std::collections::BTreeMap;

use super::super::matrix::{times, transposed};
use super::super::sums::{sum_scalar, sum_triple};
use super::eliminated::Eliminated;
use super::relation::PointRelation;
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// The forces and torques on velocities that are still to be inserted.
pub struct Acting {
    /// forces on points
    pub force: BTreeMap<PointId, Triple>,
    /// torques on frames
    pub torque: BTreeMap<FrameId, Triple>,
    /// the load on each `u'` so far
    pub loads: BTreeMap<usize, Expr>,
}

impl Acting {
    /// Adds the work of a torque to the `u'` of its frame's relation.
    pub fn split_frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let Some(torque) = self.torque.get_mut(&frame) else { return };
        *torque = linear_forms::name(&mut k.z, torque.clone());
        for (slot, a) in &k.frames[frame.0].relative.terms {
            sum_scalar(&mut self.loads, *slot, &linear_forms::dot(a, torque));
        }
    }

    /// Passes a torque to the base of its frame.
    pub fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let Some(torque) = self.torque.remove(&frame) else { return };
        let motion = &k.frames[frame.0];
        let (home, base) = (motion.home, k.turning(motion.base));
        if base != FrameId::N {
            let torque = linear_forms::name(&mut k.z, torque);
            let turned = k.tree.convert(&mut k.z, &torque, home, k.frames[base.0].home);
            sum_triple(&mut self.torque, base, &turned);
        }
    }

    /// Adds the work of a force to the `u'` of its point's relation; `None` if more than one frame carries
    /// the point.
    pub fn split_point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<()> {
        let Some(force) = self.force.get_mut(&point) else { return Some(()) };
        *force = linear_forms::name(&mut k.z, force.clone());
        for (slot, b) in PointRelation::of(k, point)?.partials {
            sum_scalar(&mut self.loads, slot, &linear_forms::dot(&b, force));
        }
        Some(())
    }

    /// Passes a force to the base of its point; `None` if more than one frame carries the point.
    pub fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<()> {
        let Some(force) = self.force.remove(&point) else { return Some(()) };
        let PointRelation { home, base, arm, .. } = PointRelation::of(k, point)?;
        let force = linear_forms::name(&mut k.z, force);
        if let Some((frame, arm)) = &arm {
            sum_triple(&mut self.torque, *frame, &times(&transposed(arm), &force));
        }
        if let Some((base, to)) = base {
            let turned = k.tree.convert(&mut k.z, &force, home, to);
            sum_triple(&mut self.force, base, &turned);
        }
        Some(())
    }

    /// Subtracts the effect of `u' = load / d` from the forces further inwards.
    pub fn eliminate(&mut self, k: &mut Kinematics<'_>, step: &Eliminated, load: &Expr) {
        if load.is_zero() {
            return;
        }
        let minus = step.reciprocal.neg();
        let named = k.z.name(load.clone());
        let share = k.z.name(named.mul(&minus));
        // The torque about a hinge's axis is not passed on, except that of its drive.
        let part = |c: &Expr| {
            let ratio = c.mul(&minus);
            if ratio.is_number() { load.mul(&ratio) } else { share.mul(c) }
        };
        if let Some((point, p)) = &step.momentum {
            sum_triple(&mut self.force, *point, &[part(&p[0]), part(&p[1]), part(&p[2])]);
        }
        if let Some((frame, h)) = &step.angular {
            sum_triple(&mut self.torque, *frame, &[part(&h[0]), part(&h[1]), part(&h[2])]);
        }
        for (other, m) in &step.others {
            sum_scalar(&mut self.loads, *other, &share.mul(m));
        }
    }
}
