//! [`Simulation`]: a motion from a start state on.

use std::collections::VecDeque;

use hodograph::{Contacts, Kind, State, Surface};
use nalgebra::Vector3;

use crate::motion::{Failure, Motion, WORKS};
use crate::phase::{Closed, ContactPhase, Leaving, Modes, Phase};
use crate::stepper::Step;
use crate::{Drive, EnergyAccount, Event, Options, Reason, SimulationError};

/// A simulation of a mechanism's motion, advanced on demand. Clones continue independently, with the same
/// results.
///
/// Steps of the integration and times of events do not depend on the times to which the simulation is
/// advanced.
#[derive(Clone)]
pub struct Simulation<'m> {
    pub(crate) mechanism: &'m dyn Contacts<f64>,
    pub(crate) options: Options,
    pub(crate) surfaces: Vec<Option<Surface<f64>>>,
    pub(crate) phases: Vec<Phase>,
    /// force of each contact when its mode was last decided
    pub(crate) forces: Vec<Vector3<f64>>,
    /// weight of each contact where forces are not unique: the same from one decision to the next
    pub(crate) weights: Vec<f64>,
    /// rate at which the direction of small slip turns where it follows from the state
    pub(crate) omegas: Vec<Option<f64>>,
    /// whether the forces of the closed contacts were the only possible ones
    pub(crate) unique: bool,
    /// time, coordinates, speeds and works at the front: the end of the last step, after its events
    pub(crate) t: f64,
    pub(crate) y: Vec<f64>,
    pub(crate) held: Vec<f64>,
    pub(crate) step: Option<Step>,
    /// the modes during that step
    pub(crate) past: Modes,
    pub(crate) next: f64,
    pub(crate) queue: VecDeque<Event>,
    /// contacts whose bounces end at a time
    pub(crate) chatter: Vec<(f64, usize)>,
    pub(crate) next_sample: Option<f64>,
    pub(crate) samples: u64,
    pub(crate) start: f64,
    pub(crate) resting: bool,
    /// greatest size of each speed so far
    pub(crate) scale: Vec<f64>,
    pub(crate) energy: EnergyAccount,
    /// greatest kinetic energy so far
    pub(crate) greatest: f64,
    /// events at this time, and the time
    pub(crate) crowd: (usize, f64),
    view: (f64, Vec<f64>),
    failed: Option<SimulationError>,
}

impl std::fmt::Debug for Simulation<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("Simulation")
            .field("mechanism", &self.mechanism.name())
            .field("t", &self.t)
            .field("phases", &self.phases)
            .finish_non_exhaustive()
    }
}

/// Numbers of contacts and their forces (n, t, s), N.
pub type ContactForces = Vec<(usize, Vector3<f64>)>;

/// How far [`Simulation::advance`] came.
#[derive(Clone, Debug)]
pub enum Progress {
    /// An event, not later than the time asked for.
    Event(Event),
    /// The time asked for: the simulation's state is the state then.
    Reached,
}

