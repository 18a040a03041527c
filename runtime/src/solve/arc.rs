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

/// A piece on which I_n rises with theta from 0 to `end`, and v_n is monotone.
pub(super) trait Arc<T: Scalar> {
    fn at(&self, theta: T) -> Point<T>;
    fn end(&self) -> T;
    /// The point at the end.
    fn last(&self, end: T) -> Point<T> {
        self.at(end)
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
        return Ok(find(contact, arc, stop, (lo, &begin, rate, slope), hi, guess, |s| s.normal).1);
    }
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
            let found = find(contact, arc, zero, (lo, &begin, rate, slope), hi, guess, |s| s.velocity);
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
        let found = find(contact, arc, zero, (lo, &begin, rate, slope), hi, guess, |s| -s.velocity);
        hi = found.0;
        top = found.1.state;
        ledger.falls(&top);
    }
    let target = ledger.target;
    if ledger.watched(&top) < target || (law == Law::Newton && ledger.watched(&begin) >= target) {
        return Err(last);
    }
    let (first, last) = (ledger.watched(&begin), ledger.watched(&top));
    let fraction = (target - first) / (last - first);
    let (_, point) = match law {
        Law::Newton => {
            let guess = arc.guess(lo, lo + (target - first) / (slope * rate), fraction);
            find(contact, arc, target, (lo, &begin, rate, slope), hi, guess, |s| s.velocity)
        }
        Law::Poisson => {
            let guess = arc.guess(lo, lo + (target - first) / rate, fraction);
            find(contact, arc, target, (lo, &begin, rate, slope), hi, guess, |s| s.normal)
        }
        Law::Stronge => {
            let missing = target - first;
            let square = begin.velocity * begin.velocity + (missing + missing) * slope;
            let after = if square > zero { square.sqrt() } else { zero };
            let guess = arc.guess(lo, lo + (missing + missing) / ((begin.velocity + after) * rate), fraction);
            find(contact, arc, target, (lo, &begin, rate, slope), hi, guess, |s| s.work)
        }
    };
    Ok(point)
}

/// The point between `from` and `hi` where a rising quantity takes the target.
///
/// Inverse cubic interpolation between the last two points, else Newton's method, kept inside a bracket; the last, tiny step is made along
/// the equations (34) themselves.
#[inline]
fn find<T: Scalar>(
    contact: &Contact<T>,
    arc: &impl Arc<T>,
    target: T,
    from: (T, &State<T>, T, T),
    hi: T,
    guess: T,
    quantity: impl Fn(&State<T>) -> T,
) -> (T, Point<T>) {
    let half = constant::<T>(0.5);
    // All quantities are linear in the state, so they turn its derivative into theirs.
    let slope_at = |state: &State<T>, rate: T, slope: T| {
        quantity(&State {
            normal: rate,
            tangential: Vector2::zeros(),
            velocity: rate * slope,
            work: rate * state.velocity,
        })
    };
    let (mut lo, mut hi) = (from.0, hi);
    let (mut x0, mut y0, mut s0) = (from.0, quantity(from.1) - target, slope_at(from.1, from.2, from.3));
    let mut x = if guess > lo && guess < hi { guess } else { (lo + hi) * half };
    let mut point = arc.at(x);
    // The square of a step this small is rounding.
    let small = constant::<T>(0.0625) * T::default_epsilon().sqrt();
    // A derivative is one step of Newton's behind its value, and interpolation between close points ruins it.
    let mut behind = T::refined();
    for _ in 0..64 {
        let y = quantity(&point.state) - target;
        let slope = slope_at(&point.state, point.rate, point.slope);
        if y < T::zero() {
            lo = x;
        } else {
            hi = x;
        }
        let newton = -y / slope;
        if newton.abs() <= small * (x - from.0) {
            if !behind {
                return (x + newton, point.moved(contact, newton));
            }
            behind = false;
            x = (x + newton).plain();
            point = arc.at(x);
            continue;
        }
        if hi - lo <= T::default_epsilon() * hi {
            break;
        }
        let rise = y - y0;
        let u = -y0 / rise;
        let w = T::one() - u;
        let cubic = x0 * w * w * (T::one() + u + u)
            + x * u * u * (T::one() + w + w)
            + u * w * rise * (w / s0 - u / slope);
        (x0, y0, s0) = (x, y, slope);
        x = if cubic > lo && cubic < hi {
            cubic
        } else if x + newton > lo && x + newton < hi {
            x + newton
        } else {
            (lo + hi) * half
        };
        point = arc.at(x);
    }
    (x, point)
}

/// The first theta in (0, limit) where F changes sign, if there is one.
#[inline]
pub(super) fn turning<T: Scalar>(f: [T; 3], limit: T) -> Option<T> {
    let [mut c, b, a] = f;
    let b = b * limit;
    let a = a * limit * limit;
    if b.abs() + a.abs() < c.abs() {
        return None;
    }
    // The step began where f changes sign: that root is behind.
    let tiny = constant::<T>(64.0) * T::default_epsilon();
    if c.abs() <= tiny * (b.abs() + a.abs()) {
        c = T::zero();
    }
    let mut best = None;
    for r in crate::solve::quadratic(a, b, c) {
        if r > tiny && r < T::one() && best.is_none_or(|x| r < x) {
            best = Some(r);
        }
    }
    best.map(|r| (r * limit).plain())
}
