//! The formula of an eliminated derivative of a speed: u' as a linear form in the accelerations of its base,
//! other u' and the load on it.

use super::super::elimination_order::Node;
use crate::algebra::Expr;
use crate::kinematics::linear_forms::Triple;
use hodograph_model::model::mechanism::{FrameId, PointId};

/// An eliminated derivative: `u' = (load - p . da - h . dalpha - sum m u') / d`.
pub struct Eliminated {
    /// which speed
    pub slot: usize,
    /// 1 / d
    pub reciprocal: Expr,
    /// p, and the point with this da
    pub momentum: Option<(PointId, Triple)>,
    /// h, and the frame with this dalpha
    pub angular: Option<(FrameId, Triple)>,
    /// m, and the slots of these u'
    pub others: Vec<(usize, Expr)>,
    /// the relation that was split last: its dalpha or da is without its own u'
    pub split: Node,
}
