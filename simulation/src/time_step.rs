//! Makes one step of the motion: integrates, finds the first event in the step and handles it.

use std::cell::{Cell, RefCell};

use hodograph::{ComponentKind, ContactError, State};
use nalgebra::Vector2;

use crate::event_functions::Watched;
use crate::event_location::{Crossing, Functions, first_crossing};
use crate::forces::Hold;
use crate::motion::{DIRECTION, Evaluation, Failure};
use crate::phase::{Closed, Phase, mus};
use crate::settled_slip::settled;
use crate::slip_end::{ENDING, Fate, fate, may_end, time_of_slip};
use crate::stepper::{self, Step, Tolerances};
use crate::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// A share of the time to the end of slip that a step may take.
const SHARE: f64 = 0.5;

/// So many steps without an event must advance the motion by this part of the longest step so far, or of half the time of
/// the problem.
const STEPS: usize = 3000;
const LONG: f64 = 0.5;
const ADVANCE: f64 = 1e-2;
/// Fewer steps that advance it by next to nothing are enough; steps with so many contacts take twice as long.
const STUCK: usize = 1200;
const CONTACTS: usize = 4;
const NOTHING: f64 = 2e-8;

/// Evaluations of the functions of a step after which it is not halved any more.
const LOOKS: usize = 30_000;

