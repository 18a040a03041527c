//! Steps of Newton's method by Gaussian elimination with row pivots, on slices.

use nalgebra::Matrix3;

use super::scaled::Scaled;
use crate::Scalar;

/// Solves the linear systems of Newton's method.
pub trait NewtonSteps<T: Scalar> {
    /// Replaces `right` by the x with (A + B (W + alpha)) x = right, where A and B are made of the 3 x 3
    /// blocks of each contact and W is the scaled matrix. `false` where there is none.
    fn solve(
        &mut self,
        matrix: &Scaled<'_, T>,
        blocks: &dyn Fn(usize) -> (Matrix3<T>, Matrix3<T>),
        alpha: T,
        right: &mut [T],
    ) -> bool;
}

/// The elimination of a full matrix, in memory of the caller.
pub struct Dense<'a, T> {
    memory: &'a mut [T],
}

impl<'a, T> Dense<'a, T> {
    /// The elimination in memory of (3 k)^2 numbers; with less it solves nothing.
    #[inline]
    pub fn new(memory: &'a mut [T]) -> Self {
        Self { memory }
    }
}

impl<T: Scalar> NewtonSteps<T> for Dense<'_, T> {
    fn solve(
        &mut self,
        matrix: &Scaled<'_, T>,
        blocks: &dyn Fn(usize) -> (Matrix3<T>, Matrix3<T>),
        alpha: T,
        right: &mut [T],
    ) -> bool {
        let n = right.len();
        let Some(memory) = self.memory.get_mut(..n * n).filter(|memory| !memory.is_empty()) else {
            return false;
        };
        // By rows.
        for (i, rows) in memory.chunks_exact_mut(3 * n).enumerate() {
            let (a, b) = blocks(i);
            let inactive = b.iter().all(|entry| entry.is_zero());
            for j in 0..n / 3 {
                let mut block = if inactive { Matrix3::zeros() } else { b * matrix.block(i, j) };
                if i == j {
                    block += a + b * alpha;
                }
                for row in 0..3 {
                    for column in 0..3 {
                        if let Some(entry) = rows.get_mut(row * n + 3 * j + column) {
                            *entry = block[(row, column)];
                        }
                    }
                }
            }
        }
        eliminate(memory, right)
    }
}

/// Solves a full system; `matrix` is given by rows and destroyed.
pub(super) fn eliminate<T: Scalar>(matrix: &mut [T], right: &mut [T]) -> bool {
    let n = right.len();
    for step in 0..n {
        let mut best = (T::zero(), step);
        for row in step..n {
            let size = matrix[row * n + step].abs();
            if size > best.0 {
                best = (size, row);
            }
        }
        if best.0.is_zero() {
            return false;
        }
        if best.1 != step {
            for column in step..n {
                matrix.swap(step * n + column, best.1 * n + column);
            }
            right.swap(step, best.1);
        }
        let (above, below) = matrix.split_at_mut((step + 1) * n);
        let pivots = &above[step * n..];
        let inverse = T::one() / pivots[step];
        let solved = right[step];
        for (row, entries) in below.chunks_exact_mut(n).enumerate() {
            let factor = entries[step] * inverse;
            if factor.is_zero() {
                continue;
            }
            for (entry, pivot) in entries[step + 1..].iter_mut().zip(&pivots[step + 1..]) {
                *entry -= factor * *pivot;
            }
            right[step + 1 + row] -= factor * solved;
        }
    }
    for step in (0..n).rev() {
        let entries = &matrix[step * n..(step + 1) * n];
        let mut sum = right[step];
        for (entry, x) in entries[step + 1..].iter().zip(&right[step + 1..]) {
            sum -= *entry * *x;
        }
        right[step] = sum / entries[step];
    }
    right.iter().all(|x| x.is_finite())
}
