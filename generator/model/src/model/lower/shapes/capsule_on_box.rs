//! Contacts of a capsule on a box, or on a rectangle in a plane of motion (section 16.11 of docs/theory.md).
//!
//! A capsule is what lies within r of a segment. The segment is nearest to the box with an end, with a place between
//! its ends at an edge, or with such a place at a vertex; where it lies along a face, the ends of what is over the face
//! are of these kinds too. The ends are balls on the box, which never end; the other contacts are valid between the ends
//! of the segment and of the edge.
//!
//! All is written in components along the axes of the box: a those of the capsule's axis, d those of what leads from the
//! middle of the box to that of the capsule.

use super::algebra::*;
use super::closed_forms::on_solid;
use super::faces::{OVERLAPS, gap_of};
use super::features::{Touch, axes_of};
use super::separation::*;
use super::shared::Shared;
use crate::model::mechanism::{Definition, FrameId, Kind, Scalar, Shape, Vector};
use crate::span::Span;

/// The number of contacts on a box: two ends, two edges along each of three axes, eight vertices.
pub const ON_BOX: usize = 2 + 3 * 2 + 8;
/// The number of contacts on a rectangle: two ends, two corners.
pub const ON_RECTANGLE: usize = 2 + 2;

/// The contacts: ends of the capsule, edges of the box, then its vertices.
pub fn between(capsule: &Shape, solid: &Shape, definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut touches: Vec<Touch> = ends(capsule).map(|ball| on_solid(&ball, solid, at)).into();
    let mut shared = Shared { definitions, shapes: [capsule, solid], at };
    let (pair, edges) = Pair::of(capsule, solid, &mut shared);
    for edge in &edges {
        let sides = pair.nearest(edge, &mut shared);
        touches.extend(sides.map(|sides| pair.on_edge(edge, &sides, &mut shared)));
    }
    if pair.is_solid {
        touches.extend(corner_signs().map(|signs| pair.on_vertex(&signs, &mut shared)));
    }
    debug_assert_eq!(touches.len(), if solid.kind == Kind::Box { ON_BOX } else { ON_RECTANGLE });
    touches
}

/// The balls at both ends.
fn ends(capsule: &Shape) -> [Shape; 2] {
    let along = capsule.axis.clone().unwrap_or(Vector::Zero);
    let half_length = capsule.sizes.get(1).map_or(integer(0), half);
    let by = scaled(half_length, &along);
    [by.clone(), opposite(&by)].map(|by| Shape {
        kind: Kind::Sphere,
        at: capsule.at.plus(by),
        sizes: capsule.sizes.iter().take(1).cloned().collect(),
        axis: None,
        ..capsule.clone()
    })
}

/// What the contacts of edges and vertices share.
struct Pair<'s> {
    capsule: &'s Shape,
    axis: Vector,
    radius: Scalar,
    half_length: Scalar,
    /// whether it is a box, not a rectangle
    is_solid: bool,
    /// the frame of the box, and its half sides; the third of a rectangle is 0
    frame: FrameId,
    half: [Scalar; 3],
    /// components of the capsule's axis, and of its middle from that of the box
    a: [Scalar; 3],
    d: [Scalar; 3],
    /// the sum of all half lengths and of the radius
    extent: Scalar,
    /// how far the segment and the box are apart along any of the axes that might separate them; the second without
    /// those across edges parallel to the segment
    distance: Scalar,
    overlap: Scalar,
}

/// An edge direction of the box beside the segment.
struct Across {
    /// which axis of the box, and the two others
    j: usize,
    others: [usize; 2],
    /// squared sine of the angle of edge and segment, and the sine, no less than that of parallel ones
    square: Scalar,
    sine: Scalar,
    /// 1 or -1, so that with it a x b_j leads from the box to the capsule
    turned: Scalar,
}

