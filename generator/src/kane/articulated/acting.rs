//! Forces on their way from the leaves to the ground, past eliminated derivatives of speeds.

use std::collections::BTreeMap;

use super::super::sums::{sum_scalar, sum_triple};
use super::Eliminated;
use super::relation::{PointRelation, times, transposed};
use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::linear::{self, Triple};
use crate::model::mechanism::{FrameId, PointId};

/// What acts on velocities that are still to be inserted.
pub struct Acting {
    /// forces on points
    pub force: BTreeMap<PointId, Triple>,
    /// torques on frames
    pub torque: BTreeMap<FrameId, Triple>,
    /// what each `u'` bears so far
    pub loads: BTreeMap<usize, Expr>,
}

impl Acting {
    /// Passes a torque to the base of its frame.
    pub fn frame(&mut self, k: &mut Kinematics<'_>, frame: FrameId) {
        let Some(torque) = self.torque.remove(&frame) else { return };
        let motion = k.frames[frame.0].clone();
        let base = k.turning(motion.base);
        let torque = linear::name(&mut k.z, torque);
        for (slot, a) in &motion.relative.terms {
            sum_scalar(&mut self.loads, *slot, &linear::dot(a, &torque));
        }
        if base != FrameId::N {
            let turned = k.tree.convert(&mut k.z, &torque, motion.home, k.frames[base.0].home);
            sum_triple(&mut self.torque, base, &turned);
        }
    }

    /// Passes a force to the base of its point; `None` if more than one frame carries the point.
    pub fn point(&mut self, k: &mut Kinematics<'_>, point: PointId) -> Option<()> {
        let Some(force) = self.force.remove(&point) else { return Some(()) };
        let PointRelation { home, base, arm, partials } = PointRelation::of(k, point)?;
        let force = linear::name(&mut k.z, force);
        if let Some((frame, arm)) = &arm {
            sum_triple(&mut self.torque, *frame, &times(&transposed(arm), &force));
        }
        for (slot, b) in &partials {
            sum_scalar(&mut self.loads, *slot, &linear::dot(b, &force));
        }
        if let Some((base, to)) = base {
            let turned = k.tree.convert(&mut k.z, &force, home, to);
            sum_triple(&mut self.force, base, &turned);
        }
        Some(())
    }

    /// What `u' = load / d` takes from the forces further in.
    pub fn eliminate(&mut self, k: &mut Kinematics<'_>, step: &Eliminated, load: &Expr) {
        if load.is_zero() {
            return;
        }
        let share = k.z.name(load.mul(&step.reciprocal.neg()));
        if let Some((point, p)) = &step.momentum {
            sum_triple(&mut self.force, *point, &linear::scale(&share, p));
        }
        if let Some((frame, h)) = &step.angular {
            sum_triple(&mut self.torque, *frame, &linear::scale(&share, h));
        }
        for (other, m) in &step.others {
            sum_scalar(&mut self.loads, *other, &share.mul(m));
        }
    }
}
