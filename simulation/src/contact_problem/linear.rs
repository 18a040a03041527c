//! Gaussian elimination with complete pivoting, which reveals the rank.
//!
//! Theory: docs/theory.md, section 17.10.

use std::ops::{Deref, DerefMut};

use nalgebra::DMatrix;

/// Systems with at most this many unknowns are stored on the stack: four contacts that stick.
pub(super) const FEW: usize = 12;
/// Pivots up to this times the first one count as zero, in units in which W_ii of each contact has the trace
/// one.
pub(super) const SINGULAR: f64 = 1e-9;

/// Numbers on the stack, or on the heap if there are many.
#[derive(Clone)]
pub(super) enum Numbers<const MOST: usize> {
    Few([f64; MOST], usize),
    Many(Vec<f64>),
}

/// A vector, and a square matrix by columns.
pub(super) type Vector = Numbers<FEW>;
pub(super) type Square = Numbers<{ FEW * FEW }>;

impl<const MOST: usize> Numbers<MOST> {
    pub fn zeros(count: usize) -> Self {
        if count <= MOST { Self::Few([0.0; MOST], count) } else { Self::Many(vec![0.0; count]) }
    }
}

impl<const MOST: usize> Deref for Numbers<MOST> {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        match self {
            Self::Few(numbers, count) => &numbers[..*count],
            Self::Many(numbers) => numbers,
        }
    }
}

impl<const MOST: usize> DerefMut for Numbers<MOST> {
    fn deref_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Few(numbers, count) => &mut numbers[..*count],
            Self::Many(numbers) => numbers,
        }
    }
}

/// The vector of these components.
pub(super) fn vector(count: usize, component: impl Fn(usize) -> f64) -> Vector {
    let mut vector = Vector::zeros(count);
    vector.iter_mut().enumerate().for_each(|(i, value)| *value = component(i));
    vector
}

/// right - A x.
pub(super) fn residual(matrix: &Square, x: &Vector, right: &Vector) -> Vector {
    let mut left = right.clone();
    for (column, x) in matrix.chunks_exact(right.len().max(1)).zip(x.iter()) {
        for (left, entry) in left.iter_mut().zip(column) {
            *left -= entry * x;
        }
    }
    left
}

/// P A Q = L U up to the rank.
pub(super) struct Elimination {
    lu: Square,
    /// row and column at each place after pivoting
    rows: Vector,
    columns: Vector,
    n: usize,
    pub rank: usize,
    /// whether the determinant of P Q is positive
    even: bool,
}

impl Elimination {
    /// Eliminates a matrix given by columns; pivots up to `singular` times the first one count as zero.
    pub fn new(mut lu: Square, n: usize, singular: f64) -> Self {
        let (mut rows, mut columns) = (vector(n, |i| i as f64), vector(n, |i| i as f64));
        let (mut rank, mut even) = (0, true);
        let mut first = 0.0;
        while rank < n {
            let (mut greatest, mut place) = (0.0, (rank, rank));
            for column in rank..n {
                for (row, entry) in lu[column * n..][..n].iter().enumerate().skip(rank) {
                    if entry.abs() > greatest {
                        (greatest, place) = (entry.abs(), (row, column));
                    }
                }
            }
            if rank == 0 {
                first = greatest;
            }
            if greatest <= singular * first {
                break;
            }
            if place.0 != rank {
                for column in 0..n {
                    lu.swap(column * n + rank, column * n + place.0);
                }
                rows.swap(rank, place.0);
                even = !even;
            }
            if place.1 != rank {
                for row in 0..n {
                    lu.swap(rank * n + row, place.1 * n + row);
                }
                columns.swap(rank, place.1);
                even = !even;
            }
            let (left, right) = lu.split_at_mut((rank + 1) * n);
            let left = &mut left[rank * n..];
            let inverse = 1.0 / left[rank];
            left[rank + 1..].iter_mut().for_each(|entry| *entry *= inverse);
            for column in right.chunks_exact_mut(n) {
                let factor = column[rank];
                if factor != 0.0 {
                    for (entry, left) in column[rank + 1..].iter_mut().zip(&left[rank + 1..]) {
                        *entry -= left * factor;
                    }
                }
            }
            rank += 1;
        }
        Self { lu, rows, columns, n, rank, even }
    }

    /// The pivots up to the rank; their product is the determinant of P A Q.
    pub fn pivots(&self) -> impl Iterator<Item = f64> {
        (0..self.rank).map(|i| self.entry(i, i))
    }

    /// The sign of the determinant of P Q.
    pub fn parity(&self) -> f64 {
        if self.even { 1.0 } else { -1.0 }
    }

    /// The sign of the determinant of A, of full rank.
    pub fn sign(&self) -> f64 {
        self.pivots().fold(self.parity(), |sign, pivot| sign * pivot.signum())
    }

    fn entry(&self, row: usize, column: usize) -> f64 {
        self.lu[column * self.n + row]
    }

    /// A solution x of the first equations up to the rank, with as many zeros as possible.
    pub fn solve(&self, right: &[f64]) -> Vector {
        let r = self.rank;
        let mut y = vector(r, |i| right[self.rows[i] as usize]);
        for j in 0..r {
            let known = y[j];
            for i in j + 1..r {
                y[i] -= self.entry(i, j) * known;
            }
        }
        self.back(&mut y);
        let mut x = Vector::zeros(right.len());
        for (y, &column) in y.iter().zip(self.columns.iter()) {
            x[column as usize] = *y;
        }
        x
    }

    /// U^-1 applied to the first entries up to the rank.
    fn back(&self, y: &mut [f64]) {
        for j in (0..self.rank).rev() {
            y[j] /= self.entry(j, j);
            let known = y[j];
            for (i, y) in y.iter_mut().enumerate().take(j) {
                *y -= self.entry(i, j) * known;
            }
        }
    }

    /// An orthonormal basis of the null space of A, by columns.
    pub fn null_space(&self) -> DMatrix<f64> {
        let (n, r) = (self.n, self.rank);
        let mut basis = DMatrix::zeros(n, n - r);
        for free in r..n {
            let mut y = vector(r, |i| -self.entry(i, free));
            self.back(&mut y);
            for (y, &column) in y.iter().zip(self.columns.iter()) {
                basis[(column as usize, free - r)] = *y;
            }
            basis[(self.columns[free] as usize, free - r)] = 1.0;
        }
        orthonormal(&mut basis);
        basis
    }
}

/// The Gram-Schmidt method, applied twice.
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
