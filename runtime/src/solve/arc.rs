//! A piece of the sliding arc that can be evaluated anywhere, and the search for the end of the collision on it.

use nalgebra::Vector2;

use super::{
    ledger::{Ledger, State},
    terminal::Contact,
};
use crate::{Law, scalar::Real as Scalar, scalar::constant, scalar::length};

/// Where a piece begins.
#[derive(Clone, Copy)]
pub(super) struct Start<T: Scalar> {
    pub state: State<T>,
    /// Unit vector along the slip.
    pub direction: Vector2<T>,
    pub slip: T,
}

/// A point on a piece.
#[derive(Clone, Copy)]
pub(super) struct Point<T: Scalar> {
    pub state: State<T>,
    /// dI_n / dtheta.
    pub rate: T,
    /// f = dv_n / dI_n (31).
    pub slope: T,
    /// Tangential velocity.
    pub slip: Vector2<T>,
}

impl<T: Scalar> Point<T> {
    /// The point a tiny step further.
    #[inline]
    fn moved(&self, contact: &Contact<T>, step: T) -> Self {
        let impulse = self.rate * step;
        let d = self.slip / length(&self.slip);
        let state = &self.state;
        Self {
            state: State {
                normal: state.normal + impulse,
                tangential: state.tangential - d * (contact.mu * impulse),
                velocity: state.velocity + self.slope * impulse,
                work: state.work + state.velocity * impulse,
            },
            slip: self.slip + contact.slip_rate(&d) * impulse,
            ..*self
        }
    }
}

/// What an event is sought in: v_n, I_n or the normal work, each less a target.
#[derive(Clone, Copy)]
pub(super) enum Sought<T> {
    Velocity(T),
    Impulse(T),
    Work(T),
}

impl<T: Scalar> Sought<T> {
    /// The value less the target.
    #[inline(always)]
    pub fn of(&self, state: &State<T>) -> T {
        match *self {
            Self::Velocity(target) => state.velocity - target,
            Self::Impulse(target) => state.normal - target,
            Self::Work(target) => state.work - target,
        }
    }

    /// Its derivative by theta.
    #[inline(always)]
    pub fn slope(&self, state: &State<T>, rate: T, slope: T) -> T {
        match self {
            Self::Velocity(_) => rate * slope,
            Self::Impulse(_) => rate,
            Self::Work(_) => rate * state.velocity,
        }
    }
}

/// A piece on which I_n rises with theta from 0 to `end`, and v_n is monotone.
pub(super) trait Arc<T: Scalar> {
    fn at(&self, theta: T) -> Point<T>;
    /// What is sought and its derivative by theta.
    fn value(&self, theta: T, sought: &Sought<T>) -> (T, T) {
        let point = self.at(theta);
        (sought.of(&point.state), sought.slope(&point.state, point.rate, point.slope))
    }
    fn end(&self) -> T;
    /// The point at the end.
    fn last(&self, end: T) -> Point<T> {
        self.at(end)
    }
    /// Whether the parameter runs far beyond what is of interest, so that the end says little.
    fn winds(&self) -> bool {
        false
    }
    /// The step that corrects Newton's for the way the arc runs out, if interpolation would do worse.
    fn step(&self, _newton: T) -> Option<T> {
        None
    }
    /// A first guess at a point after `lo`: where the rates at `lo` put it, and the part of the way to the end in the quantity sought.
    fn guess(&self, lo: T, linear: T, fraction: T) -> T;
}

/// Looks for the end of the collision on a piece: that point, or else the last one.
#[inline]
pub(super) fn follow<T: Scalar>(
    contact: &Contact<T>,
    arc: &impl Arc<T>,
    from: &Start<T>,
    rate: T,
    slope: T,
    ledger: &mut Ledger<T>,
) -> Result<Point<T>, Point<T>> {
    let zero = T::zero();
    let end = arc.end();
    let last = arc.last(end);
    let law = ledger.law();
    let (mut lo, mut hi) = (zero, end);
    let (mut begin, mut rate, mut slope) = (from.state, rate, slope);
    let mut top = last.state;
    if let Some(stop) = ledger.stop {
        if last.state.normal < stop {
            return Err(last);
        }
        let missing = stop - begin.normal;
        let guess = arc.guess(zero, missing / rate, missing / (top.normal - begin.normal));
        return Ok(find(
            contact,
            arc,
            &Sought::Impulse(stop),
            T::one(),
            (lo, &begin, rate, slope),
            (hi, Some(&last)),
            guess,
        )
        .1);
    }
    // The point at `hi`, if its rates are known.
    let mut peak = Some(&last);
    if begin.velocity < zero {
        if last.state.velocity < zero {
            return Err(last);
        }
        if law == Law::Newton && ledger.target > last.state.velocity && !ledger.thorough {
            // Newton's law need not know where compression ends.
            ledger.compressed_somewhere();
            return Err(last);
        }
        if law != Law::Newton || ledger.target <= zero || ledger.thorough {
            let guess = arc.guess(
                zero,
                -begin.velocity / (slope * rate),
                begin.velocity / (begin.velocity - top.velocity),
            );
            let found = find(
                contact,
                arc,
                &Sought::Velocity(zero),
                T::one(),
                (lo, &begin, rate, slope),
                (hi, peak),
                guess,
            );
            lo = found.0;
            let point = found.1;
            if ledger.compressed(&point.state) {
                return Ok(point);
            }
            (begin, rate, slope) = (point.state, point.rate, point.slope);
            begin.velocity = zero;
        } else {
            ledger.compressed_somewhere();
        }
    } else if last.state.velocity < zero {
        // v_n falls through zero: the law must end before.
        let guess = arc.guess(
            zero,
            -begin.velocity / (slope * rate),
            begin.velocity / (begin.velocity - top.velocity),
        );
        let found = find(
            contact,
            arc,
            &Sought::Velocity(zero),
            -T::one(),
            (lo, &begin, rate, slope),
            (hi, peak),
            guess,
        );
        hi = found.0;
        top = found.1.state;
        ledger.falls(&top);
        peak = None;
    }
    let target = ledger.target;
    if ledger.watched(&top) < target || (law == Law::Newton && ledger.watched(&begin) >= target) {
        return Err(last);
    }
    let first = ledger.watched(&begin);
    let fraction = (target - first) / (ledger.watched(&top) - first);
    let (_, point) = match law {
        Law::Newton => {
            let guess = arc.guess(lo, lo + (target - first) / (slope * rate), fraction);
            find(
                contact,
                arc,
                &Sought::Velocity(target),
                T::one(),
                (lo, &begin, rate, slope),
                (hi, peak),
                guess,
            )
        }
        Law::Poisson => {
            let guess = arc.guess(lo, lo + (target - first) / rate, fraction);
            find(
                contact,
                arc,
                &Sought::Impulse(target),
                T::one(),
                (lo, &begin, rate, slope),
                (hi, peak),
                guess,
            )
        }
        Law::Stronge => {
            let missing = target - first;
            let square = begin.velocity * begin.velocity + (missing + missing) * slope;
            let after = if square > zero { square.sqrt() } else { zero };
            let guess = arc.guess(lo, lo + (missing + missing) / ((begin.velocity + after) * rate), fraction);
            find(contact, arc, &Sought::Work(target), T::one(), (lo, &begin, rate, slope), (hi, peak), guess)
        }
    };
    Ok(point)
}

