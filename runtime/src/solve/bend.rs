//! How a straight hodograph bends when its inputs change: what derivatives need to know of a direction of slip that stays.

use nalgebra::Vector2;

use super::terminal::Contact;
use crate::scalar::{Real, constant};

/// The integral over I_n of the deviation of phi from a zero of h, where h is `turn` = 0 up to its derivatives.
///
/// To first order phi' = h + h' phi along tau, with s' = g s and dI_n = s dtau; h' + g = -mu d'.T d'.
/// `impulse` is I_n since the beginning, or nothing if slip stops.
#[inline]
pub(super) fn bend<T: Real>(c: &Contact<T>, d: &Vector2<T>, slip: T, impulse: Option<T>) -> T {
    let across = Vector2::new(-d.y, d.x);
    let rate = c.slip_rate(d);
    let (g, turn) = (rate.dot(d), rate.dot(&across));
    let sum = -c.mu * (c.tt * d.y * d.y - (c.ts + c.ts) * d.x * d.y + c.ss * d.x * d.x);
    let left = |i: &T| slip + g * *i > T::default_epsilon() * slip;
    let Some(impulse) = impulse.filter(left) else {
        return if sum < T::zero() && g < T::zero() { turn * slip / (g * sum) } else { T::zero() };
    };
    let size = g.abs() + sum.abs();
    let small = constant::<T>(1e-8);
    let ratio = impulse / slip;
    // tau = ln(1 + g I / s) / g
    let x = g * ratio;
    let tau = if x.abs() <= small { ratio * (T::one() - x * constant(0.5)) } else { (T::one() + x).ln() / g };
    let grown = |k: T| {
        let y = k * tau;
        if y.abs() <= constant(1e-3) {
            tau * (T::one()
                + y * (constant::<T>(0.5) + y * (constant::<T>(1.0 / 6.0) + y * constant(1.0 / 24.0))))
        } else {
            (y.exp() - T::one()) / k
        }
    };
    let slope = sum - g;
    // Where h' vanishes too, a neighbour is as good.
    let slope = if slope.abs() <= small * size { small * size } else { slope };
    if slope == T::zero() {
        // Nothing acts along the contact plane.
        return turn * ratio * impulse * constant(0.5);
    }
    turn * slip * (grown(slope + g) - ratio) / slope
}
