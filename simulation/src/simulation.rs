//! [`Simulation`]: a motion from a start state.

use std::collections::VecDeque;

use hodograph::{ComponentKind, Contacts, State};
use nalgebra::Vector3;

use crate::closed::angles::Angles;
use crate::closed::lengths::Lengths;
use crate::closed::pair::Pair;
use crate::closed::phase::{ContactPhase, Modes};
use crate::closed::scales::Scales;
use crate::closed::torques::{Lacking, Torque, Turning, WithTorques, torques};
use crate::integration::motion::{Failure, WORKS};
use crate::integration::stepper::Step;
use crate::state::check::check;
use crate::state::front::Front;
use crate::state::smooth_parts::{Parts, SmoothPart};
use crate::state::transition::Transition;
use crate::{Drive, EnergyAccount, ErrorKind, Event, EventKind, Options, SimulationError};

/// A simulation of a mechanism's motion, advanced on demand. Clones continue independently, with the same
/// results.
///
/// Steps of the integration and times of events do not depend on the times to which the simulation is
/// advanced.
#[derive(Clone)]
pub struct Simulation<'m> {
    mechanism: &'m dyn Contacts<f64>,
    /// the angular speeds and coordinates
    angles: Angles,
    /// the units of the coordinates
    lengths: Lengths,
    /// torques of rolling and spinning friction
    torques: Vec<Torque>,
    pub(crate) options: Options,
    /// the surfaces of each contact; `None` for a contact without a gap
    surfaces: Vec<Option<Pair>>,
    start: f64,
    pub(crate) front: Front,
    /// the steps of the last transition, the last of which ends at the front, and the modes during each
    pub(crate) steps: Vec<(Step, Modes)>,
    /// events that have not been returned yet
    pub(crate) queue: VecDeque<Event>,
    /// the requested time, and the state then
    pub(crate) view: (f64, Vec<f64>),
    pub(crate) failed: Option<SimulationError>,
    /// the smooth parts, if they are recorded
    parts: Option<Parts>,
    /// the works of impacts before those at the end of the last steps, J
    impacts_before: f64,
}

impl std::fmt::Debug for Simulation<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.debug_struct("Simulation")
            .field("mechanism", &self.mechanism.name())
            .field("t", &self.front.t)
            .field("phases", &self.front.phases)
            .finish_non_exhaustive()
    }
}

/// The message about a mechanism that does not provide the relative rotation at a contact.
const NO_ROTATION: &str = "it has rolling or spinning friction, but the equations of the mechanism do not hold the relative rotation of the two bodies there: state `rolling: 0` or `spinning: 0`, or more, in the surface of this contact in the model, and derive it anew";

/// Indices of contacts and their forces (n, t, s), N.
pub type ContactForces = Vec<(usize, Vector3<f64>)>;

/// The result of [`Simulation::advance`].
#[derive(Clone, Debug)]
pub enum Progress {
    /// An event, not later than the requested time.
    Event(Event),
    /// The requested time is reached: the state of the simulation is that at this time.
    Reached,
}

