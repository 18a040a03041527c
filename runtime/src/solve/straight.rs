//! The sliding arc of slip that keeps its direction, and the ways in which a sliding arc may end ([`Slide`]).
//!
//! Theory: docs/theory.md, sections 7.1 and 7.2.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{LinearArc, Restitution, State},
};
use crate::scalar::{Real, constant};

/// How a sliding arc ends.
#[derive(Clone, Copy)]
pub(crate) enum Slide<T: Real> {
    /// The law ended the collision while the contact slid with this velocity.
    Ended(State<T>, Vector2<T>),
    /// Slip stopped first.
    Stopped(State<T>),
    /// Neither happens: slip never stops, and the law never ends the collision.
    Endless(State<T>),
    /// The budget of quadratures was spent when the arc had been followed so far.
    OverBudget(State<T>),
}

/// Follows the sliding arcs of some kind of contact.
pub(crate) trait Slides {
    /// Slides from the tangential velocity `from` of length `speed`.
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T>;
}

/// Slip along a fixed direction: everything is linear in I_n.
#[inline(always)]
pub(crate) fn straight<T: Real>(
    c: &Contact<T>,
    d: Vector2<T>,
    slip: T,
    state: State<T>,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    if T::INLINED {
        straight_here(c, d, slip, state, restitution)
    } else {
        straight_apart(c, d, slip, state, restitution)
    }
}

/// [`straight`] as a function of its own.
#[inline(never)]
pub(super) fn straight_apart<T: Real>(
    c: &Contact<T>,
    d: Vector2<T>,
    slip: T,
    state: State<T>,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    straight_here(c, d, slip, state, restitution)
}

#[inline(always)]
fn straight_here<T: Real>(
    c: &Contact<T>,
    d: Vector2<T>,
    slip: T,
    state: State<T>,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let noise = constant::<T>(1024.0) * T::default_epsilon();
    let [mut f, g, h] = c.rates(&d);
    if f.abs() <= noise * c.normal_size() {
        f = T::zero();
    }
    // If neither slip nor v_n changes, slip never stops.
    let dead = f == T::zero() && g.abs() <= noise * c.slip_size();
    // What rounding has left of slip and v_n, which vanish together, changes no more: slip has stopped.
    if dead && state.velocity.abs() <= c.together(state.normal) && c.slip_is_rounding(slip, state.normal) {
        return Slide::Stopped(state);
    }
    let length = if g < T::zero() && !dead { Some(-slip / g) } else { None };
    let across = Vector2::new(-d.y, d.x);
    let turned = |impulse: Option<T>| if T::refined() { deviation(c, &d, slip, impulse) } else { T::zero() };
    let moved = |impulse: T, velocity: T, work: T, deviation: T| {
        let mut push = d * impulse;
        if T::refined() {
            push += across * deviation;
        }
        State { normal: state.normal + impulse, tangential: state.tangential - push * c.mu, velocity, work }
    };
    match restitution.follow_linear(&state, f, &(d * c.mu), length) {
        LinearArc::Ended { impulse, velocity, work } => {
            let mut left = d * (slip + g * impulse);
            let deviation = turned(Some(impulse));
            if T::refined() {
                left += across * (h * impulse) - c.dragged(&across) * deviation;
            }
            Slide::Ended(moved(impulse, velocity, work, deviation), left)
        }
        LinearArc::Passed(impulse) => {
            let velocity = state.velocity + f * impulse;
            let work = state.work + (state.velocity + velocity) * impulse * constant(0.5);
            Slide::Stopped(moved(impulse, velocity, work, turned(None)))
        }
        LinearArc::Endless => Slide::Endless(state),
    }
}

/// B, the integral over I_n of the angle by which slip turns, to first order in h (theory, 7.1).
///
/// To first order theta' = h + h' theta along tau, with s' = g s and dI_n = s dtau; h' + g = -mu d'.T d'.
/// Where h = 0 the value is zero, but not its derivative. `impulse` is I_n since the beginning, or `None` for
/// all I_n until slip stops.
#[inline]
pub(super) fn deviation<T: Real>(c: &Contact<T>, d: &Vector2<T>, slip: T, impulse: Option<T>) -> T {
    let [_, g, turn] = c.rates(d);
    let sum = c.convergence(d);
    let left = |i: &T| slip + g * *i > T::default_epsilon() * slip;
    let Some(impulse) = impulse.filter(left) else {
        return if sum < T::zero() && g < T::zero() { turn * slip / (g * sum) } else { T::zero() };
    };
    let (one, half, small) = (T::one(), constant::<T>(0.5), T::default_epsilon().sqrt());
    let ratio = impulse / slip;
    // tau = ln(1 + g I / s) / g
    let x = g * ratio;
    let tau = if x.abs() <= small { ratio * (one - x * half) } else { x.ln_1p() / g };
    if tau <= T::zero() {
        return T::zero();
    }
    // (e^(k tau) - 1) / k
    let grown = |k: T| {
        let y = k * tau;
        if y.abs() <= small { tau * (one + y * half) } else { y.exp_m1() / k }
    };
    // For h' -> 0 the formula is 0 / 0; a small h' gives its limit.
    let slope = sum - g;
    let slope = if (slope * tau).abs() <= small { small / tau } else { slope };
    turn * slip * (grown(slope + g) - ratio) / slope
}
