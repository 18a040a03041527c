//! Gaussian elimination with pivots from the whole matrix, which shows the rank.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector};

/// P A Q = L U up to the rank.
pub(super) struct Elimination {
    lu: DMatrix<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
    pub rank: usize,
}

impl Elimination {
    /// Pivots up to `singular` times the first one count as zero.
    pub fn new(mut lu: DMatrix<f64>, singular: f64) -> Self {
        let n = lu.nrows();
        let (mut rows, mut columns): (Vec<usize>, Vec<usize>) = ((0..n).collect(), (0..n).collect());
        let mut rank = 0;
        let mut first = 0.0;
        while rank < n {
            let (mut greatest, mut place) = (0.0, (rank, rank));
            for column in rank..n {
                for row in rank..n {
                    let size = lu[(row, column)].abs();
                    if size > greatest {
                        (greatest, place) = (size, (row, column));
                    }
                }
            }
            if rank == 0 {
                first = greatest;
            }
            if greatest <= singular * first {
                break;
            }
            lu.swap_rows(rank, place.0);
            rows.swap(rank, place.0);
            lu.swap_columns(rank, place.1);
            columns.swap(rank, place.1);
            let inverse = 1.0 / lu[(rank, rank)];
            for row in rank + 1..n {
                lu[(row, rank)] *= inverse;
            }
            let (left, mut right) = lu.columns_range_pair_mut(rank, rank + 1..);
            for mut column in right.column_iter_mut() {
                let factor = column[rank];
                if factor != 0.0 {
                    for row in rank + 1..n {
                        column[row] -= left[row] * factor;
                    }
                }
            }
            rank += 1;
        }
        Self { lu, rows, columns, rank }
    }

    /// The x with as many zeros as the rank leaves that solves the first equations, as many as the rank.
    pub fn solve(&self, right: &DVector<f64>) -> DVector<f64> {
        let r = self.rank;
        let mut y: Vec<f64> = (0..r).map(|i| right[self.rows[i]]).collect();
        for j in 0..r {
            for i in j + 1..r {
                y[i] -= self.lu[(i, j)] * y[j];
            }
        }
        self.back(&mut y);
        let mut x = DVector::zeros(right.len());
        for (y, &column) in y.iter().zip(&self.columns) {
            x[column] = *y;
        }
        x
    }

    /// U^-1 on the first entries, as many as the rank.
    fn back(&self, y: &mut [f64]) {
        for j in (0..self.rank).rev() {
            y[j] /= self.lu[(j, j)];
            for i in 0..j {
                y[i] -= self.lu[(i, j)] * y[j];
            }
        }
    }

    /// An orthonormal basis of the x with A x = 0, in columns.
    pub fn null_space(&self) -> DMatrix<f64> {
        let (n, r) = (self.lu.nrows(), self.rank);
        let mut basis = DMatrix::zeros(n, n - r);
        for free in r..n {
            let mut y: Vec<f64> = (0..r).map(|i| -self.lu[(i, free)]).collect();
            self.back(&mut y);
            for (y, &column) in y.iter().zip(&self.columns) {
                basis[(column, free - r)] = *y;
            }
            basis[(self.columns[free], free - r)] = 1.0;
        }
        orthonormal(&mut basis);
        basis
    }
}

/// Gram and Schmidt's method, twice.
fn orthonormal(basis: &mut DMatrix<f64>) {
    for j in 0..basis.ncols() {
        for _ in 0..2 {
            for i in 0..j {
                let (before, mut column) = basis.columns_range_pair_mut(i, j);
                let along = before.dot(&column);
                column.axpy(-along, &before, 1.0);
            }
            let length = basis.column(j).norm();
            if length > 0.0 {
                basis.column_mut(j).scale_mut(1.0 / length);
            }
        }
    }
}
