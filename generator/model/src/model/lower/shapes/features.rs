//! Where shapes touch, and of what they consist: axes and vertices.

use super::algebra::*;
use crate::model::mechanism::{Anchor, Kind, Scalar, Shape, Vector};

/// Where two shapes touch.
pub struct Touch {
    /// the point of the first shape
    pub point: Anchor,
    /// from the second to the first
    pub normal: Vector,
    /// their distance
    pub gap: Scalar,
    /// how far the place is within the features that touch, where these end
    pub validity: Option<Scalar>,
    /// a unit vector across the normal: the first of the two tangents, where the shapes have one to give
    pub tangent: Option<Vector>,
}

impl Touch {
    /// One between features that do not end.
    pub fn endless(point: Anchor, normal: Vector, gap: Scalar) -> Touch {
        Touch { point, normal, gap, validity: None, tangent: None }
    }
}

/// The axes of the frame along which a shape lies.
pub fn axes_of(shape: &Shape) -> [Vector; 3] {
    let frame = shape.axes.unwrap_or(shape.frame);
    [0, 1, 2].map(|i| axis(frame, i))
}

/// The vertices of a box, rectangle or polytope.
pub fn corners(shape: &Shape) -> Vec<Anchor> {
    let axes = axes_of(shape);
    let corner = |number: usize| {
        let sides = axes.iter().zip(&shape.sizes).enumerate().map(|(i, (e, size))| {
            let side = scaled(half(size), e);
            if number >> i & 1 == 0 { side } else { opposite(&side) }
        });
        shape.at.plus(total(sides))
    };
    match shape.kind {
        Kind::Polytope => shape.vertices.clone(),
        _ => (0..1 << shape.sizes.len()).map(corner).collect(),
    }
}
