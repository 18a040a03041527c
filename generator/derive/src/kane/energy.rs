//! Forms the kinetic and the potential energy.

use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::entry;
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, Load, LoadKind, PointId};
use hodograph_model::number::Number;

fn half() -> Expr {
    Expr::number(&Number::ratio(1, 2))
}

/// `sum 1/2 m v.v + 1/2 w.I.w`.
pub fn kinetic_energy(k: &mut Kinematics<'_>) -> Expr {
    let mut sum = Expr::zero();
    for body in &k.mechanism.bodies {
        let mass = k.scalar(&body.mass);
        let mass = k.z.name(mass);
        let (_, v) = k.velocity_value(body.centre);
        let square = k.z.name(linear_forms::dot(&v, &v));
        sum = sum.add(&mass.mul(&square));
        let Some(frame) = body.frame.map(|frame| k.turning(frame)).filter(|&frame| frame != FrameId::N)
        else {
            continue;
        };
        if let Some((inertia, axes)) = super::bodies::central_inertia(k, body) {
            let home = k.frames[frame.0].home;
            let w = k.angular_velocity(frame);
            let w = k.tree.convert(&mut k.z, &w, home, axes);
            let momentum: Triple = std::array::from_fn(|i| {
                linear_forms::dot(&std::array::from_fn(|j| inertia[entry(i, j)].clone()), &w)
            });
            let momentum = linear_forms::name(&mut k.z, momentum);
            sum = sum.add(&k.z.name(linear_forms::dot(&w, &momentum)));
        }
    }
    half().mul(&sum)
}

/// Potential energy of gravity and springs, zero with every mass centre at O; `None` where a height is not
/// known, or where one of these loads has none: its force is not minus the gradient.
pub fn potential_energy(k: &mut Kinematics<'_>) -> Option<Expr> {
    let applied = |load: &Load| matches!(load.kind, LoadKind::Force { .. } | LoadKind::Torque { .. });
    if k.mechanism.loads.iter().any(|load| !load.potential && !applied(load)) {
        return None;
    }
    let gravity = super::forces::gravity(k);
    let mut sum = Expr::zero();
    if !gravity.is_empty() {
        for body in &k.mechanism.bodies {
            if !k.connected(body.centre, PointId::O) {
                return None;
            }
            let mass = k.scalar(&body.mass);
            let position = k.position(body.centre, PointId::O);
            let height = k.dot(&gravity, &position);
            sum = sum.sub(&mass.mul(&height));
        }
    }
    for load in &k.mechanism.loads {
        let (stiffness, stretch) = match &load.kind {
            LoadKind::Spring { a, b, stiffness, length, .. } => {
                let r = k.position(*a, *b);
                let distance = k.norm(&r);
                let length = k.scalar(length);
                (k.scalar(stiffness), distance.sub(&length))
            }
            LoadKind::Torsion { angle, rest, stiffness, .. } => {
                let (angle, rest) = (k.scalar(angle), k.scalar(rest));
                (k.scalar(stiffness), angle.sub(&rest))
            }
            _ => continue,
        };
        let stretch = k.z.name(stretch);
        sum = sum.add(&half().mul(&stiffness).mul(&stretch).mul(&stretch));
    }
    Some(sum)
}
