//! Follows a sliding arc that is given in closed form, and locates on it the end of compression and the end
//! of the collision.
//!
//! Theory: docs/theory.md, sections 8 and 11.

use nalgebra::Vector2;

use crate::{
    Law,
    scalar::{Real, constant, length},
    solve::{Event, Restitution, Slide, State},
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
pub(super) fn follow<T: Real>(mut course: impl Course<T>, restitution: &mut Restitution<T>) -> Slide<T> {
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

fn along<T: Real>(course: &impl Course<T>, restitution: &mut Restitution<T>) -> Followed<T> {
    let mut from = (T::zero(), course.at(T::zero()));
    let stop = course.stop();
    let turn = course.turn().filter(|xi| *xi > T::zero() && stop.is_none_or(|(end, ..)| *xi < end));
    let ended = |end: Point<T>| Followed::Over(Slide::Ended(end.state, end.slip));
    if let Some(xi) = turn {
        let to = (xi, course.at(xi));
        match piece(course, restitution, from, (to.0, to.1.state, to.1.since)) {
            Piece::Ended(end) => return ended(end),
            Piece::Compressed(point) => return Followed::Compressed(point),
            Piece::Passed => {}
        }
        restitution.grazing.moved(to.1.state.velocity);
        from = to;
    }
    if let Some((xi, state, since)) = stop {
        return match piece(course, restitution, from, (xi, state, since)) {
            Piece::Ended(end) => ended(end),
            Piece::Compressed(point) => Followed::Compressed(point),
            Piece::Passed => {
                restitution.since(&state, since);
                Followed::Over(Slide::Stopped(state))
            }
        };
    }
    // Slip never stops: go on until the law ends the collision.
    let mut step = T::one() / from.1.rate;
    for _ in 0..DOUBLINGS {
        let xi = from.0 + step;
        let to = (xi, course.at(xi));
        if !to.1.state.normal.is_finite() {
            break;
        }
        match piece(course, restitution, from, (xi, to.1.state, to.1.since)) {
            Piece::Ended(end) => return ended(end),
            Piece::Compressed(point) => return Followed::Compressed(point),
            Piece::Passed => {}
        }
        from = to;
        step += step;
    }
    Followed::Over(Slide::Endless(from.1.state))
}

/// What happens between two points between which v_n is monotone.
fn piece<T: Real>(
    course: &impl Course<T>,
    restitution: &mut Restitution<T>,
    from: (T, Point<T>),
    to: (T, State<T>, T),
) -> Piece<T> {
    let zero = T::zero();
    let law = restitution.law();
    let (mut from, mut to) = (from, to);
    // Stronge's target is a work since compression ended, which may be below the rounding of the total work.
    let works = law == Law::Stronge && restitution.compressions > 0 && restitution.stop().is_none();
    let passes = if works && from.1.state.velocity >= zero {
        to.1.velocity >= zero && to.2 < restitution.wanted
    } else {
        restitution.passes(&from.1.state, &to.1, T::zero())
    };
    if passes {
        return Piece::Passed;
    }
    if let Some(stop) = restitution.stop() {
        return Piece::Ended(find(course, &Event::Impulse(stop), T::one(), &from, to.0).1);
    }
    if from.1.state.velocity < zero {
        if law == Law::Newton && restitution.target > zero && !restitution.thorough() {
            // Newton's target does not depend on where compression ends.
            restitution.compressed_somewhere();
        } else {
            from = find(course, &Event::Velocity(zero), T::one(), &from, to.0);
            if restitution.compressed(&from.1.state) {
                return Piece::Ended(from.1);
            }
            from.1.state.velocity = zero;
            if law == Law::Stronge && length(&from.1.slip) > zero {
                return Piece::Compressed(from.1);
            }
        }
    } else if to.1.velocity < zero {
        let (xi, point) = find(course, &Event::Velocity(zero), -T::one(), &from, to.0);
        to = (xi, point.state, point.since);
        restitution.falls(&to.1);
    }
    let target = restitution.target;
    let reached = if works { to.2 >= restitution.wanted } else { restitution.watched(&to.1) >= target };
    if !reached || (law == Law::Newton && restitution.watched(&from.1.state) >= target) {
        return Piece::Passed;
    }
    let mut end = find(course, &Event::end(restitution), T::one(), &from, to.0).1;
    if law == Law::Newton {
        // The law states v_n itself: rounding of the place may exceed a small target.
        end.state.velocity = target;
    }
    Piece::Ended(end)
}

/// The event between `from` and `hi`, where its residual rises (`sign` = 1) or falls (-1) through zero:
/// Newton's method inside a bracket.
fn find<T: Real>(
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
    for _ in 0..STEPS {
        let point = course.at(xi);
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
        if done || hi - lo <= small * hi {
            break;
        }
    }
    if T::refined() {
        // Derivatives converge one step of Newton's method later than values.
        let plain = xi.primal();
        let point = course.at(plain);
        xi = plain - residual(&point) / slope(&point);
    }
    (xi, course.at(xi))
}

/// (1 - e^(-k sigma)) / k, which is sigma for k = 0.
#[inline]
pub(super) fn decayed<T: Real>(k: T, sigma: T) -> T {
    let x = k * sigma;
    if x.abs() <= constant(1e-5) {
        // Three terms of the series; the next is below rounding.
        return sigma * (T::one() - x * constant(0.5) * (T::one() - x * constant(1.0 / 3.0)));
    }
    -(-x).exp_m1() / k
}

/// sigma from xi = (1 - e^(-k sigma)) / k.
#[inline]
pub(super) fn elapsed<T: Real>(k: T, xi: T) -> T {
    let x = k * xi;
    if x.abs() <= constant(1e-5) {
        return xi * (T::one() + x * constant(0.5) * (T::one() + x * constant(2.0 / 3.0)));
    }
    -(-x).ln_1p() / k
}

/// Whether slip with components `along` and `across` an axis of symmetry keeps its direction: whether one of
/// them is zero.
#[inline]
pub(super) fn stays<T: Real>(along: T, across: T) -> bool {
    let v = Vector2::new(along, across);
    let none = constant::<T>(0.25) * T::default_epsilon() * length(&v);
    along.abs() <= none || across.abs() <= none
}
