//! The symmetric part of a matrix.

use nalgebra::Matrix3;

/// The mean of a matrix and its transpose, entry by entry: the optimiser of rustc 1.95 compiles the sum of the
/// two matrices wrongly, so that (0, 1) and (1, 0) become half of (1, 1).
pub fn symmetric(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::from_fn(|i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]))
}
