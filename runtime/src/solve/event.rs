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
use crate::scalar::{Arithmetic, Mask, Real, constant, decide, dot, fma, larger, smaller};

/// An event: v_n, I_n or the normal work since compression ended reaches a target.
#[derive(Clone, Copy)]
pub(crate) enum Event<T> {
    Velocity(T),
    Impulse(T),
    Work(T),
}

impl<T: Arithmetic> Event<T> {
    /// The event that ends restitution under the law, once compression has ended.
    #[inline(always)]
    pub fn end(restitution: &Restitution<T>) -> Self
    where
        T: Real,
    {
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
                let first = || {
                    let first = (missing + missing) / (v + square.sqrt());
                    first * (T::one() - bend * first * constant(1.0 / 6.0) / slope)
                };
                return T::choose(square.at_most(zero), || zero, first);
            }
            Self::Velocity(_) => missing,
        };
        let square = dot(slope, slope, v + v, bend);
        T::choose(square.at_most(zero), || zero, || (v + v) / (slope + square.sqrt()))
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
        let ratio = (impulse * g / slip).primal();
        // None is expected, or slip stops long before it.
        let none = impulse.at_most(zero).or(|| ratio.at_most(constant(-1.5)));
        let [length] = decide!(
            T: none,
            [-one],
            {
                let far = (arc.outer + arc.outer).below(point.w);
                let [mean] = decide!(
                    T: far,
                    {
                        // Beyond the zeros of q: the rate of slip tends to that of the stable direction.
                        let last = arc.last_rate();
                        let late = last / arc.q[2] - rate;
                        [last / (one + larger(late, zero) * half)]
                    },
                    {
                        let RateChanges { shape, .. } = arc.rate_changes(point, rates);
                        let pull = fma(rate, pole - rates.shape, rates.change + shape) * lag * per;
                        [fma(pull * half, impulse, g)]
                    }
                );
                let ratio = larger((impulse * mean / slip).primal(), constant(-0.97));
                let small = ratio.abs().at_most(constant(1e-3));
                let [part] = decide!(T: small, [fma(ratio, -half, one)], [rough_ln_1p(ratio) / ratio]);
                let part = part * impulse / slip.primal();
                let (w, first) = (point.w.primal(), lag.primal());
                let length = mean_lag(arc, w, first, first * part) * part;
                decide!(T: far, [length], [mean_lag(arc, w, first, length) * part])
            },
        );
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

impl<T: Arithmetic> Correction<T> {
    #[inline(always)]
    pub fn new(event: &Event<T>, point: &ArcPoint<T>, rates: &Rates<T>) -> Self {
        let (one, half) = (T::one(), constant::<T>(0.5));
        let (slope, bend) = event.slope(&point.state, rates);
        let newton = -event.at(point) / slope;
        let bent = newton * bend;
        let [step] = decide!(T: bent.abs().at_most(half), [newton / fma(bent, half, one)], {
            decide!(
                T: half.below(bent),
                [square(newton, bent)],
                decide!(
                    T: constant::<T>(-0.999).below(bent),
                    [newton * rough_ln_1p(bent) / bent],
                    [newton]
                )
            )
        });
        let bend = bend.primal().abs();
        let rate = larger((rates.weight + rates.shape).primal().abs(), bend);
        let size = step.primal().abs() * larger(rate, half);
        Self { step, slope, curvature: bend, size }
    }

    /// Whether short steps lead from the point to the event; `around` is the length of the stretch or of the trial, the
    /// larger of them.
    #[inline(always)]
    pub fn is_near(
        &self,
        event: &Event<T>,
        arc: &SlidingArc<T>,
        point: &ArcPoint<T>,
        rates: &Rates<T>,
        around: T,
    ) -> T::Mask {
        let far = self.step.primal().abs();
        let short = || far.at_most(constant::<T>(0.035) * around);
        let beyond = || far.at_most(constant::<T>(0.065) * arc.beyond(point));
        let works = || match event {
            Event::Work(_) => (far * rates.growth.primal().abs()).at_most(constant(0.3)),
            _ => T::Mask::all(),
        };
        let near = self.size.at_most(constant(0.25)).and(|| far.at_most(constant(0.125)));
        near.and(|| short().or(beyond)).and(works)
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
fn square<T: Arithmetic>(newton: T, bent: T) -> T {
    let one = T::one();
    let under = larger(one + bent + bent, T::zero());
    (newton + newton) / (one + under.sqrt())
}

/// The mean of q / e at both ends of a stretch of the arc that begins at `w`, with `first` there.
#[inline(always)]
fn mean_lag<T: Arithmetic>(arc: &SlidingArc<T>, w: T, first: T, length: T) -> T {
    let one = T::one();
    let z = smaller(length, constant(4.0)) * constant(0.125);
    let z = (one + z) / (one - z);
    let z = z * z;
    (first + arc.q_over_e(w * z * z)) * constant(0.5)
}

/// ln(1 + x) with a relative error of about one per cent between -0.999 and 1000: enough for a first guess.
#[inline(always)]
fn rough_ln_1p<T: Arithmetic>(x: T) -> T {
    let y = T::one() + x;
    let far = x.below(constant(-0.85)).or(|| constant::<T>(8.0).below(x));
    let [ln] = decide!(T: far, [constant::<T>(4.0) * rough_ln(y.sqrt().sqrt())], [rough_ln(y)]);
    ln
}
