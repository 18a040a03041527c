//! Equations that contacts solve by iteration: a bounded number of steps, written out (section 16.13 of docs/theory.md).
//!
//! What an iteration finds is frozen: derivatives take no notice of it. From it two of Newton's steps follow that are
//! differentiated; they double its digits twice, and have the first three derivatives of the solution.

use super::algebra::*;
use super::shared::Shared;
use crate::arithmetic::Function;
use crate::model::mechanism::Scalar;

/// How many of Newton's steps are differentiated.
const DIFFERENTIATED: usize = 2;

/// What may be left of an equation after the iteration, relative to its terms: above the rounding of singles, and so little
/// that nothing but rounding is left after two of Newton's steps.
const FOUND: (i64, i64) = (1, 100_000);

/// What an iteration found.
pub struct Solution<const N: usize> {
    /// what the iteration itself came to, of which derivatives take no notice
    pub frozen: [Scalar; N],
    /// this after Newton's steps
    pub exact: [Scalar; N],
}

/// Steps from a start, of which derivatives take no notice, and then Newton's, of which they do. Numbers are given to
/// all that use them.
pub fn solved<const N: usize>(
    start: [Scalar; N],
    steps: usize,
    mut step: impl FnMut([Scalar; N], &mut Shared<'_>) -> [Scalar; N],
    mut newton: impl FnMut([Scalar; N], &mut Shared<'_>) -> [Scalar; N],
    what: &str,
    shared: &mut Shared<'_>,
) -> Solution<N> {
    let mut found = start.map(|start| shared.scalar(freeze(start), what));
    for _ in 0..steps {
        found = step(found, shared).map(|next| shared.scalar(freeze(next), what));
    }
    let frozen = found.clone();
    for _ in 0..DIFFERENTIATED {
        found = newton(found, shared).map(|next| shared.scalar(next, what));
    }
    Solution { frozen, exact: found }
}

/// 1 where what is left of an equation is small enough beside its terms, else 0.
pub fn is_found(rest: Scalar, terms: Scalar) -> Scalar {
    step(less(product([ratio(FOUND.0, FOUND.1), terms]), size(rest)))
}

/// The value, of which derivatives take no notice.
pub fn freeze(value: Scalar) -> Scalar {
    Scalar::Call(Function::Frozen, vec![value])
}

/// `a` where a condition is 1, `b` where it is 0.
pub fn either(condition: &Scalar, a: Scalar, b: Scalar) -> Scalar {
    let difference = less(a, b.clone());
    all([b, product([condition.clone(), difference])])
}
