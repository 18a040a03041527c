//! A motion that is driven by another program: the program changes the inputs at times of its choice, or
//! integrates the states itself and reads their rates, the functions whose zeros are events, and the results
//! of events. FMI calls these co-simulation and model exchange (docs/fmu.md).
//!
//! An integrating program keeps the modes of the contacts constant between events, as a step of
//! [`Simulation::advance`] does: the rates are those of the same right-hand side, and the changes at an event
//! are decided by the same transitions.

use hodograph::State;

use crate::closed::forces::{JAM, Margins, margins};
use crate::closed::phase::{Leaving, Phase, mus};
use crate::closed::torques::Turning;
use crate::events::event_functions::LIFTED;
use crate::integration::motion::{Evaluation, Failure, Motion, WORKS};
#[cfg(feature = "serde")]
use crate::state::front::Front;
use crate::state::transition::Transition;
use crate::{ContactForces, ErrorKind, Event, Progress, Simulation, SimulationError};

/// A function whose zero is an event: it is positive as long as the modes of all contacts are constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Indicator {
    /// index of the contact; `None` for [`IndicatorKind::Jam`]
    pub contact: Option<usize>,
    /// the quantity that it monitors
    pub kind: IndicatorKind,
}

/// The quantities that an [`Indicator`] monitors. An inactive indicator, such as the gap of a closed contact,
/// has the value 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IndicatorKind {
    /// gap of an open contact, m; beside a bounded face the distance from the face if that is greater
    Gap,
    /// distance of a closed contact from the boundary of its face or edge, m
    End,
    /// normal force of a closed contact, N
    NormalForce,
    /// (mu lambda_n)^2 minus the square of the friction of a sticking contact, N^2
    Friction,
    /// slip of a sliding contact along the direction that it had last, m/s
    Slip,
    /// like `Friction`, for bodies that rolling friction holds
    RollingFriction,
    /// like `Slip`, for rolling bodies: the relative angular velocity times the length of the torque
    Rolling,
    /// like `Friction`, for bodies that spinning friction holds
    SpinningFriction,
    /// like `Slip`, for bodies that rotate about the normal
    Spinning,
    /// the determinant of the sliding contacts' normal accelerations by normal forces, relative to that without friction:
    /// contacts jam where it vanishes; of one contact it is f / m_nn
    Jam,
}

impl IndicatorKind {
    /// The name of the kind: lower case, and stable between versions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gap => "gap",
            Self::End => "end",
            Self::NormalForce => "normal_force",
            Self::Friction => "friction",
            Self::Slip => "slip",
            Self::RollingFriction => "rolling_friction",
            Self::Rolling => "rolling",
            Self::SpinningFriction => "spinning_friction",
            Self::Spinning => "spinning",
            Self::Jam => "jam",
        }
    }
}

/// A monitored function, with the index of the contact or torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Frozen {
    Gap(usize),
    End(usize),
    Normal(usize),
    Cone(usize),
    Slip(usize),
    Jam,
}

/// Slip below this part of the greatest speeds so far counts as zero shortly after it began.
const BEGINS: f64 = 1e-11;
/// A speed that is larger than all others, so that every slip against its direction counts as zero.
const BOUNDLESS: f64 = 1e150;

