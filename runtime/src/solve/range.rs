//! Follows the sliding arc, in other units where its rates are so large or so small that their sixth powers
//! would overflow or underflow.
//!
//! With x = 1 + mu (|m_nt| + |m_ns|) for normal and y = |m_nt| + |m_ns| + mu tr T for tangential rates, the
//! following units make all rates at most one: 1/x for I_n, y/x for v_tan, mu/x for I_tan; v_n keeps its
//! unit. Then
//!
//! dv_n = (1/x - (mu b/x).d) dI_n,  dv_tan = (b/y - (mu T/y) d) dI_n,  dI_tan = -d dI_n.
//!
//! b/y and mu b/x no longer differ by the factor mu. The arc does not need that they do, but the balance of
//! energy does; the work is therefore integrated directly.
//!
//! Theory: docs/theory.md, section 1.2.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{Restitution, State},
    sliding::arc,
    straight::{Slide, straight},
};
use crate::scalar::{Real, constant};

/// Slides from the given tangential velocity.
#[inline]
pub(crate) fn slide<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    if c.is_ordinary() {
        return arc(c, from, speed, restitution);
    }
    rescaled(c, from, speed, restitution)
}

/// [`slide`] in the units of the module's description.
#[cold]
#[inline(never)]
fn rescaled<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let one = T::one();
    let (x, y) = (c.normal_size(), c.slip_size());
    // f is at least 1/2, so that the collision ends before I_n = 8; until then slip changes by less than
    // rounding.
    let still = x <= constant(1.5) && y * constant(8.0) <= T::default_epsilon() * speed;
    if still || y <= T::zero() {
        return straight(c, from / speed, speed, restitution.start(), restitution);
    }
    let unit = y / x;
    let [b, mu_b] = [c.b / y, c.mu_b / x];
    let [tt, ts, ss] = [c.mu_tt / y, c.mu_ts / y, c.mu_ss / y];
    let inner = Contact { nn: one / x, mu: one, b, tt, ts, ss, mu_b, mu_tt: tt, mu_ts: ts, mu_ss: ss };
    let rub = c.mu / x;
    let mut scaled = restitution.in_units(x, one / rub, true);
    let slide = arc(&inner, from / unit, speed / unit, &mut scaled);
    let back = |state: State<T>| state.in_units(one / x, rub);
    let slide = match slide {
        Slide::Ended(state, velocity) => Slide::Ended(back(state), velocity * unit),
        Slide::Stopped(state) => Slide::Stopped(back(state)),
        Slide::Endless(state) => Slide::Endless(back(state)),
        Slide::OverBudget(state) => Slide::OverBudget(back(state)),
    };
    *restitution = scaled.in_units(one / x, rub, false);
    slide
}