impl<'s> Pair<'s> {
    /// The pair, and the directions of the edges.
    fn of(capsule: &'s Shape, solid: &Shape, shared: &mut Shared<'_>) -> (Pair<'s>, Vec<Across>) {
        let is_solid = solid.kind == Kind::Box;
        let axis = capsule.axis.clone().unwrap_or(Vector::Zero);
        let sizes = |i: usize| capsule.sizes.get(i).cloned().unwrap_or_else(|| integer(0));
        let (radius, half_length) = (sizes(0), half(&sizes(1)));
        let half: [Scalar; 3] = [0, 1, 2].map(|i| solid.sizes.get(i).map_or(integer(0), half));
        let from = capsule.at.from(&solid.at);
        let axes = axes_of(solid);
        let a = axes.each_ref().map(|e| shared.scalar(dot(&axis, e), "cosine"));
        let d = axes.each_ref().map(|e| shared.scalar(dot(&from, e), "distance of the middles"));
        let lengths = half.iter().cloned().chain([radius.clone(), half_length.clone()]);
        let extent = shared.scalar(all(lengths), "extent");
        // a rectangle has corners alone, which are edges along the third axis
        let along = if is_solid { 0..3 } else { 2..3 };
        let mut distances: Vec<Scalar> = Vec::new();
        for i in 0..solid.sizes.len() {
            let reach = all([half[i].clone(), product([half_length.clone(), size(a[i].clone())])]);
            distances.push(shared.scalar(less(size(d[i].clone()), reach), "distance along an axis"));
        }
        let mut known = distances.clone();
        let mut edges = Vec::new();
        for j in along {
            let [k, l] = others(j);
            let squared = all([square(a[k].clone()), square(a[l].clone())]);
            let squared = shared.scalar(squared, "squared sine");
            let floor = square(ratio(PARALLEL.0, PARALLEL.1));
            let sine = shared.scalar(root(greater(squared.clone(), floor)), "sine of edges that are not parallel");
            let apart =
                less(product([d[k].clone(), a[l].clone()]), product([d[l].clone(), a[k].clone()]));
            let apart = shared.scalar(apart, "distance of the middles across edges");
            let reach = all([
                product([half[k].clone(), size(a[l].clone())]),
                product([half[l].clone(), size(a[k].clone())]),
            ]);
            let distance = quotient(less(size(apart.clone()), reach), sine.clone(), shared.at);
            let distance = shared.scalar(distance, "distance across edges");
            known.push(lesser(distance.clone(), crossed(squared.clone(), &extent)));
            distances.push(distance);
            let turned = shared.scalar(sign(apart.clone()), "side of edges");
            edges.push(Across { j, others: [k, l], square: squared, sine, turned });
        }
        let mut greatest_of = |distances: Vec<Scalar>, what: &str| {
            let greatest = distances.into_iter().reduce(greater).unwrap_or_else(|| integer(0));
            shared.scalar(greatest, what)
        };
        let distance = greatest_of(distances, "distance of the segment");
        let overlap = greatest_of(known, "distance of the segment across edges that are not parallel");
        let frame = solid.axes.unwrap_or(solid.frame);
        let pair =
            Pair { capsule, axis, radius, half_length, is_solid, frame, half, a, d, extent, distance, overlap };
        (pair, edges)
    }

    fn share(&self, (n, d): (i64, i64)) -> Scalar {
        product([ratio(n, d), self.extent.clone()])
    }

    /// On which sides of the middle the two edges are that can be nearest: both bound the face that is most across the
    /// common normal, whose components are turned a_l and -turned a_k.
    fn nearest(&self, edge: &Across, shared: &mut Shared<'_>) -> [[Scalar; 2]; 2] {
        let [k, l] = edge.others;
        let way = |sign_of: i64, c: &Scalar| signed(sign_of, product([edge.turned.clone(), sign(c.clone())]));
        let support = [way(1, &self.a[l]), way(-1, &self.a[k])];
        nearest_edges(support, [&size(self.a[l].clone()), &size(self.a[k].clone())], shared)
    }