impl Simulation<'_> {
    /// Like [`Simulation::advance`], but no step goes beyond `until`, so that inputs can be changed there.
    ///
    /// # Errors
    ///
    /// Those of [`Simulation::advance`].
    pub fn advance_exactly(&mut self, until: f64) -> Result<Progress, SimulationError> {
        let breaks = &mut self.options.breaks;
        let place = breaks.partition_point(|&time| time < until);
        let added = until.is_finite() && breaks.get(place) != Some(&until);
        if added {
            breaks.insert(place, until);
        }
        let progress = self.advance(until);
        if added {
            self.options.breaks.remove(place);
        }
        progress
    }

    /// Changes the constant inputs at [`Simulation::time`], to which [`Simulation::advance_exactly`]
    /// advanced.
    ///
    /// # Errors
    ///
    /// The inputs are not finite or have the wrong number; the motion was advanced beyond this time; the
    /// contacts have no forces under these inputs.
    pub fn set_inputs(&mut self, inputs: &[f64]) -> Result<(), SimulationError> {
        let refused = |message: String| Err(self.transition().error(None, ErrorKind::BadInput(message)));
        if inputs.len() != self.front.held.len() {
            return refused(format!(
                "there are {} numbers for {} inputs",
                inputs.len(),
                self.front.held.len()
            ));
        }
        if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
            return refused(self.transition().motion(&[]).bad_input(bad, inputs[bad]));
        }
        if inputs == self.front.held {
            return Ok(());
        }
        if self.front.t > self.view.0 {
            return refused(format!("the motion was already followed to t = {}", self.front.t));
        }
        let inputs = inputs.to_vec();
        self.take(|transition| transition.change_inputs(inputs))
    }

    /// Rates of coordinates, then speeds, in a state, for constant modes of the contacts.
    ///
    /// # Errors
    ///
    /// The mechanism has no equations of motion in this state, or its closed contacts have no forces.
    pub fn rates(&self, state: &State<'_>, rates: &mut [f64]) -> Result<(), SimulationError> {
        let transition = self.transition();
        let found = transition.frozen(state).map_err(|failure| transition.failure(failure))?;
        let count = rates.len().min(found.rates.len() - WORKS);
        rates[..count].copy_from_slice(&found.rates[..count]);
        Ok(())
    }

    /// Like [`Simulation::contact_forces`], but in the given state, for constant modes of the contacts.
    ///
    /// # Errors
    ///
    /// Those of [`Simulation::rates`].
    pub fn contact_forces_in(&self, state: &State<'_>) -> Result<ContactForces, SimulationError> {
        let transition = self.transition();
        let closed = transition.closed();
        let found = transition.frozen(state).map_err(|failure| transition.failure(failure))?;
        let Some(forces) = found.forces else { return Ok(Vec::new()) };
        let own = |contact: usize| transition.mechanism.torque(contact).is_none();
        let forces = closed.iter().enumerate().map(|(place, closed)| (closed.contact, forces.of(place)));
        Ok(forces.filter(|(contact, _)| own(*contact)).collect())
    }

    /// The functions whose zeros are events, in the order of their values.
    pub fn indicators(&self) -> Vec<Indicator> {
        let transition = self.transition();
        let kind = |what: Frozen| -> Indicator {
            let (index, kinds) = match what {
                Frozen::Gap(index) => (index, [IndicatorKind::Gap; 3]),
                Frozen::End(index) => (index, [IndicatorKind::End; 3]),
                Frozen::Normal(index) => (index, [IndicatorKind::NormalForce; 3]),
                Frozen::Cone(index) => {
                    use IndicatorKind::{Friction, RollingFriction, SpinningFriction};
                    (index, [Friction, RollingFriction, SpinningFriction])
                }
                Frozen::Slip(index) => {
                    use IndicatorKind::{Rolling, Slip, Spinning};
                    (index, [Slip, Rolling, Spinning])
                }
                Frozen::Jam => return Indicator { contact: None, kind: IndicatorKind::Jam },
            };
            let place = match transition.mechanism.torque(index).map(|torque| torque.turning) {
                None => 0,
                Some(Turning::Rolling) => 1,
                Some(Turning::Spinning) => 2,
            };
            Indicator { contact: Some(transition.mechanism.contact(index)), kind: kinds[place] }
        };
        transition.frozen_functions().into_iter().map(kind).collect()
    }

    /// Values of [`Simulation::indicators`] in a state, for constant modes of the contacts.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be evaluated in this state.
    pub fn indicator_values(&self, state: &State<'_>) -> Result<Vec<f64>, SimulationError> {
        let transition = self.transition();
        transition.frozen_values(state).map_err(|failure| transition.failure(failure))
    }

    /// Reports that the integration has reached a state without an event: contacts that lift off may be open
    /// now, and slip has another direction.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be evaluated in this state.
    pub fn step_completed(&mut self, state: &State<'_>) -> Result<(), SimulationError> {
        self.take(|transition| {
            transition.goes_to(state);
            transition.frozen_modes(state)
        })
    }

    /// Handles the events in a state: contacts whose indicators are not positive collide, slip, stick or lift
    /// off as in [`Simulation::advance`], and changed inputs may change modes. [`Simulation::time`] and the
    /// state are then those after the events, which are returned.
    ///
    /// # Errors
    ///
    /// Those of [`Simulation::advance`].
    pub fn continue_from(&mut self, state: &State<'_>) -> Result<Vec<Event>, SimulationError> {
        self.steps.clear();
        self.take(|transition| transition.handle_here(state))?;
        self.view = (self.front.t, self.front.y.clone());
        Ok(self.queue.drain(..).collect())
    }

    /// The time of the next event that no indicator detects: the end of bounces that are lower than the
    /// tolerance.
    pub fn next_time(&self) -> Option<f64> {
        self.transition().limit()
    }

    /// Whether the motion has ended with [`crate::EventKind::Singular`].
    pub fn has_ended(&self) -> bool {
        self.front.ended.is_some()
    }
}