/// The point between `from` and `hi` where what is sought vanishes, rising (`sign` = 1) or falling (-1).
///
/// Newton's method, kept inside a bracket; the last, tiny step is made along the equations (34) themselves.
#[inline]
fn find<T: Scalar>(
    contact: &Contact<T>,
    arc: &impl Arc<T>,
    sought: &Sought<T>,
    sign: T,
    from: (T, &State<T>, T, T),
    (hi, top): (T, Option<&Point<T>>),
    guess: T,
) -> (T, Point<T>) {
    let half = constant::<T>(0.5);
    let (from, state, rate, slope) = from;
    let (mut lo, mut hi) = (from, hi);
    let mut x = if guess > lo && guess < hi { guess } else { (lo + hi) * half };
    let (mut x0, mut y0, mut s0) = (from, sought.of(state), sought.slope(state, rate, slope));
    if let (Some(top), false) = (top, arc.winds()) {
        let y = sought.of(&top.state);
        let between = cubic((x0, y0, s0), (hi, y, sought.slope(&top.state, top.rate, top.slope)));
        if between > lo && between < hi {
            x = between;
        }
    }
    // The square of a step this small is rounding.
    let small = constant::<T>(0.0625) * T::default_epsilon().sqrt();
    // A derivative is one step of Newton's behind its value, and interpolation between close points ruins it.
    let behind = T::refined();
    for _ in 0..64 {
        let (y, slope) = arc.value(x, sought);
        if y * sign < T::zero() {
            lo = x;
        } else {
            hi = x;
        }
        let newton = -y / slope;
        if newton.abs() <= small * (x - from) || hi - lo <= T::default_epsilon() * hi {
            if behind {
                x = (x + newton).plain();
            }
            break;
        }
        let better = match arc.step(newton) {
            Some(step) => x + step,
            None => cubic((x0, y0, s0), (x, y, slope)),
        };
        (x0, y0, s0) = (x, y, slope);
        x = if better > lo && better < hi {
            better
        } else if x + newton > lo && x + newton < hi {
            x + newton
        } else {
            (lo + hi) * half
        };
    }
    let point = arc.at(x);
    let y = sought.of(&point.state);
    let step = -y / sought.slope(&point.state, point.rate, point.slope);
    if step.abs() <= constant::<T>(16.0) * small * x {
        (x + step, point.moved(contact, step))
    } else {
        (x, point)
    }
}

/// Inverse cubic interpolation: where it vanishes, from two points, values and derivatives.
#[inline(always)]
fn cubic<T: Scalar>((x0, y0, s0): (T, T, T), (x, y, slope): (T, T, T)) -> T {
    let rise = y - y0;
    let u = -y0 / rise;
    let w = T::one() - u;
    x0 * w * w * (T::one() + u + u) + x * u * u * (T::one() + w + w) + u * w * rise * (w / s0 - u / slope)
}

/// The first theta in (0, limit) where F changes sign, if there is one. `size`: how large the terms are of which f is made.
#[inline]
pub(super) fn turning<T: Scalar>(f: [T; 3], limit: T, size: T) -> Option<T> {
    let [mut c, b, a] = f;
    // The step began where f changes sign, as well as f can be known there: that root is behind. Measured against the
    // whole of f and not against its change over the step, or steep friction would find the same root again and again.
    let tiny = constant::<T>(64.0) * T::default_epsilon();
    if c.abs() <= tiny * size {
        c = T::zero();
    }
    let b = b * limit;
    let a = a * limit * limit;
    if b.abs() + a.abs() < c.abs() {
        return None;
    }
    let mut best = None;
    for r in crate::solve::quadratic(a, b, c) {
        if r > tiny && r < T::one() && best.is_none_or(|x| r < x) {
            best = Some(r);
        }
    }
    best.map(|r| (r * limit).plain())
}
