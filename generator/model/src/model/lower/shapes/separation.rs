//! What tells how far bodies with edges are apart, and which of their edges are nearest (section 16.10 of
//! docs/theory.md).

use super::algebra::*;
use super::shared::Shared;
use crate::model::mechanism::Scalar;

/// Shares of the extent of both bodies: by how much a vertex may be beyond the end of a face, and by how much
/// the crossing of two edges must be within both, and a vertex of the second box from a corner of the first.
pub const REACH: (i64, i64) = (4, 1_000_000_000);
pub const WITHIN: (i64, i64) = (1, 1_000_000_000);
/// By how much bodies must overlap across a face, and by how much the height of a crossing may be less than the
/// distance of the bodies.
pub const OVERLAP: (i64, i64) = (8, 1_000_000_000);
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

/// On which sides of the middle, along two axes of a box, the two edges along the third are that can be nearest to
/// what is beyond them along a normal: `support` has the signs of the normal's two components, `components` their
/// sizes. Both edges bound the face that is most across the normal; the first has equal signs, the second has not.
pub fn nearest_edges(
    support: [Scalar; 2],
    components: [&Scalar; 2],
    shared: &mut Shared<'_>,
) -> [[Scalar; 2]; 2] {
    let steeper = sign(less(components[0].clone(), components[1].clone()));
    let steeper = shared.scalar(steeper, "which component across edges is greater");
    let lead = all([
        product([step(steeper.clone()), support[0].clone()]),
        product([less(integer(1), step(steeper.clone())), support[1].clone()]),
    ]);
    let lead = shared.scalar(lead, "side of the nearest edge");
    let other = shared.scalar(product([lead.clone(), steeper]), "side of the edge beside it");
    [[lead.clone(), lead], [other.clone(), opposite_of(other)]]
}
