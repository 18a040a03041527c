//! Contacts of rectangles, whose sides end: vertices of one on sides of the other (section 16.9 of docs/theory.md).
//!
//! Of a body the side counts whose line is furthest from the other body: convex bodies that touch in the inside of
//! a side are on both sides of its line. Each vertex of the other body has a contact with that side. Its gap is
//! positive wherever the vertex is outside of the body, and its validity tells how far it is from the edges.

use super::algebra::*;
use super::features::{Touch, axes_of, corners};
use crate::model::mechanism::{Anchor, Scalar, Shape, Vector};

/// By how much of the length of a side a vertex of the first shape may be beyond its end, and by how much
/// one of the second must be within. Vertices that coincide are one contact, that of the first, and a contact ends
/// after the one that takes its place has begun.
const REACH: (i64, i64) = (4, 1_000_000_000);
const WITHIN: (i64, i64) = (-1, 1_000_000_000);
/// By how much of the length of a side the bodies must overlap across a face: those that are side by side, flush, do
/// not touch from above.
const OVERLAP: (i64, i64) = (8, 1_000_000_000);

/// Bodies overlap that are apart, along every axis that might separate them, by less than minus this share of their
/// extent.
pub const OVERLAPS: (i64, i64) = (4, 1_000_000);
/// How much steeper than a distance the bound is that tells it.
pub const STEEP: i64 = 10_000_000;

/// The contacts: the vertices of the first with the second, then those of the second with the first.
pub fn between(first: &Shape, second: &Shape) -> Vec<Touch> {
    let (own, other) = (Face::of(second, first), Face::of(first, second));
    let along = own.apart.iter().chain(&other.apart).cloned().reduce(greater);
    let extent = [first, second].into_iter().flat_map(|shape| &shape.sizes).cloned().collect();
    let overlap = product([ratio(OVERLAPS.0, OVERLAPS.1), Scalar::Add(extent)]);
    let distance = sum([along.unwrap_or_else(|| integer(0)), overlap]);
    let strikes = corners(first).into_iter().map(|vertex| own.under(vertex, REACH, &distance));
    let struck = corners(second).into_iter().map(|vertex| {
        // the matter of the first shape that is at the vertex of the second
        let origin = Anchor { point: first.at.point, by: Vector::Zero };
        let there = Anchor { by: vertex.from(&origin), ..origin };
        let touch = other.under(vertex, WITHIN, &distance);
        Touch { point: there, normal: opposite(&touch.normal), ..touch }
    });
    strikes.chain(struck).collect()
}

/// The side of a rectangle whose line is furthest from another body.
struct Face<'s> {
    shape: &'s Shape,
    axes: Vec<Vector>,
    /// for each axis: 1 if the face is across it, else 0
    across: Vec<Scalar>,
    /// for each axis: the side on which the other body is, 1 or -1
    sides: Vec<Scalar>,
    /// for each axis: how far the bodies are apart along it
    apart: Vec<Scalar>,
}

impl<'s> Face<'s> {
    fn of(shape: &'s Shape, other: &Shape) -> Face<'s> {
        let axes: Vec<Vector> = axes_of(shape).into_iter().take(shape.sizes.len()).collect();
        let d = other.at.from(&shape.at);
        let away: Vec<Scalar> = axes.iter().map(|e| dot(&d, e)).collect();
        let apart: Vec<Scalar> = axes
            .iter()
            .zip(&shape.sizes)
            .zip(&away)
            .map(|((e, own), away)| {
                let reach = axes_of(other).into_iter().zip(&other.sizes);
                let reach = reach.map(|(a, length)| product([half(length), size(dot(&a, e))]));
                less(size(away.clone()), Scalar::Add(std::iter::once(half(own)).chain(reach).collect()))
            })
            .collect();
        let (across, sides) = (greatest(&apart), away.into_iter().map(sign).collect());
        Face { shape, axes, across, sides, apart }
    }

    /// The contact of a vertex of the other body; by `reach` times the length of a side it may be beyond its end. The
    /// bodies overlap where `distance` is negative.
    fn under(&self, vertex: Anchor, reach: (i64, i64), distance: &Scalar) -> Touch {
        let from = vertex.from(&self.shape.at);
        let share = |(n, d): (i64, i64), length: &Scalar| product([ratio(n, d), length.clone()]);
        let (mut gaps, mut bounds, mut normals) = (Vec::new(), Vec::new(), Vec::new());
        for (i, (e, length)) in self.axes.iter().zip(&self.shape.sizes).enumerate() {
            let (across, side) = (&self.across[i], &self.sides[i]);
            let along = less(integer(1), across.clone());
            let place = dot(&from, e);
            let beyond = less(size(place.clone()), half(length));
            // within the edge, and the bodies over each other; above the middle along the normal
            let within = less(share(reach, length), beyond.clone());
            let over = less(opposite_of(self.apart[i].clone()), share(OVERLAP, length));
            let above = product([across.clone(), side.clone(), place]);
            bounds.push(sum([product([along.clone(), lesser(within, over)]), above.clone()]));
            gaps.push(less(above, product([across.clone(), half(length)])));
            normals.push(scaled(product([across.clone(), side.clone()]), e));
        }
        let validity = bounds.into_iter().reduce(lesser).unwrap_or_else(|| integer(1));
        let gap = gap_of(Scalar::Add(gaps), opposite_of(validity.clone()), distance.clone());
        Touch { point: vertex, normal: total(normals), gap, validity: Some(validity), tangent: None }
    }
}

/// The gap of a contact: its height where it is one, elsewhere how far it is from that. Of bodies that overlap
/// (`distance` < 0) it is the height everywhere: of some contact it is negative.
pub(super) fn gap_of(height: Scalar, invalidity: Scalar, distance: Scalar) -> Scalar {
    greater(height, lesser(invalidity, product([integer(STEEP), distance])))
}

/// 1 for the greatest of some numbers, the first of equal ones, and 0 for the others.
pub(super) fn greatest(values: &[Scalar]) -> Vec<Scalar> {
    let mut out: Vec<Scalar> = Vec::new();
    for (i, value) in values.iter().enumerate() {
        // none before it was the greatest, and none behind it is greater
        let before = out.iter().map(|other| less(integer(1), other.clone()));
        let behind = values[i + 1..].iter().map(|other| step(less(value.clone(), other.clone())));
        let factors: Vec<Scalar> = before.chain(behind).collect();
        out.push(if factors.is_empty() { integer(1) } else { Scalar::Mul(factors) });
    }
    out
}