impl<'m> Simulation<'m> {
    /// A simulation that begins in this state. Bodies that touch and approach there collide at once; bodies
    /// that touch and do not approach are in contact.
    ///
    /// # Errors
    ///
    /// An option or the state is wrong: a surface is missing or impossible, a contact begins with a negative
    /// gap, the mechanism cannot be evaluated in the state, or the first sample of the inputs is not
    /// finite.
    pub fn new(
        mechanism: &'m dyn Contacts<f64>,
        state: &State<'_>,
        options: Options,
    ) -> Result<Self, SimulationError> {
        let (n, p) = (mechanism.count(Kind::Coordinate), mechanism.count(Kind::Speed));
        let count = mechanism.count(Kind::Contact);
        let mut y = state.coordinates.to_vec();
        y.extend_from_slice(state.speeds);
        y.resize(n + p + WORKS, 0.0);
        let mut simulation = Self {
            mechanism,
            surfaces: Vec::new(),
            phases: vec![Phase::Open(Leaving::Apart); count],
            forces: vec![Vector3::zeros(); count],
            weights: vec![1.0; count],
            omegas: vec![None; count],
            unique: true,
            t: state.time,
            view: (state.time, y.clone()),
            y,
            held: state.inputs.to_vec(),
            step: None,
            past: Modes::default(),
            next: 1e-3,
            queue: VecDeque::new(),
            chatter: Vec::new(),
            next_sample: match &options.drive {
                Drive::Sampled { .. } => Some(state.time),
                _ => None,
            },
            samples: 0,
            start: state.time,
            resting: false,
            scale: state.speeds.iter().map(|speed| speed.abs()).collect(),
            energy: EnergyAccount::default(),
            greatest: 0.0,
            crowd: (0, f64::NEG_INFINITY),
            failed: None,
            options,
        };
        simulation.check(state)?;
        // The inputs of the first sample decide what contacts do at the start.
        simulation.sample()?;
        simulation.begin()?;
        simulation.view = (simulation.t, simulation.y.clone());
        Ok(simulation)
    }

    /// Advances to the next event or to the time `until` (s), whichever comes first.
    ///
    /// # Errors
    ///
    /// The simulation cannot continue; the error has the reason, the time and the contact. Earlier states and
    /// events remain available: advance to an earlier time. A time that is not finite is refused, and
    /// nothing changes.
    pub fn advance(&mut self, until: f64) -> Result<Progress, SimulationError> {
        if until.is_nan() || until == f64::INFINITY {
            return Err(
                self.error(None, Reason::Option(format!("the time asked for is {until}: it must be finite")))
            );
        }
        loop {
            if self.queue.front().is_some_and(|event| event.time <= until)
                && let Some(event) = self.queue.pop_front()
            {
                let mut y = event.coordinates.clone();
                y.extend_from_slice(&event.speeds);
                y.resize(self.y.len(), 0.0);
                self.view = (event.time, y);
                return Ok(Progress::Event(event));
            }
            if self.t >= until {
                self.look(until);
                return Ok(Progress::Reached);
            }
            if let Some(error) = &self.failed {
                return Err(error.clone());
            }
            if let Err(error) = self.proceed() {
                self.failed = Some(error);
            }
        }
    }

    /// Advances to a time (s) and returns the events until then.
    ///
    /// # Errors
    ///
    /// As [`Simulation::advance`]. The events before the error are lost; use [`Simulation::advance`] to keep
    /// them.
    pub fn advance_to(&mut self, time: f64) -> Result<Vec<Event>, SimulationError> {
        let mut events = Vec::new();
        loop {
            match self.advance(time)? {
                Progress::Event(event) => events.push(event),
                Progress::Reached => return Ok(events),
            }
        }
    }

    /// Looks at the state at a time in the last step.
    fn look(&mut self, time: f64) {
        if time >= self.t {
            self.view = (self.t, self.y.clone());
            return;
        }
        if let Some(y) = self.within_step(time) {
            self.view = (time, y);
            return;
        }
        let between = |step: &mut Step| step.at((time - step.t) / step.h);
        if let Some(y) = self.step.as_mut().map(between) {
            self.view = (time, y);
        }
        // Integration lets quaternions drift.
        let n = self.mechanism.count(Kind::Coordinate);
        let _ = self.mechanism.normalize(&mut self.view.1[..n]);
    }

    /// The time to which the simulation was advanced, s.
    pub fn time(&self) -> f64 {
        self.view.0
    }

    /// Coordinates at [`Simulation::time`].
    pub fn coordinates(&self) -> &[f64] {
        &self.view.1[..self.mechanism.count(Kind::Coordinate)]
    }

    /// Independent speeds at [`Simulation::time`].
    pub fn speeds(&self) -> &[f64] {
        let n = self.mechanism.count(Kind::Coordinate);
        &self.view.1[n..n + self.mechanism.count(Kind::Speed)]
    }

