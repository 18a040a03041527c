//! Forms the basis, the relative velocity and the partial velocities V_n, V_t, V_s of a contact.

use std::collections::BTreeMap;

use super::forces::Wrenches;
use crate::algebra::Expr;
use crate::kinematics::axes::{AxesId, AxesTree, unit};
use crate::kinematics::linear_forms::{self, LinearVector, Triple};
use crate::kinematics::partial_velocities::Along;
use crate::kinematics::{Kinematics, vectors};
use hodograph_model::arithmetic::Function;
use hodograph_model::model::mechanism::{Against, Body, BodyId, Contact, FrameId, PointId, Vector};

/// A contact, as algebra.
pub struct ContactForms {
    /// normal and two tangential axes, along N
    pub basis: [Triple; 3],
    /// the relative velocity
    pub rows: Rows,
    /// distance
    pub gap: Option<Expr>,
    /// how far the place of contact is within the features that touch, where these end
    pub validity: Option<Expr>,
    /// a bound from below on how far the two shapes are apart, where the contact is the first of their many
    pub clearance: Option<Expr>,
    /// whether there is no velocity along the second tangential axis, whatever the speeds.
    pub planar: bool,
    /// unit forces along the axes of the basis, if they act on nothing but the mechanism
    pub forces: Option<[Wrenches; 3]>,
    /// relative rotation of the two bodies, where friction resists it
    pub turning: Option<Rows>,
}

/// A vector that is linear in the independent speeds, along the contact basis.
pub struct Rows {
    /// per axis of the basis: partial velocities of the independent speeds, by slot
    pub partials: [BTreeMap<usize, Expr>; 3],
    /// per axis of the basis: what depends on no speed
    pub remainder: Triple,
}

/// The forms of a contact, its partial velocities found along these axes.
pub fn contact_forms(k: &mut Kinematics<'_>, contact: &Contact, along: Along) -> ContactForms {
    let normal = k.vector(&contact.normal);
    let axes = match normal.len() {
        1 => normal.keys().next().copied().unwrap_or(AxesTree::N),
        _ => k.meeting(normal.keys().copied(), std::iter::empty()),
    };
    let normal = k.express(&normal, axes);
    let relative = relative_velocity(k, contact, axes, along);
    let relative = without_dependent(k, &relative);
    let (first, second) = match &contact.tangent {
        Some(tangent) => {
            let tangent = k.vector(tangent);
            let first = k.express(&tangent, axes);
            let second = linear_forms::cross(&normal, &first);
            (first, linear_forms::name(&mut k.z, second))
        }
        None => tangents(k, &normal, &relative),
    };
    let basis: [Triple; 3] = [normal, first, second];
    let rows = along_basis(k, &relative, &basis);
    let turning = contact.turning.map(|frames| {
        let turning = relative_turning(k, frames, axes);
        along_basis(k, &turning, &basis)
    });
    let planar = rows.partials[2].is_empty() && rows.remainder[2].is_zero();
    let forces = unit_forces(k, contact, axes, &basis);
    let basis = basis.map(|v| {
        let v = linear_forms::name(&mut k.z, v);
        k.tree.convert(&mut k.z, &v, axes, AxesTree::N)
    });
    let gap = contact.gap.as_ref().map(|gap| k.scalar(gap));
    let validity = contact.validity.as_ref().map(|validity| k.scalar(validity));
    let clearance = contact.clearance.as_ref().map(|clearance| k.scalar(clearance));
    ContactForms { basis, rows, gap, validity, clearance, planar, forces, turning }
}

/// A vector along the contact basis.
fn along_basis(k: &mut Kinematics<'_>, vector: &LinearVector, basis: &[Triple; 3]) -> Rows {
    let partials: [BTreeMap<usize, Expr>; 3] = std::array::from_fn(|i| {
        let form = vector.dot(&basis[i]).map(|c| k.z.simplify(c));
        form.terms.into_iter().map(|(slot, c)| (slot, k.z.name(c))).collect()
    });
    let remainder: Triple = std::array::from_fn(|i| k.z.name(linear_forms::dot(&vector.rest, &basis[i])));
    Rows { partials, remainder }
}

/// The angular velocity of what strikes relative to what is struck, in independent speeds, along given axes.
fn relative_turning(k: &mut Kinematics<'_>, [of, in_frame]: [FrameId; 2], axes: AxesId) -> LinearVector {
    let turning = k.linear_vector(&Vector::AngularVelocity { of, in_frame });
    let turning = k.express_linear(&turning, axes);
    without_dependent(k, &turning)
}

/// What moves with a velocity.
enum Mover<'m> {
    /// a point
    Point(PointId),
    /// the material point of a frame that coincides with a point, and the frame's reference point
    Material(PointId, FrameId, PointId),
    /// a surface of given velocity
    Surface(&'m Vector),
}

/// The material point of a body at a point; the point itself where there is no body or none that turns.
fn material<'m>(k: &Kinematics<'m>, point: PointId, body: Option<BodyId>) -> Mover<'m> {
    match body.map(|body| &k.mechanism.bodies[body.0]) {
        Some(Body { frame: Some(frame), centre, .. }) if k.connected(point, *centre) => {
            Mover::Material(point, *frame, *centre)
        }
        _ => Mover::Point(point),
    }
}

