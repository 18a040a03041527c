//! Handles an event within a step: moves the front to the event, and changes the modes.

use nalgebra::{DVector, Vector2};

use crate::closed::forces::{Hold, nearest_to_jam};
use crate::closed::mode_selection::{Decision, choose};
use crate::closed::pair::Friction;
use crate::closed::phase::{Closed, Leaving, Phase, mus};
use crate::events::event_location::Crossing;
use crate::events::watched::Watched;
use crate::integration::motion::{DIRECTION, Evaluation, Failure};
use crate::integration::slip_end::{ENDING, has_passed, may_end, straight, time_of_slip};
use crate::integration::stepper::Step;
use crate::modes::mode_changes::{Ending, FIRST};
use crate::state::transition::Transition;
use crate::{EventKind, SimulationError};

/// The step after an event is at most this many times as long as the part of the step before it.
const AFTER: f64 = 10.0;
/// The greatest number of events without progress in time, each counted once for every closed contact at it; but at least
/// as many events as the second number.
const CROWD: [usize; 2] = [400, 64];
/// This number of events must advance the motion by [`ADVANCE`] of the time of the problem.
const EVENTS: usize = 500;
const ADVANCE: f64 = 1e-7;

impl Transition<'_> {
    /// Moves to an event and handles it.
    pub(crate) fn handle_event(
        &mut self,
        closed: &[Closed],
        whole: Step,
        watched: Watched,
        crossing: Crossing,
    ) -> Result<(), SimulationError> {
        let mut step = self.at_event(closed, &whole, watched, &crossing)?;
        self.front.next_settled = whole.next;
        self.front.next = match watched {
            // The step continues as without the event.
            Watched::Slip(_) => whole.next,
            _ => whole.next.min((AFTER * step.h).max(FIRST * self.front.scales.time)),
        };
        let start = self.front.t;
        self.commit(&mut step)?;
        if self.front.ended.is_some() {
            return Ok(());
        }
        if let Some(parts) = &mut self.parts {
            parts.end(watched.guard(closed));
        }
        self.front.turnings.fill(None);
        self.reached = Some(self.front.clone());
        self.crowded(start)?;
        match watched {
            Watched::Gap(contact) if self.watched_from(contact) > 0.0 => {
                self.gap_is_known(contact)?;
                self.front.phases[contact] = Phase::Open(Leaving::Near);
                Ok(())
            }
            Watched::Entry(contact) => self.enter(contact),
            Watched::End(place) => self.leave(closed[place].contact),
            Watched::Gap(contact) => {
                self.gap_is_known(contact)?;
                let (_, rate) = self.gap_at(&step, contact)?;
                if self.ends(contact) && self.keeps_height(contact)? {
                    return if self.is_held(contact)? { Ok(()) } else { self.stay(contact) };
                }
                if rate >= 0.0 {
                    let leaves = matches!(self.front.phases[contact], Phase::Open(Leaving::Lifted { .. }));
                    // The bodies only touch.
                    self.front.phases[contact] = Phase::Open(Leaving::NOW);
                    // A contact that lifts off and touches again at once does not lift off.
                    return if leaves { self.stay(contact) } else { Ok(()) };
                }
                self.strike(contact)
            }
            Watched::Normal(place) => self.modes_ended(closed[place].contact, Ending::NormalForce),
            Watched::Cone(place) => self.modes_ended(closed[place].contact, Ending::Friction),
            Watched::Slip(place) => self.settled_slip_ends(closed, place),
            Watched::Jam => self.jammed(closed),
            Watched::User(index, _) => {
                self.push(None, EventKind::Zero(index));
                // Slightly past the zero, so that it is not found again.
                let small = 1e-12 * self.front.t.abs().max(5e-3 * self.front.scales.time);
                if let Some(mut past) = self.part(closed, small) {
                    self.commit(&mut past)?;
                }
                Ok(())
            }
        }
    }

    /// A contact that was about to lift off has not: decides its mode together with those of all closed
    /// contacts.
    pub(crate) fn stay(&mut self, contact: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        let closed = |&other: &usize| other == contact || was[other].is_closed();
        let candidates: Vec<usize> = (0..was.len()).filter(closed).collect();
        self.decide(&candidates, &was)
    }

    /// A sliding contact jams: its force grows without bound.
    pub(crate) fn jammed(&mut self, closed: &[Closed]) -> Result<(), SimulationError> {
        let here = self.motion(closed).evaluate(self.front.t, &self.front.y);
        let place = match &here {
            Ok(here) => nearest_to_jam(&here.support, &here.holds, &mus(closed)),
            Err(Failure::Contact(contact, _)) => {
                closed.iter().position(|closed| closed.contact == *contact).unwrap_or(0)
            }
            Err(_) => 0,
        };
        self.jams(closed[place].contact)
    }

    /// The contacts, by index, whose slip is so small that it ends now. All that may end within three times
    /// [`ENDING`] are assumed to have stopped, and the forces decide which of them stick. Slip that small ends if sticking
    /// is possible (docs/theory.md, section 17.11).
    pub(crate) fn stops(&self, closed: &[Closed], here: &Evaluation, speeds: &[f64]) -> Vec<usize> {
        let ending = ENDING * self.front.scales.time;
        let ends = |place: usize| {
            time_of_slip(here, place, &self.front.scale).is_some_and(|left| left < 3.0 * ending)
                || has_passed(here, place, &self.front.scale)
                || may_end(here, place, speeds, &self.front.scale, 3.0 * ending)
        };
        let stopped: Vec<usize> =
            (0..closed.len()).filter(|&place| closed[place].slides.is_some() && ends(place)).collect();
        let mut slips: Vec<Option<Vector2<f64>>> = here.holds.iter().map(Hold::direction).collect();
        for &place in &stopped {
            slips[place] = None;
        }
        let before = here.forces.as_ref().map_or_else(|| DVector::zeros(0), |forces| forces.lambda.clone());
        let sticking = |friction: &[Friction]| match choose(&here.support, &slips, friction, &before) {
            Ok(choice) => {
                let sticks = |place: &usize| choice.decisions[*place] == Decision::Stick;
                stopped.iter().copied().filter(sticks).collect()
            }
            Err(_) => Vec::new(),
        };
        // Slip decreases to zero if sliding friction could hold the contact; static friction holds it only
        // afterwards. So slip has no other direction there.
        let slides = |place: usize| closed[place].slides.is_some();
        let sliding: Vec<Friction> = closed.iter().map(|closed| Friction::same(closed.mu)).collect();
        let found: Vec<usize> = sticking(&sliding);
        if !found.is_empty() {
            return found;
        }
        let mut friction = sliding.clone();
        for (place, friction) in friction.iter_mut().enumerate().filter(|(place, _)| slides(*place)) {
            if stopped.contains(&place) && straight(here, place) {
                let held = self.friction(closed[place].contact, 0.0);
                friction.sticks = held.map_or(friction.sticks, |held| held.sticks);
            }
        }
        if friction == sliding { Vec::new() } else { sticking(&friction) }
    }

    /// Settled slip is about to end, as predicted by its rate at the start of the step. If it neither sticks
    /// nor continues for longer, its direction is integrated from here on, since slip misses zero.
    fn settled_slip_ends(&mut self, closed: &[Closed], place: usize) -> Result<(), SimulationError> {
        let here = self.motion(closed).evaluate(self.front.t, &self.front.y);
        let here = here.map_err(|failure| self.failure(failure))?;
        let ending = ENDING * self.front.scales.time;
        let left = time_of_slip(&here, place, &self.front.scale);
        if left.is_some_and(|left| left >= 2.0 * ending) {
            return Ok(());
        }
        let stopped = self.stops(closed, &here, self.here().speeds);
        if stopped.contains(&place) {
            return self.end_slip(closed, &here, &stopped, left.unwrap_or(0.0).min(ending));
        }
        let turned = self.turns_round(closed, &here, place);
        if !turned.is_empty() {
            return self.end_slip(closed, &here, &turned, left.unwrap_or(0.0).min(ending));
        }
        let least = DIRECTION * here.support.velocity_size(place, self.here().speeds);
        self.front.barred[closed[place].contact] = here.support.slip(place).norm().max(least);
        Ok(())
    }

    /// The contacts, by index, whose slip ends together with that of this one and begins again in another
    /// direction: those that may end at the same time. Slip that decreases along a settled direction, and slip
    /// in a plane of motion, reaches zero; its continuation does not depend on how it got there.
    pub(crate) fn turns_round(&self, closed: &[Closed], here: &Evaluation, place: usize) -> Vec<usize> {
        let within = 3.0 * ENDING * self.front.scales.time;
        let ends = |&other: &usize| {
            other == place
                || has_passed(here, other, &self.front.scale)
                || (closed[other].turning.is_some()
                    && time_of_slip(here, other, &self.front.scale).is_some_and(|left| left < within))
        };
        let ended: Vec<usize> = (0..closed.len()).filter(ends).collect();
        let mut slips: Vec<Option<Vector2<f64>>> = here.holds.iter().map(Hold::direction).collect();
        for &other in &ended {
            slips[other] = None;
        }
        let before = here.forces.as_ref().map_or_else(|| DVector::zeros(0), |forces| forces.lambda.clone());
        let friction: Vec<Friction> = closed.iter().map(|closed| Friction::same(closed.mu)).collect();
        let Ok(choice) = choose(&here.support, &slips, &friction, &before) else { return Vec::new() };
        let anew =
            |other: &usize| matches!(choice.decisions[*other], Decision::Stick | Decision::Slide(_, true));
        if ended.iter().all(anew) { ended } else { Vec::new() }
    }

    /// Slip of contacts ends after a short time.
    pub(crate) fn end_slip(
        &mut self,
        closed: &[Closed],
        here: &Evaluation,
        places: &[usize],
        time: f64,
    ) -> Result<(), SimulationError> {
        let start = self.front.t;
        let before = self.front.y.clone();
        let mut end = before.clone();
        end.iter_mut().zip(&here.rates).for_each(|(value, rate)| *value += time * rate);
        let mut step = Step::still(self.front.t, time, &end);
        let stopped: Vec<usize> = places.iter().map(|&place| closed[place].contact).collect();
        for &contact in &stopped {
            self.front.phases[contact] = Phase::Stick;
        }
        self.commit(&mut step)?;
        if let Some(parts) = &mut self.parts {
            parts.end_of_slip(&before, closed, &stopped);
        }
        self.crowded(start)?;
        self.slip_ended(&stopped)
    }

    /// Events closer to each other than this, s, are at one time.
    pub(crate) fn instant(&self) -> f64 {
        1e-12 * self.front.t.abs().max(5.0 * self.front.scales.time)
    }

    /// Counts events that follow each other without progress.
    pub(crate) fn crowded(&mut self, before: f64) -> Result<(), SimulationError> {
        if self.front.t - before > self.instant() {
            (self.front.crowd, self.front.crowded_contacts) = (0, 0);
        }
        self.front.crowd += 1;
        let closed = self.front.phases.iter().filter(|phase| phase.is_closed()).count();
        self.front.crowded_contacts += closed.max(1);
        if self.front.crowd > CROWD[1] && self.front.crowded_contacts > CROWD[0] {
            return Err(self.error(None, self.without_end(self.front.crowd)));
        }
        let (count, since) = self.front.events;
        self.front.events = (count + 1, since);
        if count >= EVENTS {
            if self.front.t - since < ADVANCE * self.front.scales.time {
                return Err(self.error(None, self.without_end(EVENTS)));
            }
            self.front.events = (0, self.front.t);
        }
        Ok(())
    }
}
