//! Follows one stretch of the sliding arc: to the next event (the end of compression or of restitution), to a
//! turning point of v_n, or as far as one quadrature reaches, whichever comes first. Events are located by
//! trials of `gauss16` inside a bracket.
//!
//! Theory: docs/theory.md, section 8.

use super::{
    event::{Correction, Event},
    gauss16::Panel,
    restitution::Restitution,
    sliding_arc::{ArcPoint, Rates, SlidingArc},
    target::Watched,
};
use crate::{scalar::Real, scalar::constant, scalar::larger, scalar::smaller};

/// The greatest number of trials for one event; two or three are usual.
pub(super) const TRIALS: u32 = 96;

/// The greatest number of short steps after the trials.
pub(super) const SHORT_STEPS: u32 = 6;

/// A stretch of the arc on which v_n is monotone, and what locating events on it needs.
pub(super) struct EventLocation<'a, T: Real> {
    pub arc: &'a SlidingArc<T>,
    pub from: ArcPoint<T>,
    pub rates: &'a Rates<T>,
    /// Whether v_n rises, and the length in lambda to its turning point, if there is one ahead.
    pub rising: bool,
    pub turning_point: Option<T>,
    /// Whether slip is so fast that the work from the balance of energy would lose digits; it is then
    /// integrated directly.
    pub fast: bool,
    pub panel: &'a mut Panel<T>,
    /// The greatest length in lambda of one quadrature.
    pub reach: T,
}

/// The lengths between which an event lies, and that of the next trial.
#[derive(Clone, Copy)]
pub(super) struct Bracket<T> {
    pub x: T,
    lo: T,
    hi: T,
    limit: T,
    /// Whether no trial was beyond the event.
    open: bool,
}

impl<T: Real> Bracket<T> {
    /// Before the first trial on a stretch of the length `limit`.
    #[inline(always)]
    pub fn new(guess: T, limit: T) -> Self {
        let x = if guess > T::zero() && guess < limit { guess } else { limit };
        Self { x, lo: T::zero(), hi: limit, limit, open: true }
    }

    /// Takes note whether the event comes after the trial. True if it does not come on the stretch.
    #[inline(always)]
    pub fn passes(&mut self, after: bool) -> bool {
        if after {
            if self.x >= self.limit {
                return true;
            }
            self.lo = self.x;
        } else {
            self.hi = self.x;
            self.open = false;
        }
        false
    }

    /// Whether rounding leaves nothing between the ends.
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        self.hi - self.lo <= constant::<T>(4.0) * T::default_epsilon() * self.hi
    }

    /// Chooses the next trial, after that of this number; `next` is where the event is expected.
    #[inline(always)]
    pub fn move_on(&mut self, next: T, trial: u32) {
        let Self { lo, hi, limit, open, .. } = *self;
        // Where the second trial still lies before the event, the end of the stretch decides whether
        // there is one. Every fourth trial halves the bracket, in case the steps converge
        // slowly.
        let slow = if open { trial == 1 } else { trial % 4 == 3 };
        self.x = if next > lo && next < hi && !slow {
            next
        } else if open && (next >= hi || slow) {
            limit
        } else {
            (lo + hi) * constant(0.5)
        };
    }
}

