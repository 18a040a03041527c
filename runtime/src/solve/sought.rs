//! What an event is sought in, where to look for it first, and where to look next.

use super::{
    flow::{Bends, Flow, Place, Rates, rough_ln},
    ledger::{Ledger, State},
};
use crate::{Law, scalar::Real, scalar::constant, scalar::larger, scalar::smaller};

/// What an event is sought in: v_n, I_n or the work since compression ended, each less a target.
#[derive(Clone, Copy)]
pub(super) enum Sought<T> {
    Velocity(T),
    Impulse(T),
    Work(T),
}

impl<T: Real> Sought<T> {
    /// The value less the target.
    #[inline(always)]
    pub fn of(&self, place: &Place<T>) -> T {
        match *self {
            Self::Velocity(target) => place.state.velocity - target,
            Self::Impulse(target) => place.state.normal - target,
            Self::Work(target) => place.since - target,
        }
    }

    /// Its derivative by lambda, and that of the derivative's logarithm.
    #[inline(always)]
    fn slope(&self, state: &State<T>, rates: &Rates<T>) -> (T, T) {
        let Rates { impulse, slope, weight, shape, turn, .. } = *rates;
        match self {
            Self::Velocity(_) => (impulse * slope, weight + turn),
            Self::Impulse(_) => (impulse, weight + shape),
            Self::Work(_) => (impulse * state.velocity, weight + shape + impulse * slope / state.velocity),
        }
    }

    /// The normal impulse until the event, if f changes in proportion to it; not positive if that never comes.
    #[inline]
    fn impulse(&self, place: &Place<T>, slope: T, bend: T) -> T {
        let zero = T::zero();
        let missing = -self.of(place);
        let v = match self {
            Self::Impulse(_) => return missing,
            // v_n rises from zero, about, to where the work is done.
            Self::Work(_) => {
                let v = place.state.velocity;
                let square = v * v + (missing + missing) * slope;
                if square <= zero {
                    return zero;
                }
                let after = square.sqrt();
                let first = (missing + missing) / (v + after);
                return first * (T::one() - bend * first * constant(1.0 / 6.0) / slope);
            }
            Self::Velocity(_) => missing,
        };
        let square = slope * slope + (v + v) * bend;
        if square <= zero { zero } else { (v + v) / (slope + square.sqrt()) }
    }

    /// About where the event is: slip changes by the square of I_n at most, and the length is the integral of (q / e) / s over I_n.
    #[inline]
    pub fn guess(&self, flow: &Flow<T>, place: &Place<T>, rates: &Rates<T>) -> T {
        let (zero, one, half) = (T::zero(), T::one(), constant::<T>(0.5));
        let slip = place.sigma * rates.e;
        // q / e, g, and the changes of f and g with I_n.
        let lag = slip / rates.impulse;
        let rate = rates.growth + rates.shape;
        let pole = rate - rates.weight;
        let g = rate * lag;
        let per = one / rates.impulse;
        let bend = rates.slope * (rates.turn - rates.shape) * per;
        let impulse = self.impulse(place, rates.slope, bend).plain();
        if impulse <= zero {
            return -one;
        }
        let ratio = (impulse * g / slip).plain();
        if ratio <= constant(-1.5) {
            // Slip stops long before.
            return -one;
        }
        let far = place.w > flow.outer + flow.outer;
        let mean = if far {
            // Slip has yet to come to the rate of the end.
            let last = flow.last_rate();
            let late = last / flow.q[2] - rate;
            last / (one + larger(late, zero) * half)
        } else {
            let Bends { shape, .. } = flow.bends(place, rates);
            let pull = (rates.change + shape + rate * (pole - rates.shape)) * lag * per;
            g + pull * impulse * half
        };
        let ratio = larger((impulse * mean / slip).plain(), constant(-0.97));
        let part =
            if ratio.abs() <= constant(1e-3) { one - ratio * half } else { rough_ln_1p(ratio) / ratio };
        let part = part * impulse / slip.plain();
        let (w, first) = (place.w.plain(), lag.plain());
        let mut length = first * part;
        for _ in 0..if far { 1 } else { 2 } {
            let z = smaller(length, constant(4.0)) * constant(0.125);
            let z = (one + z) / (one - z);
            let z = z * z;
            length = (first + flow.lag(w * z * z)) * half * part;
        }
        length
    }
}

