//! The sliding arc to first order in the angle by which slip turns, for slip that begins next to an invariant
//! direction.
//!
//! Theory: docs/theory.md, section 7.2.

use nalgebra::Vector2;

use super::{
    contact::Contact,
    restitution::{LinearArc, Restitution, State},
    straight::{Slide, deviation},
};
use crate::scalar::{Real, constant, larger};

/// The arc from a direction where h is nearly zero, to first order in the angle by which slip turns; `None`
/// where first order is not accurate enough.
///
/// It is needed where two zeros of h are about to merge: the quadratic q of the general method is then a
/// difference of large terms without digits.
///
/// With B the integral of the angle over I_n, slip changes by (b - mu T d) I_n - mu T d' B and v_n by f I_n -
/// mu b.d' B. v_n is followed along one mean direction up to the end of compression and along another from
/// there on, so that it is right to first order at both events.
#[cold]
#[inline(never)]
pub(super) fn perturbed<T: Real>(
    c: &Contact<T>,
    d: &Vector2<T>,
    slip: T,
    restitution: &mut Restitution<T>,
) -> Option<Slide<T>> {
    let (zero, one, half) = (T::zero(), T::one(), constant::<T>(0.5));
    let across = Vector2::new(-d.y, d.x);
    let pull = c.dragged(&across);
    let rate = c.slip_rate(d);
    let [f, g, turn] = c.rates(d);
    // First order does not suffice where the angle grows faster than slip stops. The general method does: a
    // zero with so large an h' has no other zero next to it.
    let slope = -pull.dot(&across) - g;
    let size = c.slip_size();
    if slope > constant::<T>(0.25) * g.abs() && slope > constant::<T>(1e-3) * size {
        return None;
    }
    if f.abs() <= constant::<T>(1024.0) * T::default_epsilon() * c.normal_size() {
        return None;
    }
    let angle = |impulse: T| deviation(c, d, slip, Some(impulse));
    let stop = (g < zero).then(|| -slip / g);
    // The impulse from a state to the end of the arc if slip keeps its direction.
    let remains = |mut restitution: Restitution<T>, state: &State<T>, stop: Option<T>| match restitution
        .follow_linear_apart(state, f, &(*d * c.mu), stop)
    {
        LinearArc::Ended { impulse, .. } | LinearArc::Passed(impulse) => Some(impulse),
        LinearArc::Endless => None,
    };
    let mut state = restitution.start();
    let start = -state.velocity;
    let whole = remains(*restitution, &state, stop)?;
    // Nor does it suffice for large angles, which the mean angle measures.
    let mut mean = (angle(whole) / whole).abs();
    // I_n at the end of slip depends on B (theory, 7.4).
    let mut last = zero;
    let stop = stop.map(|stop| {
        if whole < stop * half {
            return stop;
        }
        last = deviation(c, d, slip, None);
        mean = larger(mean, (last / stop).abs());
        stop + d.dot(&pull) * last / g
    });
    let few = constant::<T>(16.0) * T::default_epsilon() * f.abs() / c.normal_size();
    if slope * whole > slip * constant(0.25)
        || mean * mean > few
        || size * mean * mean * mean > few * turn.abs()
    {
        return None;
    }
    let tangential = |impulse: T, angle: T| -(*d * impulse + across * angle) * c.mu;
    let left = |impulse: T, angle: T| *d * slip + rate * impulse - pull * angle;
    // The work is the area under v_n over I_n; this is the part between v_n and its chord: the integral of B
    // by Boole's rule, in a variable whose points are dense where slip may stop.
    let bow = |from: T, length: T| {
        let part = |y: f64| (one - constant(y)) * angle(from + length * constant(y * (2.0 - y)));
        let sum = (part(0.25) + part(0.75)) * constant(32.0)
            + part(0.5) * constant(12.0)
            + part(0.0) * constant(7.0);
        let chord = (angle(from) + angle(from + length)) * half;
        -c.mu_b.dot(&across) * length * (sum * constant(1.0 / 45.0) - chord)
    };
    let (mut from, mut spent) = (zero, zero);
    if restitution.stop().is_none() && f > zero && start / f <= whole {
        let mean = angle(start / f) * f / start;
        let along = *d + across * mean;
        from = start / c.normal_rate(&along);
        spent = mean * from;
        let work = bow(zero, from) - start * from * half;
        state = State { normal: from, tangential: tangential(from, spent), velocity: zero, work };
        if restitution.compressed(&state) {
            return Some(Slide::Ended(state, left(from, spent)));
        }
    }
    let stop = stop.map(|stop| stop - from);
    let more = remains(*restitution, &state, stop)?;
    // Over a short way the change of B is mere rounding, and the chord suffices.
    let short = whole * constant(1.0 / 1024.0);
    let bow = if more > short { bow(from, more) } else { zero };
    let span = larger(more, short);
    let mean = (angle(from + span) - angle(from)) / span;
    let along = *d + across * mean;
    restitution.since(&state, bow);
    let f = c.normal_rate(&along);
    Some(match restitution.follow_linear_apart(&state, f, &(along * c.mu), stop) {
        LinearArc::Ended { impulse, velocity, work } => {
            let (normal, spent) = (from + impulse, spent + mean * impulse);
            let work = work + bow;
            let state = State { normal, tangential: tangential(normal, spent), velocity, work };
            Slide::Ended(state, left(normal, spent))
        }
        LinearArc::Passed(impulse) => {
            let velocity = state.velocity + f * impulse;
            let done = (state.velocity + velocity) * impulse * half + bow;
            let (normal, work) = (from + impulse, state.work + done);
            let stopped = State { normal, tangential: tangential(normal, last), velocity, work };
            if from > zero {
                restitution.since(&stopped, done);
            }
            Slide::Stopped(stopped)
        }
        LinearArc::Endless => Slide::Endless(state),
    })
}
