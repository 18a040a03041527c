//! Vertices, axes and angles of boxes, for the contacts of all that has edges (sections 16.10 and 16.11 of
//! docs/theory.md).

use super::algebra::*;
use super::faces::{OVERLAPS, gap_of};
use super::features::Touch;
use super::shared::Shared;
use crate::model::mechanism::{Anchor, Scalar, Vector};

/// Edges whose angle has a sine below this are parallel: the vertices at their ends touch instead.
pub const PARALLEL: (i64, i64) = (1, 1_000_000);

/// On which side of the middle a vertex is, along each axis, in the order of [`super::features::corners`].
pub fn corner_signs() -> impl Iterator<Item = [i64; 3]> {
    (0..8).map(|number| [0, 1, 2].map(|i| if number >> i & 1 == 0 { 1 } else { -1 }))
}

/// The two other axes, so that all three are right-handed.
pub fn others(i: usize) -> [usize; 2] {
    [(i + 1) % 3, (i + 2) % 3]
}

/// Positive where edges are not parallel; of such that are it is minus the extent.
pub fn crossed(squared_sine: Scalar, extent: &Scalar) -> Scalar {
    let parallel = square(ratio(PARALLEL.1, PARALLEL.0));
    product([less(product([parallel, squared_sine]), integer(1)), extent.clone()])
}

/// The least of some bounds.
pub fn least(bounds: Vec<Scalar>) -> Scalar {
    bounds.into_iter().reduce(lesser).unwrap_or_else(|| integer(1))
}

/// A contact between features that end: with its normal and a tangent, its height and validity, and the distance and the
/// extent of the bodies. Where it is none, its gap is how far it is from that.
pub fn ending(
    point: Anchor,
    (normal, tangent): (Vector, Vector),
    (height, validity): (Scalar, Scalar),
    (distance, extent): (&Scalar, &Scalar),
    shared: &mut Shared<'_>,
) -> Touch {
    let validity = shared.scalar(validity, "validity of a contact");
    let apart = all([distance.clone(), product([ratio(OVERLAPS.0, OVERLAPS.1), extent.clone()])]);
    let gap = gap_of(height, opposite_of(validity.clone()), apart);
    Touch { point, normal, gap, validity: Some(validity), tangent: Some(tangent) }
}