/// Where the event should be, as seen from a point close by.
pub(super) struct Aim<T> {
    pub step: T,
    /// The step over the length on which the integrands change.
    pub size: T,
    /// Of what is sought, and the size of the derivative of its logarithm.
    slope: T,
    bend: T,
}

impl<T: Real> Aim<T> {
    #[inline]
    pub fn new(sought: &Sought<T>, place: &Place<T>, rates: &Rates<T>) -> Self {
        let (one, half) = (T::one(), constant::<T>(0.5));
        let (slope, bend) = sought.slope(&place.state, rates);
        let newton = -sought.of(place) / slope;
        let bent = newton * bend;
        let step = if bent.abs() <= half {
            newton / (one + bent * half)
        } else if bent > half {
            square(newton, bent)
        } else if bent > constant(-0.999) {
            newton * rough_ln_1p(bent) / bent
        } else {
            newton
        };
        let bend = bend.plain().abs();
        let rate = larger((rates.weight + rates.shape).plain().abs(), bend);
        let size = step.plain().abs() * larger(rate, half);
        Self { step, slope, bend, size }
    }

    /// The errors of steps of third and of fourth order, about.
    #[inline]
    pub fn errors(&self, sought: &Sought<T>, place: &Place<T>, rates: &Rates<T>) -> (T, T) {
        let length = self.step.plain().abs();
        let steepest =
            larger(larger(T::one(), self.bend), larger(rates.growth.abs(), rates.weight.abs()).plain());
        let steep = length * steepest;
        // Halley's step misses by its third power.
        let missed = self.slope.plain().abs() * length;
        let square = steep * steep * constant(1.0 / 24.0);
        let moved = (place.sigma * rates.e).plain() * steep + rates.impulse.plain().abs() * length;
        let rough = (moved + missed) * square * constant(4.0);
        (rough, if let Sought::Work(_) = sought { rough } else { moved * steep * square })
    }

    /// The step with an error of fourth order.
    #[inline]
    pub fn refined(&self, sought: &Sought<T>, place: &Place<T>, rates: &Rates<T>, bends: &Bends<T>) -> T {
        let change = match sought {
            Sought::Velocity(_) => bends.turn,
            Sought::Impulse(_) => bends.shape,
            Sought::Work(_) => return self.step,
        };
        let (slope, bend) = sought.slope(&place.state, rates);
        let newton = -sought.of(place) / slope;
        let mut step = self.step;
        for _ in 0..2 {
            let curve = bend + (bend * bend + bends.weight + change) * step * constant(1.0 / 3.0);
            step = newton / (T::one() + curve * step * constant(0.5));
        }
        step
    }
}

/// What the law waits for after compression.
#[inline]
pub(super) fn sought<T: Real>(ledger: &Ledger<T>) -> Sought<T> {
    match ledger.law() {
        Law::Newton => Sought::Velocity(ledger.target),
        Law::Poisson => Sought::Impulse(ledger.target),
        Law::Stronge => Sought::Work(ledger.wanted),
    }
}

/// The step to the zero of the parabola: Newton's step, and that times the derivative of the derivative's logarithm.
#[inline]
fn square<T: Real>(newton: T, bent: T) -> T {
    let one = T::one();
    let under = larger(one + bent + bent, T::zero());
    (newton + newton) / (one + under.sqrt())
}

/// ln(1 + x), to a per cent or so between -0.999 and 1000, which is what a guess needs.
#[inline]
fn rough_ln_1p<T: Real>(x: T) -> T {
    let y = T::one() + x;
    if x < constant(-0.85) || x > constant(8.0) {
        constant::<T>(4.0) * rough_ln(y.sqrt().sqrt())
    } else {
        rough_ln(y)
    }
}
