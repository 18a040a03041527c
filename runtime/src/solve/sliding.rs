//! The sliding arc (34), piece by piece, until the law ends the collision or slip stops.

use nalgebra::Vector2;

use super::{
    arc::{Start, follow},
    bend::bend,
    chart::Chart,
    ledger::{Ledger, Line, State},
    regular::Regular,
    root::{Ahead, Root},
    series::{MOST, table},
    terminal::Contact,
};
use crate::{scalar::Real as Scalar, scalar::constant, scalar::length};

/// Pieces after which the arc is given up. Each one changes the distance to a root of h by a fixed factor at least.
const PIECES: u32 = 512;

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
    let mut at = Start { state: State::approach(), direction: from / speed, slip: speed };
    let mut table = table(speed);
    let mut ahead = None;
    for _ in 0..PIECES {
        let chart = Chart::about(c, &at.direction);
        let [h0, h1, ..] = chart.h;
        let [g, ..] = chart.k;
        let settled = h1 < T::zero() && h0.abs() <= noise * constant(8.0);
        let over = g < T::zero() && at.slip <= eps * speed * constant(4.0);
        if settled || over || h0.abs() <= noise * constant(4.0) {
            return straight(c, at.direction, at.slip, at.state, ledger);
        }
        let [f0, ..] = chart.f;
        // An end close by is better sought from here than from the root: a rough look at how far slip will turn and change.
        let away = ledger.remaining(&at.state, f0);
        let near = away * (g.abs() + h1.abs() * constant(0.5)) < at.slip * constant(0.4);
        if ahead.is_none() && !near {
            ahead = Ahead::of(c, &chart, &at.direction);
        }
        let rest = match &ahead {
            Some(ahead) if !near => Root::new(&mut table, c, ahead, at),
            _ => None,
        };
        if let Some(mut rest) = rest {
            let stops = rest.alpha > T::zero();
            let stop = rest.stop();
            if stops && ledger.passes(&at.state, &stop) {
                return Slide::Stopped(stop);
            }
            let far = if stops {
                (stop.normal - at.state.normal) * constant(0.1)
            } else {
                rest.first_rate() * constant(0.25)
            };
            let mut log = [at.slip; MOST];
            if away > far && rest.prepare(&mut log) {
                match follow(c, &rest, &at, rest.first_rate(), f0, ledger) {
                    Ok(point) => return Slide::Ended(point.state, point.slip),
                    Err(_) if stops => return Slide::Stopped(stop),
                    Err(point) => {
                        ledger.turns.moved(point.state.velocity);
                        let slip = length(&point.slip);
                        if slip <= eps * speed {
                            return Slide::Stopped(point.state);
                        }
                        at = Start { state: point.state, direction: point.slip / slip, slip };
                        continue;
                    }
                }
            }
        }
        let step = Regular::new(&mut table, c, &chart, at, away);
        match follow(c, &step, &at, step.first_rate(), f0, ledger) {
            Ok(point) => return Slide::Ended(point.state, point.slip),
            Err(point) => {
                ledger.turns.moved(point.state.velocity);
                let slip = length(&point.slip);
                if slip <= eps * speed {
                    return Slide::Stopped(point.state);
                }
                at = Start { state: point.state, direction: point.slip / slip, slip };
            }
        }
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
