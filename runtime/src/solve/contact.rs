//! A contact in the units of the solver: reduced matrix and coefficient of friction, and the rates f, g and h
//! of (31)-(33) formed from them.
//!
//! Theory: docs/theory.md, section 2.

use nalgebra::Vector2;

use crate::{
    ReducedMatrix,
    scalar::{Arithmetic, Mask, Real, constant, dot, fma, larger, smaller},
};

/// The reduced matrix and mu, in units where m_nn = 1: b = (m_nt, m_ns) and the tangential block T.
#[derive(Clone, Copy)]
pub(crate) struct Contact<T: Arithmetic> {
    /// m_nn: one, except in the units of [`super::range`].
    pub nn: T,
    pub mu: T,
    pub b: Vector2<T>,
    pub tt: T,
    pub ts: T,
    pub ss: T,
    /// mu b and mu T, by which friction changes v_n and v_tan.
    pub mu_b: Vector2<T>,
    pub mu_tt: T,
    pub mu_ts: T,
    pub mu_ss: T,
}

impl<T: Arithmetic> Contact<T> {
    #[inline(always)]
    pub fn new(matrix: &ReducedMatrix<T>, mu: T) -> Self {
        // Quotients, not products with 1 / m_nn: that may overflow where the quotients do not.
        let nn = matrix.nn;
        let b = Vector2::new(matrix.nt / nn, matrix.ns / nn);
        Self::of([b.x, b.y, matrix.tt / nn, matrix.ts / nn, matrix.ss / nn], mu)
    }

    /// From m_nt, m_ns, m_tt, m_ts and m_ss in units where m_nn = 1.
    #[inline(always)]
    pub fn of([nt, ns, tt, ts, ss]: [T; 5], mu: T) -> Self {
        let b = Vector2::new(nt, ns);
        Self { nn: T::one(), mu, b, tt, ts, ss, mu_b: b * mu, mu_tt: mu * tt, mu_ts: mu * ts, mu_ss: mu * ss }
    }

    /// b - mu T d: the rate of the tangential velocity by I_n while slip has the direction d.
    #[inline(always)]
    pub fn slip_rate(&self, d: &Vector2<T>) -> Vector2<T> {
        Vector2::new(
            self.b.x - dot(self.mu_tt, d.x, self.mu_ts, d.y),
            self.b.y - dot(self.mu_ts, d.x, self.mu_ss, d.y),
        )
    }

    /// f (31): the rate of v_n by I_n.
    #[inline(always)]
    pub fn normal_rate(&self, d: &Vector2<T>) -> T {
        self.nn - dot(self.mu_b.x, d.x, self.mu_b.y, d.y)
    }

    /// f, g and h (31)-(33).
    #[inline(always)]
    pub fn rates(&self, d: &Vector2<T>) -> [T; 3] {
        let rate = self.slip_rate(d);
        [self.normal_rate(d), dot(rate.x, d.x, rate.y, d.y), dot(rate.y, d.x, -rate.x, d.y)]
    }

    /// g + h' = -mu d'.T d' (theory, 2.8), where d' is d turned by a right angle and h' the derivative of h
    /// with respect to phi.
    #[inline(always)]
    pub fn convergence(&self, d: &Vector2<T>) -> T {
        let twice = self.mu_ts + self.mu_ts;
        -dot(fma(self.mu_tt, d.y, -twice * d.x), d.y, self.mu_ss * d.x, d.x)
    }

    /// mu T x.
    #[inline(always)]
    pub fn dragged(&self, x: &Vector2<T>) -> Vector2<T> {
        Vector2::new(dot(self.mu_tt, x.x, self.mu_ts, x.y), dot(self.mu_ts, x.x, self.mu_ss, x.y))
    }

    /// The sum of the sizes of the terms of f. f has an error of about this times the rounding unit.
    #[inline(always)]
    pub fn normal_size(&self) -> T {
        self.nn + self.mu_b.x.abs() + self.mu_b.y.abs()
    }

    /// The sum of the sizes of the terms of g and h, likewise.
    #[inline(always)]
    pub fn slip_size(&self) -> T {
        self.b.x.abs() + self.b.y.abs() + self.mu_tt + self.mu_ss
    }

