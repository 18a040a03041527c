//! One step of the motion: integrate, locate the first event, correct drift, answer the event.

use std::cell::RefCell;

use hodograph::{ContactError, Kind, State};
use nalgebra::Vector2;

use crate::forces::{Hold, margins};
use crate::locate::{Crossing, first_crossing};
use crate::motion::{Closed, Evaluation, Failure, Modes, Motion};
use crate::simulation::{Leaving, Phase, Simulation};
use crate::slip_end::{Fate, fate};
use crate::slow::settled;
use crate::stepper::{self, Step, Tolerances};
use crate::{Drive, Event, EventKind, Reason, SimulationError, drift};

/// A contact that lifts off is apart where its gap is above this, m.
pub(crate) const LIFTED: f64 = 1e-11;
/// Slip that ends within this time is followed to its end by itself, s.
const ENDING: f64 = 1e-9;
/// A share of the time to the end of slip that a step may take.
const SHARE: f64 = 0.5;
/// Most events without progress in time.
const CROWD: usize = 2000;
/// A sliding contact with f / m_nn below this jams.
const JAM: f64 = 1e-6;

/// What is watched in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Watched {
    /// the gap of a contact
    Gap(usize),
    /// normal force of a contact (place among the closed ones)
    Normal(usize),
    /// whether friction suffices
    Cone(usize),
    /// f of the only closed contact
    Jam,
    /// a user's function, times this sign
    User(usize, f64),
}

