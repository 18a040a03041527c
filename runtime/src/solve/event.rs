//! Events of a sliding arc. An event is the point where v_n, I_n or the normal work reaches a target value.
//! This file predicts its place (`guess`) and computes the next step of the iteration towards it
//! (`Correction`); `event_location` iterates.
//!
//! Theory: docs/theory.md, section 8.

use super::{
    restitution::{Restitution, State},
    sliding_arc::{ArcPoint, RateChanges, Rates, SlidingArc, rough_ln},
    target::Watched,
};
use crate::scalar::{Real, constant, dot, fma, larger, smaller};

/// An event: v_n, I_n or the normal work since compression ended reaches a target.
#[derive(Clone, Copy)]
pub(crate) enum Event<T> {
    Velocity(T),
    Impulse(T),
    Work(T),
}

impl<T: Real> Event<T> {
    /// The event that ends restitution under the law, once compression has ended.
    #[inline(always)]
    pub fn end(restitution: &Restitution<T>) -> Self {
        match restitution.law().watched() {
            Watched::Velocity => Self::Velocity(restitution.target),
            Watched::Impulse => Self::Impulse(restitution.target),
            Watched::Work => Self::Work(restitution.wanted),
        }
    }

    /// The quantity less its target, where `since` is the normal work since compression ended.
    #[inline(always)]
    pub fn residual(&self, state: &State<T>, since: T) -> T {
        match *self {
            Self::Velocity(target) => state.velocity - target,
            Self::Impulse(target) => state.normal - target,
            Self::Work(target) => since - target,
        }
    }

    /// The derivative of the quantity with respect to I_n, where f = dv_n/dI_n.
    #[inline(always)]
    pub fn by_impulse(&self, velocity: T, f: T) -> T {
        match self {
            Self::Velocity(_) => f,
            Self::Impulse(_) => T::one(),
            Self::Work(_) => velocity,
        }
    }

    /// The residual at a point of the sliding arc.
    #[inline(always)]
    pub(super) fn at(&self, point: &ArcPoint<T>) -> T {
        self.residual(&point.state, point.since)
    }

    /// The derivative y' of the residual y with respect to lambda, and (ln y')' (theory, table in 8.4).
    #[inline(always)]
    fn slope(&self, state: &State<T>, rates: &Rates<T>) -> (T, T) {
        let Rates { impulse, slope, weight, shape, turn, .. } = *rates;
        let curvature = match self {
            Self::Velocity(_) => weight + turn,
            Self::Impulse(_) => weight + shape,
            Self::Work(_) => weight + shape + impulse * slope / state.velocity,
        };
        (impulse * self.by_impulse(state.velocity, slope), curvature)
    }

    /// The normal impulse from here to the event if f is linear in I_n with the rate `bend`; zero or less if
    /// the event does not come then.
    #[inline(always)]
    fn impulse(&self, point: &ArcPoint<T>, slope: T, bend: T) -> T {
        let zero = T::zero();
        let missing = -self.at(point);
        let v = match self {
            Self::Impulse(_) => return missing,
            // With constant f the work is quadratic in I_n; the change of f adds a cubic term, taken for v_n
            // = 0 at the beginning.
            Self::Work(_) => {
                let v = point.state.velocity;
                let square = dot(v, v, missing + missing, slope);
                if square <= zero {
                    return zero;
                }
                let after = square.sqrt();
                let first = (missing + missing) / (v + after);
                return first * (T::one() - bend * first * constant(1.0 / 6.0) / slope);
            }
            Self::Velocity(_) => missing,
        };
        let square = dot(slope, slope, v + v, bend);
        if square <= zero { zero } else { (v + v) / (slope + square.sqrt()) }
    }

    /// A first guess of the length in lambda from here to the event (theory, 8.3); negative if none is
    /// expected. Slip is taken for a quadratic in I_n, and the length is the integral of (q / e) / s over
    /// I_n.
    #[inline(always)]
    pub(super) fn guess(&self, arc: &SlidingArc<T>, point: &ArcPoint<T>, rates: &Rates<T>) -> T {
        let (zero, one, half) = (T::zero(), T::one(), constant::<T>(0.5));
        let slip = point.sigma * rates.e;
        // q / e, g, and the derivative of f with respect to I_n.
        let lag = slip / rates.impulse;
        let rate = rates.growth + rates.shape;
        let pole = rate - rates.weight;
        let g = rate * lag;
        let per = one / rates.impulse;
        let bend = rates.slope * (rates.turn - rates.shape) * per;
        let impulse = self.impulse(point, rates.slope, bend).primal();
        if impulse <= zero {
            return -one;
        }
        let ratio = (impulse * g / slip).primal();
        if ratio <= constant(-1.5) {
            // Slip stops long before the event.
            return -one;
        }
        let far = point.w > arc.outer + arc.outer;
        let mean = if far {
            // Beyond the zeros of q: the rate of slip tends to that of the stable direction.
            let last = arc.last_rate();
            let late = last / arc.q[2] - rate;
            last / (one + larger(late, zero) * half)
        } else {
            let RateChanges { shape, .. } = arc.rate_changes(point, rates);
            let pull = fma(rate, pole - rates.shape, rates.change + shape) * lag * per;
            fma(pull * half, impulse, g)
        };
        let ratio = larger((impulse * mean / slip).primal(), constant(-0.97));
        let part =
            if ratio.abs() <= constant(1e-3) { fma(ratio, -half, one) } else { rough_ln_1p(ratio) / ratio };
        let part = part * impulse / slip.primal();
        let (w, first) = (point.w.primal(), lag.primal());
        let mut length = first * part;
        for _ in 0..if far { 1 } else { 2 } {
            let z = smaller(length, constant(4.0)) * constant(0.125);
            let z = (one + z) / (one - z);
            let z = z * z;
            length = (first + arc.q_over_e(w * z * z)) * half * part;
        }
        length
    }
}

