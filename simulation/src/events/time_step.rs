//! Makes one step of the motion: integrates, finds the first event in the step, and handles it.

use std::cell::{Cell, RefCell};

use hodograph::{ComponentKind, ContactError, State, StateError};
use nalgebra::Vector2;
use smallvec::SmallVec;

use crate::closed::forces::Hold;
use crate::closed::phase::{Closed, Phase, Turned, Turning, mus};
use crate::closed::turned_axes::{along_turned, turn_of_tangents};
use crate::events::event_location::{Crossing, Functions, first_crossing};
use crate::events::stage_values::Stages;
use crate::events::watched::Watched;
use crate::impact::impact_without_collision::TURNS;
use crate::integration::motion::{Evaluation, Failure};
use crate::integration::settled_slip::settled;
use crate::integration::signed_slip::{self, EXPLICIT, Search, SettledSlip, inconsistent};
use crate::integration::slip_end::{ENDING, Fate, fate, has_passed, may_end, straight, time_of_slip};
use crate::integration::stepper::{self, Step, Tolerances};
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// The part of the time to the end of slip that a step may take.
const SHARE: f64 = 0.75;

/// Slip that is followed to its end separately ends within this many times the time given by its rate.
const LATE: f64 = 1e3;
/// This many steps without an event must advance the motion by [`ADVANCE`] of the longest step so far, or of
/// half the time of the problem.
const STEPS: usize = 3000;
const LONG: f64 = 0.5;
const ADVANCE: f64 = 1e-2;
/// Fewer steps that advance it by next to nothing are enough; steps with so many contacts take twice as long.
const STUCK: usize = 1200;
const CONTACTS: usize = 4;
const NOTHING: f64 = 2e-8;
/// Where steps hardly advance, gaps are looked at after these times, in units of the time of the problem: one that
/// has no value there is the cause.
const AHEAD: [f64; 4] = [0.0, 1e-9, 1e-6, 1e-3];
/// After so many steps in a row slip that would end at once is taken for slip whose direction turns.
const AGAIN: usize = 2;

/// Number of steps with settled directions that are tried before directions are integrated.
const TRIALS: usize = 4;
/// Such a step ends where the remaining slip is this part of [`ENDING`].
const LAST: f64 = 0.5;
/// Slip that did not end along its settled direction is integrated until it is this many times as fast.
const BARRED: f64 = 100.0;
/// Directions do not follow from the state after this many events at one time.
const CROWD: usize = 4;
/// Directions follow from the state if [`crate::closed::forces::Forces::f`] is above this; near a jam f depends on them too much.
const FAR: f64 = 0.1;
/// Points of a step at which slip is compared with its settled direction.
const LOOKED_AT: [f64; 2] = [0.4, 0.8];
/// The next step aims at this part of the size that the error allows, and its length changes at most by these
/// factors.
const SAFETY: f64 = 0.9;
const LEAST_FACTOR: f64 = 0.01;
const GREATEST_FACTOR: f64 = 5.0;
/// After a step with integrated directions, a step with settled directions that is longer by this factor is
/// tried.
const LONGER: f64 = 2.0;
const LONGEST: f64 = 50.0;

/// The result of an attempted step.
pub(crate) enum Attempt {
    /// A step, and the first event in it.
    Made(Step, Option<(Watched, Crossing)>),
    /// The integration cannot continue.
    Stuck(Option<Failure>),
}

/// Number of evaluations of the functions of a step after which it is not bisected any more.
const LOOKS: usize = 30_000;
/// After so many of them gaps of faces and edges that end, and their ends, are known to this part of the length of the problem
/// only.
const CLOSELY: usize = 6_000;
const TIES: f64 = 4e-8;
/// Friction and normal force vanish together if, where the condition of friction has its zero, mu times the normal force is at
/// most the first part of the greatest force, and the normal force is negative the second part of the step later.
const VANISHES: f64 = 1e-6;
const BEHIND: f64 = 1e-3;

