//! Equations that contacts solve by iteration: a bounded number of steps, written out (section 16.13 of docs/theory.md).
//!
//! What an iteration finds is frozen: derivatives take no notice of it. From it two of Newton's steps follow that are
//! differentiated; they change nothing but rounding, and have the first three derivatives of the solution.

use super::algebra::*;
use super::shared::Shared;
use crate::arithmetic::Function;
use crate::model::mechanism::Scalar;

/// How many of Newton's steps are differentiated.
const DIFFERENTIATED: usize = 2;

/// Steps from a start, of which derivatives take no notice, and then Newton's, of which they do. Numbers are given to
/// all that use them.
pub fn solved<const N: usize>(
    start: [Scalar; N],
    steps: usize,
    mut step: impl FnMut([Scalar; N], &mut Shared<'_>) -> [Scalar; N],
    mut newton: impl FnMut([Scalar; N], &mut Shared<'_>) -> [Scalar; N],
    what: &str,
    shared: &mut Shared<'_>,
) -> [Scalar; N] {
    let mut found = start.map(|start| shared.scalar(frozen(start), what));
    for _ in 0..steps {
        found = step(found, shared).map(|next| shared.scalar(frozen(next), what));
    }
    for _ in 0..DIFFERENTIATED {
        found = newton(found, shared).map(|next| shared.scalar(next, what));
    }
    found
}

/// The value, of which derivatives take no notice.
fn frozen(value: Scalar) -> Scalar {
    Scalar::Call(Function::Frozen, vec![value])
}

/// `a` where a condition is 1, `b` where it is 0.
pub fn either(condition: &Scalar, a: Scalar, b: Scalar) -> Scalar {
    let difference = less(a, b.clone());
    all([b, product([condition.clone(), difference])])
}
