//! Contacts of a capsule on a box, or on a rectangle in a plane of motion (section 16.11 of docs/theory.md).
//!
//! A capsule's contacts are those of the ends of the segment with the box, of the
//! segment with each edge, and of the segment with each vertex. Each gap is the distance of these two minus r: no less
//! than that of the bodies. Each is valid where the two are nearest to each other, and a little beyond, where it has the
//! place and the normal of the neighbour that takes over from it.
//!
//! All is written in components along the axes of the box: a those of the capsule's axis, d those of what leads from the
//! middle of the box to that of the capsule.

use super::algebra::*;
use super::faces::{OVERLAPS, STEEP};
use super::features::Touch;
use super::segment::Segment;
use super::separation::*;
use super::shared::Shared;
use crate::model::mechanism::{Definition, Kind, Scalar, Shape};
use crate::span::Span;

/// The number of contacts on a box: two ends, twelve edges, eight vertices.
pub const ON_BOX: usize = 2 + 12 + 8;
/// The number of contacts on a rectangle: two ends, four corners.
pub const ON_RECTANGLE: usize = 2 + 4;

/// The contacts: ends of the capsule, then edges of the box along x, y and z, then its vertices.
pub fn between(capsule: &Shape, solid: &Shape, definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut shared = Shared::pair([capsule, solid], definitions, at);
    let pair = Pair::of(capsule, solid, &mut shared);
    let mut touches: Vec<Touch> = [1, -1].map(|end| pair.end(end, &mut shared)).into();
    if solid.kind == Kind::Box {
        for j in 0..3 {
            touches.extend(SIDES.map(|sides| pair.on_edge(j, sides, &mut shared)));
        }
    }
    let vertices = corner_signs().take(1 << solid.sizes.len());
    touches.extend(vertices.map(|signs| pair.on_vertex(&signs, &mut shared)));
    debug_assert_eq!(touches.len(), if solid.kind == Kind::Box { ON_BOX } else { ON_RECTANGLE });
    touches
}

/// On which sides of the middle an edge is, along the two axes across it.
const SIDES: [[i64; 2]; 4] = [[1, 1], [-1, 1], [1, -1], [-1, -1]];

struct Pair<'s> {
    segment: Segment<'s>,
    /// half sides of the box, of which a rectangle has two
    half: Vec<Scalar>,
    /// how far the segment and the box are apart along any of the axes that might separate them: of a segment that
    /// passes through the box it is negative
    apart: Scalar,
}

impl<'s> std::ops::Deref for Pair<'s> {
    type Target = Segment<'s>;

    fn deref(&self) -> &Segment<'s> {
        &self.segment
    }
}

