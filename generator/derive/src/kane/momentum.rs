//! Forms momentum and angular momentum of all bodies, and position and velocity of their mass centre.
//!
//! Theory: docs/theory.md, section 16.7.

use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{AxesTree, entry};
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{FrameId, Place, PointId};
use hodograph_program::program::Quantity;

/// The quantities that the mechanism has, along N.x, N.y, N.z. Those of positions require that all mass
/// centres have positions relative to O, or at least to each other.
pub fn momenta(k: &mut Kinematics<'_>) -> Vec<(Quantity, Triple)> {
    let Some(first) = k.mechanism.bodies.first().map(|body| body.centre) else { return Vec::new() };
    let centres: Vec<PointId> = k.mechanism.bodies.iter().map(|body| body.centre).collect();
    let about = [PointId::O, first].into_iter().find(|&about| {
        let placed = |&point: &PointId| {
            point == about
                || k.connected(point, about)
                    && !matches!(k.mechanism.points[point.0].place, Place::Velocity(_))
        };
        centres.iter().all(placed)
    });
    let mut mass = Expr::zero();
    let [mut momentum, mut moment, mut spin] = [(); 3].map(|()| linear_forms::zero());
    for body in &k.mechanism.bodies {
        let own = k.scalar(&body.mass);
        let own = k.z.name(own);
        mass = mass.add(&own);
        let (axes, velocity) = k.velocity_value(body.centre);
        let velocity = k.tree.convert(&mut k.z, &velocity, axes, AxesTree::N);
        let velocity = linear_forms::name(&mut k.z, velocity);
        momentum = linear_forms::add(&momentum, &linear_forms::scale(&own, &velocity));
        if let Some(about) = about {
            let position = from(k, about, body.centre);
            // sum of m r
            moment = linear_forms::add(&moment, &linear_forms::scale(&own, &position));
            let share = linear_forms::name(&mut k.z, linear_forms::cross(&position, &velocity));
            spin = linear_forms::add(&spin, &linear_forms::scale(&own, &share));
        }
        let Some(frame) = body.frame.map(|frame| k.turning(frame)).filter(|&frame| frame != FrameId::N)
        else {
            continue;
        };
        if let Some((inertia, axes)) = super::bodies::central_inertia(k, body) {
            let home = k.frames[frame.0].home;
            let w = k.angular_velocity(frame);
            let w = k.tree.convert(&mut k.z, &w, home, axes);
            let own: Triple = std::array::from_fn(|i| {
                linear_forms::dot(&std::array::from_fn(|j| inertia[entry(i, j)].clone()), &w)
            });
            let own = linear_forms::name(&mut k.z, own);
            let own = k.tree.convert(&mut k.z, &own, axes, AxesTree::N);
            spin = linear_forms::add(&spin, &own);
        }
    }
    let mass = k.z.name(mass);
    let over_mass = |k: &mut Kinematics<'_>, v: &Triple| {
        let v = v.each_ref().map(|component| component.div(&mass));
        linear_forms::name(&mut k.z, v)
    };
    let momentum = linear_forms::name(&mut k.z, momentum);
    let velocity = over_mass(k, &momentum);
    let mut all = vec![(Quantity::Momentum, momentum.clone()), (Quantity::MassCentreVelocity, velocity)];
    let Some(about) = about else { return all };
    let position = over_mass(k, &moment);
    let spin = linear_forms::name(&mut k.z, spin);
    let of_centre = linear_forms::cross(&position, &momentum);
    let central = std::array::from_fn(|i| spin[i].sub(&of_centre[i]));
    all.push((Quantity::CentralAngularMomentum, central));
    if about == PointId::O {
        all.extend([(Quantity::AngularMomentum, spin), (Quantity::MassCentrePosition, position)]);
    }
    all
}

/// The position of a point from another along N.x, N.y, N.z.
fn from(k: &mut Kinematics<'_>, from: PointId, to: PointId) -> Triple {
    if from == to {
        return linear_forms::zero();
    }
    let position = k.position(to, from);
    let position = k.express(&position, AxesTree::N);
    linear_forms::name(&mut k.z, position)
}
