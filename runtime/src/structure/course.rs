//! Follows a sliding arc that is given in closed form, and locates on it the end of compression and the end
//! of the collision.
//!
//! Theory: docs/theory.md, sections 8 and 11.

use nalgebra::Vector2;

use crate::{
    scalar::{Real, constant, length},
    solve::{Event, Restitution, Slide, State, Watched},
};

/// How often the step is doubled, on an arc without end, until it reaches the end of the collision.
const DOUBLINGS: u32 = 200;

/// The greatest number of steps for one event.
const STEPS: u32 = 100;

/// A point of an arc.
#[derive(Clone, Copy)]
pub(super) struct Point<T: Real> {
    pub state: State<T>,
    /// Tangential velocity.
    pub slip: Vector2<T>,
    /// dI_n / dxi.
    pub rate: T,
    /// f = dv_n / dI_n (31).
    pub slope: T,
    /// Normal work since the arc began, kept apart from the total because it may be much smaller.
    pub since: T,
}

/// A sliding arc in closed form, over a parameter xi that is zero at its beginning and grows with I_n.
pub(super) trait Course<T: Real>: Sized {
    /// The point at xi = 0.
    fn start(&self) -> Point<T>;
    /// The point at xi.
    fn at(&self, xi: T) -> Point<T>;
    /// The same arc from one of its points on.
    fn from(&self, point: &Point<T>) -> Self;
    /// Where slip stops, if it ever does: xi, the state there and the normal work since the course began.
    fn stop(&self) -> Option<(T, State<T>, T)>;
    /// Where f changes sign, if it does.
    fn turn(&self) -> Option<T>;
}

/// What happens on a piece of an arc on which v_n is monotone.
enum Piece<T: Real> {
    /// The law ended the collision.
    Ended(Point<T>),
    /// The law did not end the collision on it.
    Passed,
    /// Compression ended here, and the law (Stronge's) needs the work from here on: the arc begins anew at
    /// this point.
    Compressed(Point<T>),
}

/// Follows an arc until the law ends the collision or slip stops.
#[inline(always)]
pub(super) fn follow<T: Real>(course: impl Course<T>, restitution: &mut Restitution<T>) -> Slide<T> {
    if T::INLINED { follow_here(course, restitution) } else { follow_apart(course, restitution) }
}

/// [`follow`] as a function of its own.
#[inline(never)]
fn follow_apart<T: Real>(course: impl Course<T>, restitution: &mut Restitution<T>) -> Slide<T> {
    follow_here(course, restitution)
}

#[inline(always)]
fn follow_here<T: Real>(mut course: impl Course<T>, restitution: &mut Restitution<T>) -> Slide<T> {
    let mut state = restitution.start();
    // f changes sign once at most, so that compression ends at most twice.
    for _ in 0..3 {
        match along(&course, restitution) {
            Followed::Over(slide) => return slide,
            Followed::Compressed(point) => {
                course = course.from(&point);
                state = point.state;
            }
        }
    }
    Slide::Endless(state)
}

/// What happens on an arc.
enum Followed<T: Real> {
    Over(Slide<T>),
    /// As [`Piece::Compressed`].
    Compressed(Point<T>),
}