/// The step of third order from a point to the event (theory, 8.2), and what the estimates of its error need.
pub(super) struct Correction<T> {
    pub step: T,
    /// The step divided by the length in lambda over which the integrands change.
    pub size: T,
    /// The size of (ln y')' is `curvature`, y' itself is `slope` (primes: derivatives with respect to
    /// lambda).
    slope: T,
    curvature: T,
}

impl<T: Real> Correction<T> {
    #[inline(always)]
    pub fn new(event: &Event<T>, point: &ArcPoint<T>, rates: &Rates<T>) -> Self {
        let (one, half) = (T::one(), constant::<T>(0.5));
        let (slope, bend) = event.slope(&point.state, rates);
        let newton = -event.at(point) / slope;
        let bent = newton * bend;
        let step = if bent.abs() <= half {
            newton / fma(bent, half, one)
        } else if bent > half {
            square(newton, bent)
        } else if bent > constant(-0.999) {
            newton * rough_ln_1p(bent) / bent
        } else {
            newton
        };
        let bend = bend.primal().abs();
        let rate = larger((rates.weight + rates.shape).primal().abs(), bend);
        let size = step.primal().abs() * larger(rate, half);
        Self { step, slope, curvature: bend, size }
    }

    /// Estimates of the errors of `second_order_step` (of third order in the length) and of
    /// `third_order_step` (of fourth order).
    #[inline(always)]
    pub fn errors(&self, event: &Event<T>, point: &ArcPoint<T>, rates: &Rates<T>) -> (T, T) {
        let length = self.step.primal().abs();
        let steepest =
            larger(larger(T::one(), self.curvature), larger(rates.growth.abs(), rates.weight.abs()).primal());
        let steep = length * steepest;
        // The error of Halley's step is of third order in the step.
        let missed = self.slope.primal().abs() * length;
        let square = steep * steep * constant(1.0 / 24.0);
        let moved = dot((point.sigma * rates.e).primal(), steep, rates.impulse.primal().abs(), length);
        let rough = (moved + missed) * square * constant(4.0);
        (rough, if let Event::Work(_) = event { rough } else { moved * steep * square })
    }

    /// The step to the event with an error of fourth order (theory, end of 8.5).
    #[inline(always)]
    pub fn refined(
        &self,
        event: &Event<T>,
        point: &ArcPoint<T>,
        rates: &Rates<T>,
        rate_changes: &RateChanges<T>,
    ) -> T {
        let change = match event {
            Event::Velocity(_) => rate_changes.turn,
            Event::Impulse(_) => rate_changes.shape,
            Event::Work(_) => return self.step,
        };
        let (slope, bend) = event.slope(&point.state, rates);
        let newton = -event.at(point) / slope;
        let mut step = self.step;
        for _ in 0..2 {
            let curve = fma(fma(bend, bend, rate_changes.weight + change), step * constant(1.0 / 3.0), bend);
            step = newton / fma(curve, step * constant(0.5), T::one());
        }
        step
    }
}

/// The step to the zero of the parabola with the same value, slope and curvature: `newton` is Newton's step
/// x, `bent` is x (ln y')'.
#[inline(always)]
fn square<T: Real>(newton: T, bent: T) -> T {
    let one = T::one();
    let under = larger(one + bent + bent, T::zero());
    (newton + newton) / (one + under.sqrt())
}

/// ln(1 + x) with a relative error of about one per cent between -0.999 and 1000: enough for a first guess.
#[inline(always)]
fn rough_ln_1p<T: Real>(x: T) -> T {
    let y = T::one() + x;
    if x < constant(-0.85) || x > constant(8.0) {
        constant::<T>(4.0) * rough_ln(y.sqrt().sqrt())
    } else {
        rough_ln(y)
    }
}
