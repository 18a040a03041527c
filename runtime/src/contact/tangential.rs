//! A closed contact in units where m_nn = 1 and the greatest component of the free acceleration is one, and
//! its tangential equations T x = rhs.
//!
//! Theory: docs/theory.md, section 17.

use nalgebra::{Vector2, Vector3};

use crate::{
    ReducedMatrix,
    scalar::{Real, constant, larger, length},
    tangential_block::TangentialBlock,
};

/// M and beta in these units; the tangential part of M is T, its coupling to the normal b.
#[derive(Clone, Copy)]
pub(super) struct Closed<T: Real> {
    pub mu: T,
    pub b: Vector2<T>,
    pub block: TangentialBlock<T>,
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
            block: TangentialBlock { tt: m.tt / m.nn, ts: m.ts / m.nn, ss: m.ss / m.nn },
            normal: beta.x / unit,
            tangential: Vector2::new(beta.y / unit, beta.z / unit),
            force: unit / m.nn,
        }
    }

    /// f (31) over m_nn.
    #[inline]
    pub fn f(&self, d: &Vector2<T>) -> T {
        T::one() - self.mu * self.b.dot(d)
    }

    /// Whether at most one mode fits without slip where f > 0 in all directions: A = T - beta_tan b^T /
    /// beta_n has a positive definite symmetric part (theory, 17.3).
    pub fn one_mode(&self) -> bool {
        if self.normal >= T::zero() {
            return false;
        }
        let pull = self.tangential / self.normal;
        let tt = self.block.tt - pull.x * self.b.x;
        let ss = self.block.ss - pull.y * self.b.y;
        let ts = self.block.ts - (pull.x * self.b.y + pull.y * self.b.x) * constant(0.5);
        let size = self.block.tt + self.block.ss + length(&pull) * length(&self.b);
        let noise = constant::<T>(64.0) * T::default_epsilon() * size;
        tt > noise && ss > noise && tt * ss - ts * ts > noise * size
    }

    /// The rounding error of f.
    #[inline]
    pub fn f_noise(&self) -> T {
        constant::<T>(8.0) * T::default_epsilon() * (T::one() + self.mu * length(&self.b))
    }

    /// The least-squares solution x of T x = rhs of least norm; a second pivot within rounding of zero counts
    /// as zero.
    pub fn hold(&self, rhs: &Vector2<T>) -> Held<T> {
        match self.block.eliminate(rhs) {
            // b^2 <= m_nn T, so where T underflows b counts as zero too.
            None => Held { x: Vector2::zeros(), left: length(rhs) },
            Some(elimination) if elimination.is_singular() => {
                Held { x: elimination.least_squares(), left: elimination.residual() }
            }
            Some(elimination) => Held { x: elimination.solution(elimination.pivot), left: T::zero() },
        }
    }

    /// Rate of v_n per normal force while the tangential force -hold per normal force keeps the contact from
    /// slipping.
    pub fn held_rate(&self, hold: &Vector2<T>) -> T {
        self.block.held_rate(&self.b, hold)
    }
}
