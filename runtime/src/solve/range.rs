//! Sliding where the rates lie beyond the range in which the arc can be calculated: mu or couplings of very large or very small size.
//!
//! With x = max(1, mu |b|) for normal and y = |b| + mu |T| for tangential rates (as sums of absolute entries), new units make all of them at most
//! one: I_n counts in 1/x, v_tan in y/x and I_tan in mu/x, and v_n in what it was. Then
//!
//! dv_n = (1/x - (mu b/x).d) dI_n,  dv_tan = (b/y - (mu T/y) d) dI_n,  dI_tan = -d dI_n.
//!
//! b and mu b are no longer multiples of each other by mu, which the arc never asks for; but the balance of energy, which does, is not
//! used: the work is integrated directly.
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

/// [`slide`] in units of the contact's own rates.
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
    // f is at least 1/2, so that I_n ends before 8, and slip has not turned by a rounding unit by then.
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
    };
    *restitution = scaled.in_units(one / x, rub, false);
    slide
}
