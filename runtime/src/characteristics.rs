//! Characteristic quantities of a contact (section 3 of the paper): mu_c, phi_c, mu_s, the rates while
//! sticking, and renewed sliding.
//!
//! Theory: docs/theory.md, section 12.

use nalgebra::{Vector2, Vector3};

use crate::{ReducedMatrix, Scalar, solve::Contact};

/// The paper's mu_c, phi_c, mu_s, c_n, c_t, c_s, phi_hat, f_hat and g_hat, for one contact and one
/// coefficient of friction.
///
/// They depend on the reduced matrix and mu, not on the velocity of approach. Angles are in radians from t
/// towards s.
///
/// | quantity | equation |
/// | --- | --- |
/// | c_n | (m_tt m_ss - m_ts^2) / det M (41a) |
/// | c_t | (m_ns m_ts - m_nt m_ss) / det M (41b) |
/// | c_s | (m_nt m_ts - m_ns m_tt) / det M (41c); M (c_n, c_t, c_s) = (1, 0, 0) (41d) |
/// | mu_c | sqrt(c_t^2 + c_s^2) / c_n (43) |
/// | phi_c | atan2(-c_s, -c_t) (43) |
/// | mu_s | m_ns / m_ts (end of section 3.3) |
/// | phi_hat | h(mu, phi_hat) = 0 and g(mu, phi_hat) > 0 (section 3.3) |
/// | f_hat, g_hat | f(mu, phi_hat) (31), g(mu, phi_hat) (32) |
///
/// [`phi_bar`](crate::phi_bar) is the direction in which slip stops (section 3.2). What happens at the end of
/// compression and where slip stops, I_nC, E_nC, I_nS, v_nS and E_nS, depends on the approach:
/// [`Phases`](crate::Phases).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Characteristics<T> {
    /// The critical coefficient of friction (43): the least with which the contact sticks after slip has
    /// stopped. Where the tangential part of the matrix is singular its pseudo-inverse is used.
    pub mu_c: T,
    /// The direction phi_c (43): while the contact sticks, friction acts in the opposite direction. Zero if
    /// mu_c is zero.
    pub phi_c: T,
    /// m_ns / m_ts, the friction at which slip along t stays along t; `None` if m_ts is zero.
    pub mu_s: Option<T>,
    /// c_n, c_t and c_s (41): dI_n / dv_n, dI_t / dv_n and dI_s / dv_n while sticking (40), in kg; `None` if
    /// the contact cannot move along n while it sticks.
    pub sticking: Option<[T; 3]>,
    /// Renewed sliding, if mu < mu_c.
    pub renewal: Option<Renewal<T>>,
}

/// Renewed sliding (46).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Renewal<T> {
    /// Its direction, the only root of h with g > 0.
    pub phi_hat: T,
    /// dv_n / dI_n there (31), positive.
    pub f_hat: T,
    /// ds / dI_n there (32), positive.
    pub g_hat: T,
    /// dh / dphi there, in 1/kg. It is below -g_hat, because h' + g = -mu d'.T d' (docs/theory.md, 2.8). Slip
    /// that deviates from phi_hat by a small angle turns back: its angle is multiplied by s^(dh_hat / g_hat)
    /// as the slip s grows (34). So phi_hat is stable.
    pub dh_hat: T,
}

impl<T: Scalar> Characteristics<T> {
    /// The characteristics of a contact. The matrix must be that of a mechanism: positive semidefinite, m_nn > 0.
    #[inline]
    pub fn of(matrix: &ReducedMatrix<T>, mu: T) -> Self {
        let c = Contact::new(matrix, mu);
        let hold = c.hold();
        let mu_c = hold.norm();
        let rate = c.held_rate(&hold);
        let sticking = if rate > T::zero() {
            let n = T::one() / (rate * matrix.nn);
            Some([n, -hold.x * n, -hold.y * n])
        } else {
            None
        };
        let renewal = (mu < mu_c).then(|| {
            let d: Vector2<T> = c.renewal();
            let [f, g, _] = c.rates(&d);
            let dh = c.convergence(&d) - g;
            let [f_hat, g_hat, dh_hat] = [f, g, dh].map(|rate| rate * matrix.nn);
            Renewal { phi_hat: d.y.atan2(d.x), f_hat, g_hat, dh_hat }
        });
        Self {
            mu_c,
            phi_c: if mu_c > T::zero() { hold.y.atan2(hold.x) } else { T::zero() },
            mu_s: (matrix.ts != T::zero()).then(|| matrix.ns / matrix.ts),
            sticking,
            renewal,
        }
    }
}

/// f, g and h (31)-(33) for slip in the direction `phi`, in 1/kg.
#[inline]
pub fn rates<T: Scalar>(matrix: &ReducedMatrix<T>, mu: T, phi: T) -> Vector3<T> {
    let (sin, cos) = phi.sin_cos();
    let c = Contact::new(matrix, mu);
    let d = Vector2::new(cos, sin);
    Vector3::from(c.rates(&d)) * matrix.nn
}
