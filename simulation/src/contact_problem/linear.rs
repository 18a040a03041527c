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
    pub fn new(lu: Square, n: usize, singular: f64) -> Self {
        let (rows, columns) = (vector(n, |i| i as f64), vector(n, |i| i as f64));
        let mut elimination = Self { lu, rows, columns, n, rank: 0, even: true };
        // The loops of the sizes that two contacts have are written out by the compiler.
        match n {
            2 => elimination.eliminate(2, singular),
            3 => elimination.eliminate(3, singular),
            4 => elimination.eliminate(4, singular),
            6 => elimination.eliminate(6, singular),
            _ => elimination.eliminate(n, singular),
        }
        elimination
    }

    #[inline(always)]
    fn eliminate(&mut self, n: usize, singular: f64) {
        let (lu, rows, columns) = (&mut self.lu[..n * n], &mut self.rows[..n], &mut self.columns[..n]);
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
        (self.rank, self.even) = (rank, even);
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
        match self.rank {
            2 if self.n == 2 => self.solved(2, 2, right),
            3 if self.n == 3 => self.solved(3, 3, right),
            4 if self.n == 4 => self.solved(4, 4, right),
            6 if self.n == 6 => self.solved(6, 6, right),
            rank => self.solved(self.n, rank, right),
        }
    }

    #[inline(always)]
    fn solved(&self, n: usize, rank: usize, right: &[f64]) -> Vector {
        let (lu, right) = (&self.lu[..n * n], &right[..n]);
        let mut numbers = vector(n, |i| right[self.rows[i] as usize]);
        let y = &mut numbers[..rank];
        for j in 0..rank {
            let known = y[j];
            for (y, entry) in y.iter_mut().zip(&lu[j * n..][..n]).skip(j + 1) {
                *y -= entry * known;
            }
        }
        back(lu, n, y);
        let mut x = Vector::zeros(n);
        for (y, &column) in y.iter().zip(self.columns.iter()) {
            x[column as usize] = *y;
        }
        x
    }

    /// An orthonormal basis of the null space of A, by columns.
    pub fn null_space(&self) -> DMatrix<f64> {
        let (n, r) = (self.n, self.rank);
        let mut basis = DMatrix::zeros(n, n - r);
        for free in r..n {
            let mut y = vector(r, |i| -self.entry(i, free));
            back(&self.lu, n, &mut y);
            for (y, &column) in y.iter().zip(self.columns.iter()) {
                basis[(column as usize, free - r)] = *y;
            }
            basis[(self.columns[free] as usize, free - r)] = 1.0;
        }
        orthonormal(&mut basis);
        basis
    }
}

/// U^-1 applied to as many numbers as the rank.
#[inline(always)]
fn back(lu: &[f64], n: usize, y: &mut [f64]) {
    for j in (0..y.len()).rev() {
        let column = &lu[j * n..][..=j];
        y[j] /= column[j];
        let known = y[j];
        for (y, entry) in y[..j].iter_mut().zip(column) {
            *y -= entry * known;
        }
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