/// Everything on which the future of a motion depends, except its mechanism and its options.
#[cfg(feature = "serde")]
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Saved {
    front: Front,
}

#[cfg(feature = "serde")]
impl Simulation<'_> {
    /// The data for [`Simulation::restore`], at a time to which [`Simulation::advance_exactly`] or
    /// [`Simulation::continue_from`] advanced.
    pub fn save(&self) -> Saved {
        Saved { front: self.front.clone() }
    }

    /// Restores a saved motion, which continues with the same results. Returns whether it belongs to this
    /// mechanism; if not, nothing changes.
    pub fn restore(&mut self, saved: Saved) -> bool {
        let sizes = |front: &Front| {
            let contacts = [
                front.phases.len(),
                front.forces.len(),
                front.omegas.len(),
                front.turned.len(),
                front.barred.len(),
            ];
            (contacts, front.y.len(), front.held.len(), front.scale.len())
        };
        let fits = sizes(&saved.front) == sizes(&self.front)
            && saved.front.t.is_finite()
            && saved.front.y.iter().chain(&saved.front.held).all(|number| number.is_finite())
            && saved.front.chatter.iter().all(|(_, contact)| *contact < self.front.phases.len());
        if !fits {
            return false;
        }
        self.front = saved.front;
        // The rate at which slip turned in the last step is determined again by the next one.
        self.front.turnings = vec![None; self.front.phases.len()];
        self.view = (self.front.t, self.front.y.clone());
        (self.steps, self.failed) = (Vec::new(), None);
        self.queue.clear();
        true
    }
}

