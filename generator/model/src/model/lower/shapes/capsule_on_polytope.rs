//! Contacts of a capsule on a polytope (section 16.12 of docs/theory.md).
//!
//! They are those of the ends of the segment with the polytope, of the segment with each edge, and of the segment with
//! each vertex, as on a box: each gap is the distance of these two minus r, and each is valid where the two are nearest to
//! each other.

use super::algebra::*;
use super::faces::{OVERLAPS, STEEP};
use super::features::Touch;
use super::segment::{Near, Segment};
use super::separation::*;
use super::shared::Shared;
use super::solids::*;
use super::sphere_on_polytope::nearest;
use crate::model::hulls::Hull;
use crate::model::mechanism::{Definition, Scalar, Shape};
use crate::span::Span;

/// How steep the bounds are within which the height over an edge counts: where the normal is not within those of the faces
/// there, it has no sign.
const SHARP: i64 = 100_000_000;

/// The contacts: ends of the capsule, then edges of the polytope, then its vertices.
pub fn between(
    [capsule, polytope]: [&Shape; 2],
    hull: &Hull,
    definitions: &mut Vec<Definition>,
    at: Span,
) -> Vec<Touch> {
    let mut shared = Shared::pair([capsule, polytope], definitions, at);
    let shared = &mut shared;
    let solid = Solid::of(polytope, hull, shared);
    let pair = Pair::of(capsule, solid, shared);
    let mut touches: Vec<Touch> = [1, -1].map(|end| pair.end(end, shared)).into();
    touches.extend((0..pair.edges.len()).map(|edge| pair.on_edge(edge, shared)));
    touches.extend((0..pair.solid.vertices.len()).map(|vertex| pair.on_vertex(vertex, shared)));
    touches
}

struct Pair<'s> {
    segment: Segment<'s>,
    solid: Solid<'s>,
    /// for each edge of the solid
    edges: Vec<Crossing>,
    /// how far the segment and the solid are apart along any of the vectors that might separate them: of a segment that
    /// passes through the solid it is negative
    apart: Scalar,
}

/// An edge of the solid beside the segment.
struct Crossing {
    /// the cosine of their angle, and the square of its sine
    cosine: Scalar,
    square: Scalar,
    /// the square, no less than that of parallel edges
    divisor: Scalar,
    /// 1 where the two are not parallel, else 0
    crosses: Scalar,
    /// from the middle of the edge to that of the segment
    from: Components,
}

impl Crossing {
    fn of(edge: &SolidEdge, segment: &Segment<'_>, shared: &mut Shared<'_>) -> Crossing {
        let cosine = shared.scalar(inner(&edge.direction, &segment.a), "cosine of an edge");
        let cross = keep(outer(&edge.direction, &segment.a), "product of an edge and the axis", shared);
        let square_of = shared.scalar(inner(&cross, &cross), "squared sine");
        let parallel = square(ratio(PARALLEL.0, PARALLEL.1));
        let divisor = shared.scalar(greater(square_of.clone(), parallel.clone()), "squared sine");
        let crosses =
            shared.scalar(step(less(square_of.clone(), parallel)), "whether an edge is not parallel");
        let from = keep(difference(&segment.d, &edge.middle), "distance from an edge", shared);
        Crossing { cosine, square: square_of, divisor, crosses, from }
    }
}

impl<'s> std::ops::Deref for Pair<'s> {
    type Target = Segment<'s>;

    fn deref(&self) -> &Segment<'s> {
        &self.segment
    }
}