    /// The inputs at the end of the last step.
    pub fn inputs(&self) -> &[f64] {
        &self.held
    }

    /// The phase of a contact after the last event. It may belong to a time later than [`Simulation::time`],
    /// by less than a step of the integration.
    pub fn phase(&self, contact: usize) -> Option<ContactPhase> {
        self.phases.get(contact).map(|phase| match phase {
            Phase::Open(_) => ContactPhase::Open,
            Phase::Stick => ContactPhase::Stick,
            Phase::Slide(_) => ContactPhase::Slide,
        })
    }

    /// Forces of the closed contacts at [`Simulation::time`], along n, t, s of their contact bases, N, and
    /// whether these forces are unique.
    ///
    /// # Errors
    ///
    /// The forces cannot be evaluated.
    pub fn contact_forces(&self) -> Result<(ContactForces, bool), SimulationError> {
        let closed = self.closed();
        if closed.is_empty() {
            return Ok((Vec::new(), true));
        }
        let motion = self.motion(&closed);
        let evaluation =
            motion.evaluate(self.view.0, &self.view.1).map_err(|failure| self.failure(failure))?;
        let forces = evaluation.forces.map_or(Vec::new(), |forces| {
            closed.iter().enumerate().map(|(i, closed)| (closed.contact, forces.of(i))).collect()
        });
        Ok((forces, self.unique))
    }

    /// The energy account since the start, at the end of the last step.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be evaluated.
    pub fn energy(&self) -> Result<EnergyAccount, SimulationError> {
        let motion = self.motion(&[]);
        let (q, u) = motion.split(&self.y);
        let state = State { time: self.t, coordinates: q, speeds: u, inputs: &self.held };
        let works = &self.y[q.len() + u.len()..];
        let fault = |error| self.failure(Failure::State(error));
        Ok(EnergyAccount {
            kinetic: self.mechanism.kinetic_energy(&state).map_err(fault)?,
            potential: self.mechanism.potential_energy(&state).map_err(fault)?,
            friction: works[0],
            inputs: works[1],
            ..self.energy
        })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &'m dyn Contacts<f64> {
        self.mechanism
    }

    /// The closed contacts as the integration needs them.
    pub(crate) fn closed(&self) -> Vec<Closed> {
        self.phases
            .iter()
            .enumerate()
            .filter_map(|(contact, phase)| {
                let slides = match phase {
                    Phase::Open(_) => return None,
                    Phase::Stick => None,
                    Phase::Slide(direction) => Some(*direction),
                };
                Some(Closed {
                    contact,
                    mu: self.mu(contact),
                    weight: self.weights[contact],
                    omega: slides.and(self.omegas[contact]),
                    slides,
                })
            })
            .collect()
    }

    pub(crate) fn mu(&self, contact: usize) -> f64 {
        self.surfaces.get(contact).copied().flatten().map_or(0.0, |surface| surface.mu)
    }

    pub(crate) fn motion<'a>(&'a self, closed: &'a [Closed]) -> Motion<'a> {
        Motion {
            mechanism: self.mechanism,
            drive: &self.options.drive,
            held: &self.held,
            closed,
            resting: self.resting,
        }
    }

    /// An error here and now.
    pub(crate) fn error(&self, contact: Option<usize>, reason: Reason) -> SimulationError {
        let name = |index| self.mechanism.component(Kind::Contact, index);
        SimulationError {
            time: self.t,
            contact: contact.and_then(name).map(|component| component.name.to_owned()),
            reason,
        }
    }

    pub(crate) fn failure(&self, failure: Failure) -> SimulationError {
        match failure {
            Failure::State(error) => self.error(None, Reason::State(error)),
            Failure::Contact(contact, error) => self.error(Some(contact), Reason::Contact(error)),
            Failure::Together => self.error(
                None,
                Reason::Forces(
                    "the contacts that are closed have no forces under which they keep their modes"
                        .to_owned(),
                ),
            ),
            Failure::Input(message) => self.error(None, Reason::Input(message)),
        }
    }
}
