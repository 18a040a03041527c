//! A bound from below on how far two shapes with many contacts are apart (section 16.14 of docs/theory.md).

use super::algebra::*;
use super::features::corners;
use super::shared::Shared;
use crate::model::mechanism::{Anchor, Definition, Kind, Scalar, Shape};
use crate::span::Span;

/// Pairs with fewer contacts than this have no bound: their gaps cost no more.
const MANY: usize = 4;

/// The distance of spheres about both shapes, or of one from a plane; none for pairs with few contacts, and for shapes
/// without end.
pub fn of_pair(
    [striking, struck]: [&Shape; 2],
    contacts: usize,
    definitions: &mut Vec<Definition>,
    at: Span,
) -> Option<Scalar> {
    if contacts < MANY {
        return None;
    }
    let (centre, radius) = sphere_about(striking)?;
    let mut shared = Shared::pair([striking, struck], definitions, at);
    if struck.kind.is_flat() {
        let height = dot(&centre.from(&struck.at), struck.axis.as_ref()?);
        return Some(shared.scalar(less(height, radius), "clearance"));
    }
    let (other, other_radius) = sphere_about(struck)?;
    let apart = shared.vector(centre.from(&other), "distance of the middles");
    Some(shared.scalar(less(norm(&apart), sum([radius, other_radius])), "clearance"))
}

/// Centre and radius of a sphere that holds a shape.
fn sphere_about(shape: &Shape) -> Option<(Anchor, Scalar)> {
    let halves: Vec<Scalar> = shape.sizes.iter().map(half).collect();
    match (shape.kind, &halves[..]) {
        (Kind::Box | Kind::Rectangle, halves) => {
            let diagonal = root(all(halves.iter().cloned().map(square)));
            Some((shape.at.clone(), diagonal))
        }
        (Kind::Capsule, [_, half_length]) => {
            Some((shape.at.clone(), sum([shape.sizes[0].clone(), half_length.clone()])))
        }
        (Kind::Polytope, _) => {
            let vertices = corners(shape);
            let share = ratio(1, i64::try_from(vertices.len()).ok()?);
            let middle = shape.at.plus(scaled(share, &total(vertices.iter().map(|v| v.from(&shape.at)))));
            let radius = vertices.iter().map(|vertex| norm(&vertex.from(&middle))).reduce(greater)?;
            Some((middle, radius))
        }
        _ => None,
    }
}
