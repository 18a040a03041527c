//! The segment of a capsule, and contacts of places on it with what is nearest to them (section 16.11 of
//! docs/theory.md).
//!
//! A capsule is what lies within r of a segment. All is written in components along the axes of a frame: a those of the
//! capsule's axis, d those of what leads from the place of the other solid to that of the capsule.

use super::algebra::*;
use super::features::Touch;
use super::separation::least;
use super::shared::Shared;
use crate::model::mechanism::{FrameId, Scalar, Shape, Vector};

/// The angle, rad, by which a normal may turn beyond the border of a contact before the contact ends. It is far above the
/// rounding of places, and does no harm: beyond the border the contact has the place and the normal of the neighbour that
/// takes over, or no neighbour takes over.
const TURN: (i64, i64) = (1, 1_000_000);
/// The same at borders beyond which the neighbour has another place and normal.
const FINE: (i64, i64) = (4, 10_000_000_000);

/// The segment of a capsule beside a solid.
pub struct Segment<'s> {
    pub capsule: &'s Shape,
    pub axis: Vector,
    pub radius: Scalar,
    pub half_length: Scalar,
    /// along whose axes components are
    pub frame: FrameId,
    /// components of the capsule's axis, and of its middle from the place of the solid
    pub a: [Scalar; 3],
    pub d: [Scalar; 3],
    /// the sum of all half lengths and of the radius
    pub extent: Scalar,
}

/// What a contact is of: the nearest place on the segment, and what leads there from the solid.
pub struct Near {
    /// from the middle of the capsule, along its axis
    pub t: Scalar,
    pub w: [Scalar; 3],
    /// the length of w
    pub distance: Scalar,
}

impl<'s> Segment<'s> {
    /// That of a capsule beside a solid whose half lengths have this sum.
    pub fn of(
        capsule: &'s Shape,
        solid: &Shape,
        (frame, half_lengths): (FrameId, Vec<Scalar>),
        shared: &mut Shared<'_>,
    ) -> Segment<'s> {
        let axis_of_it = capsule.axis.clone().unwrap_or(Vector::Zero);
        let sizes = |i: usize| capsule.sizes.get(i).cloned().unwrap_or_else(|| integer(0));
        let (radius, half_length) = (sizes(0), half(&sizes(1)));
        let from = capsule.at.from(&solid.at);
        let axes = [0, 1, 2].map(|i| axis(frame, i));
        let a = axes.each_ref().map(|e| shared.scalar(dot(&axis_of_it, e), "cosine"));
        let d = axes.each_ref().map(|e| shared.scalar(dot(&from, e), "distance of the middles"));
        let extent = all(half_lengths.into_iter().chain([radius.clone(), half_length.clone()]));
        let extent = shared.scalar(extent, "extent");
        Segment { capsule, axis: axis_of_it, radius, half_length, frame, a, d, extent }
    }

    /// What leads to a place on the segment from a place of the solid.
    pub fn near(&self, t: Scalar, from: &[Scalar; 3], shared: &mut Shared<'_>) -> Near {
        let w: [Scalar; 3] =
            std::array::from_fn(|i| all([from[i].clone(), product([t.clone(), self.a[i].clone()])]));
        let w = w.map(|w| shared.scalar(w, "distance from a feature"));
        let distance = norm(&Vector::Components(self.frame, Box::new(w.clone())));
        let distance = shared.scalar(distance, "distance from a feature");
        Near { t, w, distance }
    }

    /// The part of w along the segment.
    pub fn along(&self, near: &Near) -> Scalar {
        all((0..3).map(|i| product([near.w[i].clone(), self.a[i].clone()])))
    }

    /// How far a component of w may be on the other side of zero at most: an angle times the distance.
    pub fn whole_turn(&self, near: &Near) -> Scalar {
        product([ratio(TURN.0, TURN.1), near.distance.clone()])
    }

    /// The same at a place with this distance from the border to a neighbour with another normal. It is continuous there,
    /// since a zero of a validity that jumps would not be found.
    pub fn turn(&self, near: &Near, from_neighbour: Scalar) -> Scalar {
        let fine = product([ratio(FINE.0, FINE.1), near.distance.clone()]);
        lesser(self.whole_turn(near), all([fine, greater(from_neighbour, integer(0))]))
    }

    /// Between the ends w is across the segment.
    pub fn is_inside(&self, near: &Near) -> Vec<Scalar> {
        vec![less(self.whole_turn(near), size(self.along(near)))]
    }

    pub fn share(&self, (n, d): (i64, i64)) -> Scalar {
        product([ratio(n, d), self.extent.clone()])
    }

    /// The contact; where it is not valid its gap is positive. Where the bodies touch, the bounds are angles times the
    /// radius, and the validity is such an angle times the extent.
    pub fn touch(&self, near: &Near, bounds: Vec<Scalar>, shared: &mut Shared<'_>) -> Touch {
        let at = shared.at;
        let scale = quotient(self.extent.clone(), self.radius.clone(), at);
        let validity = shared.scalar(product([scale, least(bounds)]), "validity of a contact");
        let height = less(near.distance.clone(), self.radius.clone());
        let gap = greater(height, opposite_of(validity.clone()));
        let part = |w: &Scalar| quotient(w.clone(), near.distance.clone(), at);
        let normal = Vector::Components(self.frame, Box::new(near.w.each_ref().map(part)));
        let normal = shared.vector(normal, "normal of a contact");
        let by = total([scaled(near.t.clone(), &self.axis), opposite(&scaled(self.radius.clone(), &normal))]);
        let point = self.capsule.at.plus(by);
        Touch { point, normal, gap, validity: Some(validity), tangent: None }
    }

    /// The same of a contact that is one of many: its tangent is along the segment.
    pub fn one_of_many(&self, near: &Near, bounds: Vec<Scalar>, shared: &mut Shared<'_>) -> Touch {
        let touch = self.touch(near, bounds, shared);
        let along = dot(&self.axis, &touch.normal);
        let tangent = unit(&total([self.axis.clone(), opposite(&scaled(along, &touch.normal))]), shared.at);
        Touch { tangent: Some(tangent), ..touch }
    }
}