impl<'m> Simulation<'m> {
    /// A simulation that starts in this state. Touching bodies that approach collide immediately; other
    /// touching bodies are in contact.
    ///
    /// # Errors
    ///
    /// An option or the state is invalid: a surface is missing or impossible, a contact starts with a
    /// negative gap, the mechanism cannot be evaluated in the state, or the first sample of the inputs is not
    /// finite.
    pub fn new(
        mechanism: &'m dyn Contacts<f64>,
        state: &State<'_>,
        options: Options,
    ) -> Result<Self, SimulationError> {
        let mut surfaces = check(mechanism, state, &options)?;
        let torques = torques(mechanism, &surfaces, state).map_err(|(contact, lacking)| {
            let kind = match lacking {
                Lacking::Rotation => ErrorKind::BadOption(NO_ROTATION.to_owned()),
                Lacking::State(error) => ErrorKind::State(error),
            };
            SimulationError::new(mechanism, state.time, Some(contact), kind)
        })?;
        // A torque has no gap.
        surfaces.resize(surfaces.len() + torques.len(), None);
        // Lengths and speeds of the problem are those with the inputs that there are.
        let mut inputs = state.inputs.to_vec();
        if let Drive::Continuous(function) = &options.drive {
            function(state.time, state.coordinates, state.speeds, &mut inputs);
            if inputs.iter().any(|input| !input.is_finite()) {
                inputs.copy_from_slice(state.inputs);
            }
        }
        let state = &State { inputs: &inputs, ..*state };
        let sampled = matches!(options.drive, Drive::Sampled { .. } | Drive::Table(_));
        let (angles, lengths) = (Angles::of(mechanism), Lengths::of(mechanism));
        let scales = Scales::of(mechanism, (&angles, &lengths), state);
        let mut front = Front::new(state, surfaces.len(), sampled, scales);
        front.greatest = mechanism.kinetic_energy(state).unwrap_or(0.0);
        let view = (front.t, front.y.clone());
        let mut simulation = Self {
            mechanism,
            angles,
            lengths,
            torques,
            options,
            surfaces,
            start: state.time,
            front,
            steps: Vec::new(),
            queue: VecDeque::new(),
            view,
            failed: None,
            parts: None,
            impacts_before: 0.0,
        };
        // The inputs of the first sample determine the modes of the contacts at the start.
        let inputs = simulation.sampled_inputs()?;
        simulation.take(|transition| {
            if let Some(inputs) = inputs {
                transition.front.held = inputs;
            }
            transition.begin()
        })?;
        simulation.view = (simulation.front.t, simulation.front.y.clone());
        Ok(simulation)
    }

