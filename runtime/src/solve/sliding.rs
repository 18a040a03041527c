//! The sliding arc (34), step by step, until the law ends the collision or slip stops.

use nalgebra::Vector2;

use super::{
    chart::{Chart, Point, Series},
    ledger::{Ledger, Line, State},
    terminal::Contact,
};
use crate::{Law, Scalar, scalar::constant};

/// Steps after which the arc is given up. Each step shrinks or grows the distance to a root of h by a fixed factor.
const STEPS: u32 = 512;

/// What became of the sliding arc.
pub(super) enum Slide<T: Scalar> {
    /// The law ended the collision while the contact slid with this velocity.
    Ended(State<T>, Vector2<T>),
    /// Slip stopped first.
    Stopped(State<T>),
    /// Neither will ever happen.
    Endless(State<T>),
}

/// Slides from the given tangential velocity.
#[inline]
pub(super) fn slide<T: Scalar>(
    c: &Contact<T>,
    from: Vector2<T>,
    speed: T,
    ledger: &mut Ledger<T>,
) -> Slide<T> {
    let eps = T::default_epsilon();
    let mut d = from / speed;
    let mut slip = speed;
    let mut state = State::approach();
    for _ in 0..STEPS {
        let chart = Chart::about(c, &d);
        let [h0, h1, ..] = chart.h;
        let noise = eps * (chart.h[1].abs() + chart.h[2].abs() + chart.h[3].abs() + chart.h[4].abs());
        let settled = h1 < T::zero() && h0.abs() <= noise * constant(2.0);
        if settled || h0.abs() <= noise * constant(0.25) {
            return straight(c, d, slip, state, ledger);
        }
        if chart.k[0] < T::zero() && slip <= eps * eps * speed {
            return Slide::Stopped(state);
        }
        let Some(series) = Series::new(&chart, c.mu, d, slip, state) else {
            return Slide::Endless(state);
        };
        let end = series.turning().unwrap_or(series.limit);
        let last = match follow(&series, &state, end, ledger) {
            Ok(point) => {
                let (d, s) = series.slip(&point);
                return Slide::Ended(point.state, d * s);
            }
            Err(point) => point,
        };
        state = last.state;
        (d, slip) = series.slip(&last);
        let norm = d.norm();
        d /= norm;
    }
    Slide::Endless(state)
}

/// Slip along a fixed direction: everything is linear in I_n.
#[inline]
fn straight<T: Scalar>(
    c: &Contact<T>,
    d: Vector2<T>,
    slip: T,
    state: State<T>,
    ledger: &mut Ledger<T>,
) -> Slide<T> {
    let noise = constant::<T>(64.0) * T::default_epsilon();
    let g = c.slip_rate(&d).dot(&d);
    let mut f = c.normal_rate(&d);
    if f.abs() <= noise * (T::one() + c.mu * c.b.norm()) {
        f = T::zero();
    }
    let length = if g < T::zero() { Some(-slip / g) } else { None };
    let moved = |impulse: T, velocity: T, work: T| State {
        normal: state.normal + impulse,
        tangential: state.tangential - d * (c.mu * impulse),
        velocity,
        work,
    };
    match ledger.follow_line(&state, f, length) {
        Line::Ended { impulse, velocity, work } => {
            Slide::Ended(moved(impulse, velocity, work), d * (slip + g * impulse))
        }
        Line::Passed(impulse) => {
            let velocity = state.velocity + f * impulse;
            let work = state.work + (state.velocity + velocity) * impulse * constant(0.5);
            Slide::Stopped(moved(impulse, velocity, work))
        }
        Line::Endless => Slide::Endless(state),
    }
}

/// Looks for the end of the collision on one step, where v_n is monotone up to `end`: the point, or else the last one.
#[inline]
fn follow<T: Scalar>(
    series: &Series<T>,
    start: &State<T>,
    end: T,
    ledger: &mut Ledger<T>,
) -> Result<Point<T>, Point<T>> {
    let last = series.at(end);
    let zero = T::zero();
    let mut from = zero;
    let mut begin = *start;
    let mut hi = end;
    if begin.velocity < zero {
        if last.state.velocity < zero {
            return Err(last);
        }
        let (rate, f) = series.rates(zero, &series.at(zero));
        let guess = if f > zero { -begin.velocity / (f * rate) } else { end };
        from = find(series, zero, zero, end, guess, |p| p.velocity, |v| v);
        let point = series.at(from);
        if ledger.compressed(point.state.normal, point.state.work) {
            return Ok(point);
        }
        begin = point.state;
    } else if last.state.velocity < zero {
        // v_n falls through zero: the law must end before.
        let (rate, f) = series.rates(zero, &series.at(zero));
        let guess = if f < zero { -begin.velocity / (f * rate) } else { end };
        hi = find(series, zero, zero, end, guess, |p| -p.velocity, |v| -v);
    }
    let top = if hi < end { series.at(hi).state } else { last.state };
    let law = ledger.law();
    let target = ledger.target;
    if ledger.watched(&top) < target || (law == Law::Newton && ledger.watched(&begin) >= target) {
        return Err(last);
    }
    let at = series.at(from);
    let (rate, f) = series.rates(from, &at);
    let theta = match law {
        Law::Newton => find(
            series,
            target,
            from,
            hi,
            from + (target - begin.velocity) / (f * rate),
            |p| p.velocity,
            |v| v,
        ),
        Law::Poisson => {
            find(series, target, from, hi, from + (target - begin.normal) / rate, |p| p.normal, |_| T::one())
        }
        Law::Stronge => {
            let missing = target - begin.work;
            let square = begin.velocity * begin.velocity + (missing + missing) * f;
            let after = if square > zero { square.sqrt() } else { zero };
            let guess = from + (missing + missing) / ((begin.velocity + after) * rate);
            find(series, target, from, hi, guess, |p| p.work, |_| T::one())
        }
    };
    Ok(series.at(theta))
}

/// The theta in [lo, hi] where a rising quantity takes the target: Newton's method kept inside a bracket.
#[inline]
fn find<T: Scalar>(
    series: &Series<T>,
    target: T,
    mut lo: T,
    mut hi: T,
    guess: T,
    quantity: impl Fn(&State<T>) -> T,
    _slope: impl Fn(T) -> T,
) -> T {
    let half = constant::<T>(0.5);
    let mut theta = if guess > lo && guess < hi { guess } else { (lo + hi) * half };
    for _ in 0..64 {
        let point = series.at(theta);
        let miss = quantity(&point.state) - target;
        if miss < T::zero() {
            lo = theta;
        } else {
            hi = theta;
        }
        let (rate, f) = series.rates(theta, &point);
        let slope = slope_of(&quantity, &point.state, rate, f);
        let next = theta - miss / slope;
        let step = (next - theta).abs();
        if step <= constant::<T>(2.0) * T::default_epsilon() * hi {
            return next;
        }
        theta = if next > lo && next < hi { next } else { (lo + hi) * half };
        if hi - lo <= T::default_epsilon() * hi {
            return theta;
        }
    }
    theta
}

/// d quantity / d theta, by asking the quantity for its part of the state's derivative (all are linear in the state).
#[inline]
fn slope_of<T: Scalar>(quantity: &impl Fn(&State<T>) -> T, at: &State<T>, rate: T, f: T) -> T {
    quantity(&State {
        normal: rate,
        tangential: Vector2::zeros(),
        velocity: rate * f,
        work: rate * at.velocity,
    })
}
