//! Refines the time of an event, which the dense output of a step gives to its own accuracy, to rounding: the
//! motion is integrated again up to each trial time.

use crate::SimulationError;
use crate::closed::phase::{Closed, Leaving, Phase};
use crate::events::event_location::Crossing;
use crate::events::watched::Watched;
use crate::integration::stepper::Step;
use crate::state::transition::Transition;

/// Largest number of trials for a time. Secants need three to five; at kinks of an input intervals are
/// bisected.
const TRIALS: usize = 80;
/// Relative deviation of the slip at the end of a step with a settled direction from the requested one.
const NEARLY: f64 = 0.2;
/// Within this part of a step the slope of the last secant gives the time of a zero up to rounding.
const CLOSE: f64 = 1e-12;
/// After this many trials intervals are bisected.
const SECANTS: usize = 8;

impl Transition<'_> {
    /// The part of a step that ends at the event in it.
    pub(crate) fn at_event(
        &self,
        closed: &[Closed],
        whole: &Step,
        watched: Watched,
        crossing: &Crossing,
    ) -> Result<Step, SimulationError> {
        let after = crossing.place * whole.h;
        match watched {
            Watched::Gap(contact) if self.watched_from(contact) == 0.0 => {
                self.at_gap(closed, whole, contact, after)
            }
            _ => Ok(self.at_zero(closed, whole, watched, after)),
        }
    }

    /// A gap closes: Newton's method, since its rate is known.
    fn at_gap(
        &self,
        closed: &[Closed],
        whole: &Step,
        contact: usize,
        mut after: f64,
    ) -> Result<Step, SimulationError> {
        let mut step = whole.clone();
        for _ in 0..8 {
            let Some(part) = self.part_again(closed, whole, after) else { break };
            step = part;
            let (gap, rate) = self.gap_at(&step, contact)?;
            let gap = match self.front.phases[contact] {
                // The gap is so large that its value is known; over a long time its mean rate is less
                // accurate.
                Phase::Open(Leaving::Lifted { .. }) if self.rises(&step, contact)? => gap,
                Phase::Open(Leaving::Lifted { risen, .. }) if risen > 0.0 => {
                    let h = step.h;
                    let mut at = |after: f64| step.at(if h > 0.0 { after / h } else { 1.0 });
                    let value = self.values(closed, &[Watched::Gap(contact)], h, None, &mut at);
                    value.map_err(|failure| self.failure(failure))?[0]
                }
                // The contact has hardly lifted off: its time is that of the interpolation.
                Phase::Open(Leaving::Lifted { .. }) => 0.0,
                _ => gap,
            };
            let change = if rate < 0.0 { -gap / rate } else { 0.0 };
            let next = (after + change).clamp(0.0, whole.h);
            if settled(next, after) || (next - after).abs() > 0.1 * whole.h || step.ends_later(next - after) {
                break;
            }
            after = next;
        }
        Ok(step)
    }

    /// Another function decreases through zero: secants, bracketed by times at which it is positive and
    /// negative once these are known.
    fn at_zero(&self, closed: &[Closed], whole: &Step, watched: Watched, mut after: f64) -> Step {
        let trial = |after: f64| {
            let step = self.part_again(closed, whole, after)?;
            let h = step.h;
            let mut at = |after: f64| step.at(if h > 0.0 { after / h } else { 1.0 });
            let value = self.values(closed, &[watched], h, None, &mut at).ok()?[0];
            Some((step, value))
        };
        // Settled slip is about to end there: its end is found separately.
        let enough = match watched {
            Watched::Slip(place) => {
                closed[place].turning.as_ref().map_or(0.0, |turning| NEARLY * turning.least)
            }
            _ => 0.0,
        };
        if enough > 0.0
            && let Some((step, value)) = trial(after)
            && value.abs() <= enough
        {
            return step;
        }
        let (mut positive, mut negative) = (None, None);
        let mut last = whole.clone();
        // The first secant is short; it may span a kink of an input.
        let mut width = (1e-4 * after.min(whole.h - after).max(1e-3 * whole.h)).min(0.5 * after);
        let mut before = trial(after - width).map(|(_, value)| (after - width, value));
        for count in 0..TRIALS {
            let Some((step, value)) = trial(after) else { break };
            last = step;
            if value >= 0.0 {
                positive = Some(after);
            } else {
                negative = Some(after);
            }
            let slope = before.map_or(0.0, |(time, there)| (value - there) / (after - time));
            before = Some((after, value));
            let secant = after - value / slope;
            let next = match (positive, negative) {
                _ if value == 0.0 => after,
                (Some(low), Some(high))
                    if count < SECANTS && low.min(high) < secant && secant < low.max(high) =>
                {
                    secant
                }
                (Some(low), Some(high)) => 0.5 * (low + high),
                _ if slope < 0.0 => secant,
                // The function is constant here: search on the side where the zero must be.
                _ => {
                    width *= 8.0;
                    if value > 0.0 { after + width } else { after - width }
                }
            };
            let next = next.clamp(0.0, whole.h);
            if value.abs() <= enough
                || settled(next, after)
                || (next - after).abs() > 0.1 * whole.h
                || ((next - after).abs() < CLOSE * whole.h && slope < 0.0 && last.ends_later(next - after))
            {
                break;
            }
            after = next;
        }
        last
    }
}

/// Whether two times since the front agree up to rounding; the accuracy of the state does not depend on the
/// absolute time.
fn settled(next: f64, after: f64) -> bool {
    (next - after).abs() <= 2.0 * f64::EPSILON * after
}
