//! The problem in units in which the traces of the contacts' blocks and the greatest free acceleration are about
//! one.
//!
//! With forces lambda_i = c s_i x_i and accelerations a_i = c v_i / s_i, where s_i = tr(W_ii)^(-1/2) and c is
//! one number, the laws keep their form, since s_i is one number for the three components of a contact. All are
//! rounded to powers of two, so that units add no rounding errors.

use nalgebra::{Matrix3, Vector3};

use super::{SeveralContacts, law::Friction};
use crate::{
    Scalar,
    scalar::{constant, larger},
};

/// A problem in these units.
pub struct Scaled<'a, T: Scalar> {
    problem: &'a SeveralContacts<'a, T>,
    /// s_i of each contact
    pub(super) scale: &'a [T],
    /// W, by columns
    matrix: &'a [T],
    /// beta
    pub(super) beta: &'a [T],
    /// c
    pub(super) unit: T,
    /// All coefficients of friction are multiplied by it.
    pub(super) friction: T,
}

impl<'a, T: Scalar> Scaled<'a, T> {
    /// Scales a problem into memory of the caller: k numbers, (3 k)^2 and 3 k.
    pub(super) fn new(
        problem: &'a SeveralContacts<'a, T>,
        scale: &'a mut [T],
        matrix: &'a mut [T],
        beta: &'a mut [T],
    ) -> Self {
        let n = beta.len();
        for (i, scale) in scale.iter_mut().enumerate() {
            // A quarter of the trace: the sum of the greatest numbers is none.
            let (half, quarter) = (constant::<T>(0.5), constant::<T>(0.25));
            let mut trace = T::zero();
            for row in 3 * i..3 * i + 3 {
                trace += problem.matrix[row * n + row].abs() * quarter;
            }
            *scale = if trace > T::zero() { binary(half / trace.sqrt()) } else { T::one() };
        }
        let mut unit = T::zero();
        for (row, (scaled, beta)) in beta.iter_mut().zip(problem.beta).enumerate() {
            *scaled = *beta * scale[row / 3];
            unit = larger(unit, scaled.abs());
        }
        if unit > T::zero() {
            unit = binary(unit);
            beta.iter_mut().for_each(|beta| *beta /= unit);
        } else {
            unit = T::one();
        }
        let columns = matrix.chunks_exact_mut(n).zip(problem.matrix.chunks_exact(n));
        for (j, (scaled, column)) in columns.enumerate() {
            for (i, (scaled, entry)) in scaled.iter_mut().zip(column).enumerate() {
                *scaled = *entry * (scale[i / 3] * scale[j / 3]);
            }
        }
        Self { problem, scale, matrix, beta, unit, friction: T::one() }
    }

    /// The number of contacts.
    #[inline]
    pub fn contacts(&self) -> usize {
        self.scale.len()
    }

    /// The block of W that takes the force of contact `j` to the acceleration of contact `i`.
    #[inline]
    pub fn block(&self, i: usize, j: usize) -> Matrix3<T> {
        let n = self.beta.len();
        Matrix3::from_fn(|row, column| self.matrix[(3 * j + column) * n + 3 * i + row])
    }

    /// W, by columns.
    #[inline]
    pub fn matrix(&self) -> &[T] {
        self.matrix
    }

    #[inline]
    pub(super) fn law(&self, i: usize) -> Friction<T> {
        Friction { mu: self.problem.mu[i] * self.friction, slip: self.problem.slip[i] }
    }

    /// v = W x.
    pub fn apply(&self, x: &[T], v: &mut [T]) {
        v.iter_mut().for_each(|v| *v = T::zero());
        self.add(x, v);
    }

    /// v = W x + beta.
    pub(super) fn rates(&self, x: &[T], v: &mut [T]) {
        v.copy_from_slice(self.beta);
        self.add(x, v);
    }

    fn add(&self, x: &[T], v: &mut [T]) {
        for (x, column) in x.iter().zip(self.matrix.chunks_exact(self.beta.len())) {
            if !x.is_zero() {
                for (v, entry) in v.iter_mut().zip(column) {
                    *v += *entry * *x;
                }
            }
        }
    }

    /// The greatest component of forces.
    pub(super) fn size(&self, x: &[T]) -> T {
        x.iter().fold(T::zero(), |most, x| larger(most, x.abs()))
    }

    /// The sums of the sizes of the terms of v.
    pub(super) fn terms(&self, x: &[T], terms: &mut [T]) {
        for (terms, beta) in terms.iter_mut().zip(self.beta) {
            *terms = beta.abs();
        }
        for (x, column) in x.iter().zip(self.matrix.chunks_exact(self.beta.len())) {
            if !x.is_zero() {
                for (terms, entry) in terms.iter_mut().zip(column) {
                    *terms += (*entry * *x).abs();
                }
            }
        }
    }
}

/// The greatest power of two that is not above a positive number.
fn binary<T: Scalar>(number: T) -> T {
    let (two, half) = (constant::<T>(2.0), constant::<T>(0.5));
    let mut power = T::one();
    for _ in 0..EXPONENTS {
        if power > number {
            power *= half;
        } else if power * two <= number {
            power *= two;
        } else {
            break;
        }
    }
    if power.is_zero() { number } else { power }
}

/// More than the exponents of doubles.
const EXPONENTS: usize = 1100;

/// Three components of contact `i`.
#[inline]
pub(super) fn three<T: Scalar>(values: &[T], i: usize) -> Vector3<T> {
    Vector3::from_column_slice(&values[3 * i..3 * i + 3])
}
