//! The search for the next event on the sliding arc: the end of compression, what the law waits for, a fold of v_n, or the end of what one
//! quadrature reaches.

use super::{
    flow::{Flow, Place, Rates},
    ledger::Ledger,
    panel::Panel,
    sought::{Aim, Sought, sought},
};
use crate::{Law, scalar::Real, scalar::constant, scalar::larger, scalar::smaller};

/// Trials of one search: two or three are usual.
const TRIALS: u32 = 96;

/// Short steps after them.
const SHORT_STEPS: u32 = 6;

/// A stretch on which v_n is monotone.
pub(super) struct Search<'a, T: Real> {
    pub flow: &'a Flow<T>,
    pub from: Place<T>,
    pub rates: &'a Rates<T>,
    /// Whether v_n rises, and after which length it folds.
    pub course: (bool, Option<T>),
    /// Whether slip is so fast that the balance of energy would lose the work.
    pub fast: bool,
    pub panel: &'a mut Panel<T>,
    /// How far a stretch could reach but for folds.
    pub reach: T,
}

impl<T: Real> Search<'_, T> {
    /// Follows the arc to the next event, or as far as one stretch goes, to the point `to`; true if the law ends the collision there.
    #[inline]
    pub fn follow(&mut self, ledger: &mut Ledger<T>, to: &mut Place<T>) -> bool {
        let zero = T::zero();
        let (rising, fold) = self.course;
        let mut limit = self.reach;
        if let Some(fold) = fold {
            limit = smaller(limit, fold);
        }
        let v = self.from.state.velocity;
        let law = ledger.law();
        self.fast = self.fast || ledger.delicate();
        let target = ledger.target;
        if let Some(stop) = ledger.stop {
            return self.find(&Sought::Impulse(stop), T::one(), limit, to).is_some();
        }
        if !rising {
            return self.falling(limit, ledger, to);
        }
        // Newton's law need not know where compression ends.
        if v >= zero || (law == Law::Newton && target > zero && !ledger.thorough) {
            let ended = self.find(&sought(ledger), T::one(), limit, to).is_some();
            if v < zero && to.state.velocity >= zero {
                ledger.compressed_somewhere();
            }
            return ended;
        }
        if self.find(&Sought::Velocity(zero), T::one(), limit, to).is_none() {
            return false;
        }
        if ledger.compressed(&to.state) {
            return true;
        }
        to.state.velocity = zero;
        to.since = zero;
        false
    }

    /// v_n falls: it may come to zero before the law has what it waits for.
    #[cold]
    #[inline(never)]
    fn falling(&mut self, limit: T, ledger: &mut Ledger<T>, to: &mut Place<T>) -> bool {
        let zero = T::zero();
        self.whole(limit, to);
        if self.from.state.velocity < zero {
            return false;
        }
        let (last, mut limit) = (*to, limit);
        if last.state.velocity < zero
            && let Some(length) = self.find(&Sought::Velocity(zero), -T::one(), limit, to)
        {
            ledger.falls(&to.state);
            limit = length;
        }
        let sought = sought(ledger);
        if ledger.law() == Law::Newton || sought.of(to) < zero {
            *to = last;
            return false;
        }
        // Rounding alone tells this from the fall.
        self.find(&sought, T::one(), limit, to);
        true
    }

    /// Goes to the point at a length, with the work.
    #[inline]
    fn whole(&mut self, length: T, to: &mut Place<T>) {
        self.flow.step(&self.from, length, self.panel, to);
        self.work(to);
    }

    /// Adds the work on the stretch stepped over last.
    #[inline]
    fn work(&mut self, to: &mut Place<T>) {
        let from = &self.from;
        let done = if self.fast {
            self.flow.direct(from, to, self.panel)
        } else {
            self.flow.balance(from, to, self.panel)
        };
        to.state.work = from.state.work + done;
        to.since = from.since + done;
    }

    /// Goes to the point where what is sought vanishes, rising (`sign` = 1) or falling (-1), and returns its length; or else to the end of the stretch.
    ///
    /// Each trial is one quadrature from the beginning to there; a method of third order inside a bracket leads from one to the next. The last
    /// steps are short ones from the trial before.
    #[inline(never)]
    fn find(&mut self, sought: &Sought<T>, sign: T, limit: T, to: &mut Place<T>) -> Option<T> {
        if sought.of(&self.from) * sign >= T::zero() {
            *to = self.from;
            return Some(T::zero());
        }
        let half = constant::<T>(0.5);
        let guess = sought.guess(self.flow, &self.from, self.rates).plain();
        let (mut lo, mut hi) = (T::zero(), limit);
        let mut open = true;
        let mut x = if guess > lo && guess < limit { guess } else { limit };
        let works = matches!(sought, Sought::Work(_));
        for trial in 0..TRIALS {
            self.flow.step(&self.from, x, self.panel, to);
            if works {
                self.work(to);
            }
            let y = sought.of(to);
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
            let rates = self.flow.rates(to);
            let aim = Aim::new(sought, to, &rates);
            let far = aim.step.plain().abs();
            let near = aim.size <= constant(0.25)
                && (far <= constant::<T>(0.035) * larger(self.reach, x)
                    || far <= constant::<T>(0.065) * self.flow.beyond(to))
                && (!works || far * rates.growth.plain().abs() <= constant(0.3));
            if near || hi - lo <= constant::<T>(4.0) * T::default_epsilon() * hi {
                if !works {
                    self.work(to);
                }
                // Not back beyond the beginning.
                if aim.step < -x {
                    *to = self.from;
                    return Some(T::zero());
                }
                return Some(x + self.close_in(sought, rates, aim, to));
            }
            let next = (x + aim.step).plain();
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
    fn close_in(&self, sought: &Sought<T>, rates: Rates<T>, aim: Aim<T>, to: &mut Place<T>) -> T {
        let (mut length, mut rates, mut aim) = (T::zero(), rates, aim);
        // A derivative is one step behind its value.
        let close = constant::<T>(if T::refined() { 1e-4 } else { 32.0 }) * T::default_epsilon();
        let (mut rough, mut error) = aim.errors(sought, to, &rates);
        for _ in 0..SHORT_STEPS {
            if error <= close {
                break;
            }
            let step = aim.step.plain();
            self.flow.short_step(to, step);
            length += step;
            rates = self.flow.rates(to);
            aim = Aim::new(sought, to, &rates);
            (rough, error) = aim.errors(sought, to, &rates);
        }
        if rough <= close {
            to.touch(self.flow, &rates, aim.step);
            return length + aim.step.plain();
        }
        let bends = self.flow.bends(to, &rates);
        let step = aim.refined(sought, to, &rates, &bends);
        to.nudge(self.flow, &rates, &bends, step);
        length + step.plain()
    }
}