    fn with_torques(&self) -> WithTorques<'_> {
        WithTorques::new(self.mechanism, &self.torques)
    }

    /// A transition that starts from the front.
    pub(crate) fn transition(&self) -> Transition<'_> {
        Transition {
            mechanism: self.with_torques(),
            angles: &self.angles,
            lengths: &self.lengths,
            options: &self.options,
            surfaces: &self.surfaces,
            front: self.front.clone(),
            events: Vec::new(),
            steps: Vec::new(),
            reached: None,
            parts: self.parts.as_ref().map(|_| Parts::default()),
        }
    }

    /// Performs a transition and accepts its front and its events. If it fails, only the step up to its event
    /// is accepted, if there is one.
    pub(crate) fn take(
        &mut self,
        change: impl FnOnce(&mut Transition<'_>) -> Result<(), SimulationError>,
    ) -> Result<(), SimulationError> {
        let mut transition = self.transition();
        let done = change(&mut transition);
        let Transition { front, events, mut steps, reached, parts: later, .. } = transition;
        if let (Some(parts), Some(later)) = (&mut self.parts, later)
            && (done.is_ok() || reached.is_some())
        {
            parts.follow(later);
        }
        if let Err(error) = done {
            if let Some(front) = reached {
                steps.retain(|(step, _)| step.t + step.h <= front.t);
                self.impacts_before = self.front.energy.impacts;
                (self.front, self.steps) = (front, steps);
            }
            return Err(error);
        }
        let impacts = std::mem::replace(&mut self.front, front).energy.impacts;
        self.queue.extend(events);
        if !steps.is_empty() {
            (self.steps, self.impacts_before) = (steps, impacts);
        }
        Ok(())
    }

    /// Makes one step, with the inputs of the controller if its sampling time has come.
    fn proceed(&mut self) -> Result<(), SimulationError> {
        if let Some(contact) = self.front.ended {
            return Err(self.transition().error(Some(contact), ErrorKind::Singular));
        }
        if let Some(inputs) = self.sampled_inputs()? {
            self.take(|transition| transition.change_inputs(inputs))?;
        }
        self.take(|transition| transition.step())
    }

    /// Calls the controller if its sampling time has come.
    fn sampled_inputs(&mut self) -> Result<Option<Vec<f64>>, SimulationError> {
        let front = &mut self.front;
        if front.next_sample.is_none_or(|due| due > front.t) {
            return Ok(None);
        }
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let (period, inputs) = match &mut self.options.drive {
            Drive::Sampled { period, controller } => {
                let mut inputs = front.held.clone();
                controller.control(front.t, &front.y[..n], &front.y[n..n + p], &mut inputs);
                (*period, inputs)
            }
            Drive::Table(samples) => (samples.period, samples.from(front.samples as usize).to_vec()),
            Drive::Held | Drive::Continuous(_) => return Ok(None),
        };
        front.samples += 1;
        // After its last row a table has no more.
        let ended = matches!(&self.options.drive, Drive::Table(samples) if front.samples >= samples.values.len() as u64);
        front.next_sample = (!ended).then_some(self.start + period * front.samples as f64);
        if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
            let transition = self.transition();
            let message = transition.motion(&[]).bad_input(bad, inputs[bad]);
            return Err(transition.error(None, ErrorKind::BadInput(message)));
        }
        Ok(Some(inputs))
    }

    /// Advances to the next event or to the time `until` (s), whichever comes first.
    ///
    /// # Errors
    ///
    /// The simulation cannot continue; the error has the reason, the time and the contact. Events and states
    /// before that time remain available: advance to it. A motion that ends by itself returns the event
    /// [`crate::EventKind::Singular`]; advancing further is the error [`ErrorKind::Singular`]. A time that is
    /// not finite, and one before the last step, whose states are not kept, is refused, and nothing changes.
    pub fn advance(&mut self, until: f64) -> Result<Progress, SimulationError> {
        let refused = |what: String| {
            let what = format!("the time asked for is {until}{what}");
            Err(self.transition().error(None, ErrorKind::BadOption(what)))
        };
        if !until.is_finite() {
            return refused(": it must be finite".to_owned());
        }
        let kept = self.steps.first().map_or(self.front.t, |(step, _)| step.t);
        if until < kept {
            if until == self.view.0 {
                return Ok(Progress::Reached);
            }
            return refused(format!(" s: states before {kept} s are not kept"));
        }
        loop {
            if self.queue.front().is_some_and(|event| event.time <= until)
                && let Some(event) = self.queue.pop_front()
            {
                let mut y = event.coordinates.clone();
                y.extend_from_slice(&event.speeds);
                y.extend_from_slice(&self.works_at(event.time));
                self.view = (event.time, y);
                return Ok(Progress::Event(event));
            }
            if self.front.t >= until {
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

    /// Advances to a time (s) and returns the events until then. If the motion ends earlier (with
    /// [`crate::EventKind::Singular`] as the last event), it is simulated up to its end.
    ///
    /// # Errors
    ///
    /// Those of [`Simulation::advance`]. The events before the error are lost; use [`Simulation::advance`] to
    /// keep them.
    pub fn advance_to(&mut self, time: f64) -> Result<Vec<Event>, SimulationError> {
        let mut events = Vec::new();
        loop {
            match self.advance(time)? {
                Progress::Event(event) => {
                    let ends = matches!(event.kind, EventKind::Singular);
                    events.push(event);
                    if ends {
                        return Ok(events);
                    }
                }
                Progress::Reached => return Ok(events),
            }
        }
    }

    /// The step in which a time before the front lies, and its modes.
    fn step_at(&self, time: f64) -> Option<&(Step, Modes)> {
        self.steps.iter().rfind(|(step, _)| step.t <= time).or(self.steps.first())
    }

    /// The works of friction and of inputs up to a time in the last steps.
    fn works_at(&self, time: f64) -> [f64; WORKS] {
        let of = |y: &[f64]| std::array::from_fn(|work| y[y.len() - WORKS + work]);
        match self.step_at(time) {
            Some((step, _)) if time < self.front.t && step.h > 0.0 => of(&step.at((time - step.t) / step.h)),
            _ => of(&self.front.y),
        }
    }

    /// Evaluates the state at a time in the last steps.
    fn look(&mut self, time: f64) {
        let state = match self.step_at(time) {
            _ if time >= self.front.t => Some(self.front.y.clone()),
            None => None,
            Some((step, modes)) => {
                let transition = self.transition();
                transition
                    .within_step(step, modes, time)
                    .or_else(|| Some(step.at((time - step.t) / step.h).to_vec()))
            }
        };
        if let Some(state) = state {
            self.view = (time.min(self.front.t), state);
        }
        // Quaternions drift during a step.
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let _ = self.mechanism.normalise(&mut self.view.1[..n]);
    }

    /// The time to which the simulation was advanced, s.
    pub fn time(&self) -> f64 {
        self.view.0
    }

    /// Coordinates at [`Simulation::time`].
    pub fn coordinates(&self) -> &[f64] {
        &self.view.1[..self.mechanism.count(ComponentKind::Coordinate)]
    }

    /// Independent speeds at [`Simulation::time`].
    pub fn speeds(&self) -> &[f64] {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        &self.view.1[n..n + self.mechanism.count(ComponentKind::Speed)]
    }

    /// The inputs at the end of the last step.
    pub fn inputs(&self) -> &[f64] {
        &self.front.held
    }

    /// Whether the mechanism is at rest at [`Simulation::time`]: all closed contacts stick, and every rate is
    /// zero.
    pub fn is_at_rest(&self) -> bool {
        match self.step_at(self.view.0) {
            Some((_, modes)) if self.view.0 < self.front.t => modes.resting,
            _ => self.front.resting,
        }
    }

    /// Moves the state to the end of the last step, the latest time that was computed.
    pub(crate) fn look_at_front(&mut self) {
        self.look(self.front.t);
    }

    /// The phase of a contact at [`Simulation::time`], after the events that happen then.
    pub fn phase(&self, contact: usize) -> Option<ContactPhase> {
        let own = self.with_torques().torque(contact).is_none();
        self.phase_now(contact).filter(|_| own)
    }

    /// Whether the bodies roll relative to each other against rolling friction, at [`Simulation::time`]:
    /// `Slide` if they do, `Stick` if it holds them. `None` if the contact has no rolling friction.
    pub fn rolling_phase(&self, contact: usize) -> Option<ContactPhase> {
        self.phase_of_torque(contact, Turning::Rolling)
    }

    /// Like [`Simulation::rolling_phase`], for rotation about the normal.
    pub fn spinning_phase(&self, contact: usize) -> Option<ContactPhase> {
        self.phase_of_torque(contact, Turning::Spinning)
    }

    fn phase_of_torque(&self, contact: usize, turning: Turning) -> Option<ContactPhase> {
        let all = self.with_torques();
        let is_it = |torque: &usize| all.torque(*torque).is_some_and(|torque| torque.turning == turning);
        let torque = all.torques_of(&[contact]).find(is_it)?;
        self.phase_now(torque)
    }

    /// The phase of a contact or torque at [`Simulation::time`]; within a step the modes are those before its
    /// event.
    fn phase_now(&self, index: usize) -> Option<ContactPhase> {
        let phase = self.front.phases.get(index)?;
        if self.view.0 < self.front.t
            && let Some((_, modes)) = self.step_at(self.view.0)
        {
            let closed = modes.closed.iter().find(|closed| closed.contact == index);
            return Some(closed.map_or(ContactPhase::Open, |closed| match closed.slides {
                Some(_) => ContactPhase::Slide,
                None => ContactPhase::Stick,
            }));
        }
        Some(phase.of_contact())
    }

    /// Forces of the closed contacts at [`Simulation::time`], along n, t, s of their contact bases, N, and
    /// whether these forces are unique.
    ///
    /// # Errors
    ///
    /// The forces cannot be evaluated.
    pub fn contact_forces(&self) -> Result<(ContactForces, bool), SimulationError> {
        let (mut forces, unique) = self.closed_forces()?;
        let all = self.with_torques();
        forces.retain(|(contact, _)| all.torque(*contact).is_none());
        Ok((forces, unique))
    }

    /// Torques of rolling and spinning friction at [`Simulation::time`], along n, t, s of the contact bases,
    /// N m, on the striking bodies, for closed contacts with such friction. They are unique if the forces
    /// are.
    ///
    /// # Errors
    ///
    /// The torques cannot be evaluated.
    pub fn contact_torques(&self) -> Result<ContactForces, SimulationError> {
        let mut torques = ContactForces::new();
        let all = self.with_torques();
        for (contact, force) in self.closed_forces()?.0 {
            let Some(torque) = all.torque(contact) else { continue };
            let own = torque.torque(&force);
            match torques.iter_mut().find(|(contact, _)| *contact == torque.contact) {
                Some((_, sum)) => *sum += own,
                None => torques.push((torque.contact, own)),
            }
        }
        Ok(torques)
    }

    /// Forces of the closed contacts and their torques.
    fn closed_forces(&self) -> Result<(ContactForces, bool), SimulationError> {
        let mut transition = self.transition();
        let mut closed = transition.closed();
        if self.view.0 < self.front.t
            && let Some((_, modes)) = self.step_at(self.view.0)
        {
            // The front may be after an event: within the step the modes were those before it.
            closed.clone_from(&modes.closed);
            transition.front.held.clone_from(&modes.held);
            transition.front.resting = modes.resting;
        }
        if closed.is_empty() {
            return Ok((Vec::new(), true));
        }
        let motion = transition.motion(&closed);
        let evaluation =
            motion.evaluate(self.view.0, &self.view.1).map_err(|failure| transition.failure(failure))?;
        let Some(forces) = evaluation.forces else { return Ok((Vec::new(), true)) };
        let unique = forces.unique;
        let forces = closed.iter().enumerate().map(|(i, closed)| (closed.contact, forces.of(i))).collect();
        Ok((forces, unique))
    }

    /// The energy account from the start to [`Simulation::time`], with the impacts at that time.
    ///
    /// # Errors
    ///
    /// The mechanism cannot be evaluated.
    pub fn energy(&self) -> Result<EnergyAccount, SimulationError> {
        let mut transition = self.transition();
        let (time, y) = &self.view;
        let mut impacts = self.front.energy.impacts;
        if *time < self.front.t {
            impacts = self.impacts_before;
            if let Some((_, modes)) = self.step_at(*time) {
                transition.front.held.clone_from(&modes.held);
            }
        }
        let motion = transition.motion(&[]);
        let (coordinates, speeds) = motion.split(y);
        let inputs = motion.inputs(*time, y).map_err(|failure| transition.failure(failure))?;
        let state = State { time: *time, coordinates, speeds, inputs: &inputs };
        let works = &y[coordinates.len() + speeds.len()..];
        let fault = |error| transition.failure(Failure::State(error));
        Ok(EnergyAccount {
            kinetic: self.mechanism.kinetic_energy(&state).map_err(fault)?,
            potential: self.mechanism.potential_energy(&state).map_err(fault)?,
            friction: works[0],
            inputs: works[1],
            impacts,
        })
    }

    /// From now on records the smooth parts of the motion: [`Simulation::take_parts`].
    pub fn keep_parts(&mut self) {
        self.parts.get_or_insert_default();
    }

    /// Returns the smooth parts since they were recorded or last returned, in order. The last one may end
    /// after the requested time.
    pub fn take_parts(&mut self) -> Vec<SmoothPart> {
        self.parts.as_mut().map_or_else(Vec::new, Parts::take)
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &'m dyn Contacts<f64> {
        self.mechanism
    }
}