impl<'s> Pair<'s> {
    fn of(capsule: &'s Shape, solid: &Shape, shared: &mut Shared<'_>) -> Pair<'s> {
        let half: Vec<Scalar> = solid.sizes.iter().map(half).collect();
        let frame = solid.axes.unwrap_or(solid.frame);
        let segment = Segment::of(capsule, solid, (frame, half.clone()), shared);
        let pair = Pair { segment, half, apart: integer(0) };
        let apart = shared.scalar(pair.separation(shared.at), "distance of the segment");
        Pair { apart, ..pair }
    }

    /// How far the segment and the box are apart along the axes of the box, and along the products of these with the
    /// capsule's, but for those of parallel edges.
    fn separation(&self, at: Span) -> Scalar {
        let flat = self.half.len() == 2;
        let along = (0..self.half.len()).map(|i| {
            let reach =
                all([self.half[i].clone(), product([self.half_length.clone(), size(self.a[i].clone())])]);
            less(size(self.d[i].clone()), reach)
        });
        let edges = if flat { 2..3 } else { 0..3 };
        let across = edges.map(|j| {
            let [k, l] = others(j);
            let component = |i: usize| self.a[i].clone();
            let middles =
                less(product([self.d[k].clone(), component(l)]), product([self.d[l].clone(), component(k)]));
            let reach = all([
                product([self.half[k].clone(), size(component(l))]),
                product([self.half[l].clone(), size(component(k))]),
            ]);
            let distance = quotient(less(size(middles), reach), self.sine(j), at);
            if flat { distance } else { lesser(distance, crossed(self.squared_sine(j), &self.extent)) }
        });
        along.chain(across).reduce(greater).unwrap_or_else(|| integer(0))
    }

    /// Of the angle between the segment and the edges along an axis.
    fn squared_sine(&self, j: usize) -> Scalar {
        let [k, l] = others(j);
        all([square(self.a[k].clone()), square(self.a[l].clone())])
    }

    /// The sine, no less than that of parallel edges.
    fn sine(&self, j: usize) -> Scalar {
        root(greater(self.squared_sine(j), square(ratio(PARALLEL.0, PARALLEL.1))))
    }

    /// 1 where edges along an axis are not parallel to the segment, so that they have contacts with it, else 0.
    fn crosses(&self, j: usize) -> Scalar {
        step(less(self.squared_sine(j), square(ratio(PARALLEL.0, PARALLEL.1))))
    }

    /// The contact of an end, on this side of the middle: a ball on the box. It is the nearest place of the segment
    /// where w does not lead back along it; an edge or a vertex takes over there. Over a face, and over an edge parallel
    /// to the segment, nothing does, and the normal may turn.
    fn end(&self, side: i64, shared: &mut Shared<'_>) -> Touch {
        let t = signed(side, self.half_length.clone());
        let place: [Scalar; 3] = std::array::from_fn(|i| {
            let place = all([self.d[i].clone(), product([t.clone(), self.a[i].clone()])]);
            shared.scalar(place, "place of an end")
        });
        // from the nearest point of the box
        let from: [Scalar; 3] = std::array::from_fn(|i| {
            let held = self.half.get(i).map_or(integer(0), |half| between_bounds(place[i].clone(), half));
            less(self.d[i].clone(), held)
        });
        let beyond: Vec<Scalar> = (self.half.iter().zip(&place))
            .map(|(half, place)| {
                shared.scalar(less(size(place.clone()), half.clone()), "place of an end beyond a face")
            })
            .collect();
        let both = |k: usize, l: usize| lesser(beyond[k].clone(), beyond[l].clone());
        let taken_over = match self.half.len() {
            3 => (0..3)
                .map(|j| {
                    let crosses = self.crosses(j);
                    let nothing = product([less(crosses.clone(), integer(1)), self.extent.clone()]);
                    all([product([crosses, both(others(j)[0], others(j)[1])]), nothing])
                })
                .reduce(greater)
                .unwrap_or_else(|| integer(0)),
            _ => both(0, 1),
        };
        let near = self.near(t, &from, shared);
        let back = signed(side, self.along(&near));
        let validity = less(self.turn(&near, opposite_of(taken_over)), back);
        let touch = self.touch(&near, vec![validity], shared);
        // a segment that passes through the box is deeper than its distance, which is negative, tells
        let passes = product([integer(STEEP), all([self.apart.clone(), self.share(OVERLAPS)])]);
        let depth = greater(passes, less(self.apart.clone(), self.radius.clone()));
        Touch { gap: lesser(touch.gap, depth), ..touch }
    }

    /// The contact with an edge along the axis j, which is on these sides of the middle along the two others.
    fn on_edge(&self, j: usize, sides: [i64; 2], shared: &mut Shared<'_>) -> Touch {
        let [k, l] = others(j);
        let a = |i: usize| self.a[i].clone();
        // from the middle of the edge to that of the capsule
        let mut from = self.d.clone();
        for (i, side) in [(k, sides[0]), (l, sides[1])] {
            let beside = less(self.d[i].clone(), signed(side, self.half[i].clone()));
            from[i] = shared.scalar(beside, "distance from an edge");
        }
        let across = all([product([from[k].clone(), a(k)]), product([from[l].clone(), a(l)])]);
        let across = shared.scalar(across, "distance from an edge along the segment");
        // the nearest places of the two lines, each held within its bounds and then found again for the other
        let sine = square(self.sine(j));
        let free = quotient(opposite_of(across.clone()), sine, shared.at);
        let guess = shared.scalar(between_bounds(free, &self.half_length), "place on the segment");
        let u = all([self.d[j].clone(), product([guess, a(j)])]);
        let u = shared.scalar(u, "place on the line of an edge");
        let inside_edge = less(self.half[j].clone(), size(u.clone()));
        let u = shared.scalar(between_bounds(u, &self.half[j]), "place on an edge");
        from[j] = shared.scalar(less(self.d[j].clone(), u), "distance from a place on an edge");
        let t = opposite_of(all([product([from[j].clone(), a(j)]), across]));
        let t = shared.scalar(t, "place on the line of the segment");
        let inside_both = lesser(inside_edge, less(self.half_length.clone(), size(t.clone())));
        let t = shared.scalar(between_bounds(t, &self.half_length), "place on the segment");
        let near = self.near(t, &from, shared);
        let mut bounds = self.is_inside(&near);
        bounds.push(less(self.whole_turn(&near), size(near.w[j].clone())));
        // where both are inside, and the segment lies on a face, nothing takes over
        let turn = shared.scalar(self.turn(&near, inside_both), "turn of a normal");
        bounds.extend(
            [(k, sides[0]), (l, sides[1])]
                .map(|(i, side)| all([signed(side, near.w[i].clone()), turn.clone()])),
        );
        bounds.push(crossed(self.squared_sine(j), &self.radius));
        self.one_of_many(&near, bounds, shared)
    }

    /// The contact with a vertex, which is on these sides of the middle: w leads out of all faces that meet there. Edges
    /// take over, but for those parallel to the segment, and in a plane, where the normal may turn.
    fn on_vertex(&self, signs: &[i64; 3], shared: &mut Shared<'_>) -> Touch {
        let from: [Scalar; 3] = std::array::from_fn(|i| match self.half.get(i) {
            Some(half) => less(self.d[i].clone(), signed(signs[i], half.clone())),
            None => self.d[i].clone(),
        });
        let from = from.map(|w| shared.scalar(w, "distance from a vertex"));
        let t = opposite_of(all((0..3).map(|i| product([from[i].clone(), self.a[i].clone()]))));
        let t = shared.scalar(t, "place on the line of the segment");
        let inside = less(self.half_length.clone(), size(t.clone()));
        let t = shared.scalar(between_bounds(t, &self.half_length), "place on the segment");
        let near = self.near(t, &from, shared);
        let mut bounds = self.is_inside(&near);
        bounds.extend((0..self.half.len()).map(|i| {
            let may_turn = match self.half.len() {
                3 => product([less(integer(1), self.crosses(i)), inside.clone()]),
                _ => inside.clone(),
            };
            all([signed(signs[i], near.w[i].clone()), self.turn(&near, may_turn)])
        }));
        match self.half.len() {
            3 => self.one_of_many(&near, bounds, shared),
            _ => self.touch(&near, bounds, shared),
        }
    }
}