impl<T: Real> EventLocation<'_, T> {
    /// Follows the arc to the next event or to the end of the stretch, and sets `to` to that point; true if
    /// the law ends the collision there. Once the panel is over its budget, neither means anything.
    #[inline(always)]
    pub fn follow(&mut self, restitution: &mut Restitution<T>, to: &mut ArcPoint<T>) -> bool {
        let zero = T::zero();
        let mut limit = self.reach;
        if let Some(length) = self.turning_point {
            limit = smaller(limit, length);
        }
        let v = self.from.state.velocity;
        self.fast = self.fast || restitution.delicate();
        let target = restitution.target;
        if let Some(stop) = restitution.stop() {
            return self.find(&Event::Impulse(stop), T::one(), limit, to).is_some();
        }
        if !self.rising {
            return self.falling(limit, restitution, to);
        }
        if T::INLINED {
            return self.rising(limit, restitution, to);
        }
        // A target that is known before does not depend on where compression ends.
        if v >= zero || (restitution.skips_compression() && !restitution.thorough()) {
            let ended = self.find(&Event::end(restitution), T::one(), limit, to).is_some();
            if v < zero && (ended || to.state.velocity >= zero) {
                restitution.compressed_somewhere();
            }
            if ended && restitution.watches(Watched::Velocity) {
                // The law states v_n itself: rounding of the place may exceed a small target.
                to.state.velocity = target;
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

    /// [`Self::follow`] where v_n rises, with one search for whichever event it is: the search becomes a part
    /// of the caller.
    #[inline(always)]
    fn rising(&mut self, limit: T, restitution: &mut Restitution<T>, to: &mut ArcPoint<T>) -> bool {
        let zero = T::zero();
        let v = self.from.state.velocity;
        let ends = v >= zero || restitution.skips_compression();
        let event = if ends { Event::end(restitution) } else { Event::Velocity(zero) };
        let found = self.find_here::<true>(&event, T::one(), limit, to).is_some();
        if ends {
            if v < zero && (found || to.state.velocity >= zero) {
                restitution.compressed_somewhere();
            }
            if found && restitution.watches(Watched::Velocity) {
                // As in `follow`.
                to.state.velocity = restitution.target;
            }
            return found;
        }
        if !found {
            return false;
        }
        if restitution.compressed(&to.state) {
            return true;
        }
        to.state.velocity = zero;
        to.since = zero;
        false
    }

    /// [`Self::follow`] where v_n falls: v_n may reach zero before the law ends restitution.
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
        if restitution.watches(Watched::Velocity) || end.at(to) < zero {
            *to = last;
            return false;
        }
        // The residual at the end is not negative, so the event lies on the stretch; if `find` misses it, it
        // is at the end up to rounding.
        self.find(&end, T::one(), limit, to);
        true
    }

    /// Sets `to` to the point at this length, with the work.
    #[inline]
    fn whole(&mut self, length: T, to: &mut ArcPoint<T>) {
        if !self.panel.spend() {
            return;
        }
        self.arc.step::<false>(&self.from, length, self.fast, self.panel, to);
    }

    /// [`Self::whole`] as a function of its own.
    #[cold]
    #[inline(never)]
    fn whole_apart(&mut self, length: T, to: &mut ArcPoint<T>) {
        self.whole(length, to);
    }

    /// Sets `to` to the event, where the residual rises (`sign` = 1) or falls (-1) through zero, and returns
    /// its length from the beginning; without an event before `limit`, sets `to` to the end of the
    /// stretch and returns `None`.
    ///
    /// Each trial is one quadrature from the beginning of the stretch; the next trial follows by a method of
    /// third order inside a bracket. The last steps are short and start from the last trial.
    #[inline(never)]
    fn find(&mut self, event: &Event<T>, sign: T, limit: T, to: &mut ArcPoint<T>) -> Option<T> {
        self.find_here::<false>(event, sign, limit, to)
    }

    /// [`Self::find`] as a part of the caller, and with `HERE` all that it calls likewise.
    #[inline(always)]
    fn find_here<const HERE: bool>(
        &mut self,
        event: &Event<T>,
        sign: T,
        limit: T,
        to: &mut ArcPoint<T>,
    ) -> Option<T> {
        if event.at(&self.from) * sign >= T::zero() {
            *to = self.from;
            return Some(T::zero());
        }
        let mut bracket = Bracket::new(event.guess(self.arc, &self.from, self.rates).primal(), limit);
        for trial in 0..TRIALS {
            if !self.panel.spend() {
                return None;
            }
            let x = bracket.x;
            self.arc.step::<HERE>(&self.from, x, self.fast, self.panel, to);
            if bracket.passes(event.at(to) * sign < T::zero()) {
                return None;
            }
            let rates = self.arc.rates(to);
            let correction = Correction::new(event, to, &rates);
            let near = correction.is_near(event, self.arc, to, &rates, larger(self.reach, x));
            if near || bracket.is_narrow() {
                // The event does not lie before the beginning.
                if correction.step < -x {
                    *to = self.from;
                    return Some(T::zero());
                }
                return Some(x + self.polish::<HERE>(event, rates, correction, to));
            }
            bracket.move_on((x + correction.step).primal(), trial);
        }
        let x = bracket.x;
        if HERE {
            self.whole_apart(x, to)
        } else {
            self.whole(x, to)
        }
        Some(x)
    }

    /// Takes the last short steps, each from where the one before ended, and returns the sum of their
    /// lengths.
    #[inline(always)]
    fn polish<const HERE: bool>(
        &self,
        event: &Event<T>,
        rates: Rates<T>,
        correction: Correction<T>,
        to: &mut ArcPoint<T>,
    ) -> T {
        let (mut length, mut rates, mut correction) = (T::zero(), rates, correction);
        // Derivatives converge one step later than values (theory, 13.1).
        let close = constant::<T>(if T::refined() { 1e-4 } else { 32.0 }) * T::default_epsilon();
        let (mut rough, mut error) = correction.errors(event, to, &rates);
        for _ in 0..SHORT_STEPS {
            if error <= close {
                break;
            }
            let step = correction.step.primal();
            if HERE {
                self.arc.short_step_here::<HERE>(to, &rates, step);
            } else {
                self.arc.short_step(to, &rates, step);
            }
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
        if HERE {
            to.third_order_step_here(self.arc, &rates, &rate_changes, step);
        } else {
            to.third_order_step(self.arc, &rates, &rate_changes, step);
        }
        length + step.primal()
    }
}