impl<'s> Pair<'s> {
    fn of(capsule: &'s Shape, solid: Solid<'s>, shared: &mut Shared<'_>) -> Pair<'s> {
        let around = (solid.frame, vec![solid.extent()]);
        let segment = Segment::of(capsule, solid.shape, around, shared);
        let edges = solid.edges.iter().map(|edge| Crossing::of(edge, &segment, shared)).collect();
        let pair = Pair { segment, solid, edges, apart: integer(0) };
        let apart = pair.separation(shared);
        Pair { apart: shared.scalar(apart, "distance of the segment"), ..pair }
    }

    /// How far the segment and the solid are apart along the normals of faces, and along products of edges with the
    /// segment that are within the normals of the faces there (16.8).
    fn separation(&self, shared: &mut Shared<'_>) -> Scalar {
        let faces = self.solid.faces.iter().map(|face| {
            let reach = product([self.half_length.clone(), size(inner(&face.normal, &self.a))]);
            less(Solid::over(face, &self.d), reach)
        });
        let mut apart: Vec<Scalar> = faces.collect();
        for (edge, crossing) in self.solid.edges.iter().zip(&self.edges) {
            let cross = outer(&edge.direction, &self.a);
            // n supports the solid where it leads out of both faces, across the edge
            let leads_in = edge.of.faces.map(|f| inner(&cross, &self.inward(f, edge)));
            let [left, right] = leads_in.map(|part| shared.scalar(part, "normal within those of faces"));
            let turned = sign(opposite_of(all([left.clone(), right.clone()])));
            let turned = shared.scalar(turned, "side of an edge");
            let sine = root(crossing.divisor.clone());
            let of_both = lesser(
                opposite_of(product([turned.clone(), left])),
                opposite_of(product([turned.clone(), right])),
            );
            let supports =
                product([integer(SHARP), quotient(of_both, sine.clone(), shared.at), self.extent.clone()]);
            let height = quotient(product([turned, inner(&cross, &crossing.from)]), sine, shared.at);
            let counts = lesser(supports, crossed(crossing.square.clone(), &self.extent));
            apart.push(shared.scalar(lesser(height, counts), "height over an edge"));
        }
        apart.into_iter().reduce(greater).unwrap_or_else(|| integer(0))
    }

    /// The vector in a face, across one of its edges, towards the inside.
    fn inward(&self, face: usize, edge: &SolidEdge) -> Components {
        let is_it = |side: &&Side| {
            let of = &self.solid.edges[side.edge].of;
            of.ends == edge.of.ends
        };
        let side = self.solid.faces[face].sides.iter().find(is_it);
        side.map_or_else(|| [0, 1, 2].map(integer), |side| side.inward.clone())
    }

    /// The contact of an end, on this side of the middle: a ball on the solid. It is the nearest place of the segment
    /// where w does not lead back along it; an edge or a vertex takes over there. Over a face, and beyond its sides that
    /// are parallel to the segment, nothing does, and the normal may turn.
    fn end(&self, side: i64, shared: &mut Shared<'_>) -> Touch {
        let t = signed(side, self.half_length.clone());
        let place: Components =
            std::array::from_fn(|i| all([self.d[i].clone(), product([t.clone(), self.a[i].clone()])]));
        let place = keep(place, "place of an end", shared);
        let nearest = nearest(&self.solid, &place, shared);
        let height = shared.scalar(nearest.height, "distance of an end");
        let w: Components = std::array::from_fn(|i| product([height.clone(), nearest.normal[i].clone()]));
        let near = Near { t, w: keep(w, "distance from a feature", shared), distance: height };
        let within = self.solid.faces.iter().map(|face| {
            let sides = face.sides.iter().map(|side| {
                let crosses = self.edges[side.edge].crosses.clone();
                let parallel = product([less(integer(1), crosses), self.extent.clone()]);
                all([Solid::within(side, &place), parallel])
            });
            lesser(least(sides.collect()), Solid::over(face, &place))
        });
        let from_neighbour = within.reduce(greater).unwrap_or_else(|| integer(0));
        let back = signed(side, self.along(&near));
        let validity = less(self.turn(&near, from_neighbour), back);
        let touch = self.touch(&near, vec![validity], shared);
        // a segment that passes through the solid is deeper than the distances of its ends tell
        let passes = product([integer(STEEP), all([self.apart.clone(), self.share(OVERLAPS)])]);
        let depth = greater(passes, less(self.apart.clone(), self.radius.clone()));
        Touch { gap: lesser(touch.gap, depth), ..touch }
    }

    /// The contact with an edge: the nearest places of two lines, each held within its bounds and then found again for the
    /// other.
    fn on_edge(&self, number: usize, shared: &mut Shared<'_>) -> Touch {
        let (edge, crossing) = (&self.solid.edges[number], &self.edges[number]);
        let e = &edge.direction;
        let along_edge = shared.scalar(inner(&crossing.from, e), "place of the middle along an edge");
        // what is left of w at the edge's line
        let beside: Components = std::array::from_fn(|i| {
            less(crossing.from[i].clone(), product([along_edge.clone(), e[i].clone()]))
        });
        let beside = keep(beside, "distance from the line of an edge", shared);
        let across = shared.scalar(inner(&beside, &self.a), "distance from an edge along the segment");
        let free = quotient(opposite_of(across.clone()), crossing.divisor.clone(), shared.at);
        let guess = shared.scalar(between_bounds(free, &self.half_length), "place on the segment");
        let u = all([along_edge.clone(), product([guess, crossing.cosine.clone()])]);
        let u = shared.scalar(u, "place on the line of an edge");
        let inside_edge = less(edge.half_length.clone(), size(u.clone()));
        let u = shared.scalar(between_bounds(u, &edge.half_length), "place on an edge");
        let rest = shared.scalar(less(along_edge, u), "distance from a place on an edge");
        let from: Components =
            std::array::from_fn(|i| all([beside[i].clone(), product([rest.clone(), e[i].clone()])]));
        let from = keep(from, "distance from a place on an edge", shared);
        let t = opposite_of(all([product([rest, crossing.cosine.clone()]), across]));
        let t = shared.scalar(t, "place on the line of the segment");
        let inside_both = lesser(inside_edge, less(self.half_length.clone(), size(t.clone())));
        let t = shared.scalar(between_bounds(t, &self.half_length), "place on the segment");
        let near = self.near(t, &from, shared);
        let mut bounds = self.is_inside(&near);
        bounds.push(less(self.whole_turn(&near), size(inner(&near.w, e))));
        // where both are inside, and the segment lies on a face, nothing takes over
        let turn = shared.scalar(self.turn(&near, inside_both), "turn of a normal");
        bounds.extend(edge.of.faces.map(|f| less(turn.clone(), inner(&near.w, &self.inward(f, edge)))));
        bounds.push(crossed(crossing.square.clone(), &self.radius));
        self.one_of_many(&near, bounds, shared)
    }

    /// The contact with a vertex: w leads back along no edge that begins there. Edges take over, but for those parallel
    /// to the segment, where the normal may turn.
    fn on_vertex(&self, number: usize, shared: &mut Shared<'_>) -> Touch {
        let from = keep(difference(&self.d, &self.solid.vertices[number]), "distance from a vertex", shared);
        let t = shared.scalar(opposite_of(inner(&from, &self.a)), "place on the line of the segment");
        let inside = less(self.half_length.clone(), size(t.clone()));
        let t = shared.scalar(between_bounds(t, &self.half_length), "place on the segment");
        let near = self.near(t, &from, shared);
        let mut bounds = self.is_inside(&near);
        for (edge, crossing) in self.solid.edges.iter().zip(&self.edges) {
            let Some(end) = edge.of.ends.iter().position(|end| *end == number) else { continue };
            let leads_back = signed(if end == 0 { 1 } else { -1 }, inner(&near.w, &edge.direction));
            let may_turn = product([less(integer(1), crossing.crosses.clone()), inside.clone()]);
            bounds.push(less(self.turn(&near, may_turn), leads_back));
        }
        self.one_of_many(&near, bounds, shared)
    }
}
