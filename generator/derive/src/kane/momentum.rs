//! Forms momentum and angular momentum of all bodies, and position and velocity of their mass centre.
//!
//! Theory: docs/theory.md, section 16.7.

use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{AxesTree, entry};
use crate::kinematics::linear_forms::{self, Triple};
use hodograph_model::model::mechanism::{Body, FrameId, Place, PointId};
use hodograph_program::program::Quantity;

/// The quantities that the mechanism has, along N.x, N.y, N.z, but for the angular momentum about the mass
/// centre. Those of positions require that all mass centres have positions relative to O.
pub fn momenta(k: &mut Kinematics<'_>) -> Vec<(Quantity, Triple)> {
    if k.mechanism.bodies.is_empty() {
        return Vec::new();
    }
    let placed = placed_from(k, PointId::O);
    let [mut momentum, mut moment, mut spin] = [(); 3].map(|()| linear_forms::zero());
    for body in &k.mechanism.bodies {
        let own = k.scalar(&body.mass);
        let own = k.z.name(own);
        let (axes, velocity) = k.velocity_value(body.centre);
        let velocity = k.tree.convert(&mut k.z, &velocity, axes, AxesTree::N);
        let velocity = linear_forms::name(&mut k.z, velocity);
        momentum = linear_forms::add(&momentum, &linear_forms::scale(&own, &velocity));
        if placed {
            let position = k.position(body.centre, PointId::O);
            let position = k.express(&position, AxesTree::N);
            let position = linear_forms::name(&mut k.z, position);
            // sum of m r
            moment = linear_forms::add(&moment, &linear_forms::scale(&own, &position));
            let share = linear_forms::name(&mut k.z, linear_forms::cross(&position, &velocity));
            spin = linear_forms::add(&spin, &linear_forms::scale(&own, &share));
        }
        spin = linear_forms::add(&spin, &own_spin(k, body));
    }
    let momentum = linear_forms::name(&mut k.z, momentum);
    let velocity = over_mass(k, &momentum);
    let mut all = vec![(Quantity::Momentum, momentum), (Quantity::MassCentreVelocity, velocity)];
    if placed {
        let spin = linear_forms::name(&mut k.z, spin);
        let position = over_mass(k, &moment);
        all.extend([(Quantity::AngularMomentum, spin), (Quantity::MassCentrePosition, position)]);
    }
    all
}

/// The angular momentum about the mass centre, along N.x, N.y, N.z, if all mass centres have positions
/// relative to each other. It is formed of positions and velocities relative to the first mass centre:
/// wherever all of them are, and however fast they fly together, no digits are lost.
pub fn central_angular_momentum(k: &mut Kinematics<'_>) -> Option<Triple> {
    let first = k.mechanism.bodies.first()?.centre;
    if !placed_from(k, PointId::O) && !placed_from(k, first) {
        return None;
    }
    let [mut moment, mut spin] = [(); 2].map(|()| linear_forms::zero());
    let mut others = Vec::new();
    for body in &k.mechanism.bodies {
        spin = linear_forms::add(&spin, &own_spin(k, body));
        if body.centre == first {
            continue;
        }
        let own = k.scalar(&body.mass);
        let own = k.z.name(own);
        let position = k.separation(body.centre, first);
        let position = k.express(&position, AxesTree::N);
        let position = linear_forms::name(&mut k.z, position);
        moment = linear_forms::add(&moment, &linear_forms::scale(&own, &position));
        others.push((body.centre, own, position));
    }
    let common = over_mass(k, &moment);
    for (centre, own, position) in others {
        // The sum of m (r - r_G) vanishes: of all velocities the same one may be subtracted.
        let velocity = k.relative_velocity(centre, first);
        let arm = std::array::from_fn(|i| position[i].sub(&common[i]));
        let arm = linear_forms::name(&mut k.z, arm);
        let share = linear_forms::name(&mut k.z, linear_forms::cross(&arm, &velocity));
        spin = linear_forms::add(&spin, &linear_forms::scale(&own, &share));
    }
    Some(spin)
}

/// Whether all mass centres have positions relative to this point.
fn placed_from(k: &Kinematics<'_>, about: PointId) -> bool {
    k.mechanism.bodies.iter().map(|body| body.centre).all(|point| {
        point == about
            || k.connected(point, about) && !matches!(k.mechanism.points[point.0].place, Place::Velocity(_))
    })
}

/// The angular momentum of a body about its own mass centre.
fn own_spin(k: &mut Kinematics<'_>, body: &Body) -> Triple {
    let Some(frame) = body.frame.map(|frame| k.turning(frame)).filter(|&frame| frame != FrameId::N) else {
        return linear_forms::zero();
    };
    let Some((inertia, axes)) = super::bodies::central_inertia(k, body) else {
        return linear_forms::zero();
    };
    let home = k.frames[frame.0].home;
    let w = k.angular_velocity(frame);
    let w = k.tree.convert(&mut k.z, &w, home, axes);
    let own: Triple = std::array::from_fn(|i| {
        linear_forms::dot(&std::array::from_fn(|j| inertia[entry(i, j)].clone()), &w)
    });
    let own = linear_forms::name(&mut k.z, own);
    k.tree.convert(&mut k.z, &own, axes, AxesTree::N)
}

/// A vector divided by the mass of all bodies.
fn over_mass(k: &mut Kinematics<'_>, v: &Triple) -> Triple {
    let mut mass = Expr::zero();
    for body in &k.mechanism.bodies {
        let own = k.scalar(&body.mass);
        mass = mass.add(&k.z.name(own));
    }
    let mass = k.z.name(mass);
    let v = v.each_ref().map(|component| component.div(&mass));
    linear_forms::name(&mut k.z, v)
}