impl Transition<'_> {
    /// The monitored functions, independent of the modes.
    pub(crate) fn frozen_functions(&self) -> Vec<Frozen> {
        let mut all = Vec::new();
        for index in 0..self.front.phases.len() {
            if self.mechanism.torque(index).is_some() {
                all.extend([Frozen::Cone(index), Frozen::Slip(index)]);
            } else if self.surfaces[index].is_some() {
                all.push(Frozen::Gap(index));
                if self.ends(index) {
                    all.push(Frozen::End(index));
                }
                all.extend([Frozen::Normal(index), Frozen::Cone(index), Frozen::Slip(index)]);
            }
        }
        if !all.is_empty() {
            all.push(Frozen::Jam);
        }
        all
    }

    /// Evaluates a state in the modes of the front. Slip against its direction, which an integration produces
    /// beyond an event, keeps its previous friction, so that the rates are smooth there.
    pub(crate) fn frozen(&self, state: &State<'_>) -> Result<Evaluation, Failure> {
        let mut closed = self.closed();
        for contact in &mut closed {
            // Directions that follow from the state were computed in the step that led here.
            (contact.omega, contact.turning) = (None, None);
        }
        let mut y = [state.coordinates, state.speeds].concat();
        y.resize(y.len() + WORKS, 0.0);
        let boundless = vec![BOUNDLESS; state.speeds.len()];
        let motion = Motion { held: state.inputs, scale: &boundless, ..self.motion(&closed) };
        motion.evaluate(state.time, &y)
    }

    /// The values of the monitored functions.
    pub(crate) fn frozen_values(&self, state: &State<'_>) -> Result<Vec<f64>, Failure> {
        let closed = self.closed();
        let all = self.frozen_functions();
        let place = |index: usize| closed.iter().position(|closed| closed.contact == index);
        let found = if closed.is_empty() { None } else { Some(self.frozen(state)) };
        let (mut conditions, mut jam) = (Margins::new(), 1.0);
        let mut here = None;
        match found {
            Some(Ok(evaluation)) => {
                if let Some(forces) = &evaluation.forces {
                    conditions = margins(forces, &evaluation.holds, &mus(&closed));
                    jam = forces.f - JAM;
                }
                here = Some(evaluation);
            }
            // There are no forces in these modes.
            Some(Err(Failure::Contact(..) | Failure::NoForces)) => jam = -1.0,
            Some(Err(failure)) => return Err(failure),
            None => {}
        }
        let slip = |index: usize| -> Option<f64> {
            let (place, here) = (place(index)?, here.as_ref()?);
            let begins = BEGINS * here.support.velocity_size(place, &self.front.scale);
            Some(here.support.slip(place).dot(&closed[place].slides?) + begins)
        };
        let value = |what: &Frozen| -> Result<f64, Failure> {
            Ok(match *what {
                Frozen::Gap(index) => match self.front.phases[index] {
                    Phase::Open(leaving) => {
                        let gap = self.mechanism.gap(index, state)?.unwrap_or(1.0);
                        match leaving {
                            // A closed contact holds its place.
                            Leaving::Apart | Leaving::Near if self.is_held(index).unwrap_or(false) => 1.0,
                            // A contact that comes along the surface of its face has a gap of rounding errors
                            // only.
                            Leaving::Apart | Leaving::Near if self.ends(index) => {
                                (gap - self.low()).max(-self.validity(index, state)?)
                            }
                            Leaving::Apart | Leaving::Near => gap,
                            // The gap of a contact that lifts off is not yet larger than its rounding error.
                            _ => (gap + self.lifted()).max(-self.validity(index, state)?),
                        }
                    }
                    _ => 1.0,
                },
                Frozen::End(index) => match place(index) {
                    Some(_) => self.validity(index, state)?,
                    None => 1.0,
                },
                Frozen::Normal(index) => {
                    place(index).and_then(|place| conditions.get(place)).map_or(1.0, |margins| margins[0])
                }
                Frozen::Cone(index) => {
                    place(index).and_then(|place| conditions.get(place)).map_or(1.0, |margins| margins[1])
                }
                Frozen::Slip(index) => slip(index).unwrap_or(1.0),
                Frozen::Jam => jam,
            })
        };
        all.iter().map(value).collect()
    }

    /// The gap from which on a contact that lifts off counts as open, m.
    fn lifted(&self) -> f64 {
        LIFTED * self.front.scales.length
    }

    /// Sets the front to a state.
    pub(crate) fn goes_to(&mut self, state: &State<'_>) {
        let n = state.coordinates.len();
        self.front.t = state.time;
        self.front.y[..n].copy_from_slice(state.coordinates);
        self.front.y[n..n + state.speeds.len()].copy_from_slice(state.speeds);
        for (scale, speed) in self.front.scale.iter_mut().zip(state.speeds) {
            *scale = scale.max(speed.abs());
        }
        if let Ok(kinetic) = self.mechanism.kinetic_energy(state) {
            self.front.greatest = self.front.greatest.max(kinetic);
        }
    }

    /// Contacts that lifted off count as open once their gaps are open, and slip that goes forward takes its
    /// present direction.
    fn frozen_modes(&mut self, state: &State<'_>) -> Result<(), SimulationError> {
        for contact in 0..self.front.phases.len() {
            if let Phase::Open(Leaving::Bounced | Leaving::Lifted { .. }) = self.front.phases[contact]
                && self.surfaces[contact].is_some()
            {
                let gap = self.mechanism.gap(contact, state);
                let gap = gap.map_err(|error| self.failure(Failure::State(error)))?.unwrap_or(1.0);
                if gap > self.lifted() {
                    self.front.phases[contact] = Phase::Open(Leaving::Apart);
                }
            }
        }
        let closed = self.closed();
        if closed.iter().any(|closed| closed.slides.is_some()) {
            // A state near a jam may have no forces; then directions stay.
            if let Ok(here) = self.frozen(state) {
                for (contact, hold) in closed.iter().zip(&here.holds) {
                    if let Some(direction) = hold.direction() {
                        self.front.phases[contact.contact] = Phase::Slide(direction);
                    }
                }
            }
        }
        Ok(())
    }
}
