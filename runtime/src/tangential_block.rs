//! The tangential block T of a reduced matrix in units where m_nn = 1: a symmetric positive semidefinite 2x2
//! matrix, which rounding and contacts that cannot move in some direction make singular.
//!
//! Theory: docs/theory.md, section 10.

use nalgebra::Vector2;

use crate::scalar::{Real, constant, dot, fma};

/// A pivot at most this often the machine epsilon of the larger one is lost to rounding.
const LOST_PIVOT: f64 = 64.0;

/// A rate of v_n at most this often the rounding of its terms counts as zero.
const LOST_RATE: f64 = 32.0;

/// The symmetric matrix ((tt, ts), (ts, ss)).
#[derive(Clone, Copy)]
pub(crate) struct TangentialBlock<T: Real> {
    pub tt: T,
    pub ts: T,
    pub ss: T,
}

/// T x = rhs after elimination from the larger pivot p: x = (first / p - l y, y) with pivot y = left, in the
/// order of the pivots.
pub(crate) struct Elimination<T: Real> {
    swapped: bool,
    /// the larger pivot
    pub p: T,
    l: T,
    /// the right side
    first: T,
    second: T,
    /// the smaller pivot
    pub pivot: T,
    /// what elimination leaves of the right side
    pub left: T,
}

impl<T: Real> TangentialBlock<T> {
    /// T x.
    #[inline]
    pub fn times(&self, x: &Vector2<T>) -> Vector2<T> {
        Vector2::new(dot(self.tt, x.x, self.ts, x.y), dot(self.ts, x.x, self.ss, x.y))
    }

    /// Eliminates T x = rhs; `None` where T has no positive pivot.
    #[inline]
    pub fn eliminate(&self, rhs: &Vector2<T>) -> Option<Elimination<T>> {
        let swapped = self.ss > self.tt;
        let (p, q, first, second) =
            if swapped { (self.ss, self.tt, rhs.y, rhs.x) } else { (self.tt, self.ss, rhs.x, rhs.y) };
        if p <= T::zero() {
            return None;
        }
        let l = self.ts / p;
        let (pivot, left) = (q - l * self.ts, second - l * first);
        Some(Elimination { swapped, p, l, first, second, pivot, left })
    }

    /// dv_n / dI_n of a contact with the coupling b = (m_nt, m_ns) while the tangential impulse -`hold` per
    /// I_n keeps it from slipping; zero where it cannot move along n without slip.
    ///
    /// The formula is such that an error of `hold` enters by its square. What remains is the rounding of the
    /// matrix entries, which counts much where `hold` is large. A rate below that error is taken for
    /// zero; it would depend on the choice of axes.
    #[inline]
    pub fn held_rate(&self, b: &Vector2<T>, hold: &Vector2<T>) -> T {
        let left = b + b - self.times(hold);
        let rate = T::one() - dot(left.x, hold.x, left.y, hold.y);
        let known = fma(self.tt + self.ss, dot(hold.x, hold.x, hold.y, hold.y), T::one());
        if rate <= constant::<T>(LOST_RATE) * T::default_epsilon() * known { T::zero() } else { rate }
    }
}

impl<T: Real> Elimination<T> {
    /// Whether the smaller pivot is lost to rounding.
    #[inline]
    pub fn is_singular(&self) -> bool {
        let is_regular = self.pivot > constant::<T>(LOST_PIVOT) * T::default_epsilon() * self.p;
        !is_regular
    }

    /// The solution where the smaller pivot has this value.
    #[inline]
    pub fn solution(&self, pivot: T) -> Vector2<T> {
        let y = self.left / pivot;
        self.in_order(self.first / self.p - self.l * y, y)
    }

    /// The least x with T x as near to the right side as possible, where the smaller pivot counts as zero.
    #[inline]
    pub fn least_squares(&self) -> Vector2<T> {
        let square = T::one() + self.l * self.l;
        let scale = (self.first + self.l * self.second) / (self.p * square * square);
        self.in_order(scale, self.l * scale)
    }

    /// The length of the part of the right side that T does not reach, where the smaller pivot counts as
    /// zero.
    #[inline]
    pub fn residual(&self) -> T {
        self.left.abs() / (T::one() + self.l * self.l).sqrt()
    }

    #[inline]
    fn in_order(&self, first: T, second: T) -> Vector2<T> {
        if self.swapped { Vector2::new(second, first) } else { Vector2::new(first, second) }
    }
}
