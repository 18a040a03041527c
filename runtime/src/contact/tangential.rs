//! A closed contact in units where m_nn = 1 and the greatest component of the free acceleration is one, and its tangential equations T x = rhs.
//!
//! Theory: docs/theory.md, section 17.

use nalgebra::{Vector2, Vector3};

use crate::{
    ReducedMatrix,
    scalar::{Real, constant, larger, length},
};

/// M and beta in these units; the tangential part of M is T, its coupling to the normal b.
#[derive(Clone, Copy)]
pub(super) struct Closed<T: Real> {
    pub mu: T,
    pub b: Vector2<T>,
    pub tt: T,
    pub ts: T,
    pub ss: T,
    /// beta_n and the tangential part of beta
    pub normal: T,
    pub tangential: Vector2<T>,
    /// The unit of force, N.
    pub force: T,
}

/// A solution of T x = rhs in the sense of least squares.
pub(super) struct Held<T: Real> {
    pub x: Vector2<T>,
    /// The part of the right side outside the range of T.
    pub left: T,
}

impl<T: Real> Closed<T> {
    /// Scales a contact.
    pub fn new(m: &ReducedMatrix<T>, beta: &Vector3<T>, mu: T) -> Self {
        let size = larger(larger(beta.x.abs(), beta.y.abs()), beta.z.abs()).primal();
        let unit = if size > T::zero() { size } else { T::one() };
        Self {
            mu,
            b: Vector2::new(m.nt / m.nn, m.ns / m.nn),
            tt: m.tt / m.nn,
            ts: m.ts / m.nn,
            ss: m.ss / m.nn,
            normal: beta.x / unit,
            tangential: Vector2::new(beta.y / unit, beta.z / unit),
            force: unit / m.nn,
        }
    }

    /// T x.
    #[inline]
    pub fn pulled(&self, x: &Vector2<T>) -> Vector2<T> {
        Vector2::new(self.tt * x.x + self.ts * x.y, self.ts * x.x + self.ss * x.y)
    }

    /// f (31) over m_nn.
    #[inline]
    pub fn f(&self, d: &Vector2<T>) -> T {
        T::one() - self.mu * self.b.dot(d)
    }

    /// Whether at most one mode fits without slip where f > 0 in all directions: A = T - beta_tan b^T / beta_n has a positive definite
    /// symmetric part (theory, 17.3).
    pub fn one_mode(&self) -> bool {
        if self.normal >= T::zero() {
            return false;
        }
        let pull = self.tangential / self.normal;
        let tt = self.tt - pull.x * self.b.x;
        let ss = self.ss - pull.y * self.b.y;
        let ts = self.ts - (pull.x * self.b.y + pull.y * self.b.x) * constant(0.5);
        let size = self.tt + self.ss + length(&pull) * length(&self.b);
        let noise = constant::<T>(64.0) * T::default_epsilon() * size;
        tt > noise && ss > noise && tt * ss - ts * ts > noise * size
    }

    /// The rounding error of f.
    #[inline]
    pub fn f_noise(&self) -> T {
        constant::<T>(8.0) * T::default_epsilon() * (T::one() + self.mu * length(&self.b))
    }

    /// The least-squares solution x of T x = rhs of least norm, by elimination with the larger pivot first; a second pivot within rounding of zero counts as zero.
    pub fn hold(&self, rhs: &Vector2<T>) -> Held<T> {
        let swap = self.ss > self.tt;
        let (p, q, r) =
            if swap { (self.ss, self.tt, Vector2::new(rhs.y, rhs.x)) } else { (self.tt, self.ss, *rhs) };
        // b^2 <= m_nn T, so where T underflows b counts as zero too.
        if p <= T::zero() {
            return Held { x: Vector2::zeros(), left: length(rhs) };
        }
        let l = self.ts / p;
        let (pivot, left) = (q - l * self.ts, r.y - l * r.x);
        let square = T::one() + l * l;
        let (x, left) = if pivot > constant::<T>(64.0) * T::default_epsilon() * p {
            let y = left / pivot;
            (Vector2::new(r.x / p - l * y, y), T::zero())
        } else {
            let scale = (r.x + l * r.y) / (p * square * square);
            (Vector2::new(scale, l * scale), left.abs() / square.sqrt())
        };
        Held { x: if swap { Vector2::new(x.y, x.x) } else { x }, left }
    }

    /// Rate of v_n per normal force while the tangential force -hold per normal force keeps the contact from slipping; zero where it is below its rounding
    /// error.
    pub fn held_rate(&self, hold: &Vector2<T>) -> T {
        let rate = T::one() - (self.b + self.b - self.pulled(hold)).dot(hold);
        let known = T::one() + (self.tt + self.ss) * hold.dot(hold);
        if rate <= constant::<T>(32.0) * T::default_epsilon() * known { T::zero() } else { rate }
    }
}