/// What strikes and what is struck; `None`: the ground.
fn movers<'m>(k: &Kinematics<'m>, contact: &'m Contact) -> (Mover<'m>, Option<Mover<'m>>) {
    let struck = match &contact.against {
        Against::Fixed => None,
        Against::Point(struck, body) => Some(material(k, *struck, *body)),
        Against::Body(body) => Some(match material(k, contact.point, Some(*body)) {
            Mover::Point(_) => Mover::Point(k.mechanism.bodies[body.0].centre),
            of_body => of_body,
        }),
        Against::Velocity(velocity) => Some(Mover::Surface(velocity)),
    };
    (material(k, contact.point, contact.body), struck)
}

/// v^R of (3), of all speeds, along given axes.
fn relative_velocity(k: &mut Kinematics<'_>, contact: &Contact, axes: AxesId, along: Along) -> LinearVector {
    let (striking, struck) = movers(k, contact);
    let difference = match struck {
        None => velocity(k, &striking, axes, along),
        Some(struck) => {
            let of_point = velocity(k, &striking, axes, along);
            let of_struck = velocity(k, &struck, axes, along);
            of_point.add(&of_struck.map(|p| linear_forms::scale(&Expr::integer(-1), p)))
        }
    };
    difference.map(|p| linear_forms::name(&mut k.z, p.clone()))
}

fn velocity(k: &mut Kinematics<'_>, of: &Mover<'_>, axes: AxesId, along: Along) -> LinearVector {
    match *of {
        Mover::Point(point) => k.partial_velocities(point, axes, along),
        Mover::Material(point, frame, centre) => {
            k.partial_velocities_of_material_point(point, centre, frame, axes, along)
        }
        Mover::Surface(velocity) => {
            let velocity = k.linear_vector(velocity);
            k.express_linear(&velocity, axes)
        }
    }
}

/// Unit forces along given vectors on what strikes and against what is struck; `None` where a surface of
/// given velocity takes them.
fn unit_forces(
    k: &mut Kinematics<'_>,
    contact: &Contact,
    axes: AxesId,
    along: &[Triple; 3],
) -> Option<[Wrenches; 3]> {
    let (striking, struck) = movers(k, contact);
    let mut wrenches = [Wrenches::default(), Wrenches::default(), Wrenches::default()];
    for (wrenches, along) in wrenches.iter_mut().zip(along) {
        let against = linear_forms::scale(&Expr::integer(-1), along);
        for (mover, force) in [(Some(&striking), along), (struck.as_ref(), &against)] {
            match mover {
                None => {}
                Some(Mover::Surface(_)) => return None,
                Some(&Mover::Point(point)) => wrenches.force(k, point, &vectors::mixed(axes, force.clone())),
                Some(&Mover::Material(point, frame, centre)) => {
                    wrenches.force(k, centre, &vectors::mixed(axes, force.clone()));
                    let arm = k.position(point, centre);
                    let arm = k.express(&arm, axes);
                    let torque = linear_forms::name(&mut k.z, linear_forms::cross(&arm, force));
                    wrenches.torque(k, frame, &vectors::mixed(axes, torque));
                }
            }
        }
    }
    Some(wrenches)
}

/// The form in independent speeds alone.
fn without_dependent(k: &mut Kinematics<'_>, form: &LinearVector) -> LinearVector {
    let dependent = k.dependent.clone();
    form.substitute(|slot| dependent.get(&slot).cloned()).map(|p| {
        let simple = p.clone().map(|c| k.z.simplify(&c));
        linear_forms::name(&mut k.z, simple)
    })
}

/// Tangential axes that go with a normal, right-handed: the second is one along which nothing moves if there
/// is one.
fn tangents(k: &mut Kinematics<'_>, normal: &Triple, relative: &LinearVector) -> (Triple, Triple) {
    let still = |i: usize| {
        relative.rest[i].is_zero() && relative.terms.values().all(|partial: &Triple| partial[i].is_zero())
    };
    let across: Vec<usize> = (0..3).filter(|&i| normal[i].is_zero()).collect();
    let second = across.iter().copied().find(|&i| still(i)).or(across.last().copied());
    match second {
        Some(i) => {
            let second = unit(i);
            let first = linear_forms::cross(&second, normal);
            (first, second)
        }
        None => {
            // any right-handed basis that is smooth but for normal = -z (Duff et al. 2017)
            let [x, y, z] = normal;
            let sign = k.z.call(Function::Sign, vec![z.clone()]);
            let a = k.z.name(sign.add(z)).pow(-1).neg();
            let a = k.z.name(a);
            let b = k.z.name(x.mul(y).mul(&a));
            let first = [Expr::one().add(&sign.mul(x).mul(x).mul(&a)), sign.mul(&b), sign.mul(x).neg()];
            let second = [b, sign.add(&y.mul(y).mul(&a)), y.neg()];
            (linear_forms::name(&mut k.z, first), linear_forms::name(&mut k.z, second))
        }
    }
}

/// Partial velocities of a point along N, in independent speeds, by slot, and the remainder.
pub fn point_jacobian(k: &mut Kinematics<'_>, point: PointId, along: Along) -> LinearVector {
    let form = k.partial_velocities(point, AxesTree::N, along);
    without_dependent(k, &form)
}
