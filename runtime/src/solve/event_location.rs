//! Locates the next event on the sliding arc: the end of compression or of restitution, a turning point of v_n, or the farthest point that one
//! quadrature reaches.
//!
//! Theory: docs/theory.md, section 8.

use super::{
    event::{Correction, Event},
    gauss16::Panel,
    restitution::Restitution,
    sliding_arc::{ArcPoint, Rates, SlidingArc},
};
use crate::{Law, scalar::Real, scalar::constant, scalar::larger, scalar::smaller};

/// Trials of one search: two or three are usual.
const TRIALS: u32 = 96;

/// Short steps after them.
const SHORT_STEPS: u32 = 6;

/// A stretch on which v_n is monotone.
pub(super) struct EventLocation<'a, T: Real> {
    pub arc: &'a SlidingArc<T>,
    pub from: ArcPoint<T>,
    pub rates: &'a Rates<T>,
    /// Whether v_n rises, and the length in lambda after which it turns, if it does.
    pub rising: bool,
    pub turning_point: Option<T>,
    /// Whether slip is so fast that the balance of energy would lose the work.
    pub fast: bool,
    pub panel: &'a mut Panel<T>,
    /// How far one quadrature reaches.
    pub reach: T,
}

impl<T: Real> EventLocation<'_, T> {
    /// Follows the arc to the next event, or as far as one stretch goes, to the point `to`; true if the law ends the collision there.
    #[inline]
    pub fn follow(&mut self, restitution: &mut Restitution<T>, to: &mut ArcPoint<T>) -> bool {
        let zero = T::zero();
        let mut limit = self.reach;
        if let Some(length) = self.turning_point {
            limit = smaller(limit, length);
        }
        let v = self.from.state.velocity;
        let law = restitution.law();
        self.fast = self.fast || restitution.delicate();
        let target = restitution.target;
        if let Some(stop) = restitution.stop {
            return self.find(&Event::Impulse(stop), T::one(), limit, to).is_some();
        }
        if !self.rising {
            return self.falling(limit, restitution, to);
        }
        // Newton's law need not know where compression ends.
        if v >= zero || (law == Law::Newton && target > zero && !restitution.thorough) {
            let ended = self.find(&Event::end(restitution), T::one(), limit, to).is_some();
            if v < zero && to.state.velocity >= zero {
                restitution.compressed_somewhere();
            }
            return ended;
        }
        if self.find(&Event::Velocity(zero), T::one(), limit, to).is_none() {
            return false;
        }
        if restitution.compressed(&to.state) {
            return true;
        }
        to.state.velocity = zero;
        to.since = zero;
        false
    }

    /// v_n falls: it may come to zero before the law ends restitution.
    #[cold]
    #[inline(never)]
    fn falling(&mut self, limit: T, restitution: &mut Restitution<T>, to: &mut ArcPoint<T>) -> bool {
        let zero = T::zero();
        self.whole(limit, to);
        if self.from.state.velocity < zero {
            return false;
        }
        let (last, mut limit) = (*to, limit);
        if last.state.velocity < zero
            && let Some(length) = self.find(&Event::Velocity(zero), -T::one(), limit, to)
        {
            restitution.falls(&to.state);
            limit = length;
        }
        let end = Event::end(restitution);
        if restitution.law() == Law::Newton || end.at(to) < zero {
            *to = last;
            return false;
        }
        // The law ends restitution here, before v_n falls to zero; rounding alone may say otherwise.
        self.find(&end, T::one(), limit, to);
        true
    }

    /// Goes to the point at a length, with the work.
    #[inline]
    fn whole(&mut self, length: T, to: &mut ArcPoint<T>) {
        self.arc.step(&self.from, length, self.panel, to);
        self.work(to);
    }

    /// Adds the work on the stretch stepped over last.
    #[inline]
    fn work(&mut self, to: &mut ArcPoint<T>) {
        let from = &self.from;
        let done = if self.fast {
            self.arc.direct(from, to, self.panel)
        } else {
            self.arc.balance(from, to, self.panel)
        };
        to.state.work = from.state.work + done;
        to.since = from.since + done;
    }

    /// Goes to the event, where the residual rises (`sign` = 1) or falls (-1) through zero, and returns the length to it; or else to the end of the stretch.
    ///
    /// Each trial is one quadrature from the beginning to there; a method of third order inside a bracket leads from one to the next. The last
    /// steps are short ones from the trial before.
    #[inline(never)]
    fn find(&mut self, event: &Event<T>, sign: T, limit: T, to: &mut ArcPoint<T>) -> Option<T> {
        if event.at(&self.from) * sign >= T::zero() {
            *to = self.from;
            return Some(T::zero());
        }
        let half = constant::<T>(0.5);
        let guess = event.guess(self.arc, &self.from, self.rates).primal();
        let (mut lo, mut hi) = (T::zero(), limit);
        let mut open = true;
        let mut x = if guess > lo && guess < limit { guess } else { limit };
        let works = matches!(event, Event::Work(_));
        for trial in 0..TRIALS {
            self.arc.step(&self.from, x, self.panel, to);
            if works {
                self.work(to);
            }
            let y = event.at(to);
            if y * sign < T::zero() {
                if x >= limit {
                    if !works {
                        self.work(to);
                    }
                    return None;
                }
                lo = x;
            } else {
                hi = x;
                open = false;
            }
            let rates = self.arc.rates(to);
            let correction = Correction::new(event, to, &rates);
            let far = correction.step.primal().abs();
            let near = correction.size <= constant(0.25)
                && (far <= constant::<T>(0.035) * larger(self.reach, x)
                    || far <= constant::<T>(0.065) * self.arc.beyond(to))
                && (!works || far * rates.growth.primal().abs() <= constant(0.3));
            if near || hi - lo <= constant::<T>(4.0) * T::default_epsilon() * hi {
                if !works {
                    self.work(to);
                }
                // Not back beyond the beginning.
                if correction.step < -x {
                    *to = self.from;
                    return Some(T::zero());
                }
                return Some(x + self.polish(event, rates, correction, to));
            }
            let next = (x + correction.step).primal();
            // Where the derivatives mislead, halving the bracket does not.
            let slow = trial % 4 == 3;
            x = if next > lo && next < hi && (open || !slow) {
                next
            } else if open && (next >= hi || slow) {
                limit
            } else {
                (lo + hi) * half
            };
        }
        self.whole(x, to);
        Some(x)
    }

    /// The last short steps, each from the point before; returns their length.
    #[inline]
    fn polish(
        &self,
        event: &Event<T>,
        rates: Rates<T>,
        correction: Correction<T>,
        to: &mut ArcPoint<T>,
    ) -> T {
        let (mut length, mut rates, mut correction) = (T::zero(), rates, correction);
        // A derivative is one step behind its value.
        let close = constant::<T>(if T::refined() { 1e-4 } else { 32.0 }) * T::default_epsilon();
        let (mut rough, mut error) = correction.errors(event, to, &rates);
        for _ in 0..SHORT_STEPS {
            if error <= close {
                break;
            }
            let step = correction.step.primal();
            self.arc.short_step(to, step);
            length += step;
            rates = self.arc.rates(to);
            correction = Correction::new(event, to, &rates);
            (rough, error) = correction.errors(event, to, &rates);
        }
        if rough <= close {
            to.second_order_step(self.arc, &rates, correction.step);
            return length + correction.step.primal();
        }
        let rate_changes = self.arc.rate_changes(to, &rates);
        let step = correction.refined(event, to, &rates, &rate_changes);
        to.third_order_step(self.arc, &rates, &rate_changes, step);
        length + step.primal()
    }
}
