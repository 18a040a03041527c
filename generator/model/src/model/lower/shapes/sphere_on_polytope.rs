//! The contact of a sphere on a polytope: the distance of its centre from the nearest face, edge or vertex (section
//! 16.12 of docs/theory.md).

use super::algebra::*;
use super::faces::greatest;
use super::features::Touch;
use super::separation::least;
use super::shared::Shared;
use super::solids::*;
use crate::model::hulls::Hull;
use crate::model::mechanism::{Definition, Scalar, Shape};
use crate::span::Span;

/// Ends of edges count as farther than other places by this part of the square of their distance. Beside the end of an edge
/// the nearest places of its neighbours are at the same distance but for rounding, and only that on the edge itself moves
/// along with the centre.
const BEYOND: (i64, i64) = (1, 10_000_000_000_000);

/// The contact. A centre within the polytope has the distance from the nearest plane of a face, which is negative.
pub fn between(
    [sphere, polytope]: [&Shape; 2],
    hull: &Hull,
    definitions: &mut Vec<Definition>,
    at: Span,
) -> Vec<Touch> {
    let mut shared = Shared::pair([sphere, polytope], definitions, at);
    let shared = &mut shared;
    let solid = Solid::of(polytope, hull, shared);
    let from = sphere.at.from(&polytope.at);
    let place: Components = std::array::from_fn(|i| dot(&from, &axis(solid.frame, i)));
    let place = keep(place, "place of the centre", shared);
    let nearest = nearest(&solid, &place, shared);
    let normal = shared.vector(vector(solid.frame, nearest.normal), "normal of the nearest place");
    let radius = sphere.sizes.first().cloned().unwrap_or_else(|| integer(0));
    let point = sphere.at.plus(opposite(&scaled(radius.clone(), &normal)));
    vec![Touch::endless(point, normal, less(nearest.height, radius))]
}

/// What of a solid is nearest to a place.
pub struct Nearest {
    /// the unit vector to the place from what is nearest
    pub normal: Components,
    /// the distance; of a place within the solid the distance from the nearest plane of a face, which is negative
    pub height: Scalar,
}

/// What of a solid is nearest to a place.
pub fn nearest(solid: &Solid<'_>, place: &Components, shared: &mut Shared<'_>) -> Nearest {
    let heights: Vec<Scalar> = (solid.faces.iter())
        .map(|face| shared.scalar(Solid::over(face, place), "height of the centre"))
        .collect();
    let highest = heights.iter().cloned().reduce(greater).unwrap_or_else(|| integer(0));
    let inside = shared.scalar(step(opposite_of(highest)), "whether the centre is inside");
    let nearest_plane = greatest(&heights);
    // 1 for the face that is nearest, if it is a face: that over which the centre is, or of a centre inside the highest
    let mut none = integer(1);
    let mut chosen = Vec::new();
    for ((face, height), nearest) in solid.faces.iter().zip(&heights).zip(nearest_plane) {
        let sides = face.sides.iter().map(|side| Solid::within(side, place));
        let over = step(lesser(least(sides.collect()), height.clone()));
        let is_nearest = greater(over, product([inside.clone(), nearest]));
        let is_it = shared.scalar(product([none.clone(), is_nearest]), "whether a face is nearest");
        none = shared.scalar(less(none, is_it.clone()), "whether no face is nearest");
        chosen.push(is_it);
    }
    // what leads to the centre from the nearest point of all edges, and the square of its length as it is compared
    let mut nearest: Option<(Scalar, Components)> = None;
    for edge in &solid.edges {
        let from = keep(difference(place, &edge.middle), "distance from an edge", shared);
        let free = shared.scalar(inner(&from, &edge.direction), "place on the line of an edge");
        let along = shared.scalar(between_bounds(free.clone(), &edge.half_length), "place on an edge");
        let to: Components = std::array::from_fn(|i| {
            less(from[i].clone(), product([along.clone(), edge.direction[i].clone()]))
        });
        let to = keep(to, "distance from an edge", shared);
        let beyond = step(less(size(free), edge.half_length.clone()));
        let farther = sum([integer(1), product([ratio(BEYOND.0, BEYOND.1), beyond])]);
        let squared = shared.scalar(product([farther, inner(&to, &to)]), "distance from an edge");
        nearest = Some(match nearest {
            None => (squared, to),
            Some((best, way)) => {
                let nearer =
                    shared.scalar(step(less(best.clone(), squared.clone())), "whether an edge is nearer");
                let keeps = less(integer(1), nearer.clone());
                let mixed = std::array::from_fn(|i| {
                    let [new, old] = [(&nearer, &to[i]), (&keeps, &way[i])];
                    all([new, old].map(|(share, part)| product([share.clone(), part.clone()])))
                });
                let best = shared.scalar(lesser(best, squared), "distance from the nearest edge");
                (best, keep(mixed, "way from the nearest edge", shared))
            }
        });
    }
    let way = nearest.map_or_else(|| [1, 0, 0].map(integer), |(_, way)| way);
    let distance = shared.scalar(root(inner(&way, &way)), "distance from the nearest edge");
    let normal: Components = std::array::from_fn(|i| {
        let of_edge = product([none.clone(), quotient(way[i].clone(), distance.clone(), shared.at)]);
        let of_faces = chosen.iter().zip(&solid.faces);
        let of_faces = of_faces.map(|(chosen, face)| product([chosen.clone(), face.normal[i].clone()]));
        all(of_faces.chain([of_edge]))
    });
    let of_faces =
        chosen.iter().zip(&heights).map(|(chosen, height)| product([chosen.clone(), height.clone()]));
    let height = all(of_faces.chain([product([none, distance])]));
    Nearest { normal, height }
}
