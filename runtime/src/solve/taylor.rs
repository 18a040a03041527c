//! Steps along the sliding arc so short that a few terms of Taylor's series suffice.
//!
//! Theory: docs/theory.md, section 8.5.

use super::sliding_arc::{ArcPoint, RateChanges, Rates, SlidingArc};
use crate::scalar::{Arithmetic, constant, fma};

impl<T: Arithmetic> ArcPoint<T> {
    /// Moves the point by `step` in lambda with an error of third order.
    #[inline(always)]
    pub fn second_order_step(&mut self, arc: &SlidingArc<T>, rates: &Rates<T>, step: T) {
        let (one, half) = (T::one(), constant::<T>(0.5));
        let first = self.sigma * rates.e * rates.inverse * step;
        let halved = step * half;
        let bent = |extra: T| fma(rates.weight + extra, halved, one);
        let second = first * self.w;
        let from = self.state;
        arc.add(
            [first * bent(T::zero()), second * bent(one), second * self.w * bent(one + one)],
            &mut self.state,
        );
        let done = (from.velocity + self.state.velocity) * half * (self.state.normal - from.normal);
        self.state.work += done;
        self.since += done;
        self.sigma *=
            fma(step, fma(halved, fma(rates.growth, rates.growth, rates.change), rates.growth), one);
        self.w *= fma(step, one + halved, one);
    }

    /// Moves the point by `step` in lambda with an error of fourth order.
    #[inline(never)]
    pub fn third_order_step(
        &mut self,
        arc: &SlidingArc<T>,
        rates: &Rates<T>,
        rate_changes: &RateChanges<T>,
        step: T,
    ) {
        self.third_order_step_here(arc, rates, rate_changes, step);
    }

    /// [`Self::third_order_step`] as a part of the caller.
    #[inline(always)]
    pub fn third_order_step_here(
        &mut self,
        arc: &SlidingArc<T>,
        rates: &Rates<T>,
        rate_changes: &RateChanges<T>,
        step: T,
    ) {
        let (one, half, third) = (T::one(), constant::<T>(0.5), constant::<T>(1.0 / 3.0));
        let w = self.w;
        let first = self.sigma * rates.e * rates.inverse * step;
        let bent = |extra: T| {
            let rate = rates.weight + extra;
            fma(step * half, fma(step * third, fma(rate, rate, rate_changes.weight), rate), one)
        };
        let second = first * w;
        let from = self.state;
        arc.add([first * bent(T::zero()), second * bent(one), second * w * bent(one + one)], &mut self.state);
        // The work by the trapezoidal rule and its correction for the curvature of v_n over I_n.
        let pushed = self.state.normal - from.normal;
        let bow = rates.slope * (rates.turn - rates.shape) * step * pushed * constant(1.0 / 6.0);
        let done = (from.velocity + self.state.velocity - bow) * half * pushed;
        self.state.work += done;
        self.since += done;
        let (g, change) = (rates.growth, rates.change);
        let cubed = fma(g, fma(g, g, constant::<T>(3.0) * change), rate_changes.growth);
        let square = fma(step * third, cubed, fma(g, g, change));
        self.sigma *= fma(step, fma(step * half, square, g), one);
        self.w *= fma(step, fma(step * half, fma(step, third, one), one), one);
    }
}
