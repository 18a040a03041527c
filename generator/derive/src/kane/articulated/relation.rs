//! The relation of the acceleration of a point to those of its base and its frame, as matrices.

use std::collections::BTreeMap;

use super::super::matrix::{Matrix, arm_matrix, turn_rows};
use super::super::sums::sum_triple;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::AxesId;
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, PointId};

/// `da = da_base + dalpha x r + sum b u'`, along the home axes of the point.
pub struct PointRelation {
    /// those axes
    pub home: AxesId,
    /// the base point, with its home axes
    pub base: Option<(PointId, AxesId)>,
    /// the matrix that takes dalpha along the frame's home axes to dalpha x r
    pub arm: Option<(FrameId, Matrix)>,
    /// b, per slot
    pub partials: BTreeMap<usize, Triple>,
}

impl PointRelation {
    /// `None` if more than one frame carries the point.
    pub fn of(k: &mut Kinematics<'_>, point: PointId) -> Option<Self> {
        let motion = k.points[point.0].clone();
        let home = motion.home;
        if motion.arms.iter().any(|arm| arm.frame != motion.arms[0].frame) {
            return None;
        }
        let arm = motion.arms.first().map(|first| first.frame).map(|frame| {
            let from = k.frames[frame.0].home;
            let total = motion.arms.iter().fold(linear_forms::zero(), |sum, arm| {
                let turned = k.tree.convert(&mut k.z, &arm.arm, arm.axes, from);
                linear_forms::add(&sum, &turned)
            });
            let r = linear_forms::name(&mut k.z, total);
            (frame, turn_rows(k, &arm_matrix(&r), from, home))
        });
        let mut partials: BTreeMap<usize, Triple> = BTreeMap::new();
        for (axes, relative) in &motion.relative {
            for (&slot, b) in &relative.terms {
                let turned = k.tree.convert(&mut k.z, b, *axes, home);
                sum_triple(&mut partials, slot, &turned);
            }
        }
        let base = motion.base.map(|base| (base, k.points[base.0].home));
        Some(PointRelation { home, base, arm, partials })
    }
}