/// Follows an arc piece by piece: to where f changes sign, and from there to where slip stops or, if it never
/// does, on in steps of twice the length until the law ends the collision.
///
/// Each routine is called in one place, so that all of them together are one routine of bounded length where
/// they become a part of the caller.
#[inline(always)]
fn along<T: Real>(course: &impl Course<T>, restitution: &mut Restitution<T>) -> Followed<T> {
    let mut from = (T::zero(), course.start());
    let stop = course.stop();
    let mut turn = course.turn().filter(|xi| *xi > T::zero() && stop.is_none_or(|(end, ..)| *xi < end));
    let mut step = T::one() / from.1.rate;
    for _ in 0..if turn.is_some() { DOUBLINGS + 1 } else { DOUBLINGS } {
        let (to, next) = match (turn, stop) {
            (None, Some(stop)) => (stop, None),
            _ => {
                let xi = turn.unwrap_or(from.0 + step);
                let point = course.at(xi);
                if turn.is_none() && !point.state.normal.is_finite() {
                    break;
                }
                ((xi, point.state, point.since), Some((xi, point)))
            }
        };
        match piece(course, restitution, from, to) {
            Piece::Ended(end) => return Followed::Over(Slide::Ended(end.state, end.slip)),
            Piece::Compressed(point) => return Followed::Compressed(point),
            Piece::Passed => {}
        }
        let Some(next) = next else {
            let (_, state, since) = to;
            restitution.since(&state, since);
            return Followed::Over(Slide::Stopped(state));
        };
        from = next;
        if turn.take().is_some() {
            restitution.grazing.moved(from.1.state.velocity);
            step = T::one() / from.1.rate;
        } else {
            step += step;
        }
    }
    Followed::Over(Slide::Endless(from.1.state))
}

/// What happens between two points between which v_n is monotone.
#[inline(always)]
fn piece<T: Real>(
    course: &impl Course<T>,
    restitution: &mut Restitution<T>,
    from: (T, Point<T>),
    to: (T, State<T>, T),
) -> Piece<T> {
    let zero = T::zero();
    let (mut from, mut to) = (from, to);
    // A work since compression ended may be below the rounding of the total work.
    let works =
        restitution.watches(Watched::Work) && restitution.compressions > 0 && restitution.stop().is_none();
    let passes = if works && from.1.state.velocity >= zero {
        to.1.velocity >= zero && to.2 < restitution.wanted
    } else {
        restitution.passes(&from.1.state, &to.1, T::zero())
    };
    if passes {
        return Piece::Passed;
    }
    // Whether to find the end of compression first.
    let mut compresses = false;
    let by_law = restitution.stop().is_none();
    if by_law && from.1.state.velocity < zero {
        // A target that is known before does not depend on where compression ends.
        compresses = !restitution.skips_compression() || restitution.thorough();
        if !compresses {
            restitution.compressed_somewhere();
        }
    } else if by_law && to.1.velocity < zero {
        let (xi, point) = fall(course, &from, to.0);
        to = (xi, point.state, point.since);
        restitution.falls(&to.1);
    }
    loop {
        let event = match restitution.stop() {
            Some(stop) => Event::Impulse(stop),
            None if compresses => Event::Velocity(zero),
            None => {
                let target = restitution.target;
                let reached =
                    if works { to.2 >= restitution.wanted } else { restitution.watched(&to.1) >= target };
                if !reached
                    || (restitution.watches(Watched::Velocity)
                        && restitution.watched(&from.1.state) >= target)
                {
                    return Piece::Passed;
                }
                Event::end(restitution)
            }
        };
        let mut found = find(course, &event, T::one(), &from, to.0);
        if !compresses {
            if by_law && restitution.watches(Watched::Velocity) {
                // The law states v_n itself: rounding of the place may exceed a small target.
                found.1.state.velocity = restitution.target;
            }
            return Piece::Ended(found.1);
        }
        compresses = false;
        from = found;
        if restitution.compressed(&from.1.state) {
            return Piece::Ended(from.1);
        }
        from.1.state.velocity = zero;
        if restitution.watches(Watched::Work) && length(&from.1.slip) > zero {
            return Piece::Compressed(from.1);
        }
    }
}

/// Where v_n falls through zero, between `from` and `hi`.
#[cold]
#[inline(never)]
fn fall<T: Real>(course: &impl Course<T>, from: &(T, Point<T>), hi: T) -> (T, Point<T>) {
    find_here(course, &Event::Velocity(T::zero()), -T::one(), from, hi)
}

