//! Matrices of expressions in quadratic forms, with rows and columns along different axes.

use crate::algebra::Expr;
use crate::kinematics::Kinematics;
use crate::kinematics::axes::{AxesId, ENTRIES, Symmetric, entry};
use crate::kinematics::linear_forms::{self, Triple};

/// Rows along the home axes of the first of two velocities, columns along those of the second.
pub type Matrix = [Triple; 3];

/// A column.
pub fn column(m: &Matrix, j: usize) -> Triple {
    std::array::from_fn(|i| m[i][j].clone())
}

/// The transposed matrix.
pub fn transposed(m: &Matrix) -> Matrix {
    std::array::from_fn(|i| column(m, i))
}

/// The rows along other axes.
pub fn turn_rows(k: &mut Kinematics<'_>, m: &Matrix, from: AxesId, to: AxesId) -> Matrix {
    if from == to {
        return m.clone();
    }
    let columns: Matrix = std::array::from_fn(|j| k.tree.convert(&mut k.z, &column(m, j), from, to));
    transposed(&columns)
}

/// `m v`.
pub fn times(m: &Matrix, v: &Triple) -> Triple {
    std::array::from_fn(|i| linear_forms::dot(&m[i], v))
}

/// `-[r]x`: the matrix that takes w to w x r.
pub fn arm_matrix(r: &Triple) -> Matrix {
    let [x, y, z] = r;
    [
        [Expr::zero(), z.clone(), y.neg()],
        [z.neg(), Expr::zero(), x.clone()],
        [y.clone(), x.neg(), Expr::zero()],
    ]
}

/// All nine entries of a symmetric matrix.
pub fn full(m: &Symmetric) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| m[entry(i, j)].clone()))
}

/// `m + m'`.
pub fn both_halves(m: &Matrix) -> Symmetric {
    ENTRIES.map(|(i, j)| m[i][j].add(&m[j][i]))
}

/// Gives every entry a name.
pub fn name_matrix(k: &mut Kinematics<'_>, m: Matrix) -> Matrix {
    m.map(|row| linear_forms::name(&mut k.z, row))
}