impl Simulation<'_> {
    /// Makes one step.
    pub(crate) fn proceed(&mut self) -> Result<(), SimulationError> {
        self.sample()?;
        self.omegas.fill(None);
        let mut closed = self.closed();
        let here = self.motion(&closed).evaluate(self.t, &self.y).map_err(|failure| self.failure(failure))?;
        let mut most = self.next.min(self.options.max_step);
        if let Some(limit) = self.limit() {
            most = most.min(limit - self.t);
        }
        for (i, contact) in closed.iter().enumerate() {
            if contact.slides.is_none() {
                continue;
            }
            let Some(left) = time_of_slip(&here, i) else { continue };
            if left < ENDING
                && let Fate::Ends(time) = fate(&here.support, &here.holds, &mus(&closed), i)
            {
                return self.end_slip(&closed, &here, i, time);
            }
            most = most.min((SHARE * left).max(ENDING));
        }
        let omegas = settled(&self.motion(&closed), self.t, &self.y, &here);
        for (contact, omega) in closed.iter_mut().zip(omegas) {
            contact.omega = omega;
            self.omegas[contact.contact] = omega;
        }
        let Some((mut step, crossing)) = self.attempt(&closed, &here, most)? else { return Ok(()) };
        match crossing {
            None => {
                self.next = step.next;
                self.commit(&mut step)?;
                self.arm()?;
                self.on_time()
            }
            Some((watched, crossing)) => self.happen(&closed, step, watched, crossing),
        }
    }

    /// The next time at which something is due.
    fn limit(&self) -> Option<f64> {
        let chatter = self.chatter.iter().map(|(time, _)| *time);
        chatter.chain(self.next_sample).filter(|&time| time > self.t).reduce(f64::min)
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
        for _ in 0..80 {
            let failed = RefCell::new(None);
            let made = {
                let motion = self.motion(closed);
                let rates = |t: f64, y: &[f64], rates: &mut [f64]| match motion.evaluate(t, y) {
                    Ok(evaluation) => rates.copy_from_slice(&evaluation.rates),
                    Err(failure) => {
                        failed.borrow_mut().get_or_insert(failure);
                        rates.fill(f64::NAN);
                    }
                };
                stepper::step(&rates, self.t, &self.y, most, &tolerances)
            };
            let Some(mut step) = made else {
                return self.stuck_integration(failed.into_inner()).map(|()| None);
            };
            if !self.keeps_direction(closed, here, &step)? {
                most = 0.5 * step.h;
                continue;
            }
            let (watched, noise) = self.watched(closed, step.h);
            let found = first_crossing(watched.len(), &noise, &mut |fraction| {
                let y = step.at(fraction);
                self.values(closed, &watched, step.h * fraction, &y).ok()
            });
            let Ok(found) = found else {
                most = 0.5 * step.h;
                continue;
            };
            let found = found.map(|crossing| (watched[crossing.function], crossing));
            return Ok(Some((step, found)));
        }
        Err(self.error(None, Reason::Stalled))
    }

    /// The integration came to a place that it cannot pass.
    fn stuck_integration(&mut self, failed: Option<Failure>) -> Result<(), SimulationError> {
        match failed {
            Some(Failure::Contact(
                contact,
                ContactError::Jam { .. } | ContactError::ImpactWithoutCollision { .. },
            )) => self.impact_without_collision(contact),
            Some(failure) => Err(self.failure(failure)),
            None => Err(self.error(None, Reason::Stalled)),
        }
    }

    /// Whether sliding contacts keep the half plane of their slip.
    fn keeps_direction(
        &self,
        closed: &[Closed],
        here: &Evaluation,
        step: &Step,
    ) -> Result<bool, SimulationError> {
        if closed.iter().all(|contact| contact.slides.is_none()) {
            return Ok(true);
        }
        let motion = self.motion(closed);
        let (q, u) = motion.split(&step.end);
        let inputs = motion.inputs(step.t + step.h, &step.end).map_err(|failure| self.failure(failure))?;
        let state = State { time: step.t + step.h, coordinates: q, speeds: u, inputs: &inputs };
        for (contact, hold) in closed.iter().zip(&here.holds) {
            if let Hold::Slide(d) = hold {
                let velocity = self
                    .mechanism
                    .contact_velocity(contact.contact, &state)
                    .map_err(|error| self.failure(Failure::State(error)))?;
                let slip = Vector2::new(velocity.y, velocity.z);
                if slip.dot(d) < 0.5 * slip.norm() && step.h > 2.0 * ENDING {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }

    /// What must be watched from here on, and what rounding may do to it.
    fn watched(&self, closed: &[Closed], h: f64) -> (Vec<Watched>, Vec<f64>) {
        let (mut watched, mut noise) = (Vec::new(), Vec::new());
        let n = self.mechanism.count(Kind::Coordinate);
        let size = self.y[..n].iter().fold(1e-3_f64, |size, q| size.max(q.abs()));
        let rounding = 4.0 * f64::EPSILON * size;
        for (contact, phase) in self.phases.iter().enumerate() {
            if let Phase::Open(leaving) = phase
                && self.surfaces[contact].is_some()
            {
                watched.push(Watched::Gap(contact));
                noise.push(match leaving {
                    // Divided by the time, at the second point of the step.
                    Leaving::Bounced(_) => rounding / (0.0024 * h),
                    _ => rounding,
                });
            }
        }
        for (place, contact) in closed.iter().enumerate() {
            watched.push(Watched::Normal(place));
            noise.push(0.0);
            if contact.slides.is_none() {
                watched.push(Watched::Cone(place));
                noise.push(0.0);
            } else if closed.len() == 1 {
                watched.push(Watched::Jam);
                noise.push(0.0);
            }
        }
        let (q, u) = (&self.y[..n], &self.y[n..n + self.mechanism.count(Kind::Speed)]);
        for (index, function) in self.options.events.iter().enumerate() {
            let value = function(self.t, q, u);
            watched.push(Watched::User(index, if value < 0.0 { -1.0 } else { 1.0 }));
            noise.push(1e-15);
        }
        (watched, noise)
    }

    /// The values of what is watched, a time after the front.
    fn values(
        &self,
        closed: &[Closed],
        watched: &[Watched],
        after: f64,
        y: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let motion = self.motion(closed);
        let t = self.t + after;
        let (q, u) = motion.split(y);
        let inputs = motion.inputs(t, y)?;
        let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
        let mut conditions = Vec::new();
        let mut f = 1.0;
        if !closed.is_empty() {
            let evaluation = motion.evaluate(t, y)?;
            if let Some(forces) = &evaluation.forces {
                conditions = margins(forces, &evaluation.holds, &mus(closed));
                f = forces.f;
            }
        }
        watched
            .iter()
            .map(|what| match *what {
                Watched::Gap(contact) => {
                    let gap = self.mechanism.gap(contact, &state)?.unwrap_or(1.0);
                    Ok(match self.phases[contact] {
                        Phase::Open(Leaving::Bounced(start)) if after > 0.0 => (gap - start) / after,
                        Phase::Open(Leaving::Bounced(_)) => {
                            self.mechanism.contact_velocity(contact, &state)?.x
                        }
                        Phase::Open(Leaving::Lifted) => gap + LIFTED,
                        _ => gap,
                    })
                }
                Watched::Normal(place) => Ok(conditions.get(place).map_or(1.0, |margins| margins[0])),
                Watched::Cone(place) => Ok(conditions.get(place).map_or(1.0, |margins| margins[1])),
                Watched::Jam => Ok(f - JAM),
                Watched::User(index, sign) => Ok(sign * (self.options.events[index])(t, q, u)),
            })
            .collect()
    }

    /// A part of the step from the front, integrated anew.
    fn part(&self, closed: &[Closed], h: f64) -> Option<Step> {
        part_of(&self.motion(closed), self.t, &self.y, h)
    }

    /// Gap and normal velocity of a contact at the end of a step.
    fn gap_at(&self, step: &Step, contact: usize) -> Result<(f64, f64), SimulationError> {
        let motion = self.motion(&[]);
        let (q, u) = motion.split(&step.end);
        let state = State { time: step.t + step.h, coordinates: q, speeds: u, inputs: &self.held };
        let fault = |error| self.failure(Failure::State(error));
        let gap = self.mechanism.gap(contact, &state).map_err(fault)?.unwrap_or(1.0);
        Ok((gap, self.mechanism.contact_velocity(contact, &state).map_err(fault)?.x))
    }

    /// Finds the time of an event to rounding, goes there and answers it.
    fn happen(
        &mut self,
        closed: &[Closed],
        whole: Step,
        watched: Watched,
        crossing: Crossing,
    ) -> Result<(), SimulationError> {
        let mut after = crossing.place * whole.h;
        let mut step = whole.clone();
        for _ in 0..8 {
            let Some(part) = self.part(closed, after) else { break };
            step = part;
            let change = match watched {
                Watched::Gap(contact) => {
                    let (gap, rate) = self.gap_at(&step, contact)?;
                    if rate < 0.0 { -gap / rate } else { 0.0 }
                }
                _ => {
                    let d = 1e-4 * after.min(whole.h - after).max(1e-3 * whole.h);
                    let value = |simulation: &Self, h: f64| {
                        let step = simulation.part(closed, h)?;
                        simulation.values(closed, &[watched], h, &step.end).ok().map(|values| values[0])
                    };
                    let (here, there) = (value(self, after), value(self, after - d));
                    match (here, there) {
                        (Some(here), Some(there)) if here < there => here * d / (there - here),
                        _ => 0.0,
                    }
                }
            };
            let next = (after + change).clamp(0.0, whole.h);
            // Relative to the time since the front: the state is as exact as that, however late it is.
            if (next - after).abs() <= 2.0 * f64::EPSILON * after || (next - after).abs() > 0.1 * whole.h {
                break;
            }
            after = next;
        }
        self.next = whole.next.min((10.0 * step.h).max(1e-7));
        let start = self.t;
        self.commit(&mut step)?;
        self.crowded(start)?;
        match watched {
            Watched::Gap(contact) => {
                let (_, rate) = self.gap_at(&step, contact)?;
                if rate >= 0.0 {
                    // It only touches.
                    self.phases[contact] = Phase::Open(Leaving::Lifted);
                    return Ok(());
                }
                self.arm_others(contact)?;
                self.strike(contact)
            }
            Watched::Normal(place) => {
                let contact = closed[place].contact;
                self.lift_off(contact)
            }
            Watched::Cone(place) => self.begin_slip(closed[place].contact),
            Watched::Jam => self.impact_without_collision(closed[0].contact),
            Watched::User(index, _) => {
                self.push(None, EventKind::Zero(index));
                // Past the zero, so that it is not found again.
                let small = 1e-12 * self.t.abs().max(1e-3);
                if let Some(mut past) = self.part(closed, small) {
                    self.commit(&mut past)?;
                }
                self.arm()
            }
        }
    }

    /// Takes the end of a step as the new front.
    pub(crate) fn commit(&mut self, step: &mut Step) -> Result<(), SimulationError> {
        self.past = self.modes();
        self.t = step.t + step.h;
        self.y.copy_from_slice(&step.end);
        self.correct()?;
        step.corrected(&self.y);
        self.step = Some(step.clone());
        let n = self.mechanism.count(Kind::Coordinate);
        for (scale, speed) in self.scale.iter_mut().zip(&self.y[n..]) {
            *scale = scale.max(speed.abs());
        }
        let p = self.scale.len();
        let state =
            State { time: self.t, coordinates: &self.y[..n], speeds: &self.y[n..n + p], inputs: &self.held };
        if let Ok(kinetic) = self.mechanism.kinetic_energy(&state) {
            self.greatest = self.greatest.max(kinetic);
        }
        Ok(())
    }

    /// Puts right what drifted.
    pub(crate) fn correct(&mut self) -> Result<(), SimulationError> {
        let mut y = std::mem::take(&mut self.y);
        let modes = self.modes();
        let done = self.put_right(&modes, self.t, &mut y);
        self.y = y;
        done
    }

    /// The modes at the front.
    pub(crate) fn modes(&self) -> Modes {
        Modes { closed: self.closed(), held: self.held.clone(), resting: self.resting }
    }

    /// Puts right what drifted while these modes lasted.
    fn put_right(&self, modes: &Modes, t: f64, y: &mut [f64]) -> Result<(), SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let p = self.mechanism.count(Kind::Speed);
        let closed: Vec<(usize, bool)> =
            modes.closed.iter().map(|closed| (closed.contact, closed.slides.is_none())).collect();
        let mut q = y[..n].to_vec();
        let mut u = y[n..n + p].to_vec();
        let moved = (|| {
            drift::close_loops(self.mechanism, t, &mut q, &u, &modes.held)?;
            drift::hold_velocities(self.mechanism, t, &q, &mut u, &modes.held, &closed)?;
            if !modes.resting {
                let contacts: Vec<usize> = closed.iter().map(|(contact, _)| *contact).collect();
                drift::close_gaps(self.mechanism, t, &mut q, &u, &modes.held, &contacts)?;
            }
            Ok(())
        })();
        moved.map_err(|error| self.failure(Failure::State(error)))?;
        y[..n].copy_from_slice(&q);
        if !modes.resting {
            y[n..n + p].copy_from_slice(&u);
        }
        Ok(())
    }

    /// The state at a time in the last step, integrated anew up to it: as exact as the step itself.
    pub(crate) fn within_step(&self, time: f64) -> Option<Vec<f64>> {
        let step = self.step.as_ref()?;
        let motion = Motion {
            mechanism: self.mechanism,
            drive: &self.options.drive,
            held: &self.past.held,
            closed: &self.past.closed,
            resting: self.past.resting,
        };
        let part = part_of(&motion, step.t, step.start(), time - step.t)?;
        let mut y = part.end;
        self.put_right(&self.past, time, &mut y).ok()?;
        Some(y)
    }

    /// Contacts that were about to leave are apart once their gaps are open.
    fn arm(&mut self) -> Result<(), SimulationError> {
        self.arm_others(usize::MAX)
    }

    fn arm_others(&mut self, but: usize) -> Result<(), SimulationError> {
        let Some(step) = self.step.clone() else { return Ok(()) };
        for contact in 0..self.phases.len() {
            if contact == but {
                continue;
            }
            match self.phases[contact] {
                Phase::Open(Leaving::Bounced(_)) if step.h > 0.0 => {
                    let (gap, _) = self.gap_at(&step, contact)?;
                    self.phases[contact] =
                        Phase::Open(if gap > 0.0 { Leaving::Apart } else { Leaving::Lifted });
                }
                Phase::Open(Leaving::Lifted) => {
                    let (gap, _) = self.gap_at(&step, contact)?;
                    if gap > LIFTED {
                        self.phases[contact] = Phase::Open(Leaving::Apart);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// What is due at this time.
    fn on_time(&mut self) -> Result<(), SimulationError> {
        let now = self.t;
        let due: Vec<usize> =
            self.chatter.iter().filter(|(time, _)| *time <= now).map(|(_, contact)| *contact).collect();
        self.chatter.retain(|(time, _)| *time > now);
        for contact in due {
            if self.phases[contact].is_closed() {
                self.announce_contact(contact);
            }
        }
        self.look_for_rest()
    }

    /// Lets a controller act where its time has come.
    fn sample(&mut self) -> Result<(), SimulationError> {
        let Some(due) = self.next_sample else { return Ok(()) };
        if due > self.t {
            return Ok(());
        }
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let (t, q, u) = (self.t, self.y[..n].to_vec(), self.y[n..n + p].to_vec());
        let Drive::Sampled { period, controller } = &mut self.options.drive else { return Ok(()) };
        let mut inputs = self.held.clone();
        controller.control(t, &q, &u, &mut inputs);
        self.samples += 1;
        self.next_sample = Some(self.start + *period * self.samples as f64);
        if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
            let message = self.motion(&[]).bad_input(bad, inputs[bad]);
            return Err(self.error(None, Reason::Input(message)));
        }
        if inputs != self.held {
            self.held = inputs;
            self.resting = false;
            self.next = self.next.min(1e-3 * self.options.max_step.min(1.0)).max(1e-6);
            self.settle_again()?;
        }
        Ok(())
    }

    /// Counts events that follow each other without progress.
    fn crowded(&mut self, before: f64) -> Result<(), SimulationError> {
        let close = 1e-12 * self.t.abs().max(1.0);
        if self.t - before > close {
            self.crowd = (0, self.t);
        }
        self.crowd.0 += 1;
        if self.crowd.0 > CROWD {
            return Err(self.error(None, Reason::EventsWithoutEnd(CROWD)));
        }
        Ok(())
    }

    /// Records an event with the state here.
    pub(crate) fn push(&mut self, contact: Option<usize>, kind: EventKind) {
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        self.queue.push_back(Event {
            time: self.t,
            contact,
            kind,
            coordinates: self.y[..n].to_vec(),
            speeds: self.y[n..n + p].to_vec(),
        });
    }

    /// Slip of a contact ends after a short time.
    fn end_slip(
        &mut self,
        closed: &[Closed],
        here: &Evaluation,
        place: usize,
        time: f64,
    ) -> Result<(), SimulationError> {
        let start = self.t;
        let mut end = self.y.clone();
        end.iter_mut().zip(&here.rates).for_each(|(value, rate)| *value += time * rate);
        let mut step = Step::still(self.t, time, &end);
        let mut stopped = Vec::new();
        for (i, contact) in closed.iter().enumerate() {
            // Contacts of one body may stop together.
            let together =
                contact.slides.is_some() && time_of_slip(here, i).is_some_and(|left| left < 3.0 * ENDING);
            if i == place || together {
                self.phases[contact.contact] = Phase::Stick;
                stopped.push(contact.contact);
            }
        }
        self.commit(&mut step)?;
        self.crowded(start)?;
        self.slip_ended(&stopped)?;
        self.arm()
    }
}

/// The motion from a state on, over exactly so long.
fn part_of(motion: &Motion<'_>, t: f64, y: &[f64], h: f64) -> Option<Step> {
    let rates = |t: f64, y: &[f64], rates: &mut [f64]| match motion.evaluate(t, y) {
        Ok(evaluation) => rates.copy_from_slice(&evaluation.rates),
        Err(_) => rates.fill(f64::NAN),
    };
    stepper::part(&rates, t, y, h)
}

/// The coefficients of friction.
pub(crate) fn mus(closed: &[Closed]) -> Vec<f64> {
    closed.iter().map(|contact| contact.mu).collect()
}

/// The time after which slip would end if its rate stayed; `None` where it grows.
fn time_of_slip(here: &Evaluation, place: usize) -> Option<f64> {
    let Hold::Slide(d) = here.holds[place] else { return None };
    let forces = here.forces.as_ref()?;
    let rate = Vector2::new(forces.acceleration[3 * place + 1], forces.acceleration[3 * place + 2]);
    let slip = here.support.slip(place).norm();
    let along = rate.dot(&d);
    (along < 0.0).then(|| slip / -along)
}