/// The event between `from` and `hi`, where its residual rises (`sign` = 1) or falls (-1) through zero:
/// Newton's method inside a bracket.
#[inline(always)]
fn find<T: Real>(
    course: &impl Course<T>,
    event: &Event<T>,
    sign: T,
    from: &(T, Point<T>),
    hi: T,
) -> (T, Point<T>) {
    if T::INLINED {
        find_here(course, event, sign, from, hi)
    } else {
        find_apart(course, event, sign, from, hi)
    }
}

/// [`find`] as a function of its own.
#[inline(never)]
fn find_apart<T: Real>(
    course: &impl Course<T>,
    event: &Event<T>,
    sign: T,
    from: &(T, Point<T>),
    hi: T,
) -> (T, Point<T>) {
    find_here(course, event, sign, from, hi)
}

#[inline(always)]
fn find_here<T: Real>(
    course: &impl Course<T>,
    event: &Event<T>,
    sign: T,
    (from, begin): &(T, Point<T>),
    hi: T,
) -> (T, Point<T>) {
    let half = constant::<T>(0.5);
    let (mut lo, mut hi) = (*from, hi);
    let residual = |point: &Point<T>| event.residual(&point.state, point.since);
    let slope = |point: &Point<T>| point.rate * event.by_impulse(point.state.velocity, point.slope);
    let y = residual(begin);
    // After the end of compression the work grows like the square of I_n.
    let v = begin.state.velocity;
    let guess = match event {
        Event::Work(_) => {
            let square = v * v - (y + y) * begin.slope;
            let after = if square > T::zero() { square.sqrt() } else { T::zero() };
            lo - (y + y) / ((v + after) * begin.rate)
        }
        _ => lo - y / slope(begin),
    };
    let mut xi = if guess > lo && guess < hi { guess } else { (lo + hi) * half };
    let small = constant::<T>(4.0) * T::default_epsilon();
    // The trials that are left; then the point is the answer. Derivatives converge one step of Newton's
    // method later than values.
    let (mut trials, mut refined) = (STEPS, !T::refined());
    loop {
        let point = course.at(xi);
        if trials > 0 {
            let y = residual(&point);
            if y * sign < T::zero() {
                lo = xi;
            } else {
                hi = xi;
            }
            let step = -y / slope(&point);
            let next = xi + step;
            let done = step.abs() <= small * xi;
            xi = if next >= lo && next <= hi { next } else { (lo + hi) * half };
            let settled = done || hi - lo <= small * hi;
            trials = if settled { 0 } else { trials - 1 };
            if trials == 0 && !refined {
                xi = xi.primal();
            }
        } else if !refined {
            xi -= residual(&point) / slope(&point);
            refined = true;
        } else {
            return (xi, point);
        }
    }
}

/// (1 - e^(-k sigma)) / k, which is sigma for k = 0.
#[inline(always)]
pub(super) fn decayed<T: Real>(k: T, sigma: T) -> T {
    let x = k * sigma;
    if x.abs() <= constant(1e-5) {
        // Three terms of the series; the next is below rounding.
        return sigma * (T::one() - x * constant(0.5) * (T::one() - x * constant(1.0 / 3.0)));
    }
    -(-x).exp_m1() / k
}

/// sigma from xi = (1 - e^(-k sigma)) / k.
#[inline(always)]
pub(super) fn elapsed<T: Real>(k: T, xi: T) -> T {
    let x = k * xi;
    if x.abs() <= constant(1e-5) {
        return xi * (T::one() + x * constant(0.5) * (T::one() + x * constant(2.0 / 3.0)));
    }
    -(-x).ln_1p() / k
}

/// Whether slip with components `along` and `across` an axis of symmetry keeps its direction: whether one of
/// them is zero.
#[inline(always)]
pub(super) fn stays<T: Real>(along: T, across: T) -> bool {
    let v = Vector2::new(along, across);
    let none = constant::<T>(0.25) * T::default_epsilon() * length(&v);
    along.abs() <= none || across.abs() <= none
}
