//! Finds closed loops that are stated by velocities: pairs of points that a velocity constraint holds
//! together.

use super::state::State;
use super::views::{Vector3, Views, alike};
use crate::model::mechanism::{EquationSides, Mechanism, PointId, Vector};

/// The pairs of points that velocity constraints hold together, so that they must be one point from the
/// beginning.
///
/// `velocity(P) = velocity(Q)` is the rate of `position(P) = position(Q)`, and so integrable, if both
/// velocities are those of the points as places: the rates of their positions. The velocity of a material
/// point that is at the place only now (a tooth in mesh, a point of a rolling wheel) is another, and such a
/// constraint says nothing of positions. Which it is shows at the state, or where that is singular near it.
pub fn held_together(m: &Mechanism, state: &State) -> Vec<[PointId; 2]> {
    let pairs: Vec<[PointId; 2]> =
        m.constraints.iter().filter_map(|equation| joined(&equation.sides)).collect();
    if pairs.is_empty() {
        return pairs;
    }
    let mut near = vec![state.clone()];
    for step in [1e-3, 0.1, 0.3] {
        let mut other = state.clone();
        let shift = |(i, q): (usize, &mut f64)| *q += step * (1.0 + i as f64).sin();
        other.coordinates.iter_mut().enumerate().for_each(shift);
        near.push(other);
    }
    let Some(views) = near.iter().find_map(|state| Views::at(m, state).ok()) else { return Vec::new() };
    let is_place = |point: PointId| moves_as_place(&views, point) == Some(true);
    let same_root = |[p, q]: &[PointId; 2]| views.now.same_root(*p, *q);
    pairs.into_iter().filter(|pair| same_root(pair) && pair.iter().all(|point| is_place(*point))).collect()
}

/// Whether the velocity of a point is the rate of its position.
pub fn moves_as_place(views: &Views<'_>, point: PointId) -> Option<bool> {
    let velocity: Vec<Vector3> = views.vector_parts(|values| values.velocity(point)).ok()?;
    let rate: Vec<Vector3> = views.vector_parts(|values| values.rate_of_position(point)).ok()?;
    Some(alike(&velocity, &rate))
}

/// The points whose velocities an equation holds equal.
fn joined(sides: &EquationSides) -> Option<[PointId; 2]> {
    let EquationSides::Vector(left, right) = sides else { return None };
    let mut terms = Vec::new();
    (velocities(left, 1, &mut terms) && velocities(right, -1, &mut terms)).then_some(())?;
    match terms[..] {
        [(a, 1), (b, -1)] | [(b, -1), (a, 1)] => Some([a, b]),
        _ => None,
    }
}

/// Writes a vector as a sum of velocities of points; `false` if it has other terms.
fn velocities(vector: &Vector, sign: i32, terms: &mut Vec<(PointId, i32)>) -> bool {
    match vector {
        Vector::Zero => true,
        Vector::Velocity(point) => {
            terms.push((*point, sign));
            true
        }
        Vector::Neg(inner) => velocities(inner, -sign, terms),
        Vector::Add(parts) => parts.iter().all(|part| velocities(part, sign, terms)),
        _ => false,
    }
}
