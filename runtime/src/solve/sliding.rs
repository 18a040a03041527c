//! The sliding arc (34), stretch by stretch, until the law ends the collision or slip stops.

use nalgebra::Vector2;

use super::{
    bend::{bend, bent},
    flow::{Flow, Place},
    ledger::{Ledger, Line, State},
    panel::Panel,
    search::Search,
    terminal::Contact,
};
use crate::{scalar::Real as Scalar, scalar::constant, scalar::length};

/// Stretches after which the arc is given up. Each is as long, in the logarithm of the distance to the directions where slip stays, as the zeros of q
/// are away from it, so that a few dozen lead past anything.
const STRETCHES: u32 = 512;

/// So many times its own rounding h may be where slip begins and is taken to turn by a small angle only, if it does.
const NEARLY: f64 = 131_072.0;

/// What became of the sliding arc.
pub(crate) enum Slide<T: Scalar> {
    /// The law ended the collision while the contact slid with this velocity.
    Ended(State<T>, Vector2<T>),
    /// Slip stopped first.
    Stopped(State<T>),
    /// Neither will ever happen.
    Endless(State<T>),
}

/// Slides from the given tangential velocity.
#[inline]
pub(crate) fn slide<T: Scalar>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    ledger: &mut Ledger<T>,
) -> Slide<T> {
    let eps = T::default_epsilon();
    // Rounding leaves h this uncertain.
    let noise = eps * (length(&c.b) + c.mu * (c.tt + c.ss));
    let direction = from / speed;
    let rate = c.slip_rate(&direction);
    let h = rate.y * direction.x - rate.x * direction.y;
    if h.abs() <= noise * constant(NEARLY) {
        if h.abs() <= noise * constant(4.0) {
            return straight(c, direction, speed, State::approach(), ledger);
        }
        if let Some(slide) = bent(c, &direction, speed, ledger) {
            return slide;
        }
    }
    let (flow, w) = Flow::through(c, &direction);
    let mut at = Place { state: State::approach(), since: T::zero(), w, sigma: speed / flow.e(w) };
    let stops = flow.last_rate() < T::zero();
    let mut panel = Panel::new(speed);
    for _ in 0..STRETCHES {
        let rates = flow.rates(&at);
        let slip = at.sigma * rates.e;
        let over = slip <= eps * speed * constant(4.0) && rates.growth + rates.shape < T::zero();
        let settled = at.w > flow.outer && flow.turns_less(&at, &rates, noise * constant(8.0));
        if over || settled {
            ledger.since(&at.state, at.since);
            return straight(c, flow.slip(&at) / slip, slip, at.state, ledger);
        }
        let fast = ledger.fast(c, slip);
        let course = flow.fold(&at, &rates);
        if stops && course.1.is_none() && !fast && flow.settles(&at, slip / speed) {
            let (stop, since) = flow.stop(&at);
            if ledger.passes(&at.state, &stop) {
                ledger.since(&stop, since);
                return Slide::Stopped(stop);
            }
        }
        let reach = flow.reach(&at, &rates);
        let mut search =
            Search { flow: &flow, from: at, rates: &rates, course, fast, panel: &mut panel, reach };
        if search.follow(ledger, &mut at) {
            return Slide::Ended(at.state, flow.slip(&at));
        }
        ledger.turns.moved(at.state.velocity);
    }
    Slide::Endless(at.state)
}

/// Slip along a fixed direction: everything is linear in I_n.
#[inline]
pub(crate) fn straight<T: Scalar>(
    c: &Contact<T>,
    d: Vector2<T>,
    slip: T,
    state: State<T>,
    ledger: &mut Ledger<T>,
) -> Slide<T> {
    let noise = constant::<T>(1024.0) * T::default_epsilon();
    let g = c.slip_rate(&d).dot(&d);
    let mut f = c.normal_rate(&d);
    if f.abs() <= noise * (T::one() + c.mu * length(&c.b)) {
        f = T::zero();
    }
    // Slip that no longer changes while v_n does not either goes on for ever.
    let dead = f == T::zero() && g.abs() <= noise * (length(&c.b) + c.mu * (c.tt + c.ss));
    let length = if g < T::zero() && !dead { Some(-slip / g) } else { None };
    let across = Vector2::new(-d.y, d.x);
    let turned = |impulse: Option<T>| if T::refined() { bend(c, &d, slip, impulse) } else { T::zero() };
    let moved = |impulse: T, velocity: T, work: T, bend: T| {
        let mut push = d * impulse;
        if T::refined() {
            push += across * bend;
        }
        State { normal: state.normal + impulse, tangential: state.tangential - push * c.mu, velocity, work }
    };
    match ledger.follow_line(&state, f, &(d * c.mu), length) {
        Line::Ended { impulse, velocity, work } => {
            let mut left = d * (slip + g * impulse);
            let bend = turned(Some(impulse));
            if T::refined() {
                let pull = Vector2::new(c.ts * d.x - c.tt * d.y, c.ss * d.x - c.ts * d.y);
                left += across * (c.slip_rate(&d).dot(&across) * impulse) - pull * (c.mu * bend);
            }
            Slide::Ended(moved(impulse, velocity, work, bend), left)
        }
        Line::Passed(impulse) => {
            let velocity = state.velocity + f * impulse;
            let work = state.work + (state.velocity + velocity) * impulse * constant(0.5);
            Slide::Stopped(moved(impulse, velocity, work, turned(None)))
        }
        Line::Endless => Slide::Endless(state),
    }
}