impl Transition<'_> {
    /// Makes one step.
    pub(crate) fn step(&mut self) -> Result<(), SimulationError> {
        self.front.omegas.fill(None);
        let mut closed = self.closed();
        let here = self
            .motion(&closed)
            .evaluate(self.front.t, &self.front.y)
            .map_err(|failure| self.failure(failure))?;
        self.weigh_lifted(&here)?;
        for (contact, hold) in closed.iter().zip(&here.holds) {
            // Should slip become too small to have a direction, it has the last one.
            if let Hold::Slide(direction) = hold {
                self.front.phases[contact.contact] = Phase::Slide(*direction);
            }
        }
        let mut most = self.front.next.min(self.options.max_step);
        if let Some(limit) = self.limit() {
            most = most.min(limit - self.front.t);
        }
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let speeds = &self.front.y[n..n + self.mechanism.count(ComponentKind::Speed)];
        let ending = ENDING * self.front.scales.time;
        for (i, contact) in closed.iter().enumerate() {
            if !contact.rubs() {
                continue;
            }
            let left = time_of_slip(&here, i, &self.front.scale);
            if left.is_some_and(|left| left < ending) || may_end(&here, i, speeds, &self.front.scale, ending)
            {
                if closed.len() > 1 {
                    let stopped = self.stops(&closed, &here, speeds);
                    if !stopped.is_empty() {
                        return self.end_slip(&closed, &here, &stopped, left.unwrap_or(0.0).min(ending));
                    }
                } else if let Fate::Ends(time) = fate(&here.support, &here.holds, &mus(&closed), i) {
                    return self.end_slip(&closed, &here, &[i], time);
                }
            }
            if let Some(left) = left {
                most = most.min(SHARE * left.max(ending));
            }
        }
        let omegas = settled(&self.motion(&closed), self.front.t, &self.front.y, &here, &self.front.scales);
        for (contact, omega) in closed.iter_mut().zip(omegas) {
            contact.omega = omega;
            self.front.omegas[contact.contact] = omega;
        }
        let Some((mut step, crossing)) = self.attempt(&closed, &here, most)? else { return Ok(()) };
        if let Some(contact) = self.singular(&closed, &step) {
            return self.end_with(contact, &step);
        }
        match crossing {
            None => {
                self.front.next = step.next;
                self.commit(&mut step)?;
                self.progress(step.h)?;
                self.on_time()
            }
            Some((watched, crossing)) => {
                self.front.steps = (0, self.front.t, self.front.steps.2);
                self.handle_event(&closed, step, watched, crossing)
            }
        }
    }

    /// Counts steps without an event, and refuses to go on where they hardly advance the motion.
    fn progress(&mut self, h: f64) -> Result<(), SimulationError> {
        let (steps, since, longest) = self.front.steps;
        let longest = longest.max(h.min(LONG * self.front.scales.time));
        let steps = steps + 1;
        self.front.steps = (steps, since, longest);
        let closed = self.front.phases.iter().filter(|phase| phase.is_closed()).count();
        let time = self.front.t - since;
        let stuck = steps % (STUCK * CONTACTS / (CONTACTS + closed)).max(1) == 0
            && time < NOTHING * steps as f64 * longest;
        if stuck || steps % STEPS == 0 {
            if stuck || time < ADVANCE * longest {
                if let Some(contact) = self.singular_here(&self.closed()) {
                    return self.end_at(contact);
                }
                let modes = self.modes_in_words();
                return Err(self.error(None, ErrorKind::NoProgress { steps, time, modes }));
            }
            self.front.steps = (0, self.front.t, longest);
        }
        Ok(())
    }

    /// A step that was integrated, and the first event in it.
    #[allow(clippy::type_complexity)]
    fn attempt(
        &mut self,
        closed: &[Closed],
        here: &Evaluation,
        mut most: f64,
    ) -> Result<Option<(Step, Option<(Watched, Crossing)>)>, SimulationError> {
        let tolerances = Tolerances {
            relative: self.options.relative_tolerance,
            absolute: self.options.absolute_tolerance,
        };
        let looks = Cell::new(0);
        for _ in 0..80 {
            if looks.get() > LOOKS {
                let modes = self.modes_in_words();
                return Err(self.error(None, ErrorKind::NoProgress { steps: 1, time: most, modes }));
            }
            let failed = RefCell::new(None);
            let made = {
                let motion = self.motion(closed);
                let mut room = motion.room();
                let mut rates = |t: f64, y: &[f64], rates: &mut [f64]| {
                    if let Err(failure) = motion.rates(t, y, rates, &mut room) {
                        failed.borrow_mut().get_or_insert(failure);
                        rates.fill(f64::NAN);
                    }
                };
                // Directions that follow from the state change the rates.
                let first = closed.iter().all(|contact| contact.omega.is_none()).then_some(&here.rates[..]);
                stepper::step(&mut rates, (self.front.t, &self.front.y, first), most, &tolerances)
            };
            let Some(step) = made else {
                return self.stuck_integration(failed.into_inner()).map(|()| None);
            };
            if !self.keeps_direction(closed, here, &step)? {
                most = 0.5 * step.h;
                continue;
            }
            let (watched, noise) = self.watched(closed, step.h);
            let Some(turns) = self.turns(closed, &step) else {
                most = 0.5 * step.h;
                continue;
            };
            let h = step.h;
            let found = first_crossing(
                &mut Functions {
                    count: watched.len(),
                    noise: &noise,
                    values: &mut |fraction| {
                        looks.set(looks.get() + 1);
                        let at = &mut |after: f64| step.at(after / h);
                        self.values(closed, &watched, h * fraction, Some(here), at).ok()
                    },
                    slopes: &mut |fraction| {
                        let y = step.at(fraction);
                        self.slopes(&watched, h * fraction, &y)
                            .into_iter()
                            .map(|slope| slope.map(|slope| slope * h))
                            .collect()
                    },
                },
                turns,
            );
            let Ok(found) = found else {
                most = 0.5 * step.h;
                continue;
            };
            let found = found.map(|crossing| (watched[crossing.function], crossing));
            return Ok(Some((step, found)));
        }
        Err(self.error(None, ErrorKind::Stalled))
    }

    /// Handles an integration that cannot continue.
    fn stuck_integration(&mut self, failed: Option<Failure>) -> Result<(), SimulationError> {
        match failed {
            Some(Failure::Contact(
                contact,
                ContactError::Jam { .. } | ContactError::ImpactWithoutCollision { .. },
            )) => self.impact_without_collision(contact),
            Some(failure) => Err(self.failure(failure)),
            None => match self.singular_here(&self.closed()) {
                Some(contact) => self.end_at(contact),
                None => Err(self.error(None, ErrorKind::Stalled)),
            },
        }
    }

    /// Whether sliding contacts keep the half plane of their slip.
    fn keeps_direction(
        &self,
        closed: &[Closed],
        here: &Evaluation,
        step: &Step,
    ) -> Result<bool, SimulationError> {
        if !closed.iter().any(Closed::rubs) {
            return Ok(true);
        }
        let motion = self.motion(closed);
        let (q, u) = motion.split(&step.end);
        let inputs = motion.inputs(step.t + step.h, &step.end).map_err(|failure| self.failure(failure))?;
        let state = State { time: step.t + step.h, coordinates: q, speeds: u, inputs: &inputs };
        for (place, (contact, hold)) in closed.iter().zip(&here.holds).enumerate() {
            if let (Hold::Slide(d), true) = (hold, contact.rubs()) {
                let velocity = self
                    .mechanism
                    .contact_velocity(contact.contact, &state)
                    .map_err(|error| self.failure(Failure::State(error)))?;
                let slip = Vector2::new(velocity.y, velocity.z);
                if slip.norm() <= DIRECTION * here.support.velocity_size(place, u) {
                    continue;
                }
                if slip.dot(d) < 0.5 * slip.norm() && step.h > 2.0 * ENDING * self.front.scales.time {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}