    /// Whether sixth powers of the rates stay within the range of the number type.
    #[inline(always)]
    pub fn is_ordinary(&self) -> T::Mask {
        // The compiler evaluates this.
        let most = if single::<T>() { WIDE.0 } else { WIDE.1 };
        let least = 1.0 / most;
        let size = self.slip_size();
        let slow = || constant::<T>(least).below(size);
        size.below(constant(most)).and(slow).and(|| self.normal_size().below(constant(most)))
    }

    /// Whether products with this mu cannot overflow.
    #[inline(always)]
    pub fn is_moderate(mu: T) -> T::Mask {
        mu.at_most(constant(if single::<T>() { WIDE.0 } else { WIDE.1 }))
    }
}

impl<T: Real> Contact<T> {
    /// The contact to calculate with, and its mu over the true mu. The quotient is below one where products
    /// of the true mu would overflow and a smaller mu is used.
    ///
    /// Friction of that size stops slip, or ends the collision, after an I_n of the order of 1/mu, during
    /// which nothing but friction counts. A smaller mu gives the same arc with a larger I_n
    /// (docs/theory.md, section 1.2).
    #[inline(always)]
    pub fn limited(matrix: &ReducedMatrix<T>, mu: T) -> (Self, T) {
        let mut used = mu;
        if !Self::is_moderate(mu) {
            used = Self::most_friction(matrix, mu);
        }
        (Self::new(matrix, used), if used < mu { used / mu } else { T::one() })
    }

    #[cold]
    #[inline(never)]
    fn most_friction(matrix: &ReducedMatrix<T>, mu: T) -> T {
        let most = constant::<T>(if single::<T>() { MOST.0 } else { MOST.1 });
        let Self { b, tt, ss, .. } = Self::new(matrix, T::one());
        let size = larger(larger(b.x.abs(), b.y.abs()), larger(tt, ss));
        // The divisor is kept so large that the quotient does not overflow.
        smaller(mu, most / larger(size, T::one() / most))
    }

    /// Whether an impulse moves the contact across this direction by more than so many roundings of the
    /// largest diagonal entry. If not, slip along it cannot turn, whatever h' is: so it is in planar systems
    /// (Appendix C of the paper).
    #[cold]
    #[inline(never)]
    pub fn moves_across(&self, d: &Vector2<T>, roundings: f64) -> bool {
        let noise =
            constant::<T>(roundings) * T::default_epsilon() * larger(larger(self.nn, self.tt), self.ss);
        let coupled = dot(self.b.y, d.x, -self.b.x, d.y);
        let along = dot(self.ts, d.x, -self.tt, d.y);
        let across = dot(self.ss, d.x, -self.ts, d.y);
        coupled.abs() > noise || along.abs() > noise || across.abs() > noise
    }

    /// The size of v_n that is taken for zero where slip stops at this normal impulse: some roundings of its
    /// terms.
    #[inline(always)]
    pub fn together(&self, normal: T) -> T {
        constant::<T>(8.0) * T::default_epsilon() * fma(normal, self.normal_size(), T::one())
    }

    /// Whether slip is no more than some roundings of the terms that have brought it down to this at this
    /// normal impulse.
    #[inline(always)]
    pub fn slip_is_rounding(&self, slip: T, normal: T) -> bool {
        slip <= constant::<T>(32.0) * T::default_epsilon() * fma(normal, self.slip_size(), T::one())
    }
}

/// Whether numbers are of single precision.
#[inline(always)]
fn single<T: Arithmetic>() -> bool {
    constant::<T>(1e-10).below(T::default_epsilon()).any()
}

/// The largest ordinary rate, in single and in double precision: 2^20 and 2^160.
const WIDE: (f64, f64) = (1_048_576.0, 1_461_501_637_330_902_918_203_684_832_716_283_019_655_932_542_976.0);

/// The largest product of mu and an entry that is calculated with, in single and in double precision: its
/// square does not overflow.
const MOST: (f64, f64) = (1e18, 1e150);