    /// The contact of a place between the ends with an edge.
    fn on_edge(&self, edge: &Across, sides: &[Scalar; 2], shared: &mut Shared<'_>) -> Touch {
        let (j, [k, l]) = (edge.j, edge.others);
        let a = |i: usize| self.a[i].clone();
        // from the middle of the edge to that of the capsule
        let across = [(k, &sides[0]), (l, &sides[1])]
            .map(|(i, side)| less(self.d[i].clone(), product([side.clone(), self.half[i].clone()])));
        let [w_k, w_l] = across.map(|w| shared.scalar(w, "distance from an edge"));
        let height = less(product([w_k.clone(), a(l)]), product([w_l.clone(), a(k)]));
        let height = quotient(product([edge.turned.clone(), height]), edge.sine.clone(), shared.at);
        let height = shared.scalar(height, "height over an edge");
        let along = opposite_of(all([product([w_k, a(k)]), product([w_l, a(l)])]));
        let t = shared.scalar(
            quotient(along, square(edge.sine.clone()), shared.at),
            "place on the segment",
        );
        let mut bounds = vec![self.between_ends(t.clone())];
        if self.is_solid {
            let u = all([self.d[j].clone(), product([t.clone(), a(j)])]);
            bounds.push(less(less(self.half[j].clone(), size(u)), self.share(WITHIN)));
            bounds.push(crossed(edge.square.clone(), &self.extent));
        }
        // steep, so that it hides none of the other bounds where the height is the distance
        let above = product([ratio(OVERLAP.1, OVERLAP.0), less(height.clone(), self.distance.clone())]);
        let reached = greater(all([above, self.extent.clone()]), opposite_of(self.extent.clone()));
        bounds.push(reached);
        let part = |sign: i64, c: Scalar| {
            quotient(signed(sign, product([edge.turned.clone(), c])), edge.sine.clone(), shared.at)
        };
        let mut components = [integer(0), integer(0), integer(0)];
        (components[k], components[l]) = (part(1, a(l)), part(-1, a(k)));
        let normal = Vector::Components(self.frame, Box::new(components));
        let normal = shared.vector(normal, "normal at an edge");
        self.touch(t, normal, (height, least(bounds)), shared)
    }

    /// The contact of a place between the ends with a vertex, which is on these sides of the middle.
    fn on_vertex(&self, signs: &[i64; 3], shared: &mut Shared<'_>) -> Touch {
        let from: [Scalar; 3] = std::array::from_fn(|i| {
            less(self.d[i].clone(), signed(signs[i], self.half[i].clone()))
        });
        let from = from.map(|w| shared.scalar(w, "distance from a vertex"));
        let terms = (0..3).map(|i| product([from[i].clone(), self.a[i].clone()]));
        let free = shared.scalar(opposite_of(all(terms)), "place on the segment");
        let t = shared.scalar(between_bounds(free.clone(), &self.half_length), "place between the ends");
        let w: [Scalar; 3] = std::array::from_fn(|i| {
            all([from[i].clone(), product([t.clone(), self.a[i].clone()])])
        });
        let w = w.map(|w| shared.scalar(w, "distance from a vertex"));
        let mut bounds = vec![self.between_ends(free)];
        // the normal leads out of all three faces that meet
        bounds.extend((0..3).map(|i| all([signed(signs[i], w[i].clone()), self.share(REACH)])));
        let w = Vector::Components(self.frame, Box::new(w));
        let height = shared.scalar(norm(&w), "distance from a vertex");
        self.touch(t, unit(&w, shared.at), (height, least(bounds)), shared)
    }

    /// How far a place on the segment is from its ends.
    fn between_ends(&self, t: Scalar) -> Scalar {
        less(less(self.half_length.clone(), size(t)), self.share(WITHIN))
    }

    /// The contact at a place on the segment; where it is none, its gap is how far it is from that.
    fn touch(
        &self,
        t: Scalar,
        normal: Vector,
        (height, validity): (Scalar, Scalar),
        shared: &mut Shared<'_>,
    ) -> Touch {
        let validity = shared.scalar(validity, "validity of a contact");
        let apart = all([self.overlap.clone(), self.share(OVERLAPS)]);
        let gap = gap_of(less(height, self.radius.clone()), opposite_of(validity.clone()), apart);
        let by = total([scaled(t, &self.axis), opposite(&scaled(self.radius.clone(), &normal))]);
        let point = self.capsule.at.plus(by);
        Touch { point, normal, gap, validity: Some(validity), tangent: None }
    }
}