impl Transition<'_> {
    /// Makes one step.
    pub(crate) fn step(&mut self) -> Result<(), SimulationError> {
        self.front.omegas.fill(None);
        self.front.turnings.fill(None);
        for (barred, phase) in self.front.barred.iter_mut().zip(&self.front.phases) {
            if !matches!(phase, Phase::Slide(_)) {
                *barred = 0.0;
            }
        }
        let mut closed = self.closed();
        let here = match self.motion(&closed).evaluate(self.front.t, &self.front.y) {
            Ok(here) => here,
            // The contact has jammed at the end of the last step.
            Err(failure) => return self.stuck_integration(Some(failure)),
        };
        self.weigh_lifted(&here)?;
        for (contact, hold) in closed.iter().zip(&here.holds) {
            // If slip becomes too small to have a direction, the last one is used.
            if let Hold::Slide(direction) = hold {
                self.front.phases[contact.contact] = Phase::Slide(*direction);
            }
        }
        let most =
            self.limit().map_or(f64::INFINITY, |limit| limit - self.front.t).min(self.options.max_step);
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let speeds = &self.front.y[n..n + self.mechanism.count(ComponentKind::Speed)];
        let ending = ENDING * self.front.scales.time;
        let mut left = vec![None; closed.len()];
        // Contacts whose slip would end at once at its present rate, but does not.
        let mut turns = vec![false; closed.len()];
        for (i, contact) in closed.iter().enumerate() {
            if !contact.rubs() {
                continue;
            }
            left[i] = time_of_slip(&here, i, &self.front.scale);
            let passed = has_passed(&here, i, &self.front.scale);
            if passed
                || left[i].is_some_and(|left| left < ending)
                || may_end(&here, i, speeds, &self.front.scale, ending)
            {
                let time = if passed { 0.0 } else { left[i].unwrap_or(0.0).min(ending) };
                if closed.len() > 1 || passed {
                    let mut stopped = self.stops(&closed, &here, speeds);
                    if stopped.is_empty() && (passed || straight(&here, i)) {
                        stopped = self.turns_round(&closed, &here, i);
                    }
                    if !stopped.is_empty() {
                        return self.end_slip(&closed, &here, &stopped, time);
                    }
                    turns[i] = !passed && left[i].is_some_and(|left| left < ending);
                } else if let Fate::Ends(time) =
                    fate(&here.support, &here.holds, &mus(&closed), i, LATE * ending)
                {
                    return self.end_slip(&closed, &here, &[i], time);
                }
            }
        }
        // Where this is so in step after step, while slip of another contact lasts, the direction turns faster than slip
        // becomes less: it is sought together with those of the others (theory 17.5).
        let rubbing = closed.iter().filter(|contact| contact.rubs()).count();
        let turning = turns.iter().filter(|&&turns| turns).count();
        let sought = turning < rubbing && self.front.would_end >= AGAIN;
        self.front.would_end = if turning > 0 { self.front.would_end + 1 } else { 0 };
        let ends: Vec<_> =
            left.iter().zip(&turns).map(|(&left, &turns)| left.filter(|_| !(turns && sought))).collect();
        let (made, signed) = match self.settled_step(&mut closed, &here, most, &ends) {
            Some(made) => (made, true),
            None => {
                let omegas =
                    settled(&self.motion(&closed), self.front.t, &self.front.y, &here, &self.front.scales);
                for (contact, omega) in closed.iter_mut().zip(omegas) {
                    contact.omega = omega;
                    self.front.omegas[contact.contact] = omega;
                }
                self.ends_along_settled(&closed, &mut left);
                let ends = left.iter().flatten().map(|left| SHARE * left.max(ending));
                let free = most.min(self.front.next);
                let most = ends.fold(free, f64::min);
                match self.attempt(&closed, &here, most)? {
                    Attempt::Made(mut step, crossing) => {
                        // A step that ends with the slip says nothing about the size that the error allows.
                        if step.h == most && most < free {
                            step.next = step.next.max(self.front.next);
                        }
                        ((step, crossing), false)
                    }
                    Attempt::Stuck(failure) => return self.stuck_integration(failure),
                }
            }
        };
        let (mut step, crossing) = made;
        if let Some(contact) = self.singular(&closed, &step) {
            return self.end_with(contact, &step);
        }
        match crossing {
            None => {
                self.front.next = step.next;
                self.front.next_settled = match signed {
                    true => self.front.next_settled.min(step.next),
                    false => step.next.max((LONGER * self.front.next_settled).min(LONGEST * step.next)),
                };
                self.commit(&mut step)?;
                if self.front.ended.is_some() {
                    return Ok(());
                }
                if step.h > self.instant() {
                    (self.front.crowd, self.front.crowded_contacts) = (0, 0);
                }
                self.progress(step.h)?;
                self.on_time()
            }
            Some((watched, crossing)) => {
                self.front.steps = (0, self.front.t, self.front.steps.2);
                self.front.turned.fill(Turned::default());
                self.handle_event(&closed, step, watched, crossing)
            }
        }
    }

    /// Replaces the times to the end of slip by those that follow from the rates along settled directions, for contacts whose
    /// directions follow from the state. Slip that is next to nothing may have another direction itself, and along that one it
    /// seems to end at once.
    fn ends_along_settled(&self, closed: &[Closed], left: &mut [Option<f64>]) {
        if closed.iter().all(|contact| contact.omega.is_none()) {
            return;
        }
        let Ok(settled) = self.motion(closed).evaluate(self.front.t, &self.front.y) else { return };
        for (i, left) in left.iter_mut().enumerate().filter(|(i, _)| closed[*i].omega.is_some()) {
            *left = time_of_slip(&settled, i, &self.front.scale);
        }
    }

    /// A step in which contacts with settled slip have the directions that follow from the state; `left` are
    /// the times to the end of each slip at its present rate. `None` if no such step is as long as an
    /// explicit integration of the directions allows; then only the sizes of trial steps have changed.
    fn settled_step(
        &mut self,
        closed: &mut [Closed],
        here: &Evaluation,
        most: f64,
        left: &[Option<f64>],
    ) -> Option<(Step, Option<(Watched, Crossing)>)> {
        let ending = ENDING * self.front.scales.time;
        let asked: Vec<usize> = (0..closed.len())
            .filter(|&place| {
                let slip = here.support.slip(place).norm();
                closed[place].rubs()
                    && left[place].is_none_or(|left| left >= ending)
                    && slip >= BARRED * self.front.barred[closed[place].contact]
            })
            .collect();
        let far = here.forces.as_ref().is_some_and(|forces| forces.f > FAR);
        if asked.is_empty() || !far || self.front.crowd >= CROWD {
            return None;
        }
        let before: Vec<Turned> = closed.iter().map(|contact| self.front.turned[contact.contact]).collect();
        let mut reach = most.min(self.front.next_settled);
        for _ in 0..TRIALS {
            let search =
                Search { asked: &asked, left, before: &before, reach, tolerances: self.tolerances() };
            let start = (self.front.t, &self.front.y[..]);
            let found = signed_slip::settled(&self.motion(closed), start, here, &search)?;
            for slip in &found.slips {
                let contact = closed[slip.place].contact;
                self.front.turned[contact] = [Some((self.front.t, slip.rates[0])), before[slip.place][0]];
            }
            let settles = |place: &usize| found.slips.iter().any(|slip| slip.place == *place);
            let others = (0..closed.len()).filter(|place| !settles(place));
            let ends = others.filter_map(|place| left[place]).map(|left| SHARE * left.max(ending));
            let h = ends.fold(reach.min(found.reach), f64::min);
            let ends_within = |slip: &SettledSlip| left[slip.place].is_some_and(|left| left < h);
            let worth = EXPLICIT * found.relaxation < h || found.slips.iter().any(ends_within);
            if !found.has_settled || !worth {
                return None;
            }
            let mut trial = closed.to_vec();
            for slip in &found.slips {
                let place = slip.place;
                trial[place].slides = Some(slip.direction);
                // The end of slip is followed separately.
                let least =
                    left[place].map_or(0.0, |left| LAST * ending / left * here.support.slip(place).norm());
                trial[place].turning = Some(Turning {
                    since: self.front.t,
                    rates: slip.rates,
                    across: slip.across,
                    within: h,
                    inverse: found.inverse.clone(),
                    least,
                });
            }
            if let Ok(Attempt::Made(step, crossing)) = self.attempt(&trial, here, h) {
                if crossing.is_some_and(|(watched, _)| watched == Watched::Jam) {
                    return None;
                }
                let part = crossing.map_or(1.0, |(_, crossing)| crossing.place);
                let error = self.inconsistency(&trial, &step, part);
                reach = part * step.h * (SAFETY / error.cbrt()).clamp(LEAST_FACTOR, GREATEST_FACTOR);
                if error <= 1.0 {
                    for slip in &found.slips {
                        let contact = closed[slip.place].contact;
                        self.front.phases[contact] = Phase::Slide(slip.direction);
                        self.front.turnings[contact] = trial[slip.place].turning.clone();
                    }
                    self.front.next_settled = reach;
                    closed.clone_from_slice(&trial);
                    return Some((step, crossing));
                }
            } else {
                reach = LEAST_FACTOR * h;
            }
            self.front.next_settled = reach;
        }
        None
    }

    /// The difference of slip from its settled directions in the first part of a step, relative to the
    /// tolerances.
    fn inconsistency(&self, closed: &[Closed], step: &Step, part: f64) -> f64 {
        let motion = self.motion(closed);
        let at = |share: f64| {
            let fraction = share * part;
            let time = step.t + fraction * step.h;
            let there = motion.evaluate_near(time, &step.at(fraction), None);
            let (_, u) = motion.split(&step.end);
            there.map_or(f64::INFINITY, |there| inconsistent(closed, (time, &there), u, &self.tolerances()))
        };
        LOOKED_AT.into_iter().map(at).fold(0.0, f64::max)
    }

    pub(crate) fn tolerances(&self) -> Tolerances {
        Tolerances { relative: self.options.relative_tolerance, absolute: self.options.absolute_tolerance }
    }

    /// Counts steps without an event, and stops with an error if they hardly advance the motion.
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
                if let Some(error) = self.undefined_ahead() {
                    return Err(self.failure(Failure::State(error)));
                }
                let modes = self.modes_in_words();
                return Err(self.error(None, ErrorKind::NoProgress { steps, time, modes }));
            }
            self.front.steps = (0, self.front.t, longest);
        }
        Ok(())
    }

    /// Why a gap has no value a little later, if one has none: what shorter and shorter steps have kept away from.
    fn undefined_ahead(&self) -> Option<StateError> {
        let closed = self.closed();
        let here = self.motion(&closed).evaluate(self.front.t, &self.front.y).ok()?;
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let p = self.mechanism.count(ComponentKind::Speed);
        AHEAD.into_iter().find_map(|ahead| {
            let after = ahead * self.front.scales.time;
            let y: Vec<f64> =
                self.front.y.iter().zip(&here.rates).map(|(value, rate)| value + after * rate).collect();
            let state = State {
                time: self.front.t + after,
                coordinates: &y[..n],
                speeds: &y[n..n + p],
                inputs: &self.front.held,
            };
            let with_surface = (0..self.front.phases.len()).filter(|&contact| self.pair(contact).is_some());
            with_surface.map(|contact| self.mechanism.gap(contact, &state)).find_map(Result::err)
        })
    }

    /// A step of at most this size, and the first event in it.
    fn attempt(
        &self,
        closed: &[Closed],
        here: &Evaluation,
        mut most: f64,
    ) -> Result<Attempt, SimulationError> {
        let tolerances = self.tolerances();
        let looks = Cell::new(0);
        // What the user gave and is no number, and what has no value in the model: the error, if no shorter step avoids it.
        let refused = RefCell::new(None);
        let undefined = RefCell::new(None);
        for _ in 0..80 {
            if looks.get() > LOOKS {
                let modes = self.modes_in_words();
                return Err(self.error(None, ErrorKind::NoProgress { steps: 1, time: most, modes }));
            }
            let motion = self.motion(closed);
            let mut stages = Stages::new(&motion);
            // Directions that follow from the state change the rates.
            let first = closed.iter().all(Closed::has_own_direction).then_some(&here.rates[..]);
            if first.is_some() {
                stages.starts(here);
            }
            let made = stepper::step(&mut stages, (self.front.t, &self.front.y, first), most, &tolerances);
            let Some(step) = made else {
                return Ok(Attempt::Stuck(stages.failed.or(refused.into_inner())));
            };
            let refused_before = refused.take();
            // No time is left before it.
            if step.h <= 4.0 * f64::EPSILON * self.front.t.abs()
                && let Some(failure) = refused_before
            {
                return Err(self.failure(failure));
            }
            let keeps = self.keeps_direction(closed, here, &step);
            match keeps.and_then(|keeps| Ok(keeps && self.leaving_is_known(&step)?)) {
                Ok(true) => {}
                Ok(false) => {
                    most = 0.5 * step.h;
                    continue;
                }
                // Behind an event the mechanism may have no state: a ball in the middle of the box that it strikes.
                Err(SimulationError { kind: ErrorKind::State(error), .. }) => {
                    *undefined.borrow_mut() = Some(Failure::State(error));
                    most = 0.5 * step.h;
                    continue;
                }
                Err(error) => return Err(error),
            }
            let Some(turns) = self.turns(closed, &step) else {
                most = 0.5 * step.h;
                continue;
            };
            let (watched, mut noise) = self.watched(closed, step.h, &self.stay_apart(&step, turns));
            if looks.get() > CLOSELY {
                self.blur_ties(&watched, &mut noise);
            }
            let h = step.h;
            let found = first_crossing(
                &mut Functions {
                    count: watched.len(),
                    noise: &noise,
                    near: &|function| stages.values(&watched[function]),
                    values: &mut |fraction, functions| {
                        looks.set(looks.get() + 1);
                        let at = &mut |after: f64| step.at(after / h);
                        let asked: SmallVec<[Watched; 12]> =
                            functions.iter().map(|&one| watched[one]).collect();
                        let values = self.values(closed, &asked, h * fraction, Some(here), at);
                        match values {
                            Ok(values) => Some(values),
                            Err(failure) => {
                                match failure {
                                    Failure::Input(_) => *refused.borrow_mut() = Some(failure),
                                    Failure::State(_) => *undefined.borrow_mut() = Some(failure),
                                    _ => {}
                                }
                                None
                            }
                        }
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
            let found = found.map(|crossing| {
                (self.of_pressure(closed, watched[crossing.function], &crossing, &step), crossing)
            });
            return Ok(Attempt::Made(step, found));
        }
        Err(match refused.into_inner().or(undefined.into_inner()) {
            Some(failure) => self.failure(failure),
            None => self.error(None, ErrorKind::Stalled),
        })
    }

    /// The function whose zero is the event: the normal force in place of friction, where both vanish together. The square of
    /// the normal force in the condition of friction has a double zero there, which is known less well.
    fn of_pressure(&self, closed: &[Closed], found: Watched, crossing: &Crossing, step: &Step) -> Watched {
        let Watched::Cone(place) = found else { return found };
        // Without friction the condition is one of the acceleration.
        if closed[place].mu == 0.0 {
            return found;
        }
        let pressure = |fraction: f64| {
            let at = &mut |after: f64| step.at(after / step.h);
            let values = self.values(closed, &[Watched::Normal(place)], step.h * fraction, None, at);
            values.map_or(f64::INFINITY, |values| values[0])
        };
        let greatest = self.front.forces.iter().map(|force| force.norm()).fold(0.0, f64::max);
        let vanishes = closed[place].mu * pressure(crossing.place) <= VANISHES * greatest
            && pressure((crossing.place + BEHIND).min(1.0)) < 0.0;
        if vanishes { Watched::Normal(place) } else { found }
    }

    /// Where sides or corners are at a tie, rounding makes gaps jump between two values that are next to each other. What does
    /// not become smooth however closely it is looked at is such a jump.
    fn blur_ties(&self, watched: &[Watched], noise: &mut [f64]) {
        for (what, noise) in watched.iter().zip(noise) {
            let ends = match *what {
                Watched::Gap(contact) | Watched::Entry(contact) => self.ends(contact),
                Watched::End(_) => true,
                _ => false,
            };
            if ends {
                *noise = noise.max(TIES * self.front.scales.length);
            }
        }
    }

    /// Handles an integration that cannot continue.
    fn stuck_integration(&mut self, failed: Option<Failure>) -> Result<(), SimulationError> {
        match failed {
            Some(Failure::Contact(
                contact,
                ContactError::Jam { .. } | ContactError::ImpactWithoutCollision { .. },
            )) => self.jams(contact),
            // Two closed contacts may have coincided up to here: the one that is at its end makes way for the other.
            Some(Failure::NoForces) => match self.at_its_end()? {
                Some(contact) => self.leave(contact),
                None => self.decide_again(),
            },
            Some(failure) => Err(self.failure(failure)),
            None => match (self.singular_here(&self.closed()), self.turns_into_jam()?) {
                (Some(contact), _) => self.end_at(contact),
                (None, Some(contact)) => self.impact_without_collision(contact),
                (None, None) => self.stalled(),
            },
        }
    }

    /// Steps have become too short: where slip of several contacts turns into a jam of all of them, the last turn takes less
    /// time than any step, and an impact without approach follows.
    fn stalled(&mut self) -> Result<(), SimulationError> {
        let stalled = self.error(None, ErrorKind::Stalled);
        let closed = self.closed();
        let here = self.motion(&closed).evaluate(self.front.t, &self.front.y).ok();
        let jams = here.and_then(|here| here.forces).is_some_and(|forces| forces.f < TURNS);
        if closed.len() < 2 || !jams {
            return Err(stalled);
        }
        let contacts: Vec<usize> = closed.iter().map(|closed| closed.contact).collect();
        self.jam_of_all(&contacts, stalled)
    }

    /// Decides modes anew where the closed contacts have no forces in theirs, though nothing has ended them; the error
    /// `no_forces` if there are no others.
    fn decide_again(&mut self) -> Result<(), SimulationError> {
        let before = self.mark();
        let was = self.front.phases.clone();
        let closed: Vec<usize> = (0..was.len()).filter(|&contact| was[contact].is_closed()).collect();
        if self.decide(&closed, &was).is_ok() && self.front.phases != was {
            return self.crowded(before.front.t);
        }
        self.return_to(&before);
        Err(self.failure(Failure::NoForces))
    }

    /// Whether the slip of sliding contacts stays in its half plane.
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
            if let (Hold::Slide(d), true, None, Some(began)) =
                (hold, contact.rubs(), &contact.turning, contact.slides)
            {
                let velocity = self
                    .mechanism
                    .contact_velocity(contact.contact, &state)
                    .map_err(|error| self.failure(Failure::State(error)))?;
                let slip = Vector2::new(velocity.y, velocity.z);
                let there = motion.direction(&here.support, place, (slip, began), u);
                if there.dot(d) >= 0.5 || step.h <= 2.0 * ENDING * self.front.scales.time {
                    continue;
                }
                // Where the tangential axes have jumped, slip has not.
                let p = u.len();
                let mut rows = vec![0.0; 3 * p];
                self.mechanism
                    .partial_velocities(contact.contact, &state, &mut rows)
                    .map_err(|error| self.failure(Failure::State(error)))?;
                let before = &here.support.partials.as_slice()[3 * p * place..][..3 * p];
                if along_turned(there, turn_of_tangents(&rows, before)).dot(d) < 0.5 {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}
