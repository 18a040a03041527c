//! The saltation matrix: how a small deviation of a mechanism's state changes in a collision.
//!
//! Theory: docs/theory.md, section 13.4.

use nalgebra::{Matrix3, SMatrix, SVector};

use crate::{ImpactDerivative, NonSmoothness, Scalar};

/// A saltation matrix, and why it is only a one-sided derivative, if it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Saltation<T, const N: usize> {
    /// To first order, deviation of the state after = matrix * deviation before, at the same time.
    pub matrix: SMatrix<T, N, N>,
    /// Why the outcome is not differentiable, if it is not.
    pub non_smoothness: Option<NonSmoothness>,
}

/// Derivative of the speeds after a collision with respect to those before, at the same configuration: 1 + R
/// (dI/dv) V.
///
/// `partial_velocities` are V (rows along the contact basis, columns the `P` independent speeds) and
/// `response` is R = M^-1 V^T, change of speeds per unit impulse, both in the axes in which the derivative
/// was taken; [`crate::derivative`] takes any tangential axes, so that
/// those of `partial_velocities_<contact>` and `reduced_matrix_<contact>` of a generated module do. Without
/// prescribed motion V u is the approach velocity; with it V is still its derivative.
#[inline]
pub fn speed_derivative<T: Scalar, const P: usize>(
    derivative: &ImpactDerivative<T>,
    partial_velocities: &SMatrix<T, 3, P>,
    response: &SMatrix<T, P, 3>,
) -> SMatrix<T, P, P> {
    let by_approach: Matrix3<T> = derivative.impulse_by_approach();
    SMatrix::identity() + response * (by_approach * partial_velocities)
}

/// The saltation matrix: to first order, deviation after = matrix * deviation before, at the same time.
///
/// A trajectory with a small deviation also meets the surface a little earlier or later. With the state x =
/// (q, u), the rates x' = f, the gap g(x) = 0 and the jump x+ = r(x-) it is
///
/// D r + (f(x+) - D r f(x-)) D g / (D g f(x-)).
///
/// `reset` is D r: the block of the speeds is [`speed_derivative`], that of the configurations is the
/// identity, and the lower left one is the derivative of the speeds after with respect to the configuration.
/// `before` and `after` are f(x-) and f(x+). For an explicit time add its part to D g f(x-) through a state
/// whose rate is one. `None` if the gap does not close: D g f(x-) >= 0.
#[inline]
pub fn saltation<T: Scalar, const N: usize>(
    reset: &SMatrix<T, N, N>,
    before: &SVector<T, N>,
    after: &SVector<T, N>,
    gap_gradient: &SVector<T, N>,
) -> Option<SMatrix<T, N, N>> {
    let closing = gap_gradient.dot(before);
    if closing >= T::zero() {
        return None;
    }
    let jump = after - reset * before;
    Some(reset + jump * gap_gradient.transpose() / closing)
}
