//! The sliding arc (34), stretch by stretch, until the law ends the collision or slip stops.
//!
//! Theory: docs/theory.md, section 7.1.

use nalgebra::Vector2;

use super::{
    Contact,
    event_location::EventLocation,
    gauss16::Panel,
    perturbation::{deviation, perturbed},
    range::rescaled,
    restitution::{LinearArc, Restitution, State},
    sliding_arc::{ArcPoint, SlidingArc},
};
use crate::scalar::{Real, constant};

/// The greatest number of stretches. Each is as long in lambda as the zeros of q are far from it, so that a few dozen lead past everything.
const STRETCHES: u32 = 512;

/// Where slip begins with |h| below so many times the rounding of h, slip turns by a small angle only, or not at all, and perturbation is tried first.
const NEARLY: f64 = 131_072.0;

/// How the sliding arc ends.
pub(crate) enum Slide<T: Real> {
    /// The law ended the collision while the contact slid with this velocity.
    Ended(State<T>, Vector2<T>),
    /// Slip stopped first.
    Stopped(State<T>),
    /// Neither happens: slip goes on for ever.
    Endless(State<T>),
}

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

/// The same for a contact whose rates are ordinary numbers.
#[inline]
pub(super) fn arc<T: Real>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    restitution: &mut Restitution<T>,
) -> Slide<T> {
    let eps = T::default_epsilon();
    // Rounding leaves h this uncertain.
    let noise = eps * c.slip_size();
    let direction = from / speed;
    let [.., h] = c.rates(&direction);
    if h.abs() <= noise * constant(NEARLY) {
        if h.abs() <= noise * constant(4.0) {
            return straight(c, direction, speed, restitution.start(), restitution);
        }
        if let Some(slide) = perturbed(c, &direction, speed, restitution) {
            return slide;
        }
    }
    let (arc, w) = SlidingArc::through(c, &direction);
    let mut at = ArcPoint { state: restitution.start(), since: T::zero(), w, sigma: speed / arc.e(w) };
    let stops = arc.last_rate() < T::zero();
    let mut panel = Panel::new(speed);
    for _ in 0..STRETCHES {
        let rates = arc.rates(&at);
        let slip = at.sigma * rates.e;
        let over = slip <= eps * speed * constant(4.0) && rates.growth + rates.shape < T::zero();
        let settled = at.w > arc.outer && arc.turns_slower(&at, &rates, noise * constant(8.0));
        if over || settled {
            restitution.since(&at.state, at.since);
            return straight(c, arc.slip(&at) / slip, slip, at.state, restitution);
        }
        let fast = restitution.fast(c, slip);
        let (rising, turning_point) = arc.turning_point(&at, &rates);
        if stops && turning_point.is_none() && !fast && arc.settles(&at, slip / speed) {
            let (stop, since) = arc.stop(&at);
            if restitution.passes(&at.state, &stop) {
                restitution.since(&stop, since);
                return Slide::Stopped(stop);
            }
        }
        let reach = arc.reach(&at, &rates);
        let panel = &mut panel;
        let mut location =
            EventLocation { arc: &arc, from: at, rates: &rates, rising, turning_point, fast, panel, reach };
        if location.follow(restitution, &mut at) {
            return Slide::Ended(at.state, arc.slip(&at));
        }
        restitution.grazing.moved(at.state.velocity);
    }
    Slide::Endless(at.state)
}

/// Slip along a fixed direction: everything is linear in I_n.
#[inline]
pub(crate) fn straight<T: Real>(
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
    // Slip that no longer changes while v_n does not either goes on for ever.
    let dead = f == T::zero() && g.abs() <= noise * c.slip_size();
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
