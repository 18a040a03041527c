//! An instantiated unit: its values, its mode, and its motion.

use std::sync::Arc;

use hodograph::{Contacts, Law, StateError, Surface};
use hodograph_simulation::{Options, Progress, Simulation};
use serde::{Deserialize, Serialize};

use crate::derivative::directional;
use crate::layout::{Defaults, Layout, VariableKind, close_loops};
use crate::running::Running;
use crate::settings::{Now, Settings};
use crate::values::Values;
use crate::words::{Told, not_finite};

/// The kind of use of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// the importer integrates
    ModelExchange,
    /// the unit integrates
    CoSimulation,
}

/// The state of a unit in the state machine of the standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    Instantiated,
    Initialization,
    Event,
    ContinuousTime,
    Step,
    Terminated,
}

/// The states in which there is a motion.
const ONCE_BEGUN: [Mode; 5] =
    [Mode::Initialization, Mode::Event, Mode::ContinuousTime, Mode::Step, Mode::Terminated];

/// The reason why a call is refused or fails, in a sentence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal(pub String);

impl From<String> for Refusal {
    fn from(message: String) -> Self {
        Self(message)
    }
}

pub fn refused<R>(message: impl Into<String>) -> Result<R, Refusal> {
    Err(Refusal(message.into()))
}

/// The results of [`Instance::update_discrete_states`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Updated {
    /// the motion has ended
    pub terminates: bool,
    /// whether states have changed
    pub states_changed: bool,
    /// the time of the next event that no indicator announces
    pub next_time: Option<f64>,
}

/// In model exchange, bounces that are lower than this, m, are the last ones, since importers do not detect
/// lower ones.
const MIN_BOUNCE: f64 = 1e-9;
/// The time of a communication point may deviate by this part.
const SAME_TIME: f64 = 1e-9;

/// A unit.
pub struct Instance {
    pub(crate) layout: Arc<Layout>,
    pub(crate) defaults: Defaults,
    /// creates the mechanism with the parameters of the model
    pub(crate) make: fn() -> Box<dyn Contacts<f64>>,
    pub(crate) kind: Kind,
    pub(crate) mode: Mode,
    pub(crate) settings: Settings,
    pub(crate) now: Now,
    pub(crate) events: u64,
    pub(crate) running: Option<Running>,
}

impl Instance {
    /// A unit after instantiation.
    ///
    /// # Errors
    ///
    /// Those of [`Layout::of`].
    pub fn new(
        make: fn() -> Box<dyn Contacts<f64>>,
        defaults: Defaults,
        kind: Kind,
    ) -> Result<Self, Refusal> {
        let layout = Arc::new(Layout::of(&*make(), &defaults)?);
        let settings = Settings::of(&layout, &defaults);
        let now = settings.start.clone();
        Ok(Self {
            layout,
            defaults,
            make,
            kind,
            mode: Mode::Instantiated,
            settings,
            now,
            events: 0,
            running: None,
        })
    }

    /// The variables.
    pub fn layout(&self) -> &Arc<Layout> {
        &self.layout
    }

    /// The kind of use.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The motion; during the initialization it is started from the values set so far.
    pub(crate) fn running(&mut self) -> Result<&mut Running, Refusal> {
        if self.running.is_none() {
            self.begin()?;
        }
        match &mut self.running {
            Some(running) => Ok(running),
            None => refused("there is no motion"),
        }
    }

    fn begin(&mut self) -> Result<(), Refusal> {
        let Settings { tolerance, max_step, parameters, surfaces, start } = &self.settings;
        let mut mechanism = (self.make)();
        mechanism.set_parameter_values(parameters).map_err(|error| error.told())?;
        let mut now = start.clone();
        let (time, inputs) = (now.time, now.inputs.clone());
        let speeds = now.speeds.clone();
        close_loops(&*mechanism, time, &mut now.coordinates, &speeds, &inputs)?;
        let mut given = Vec::new();
        for &(contact, mu, e, law) in surfaces {
            given.push((contact, Surface { mu, e, law: law_of(law)? }));
        }
        let lowest = if self.kind == Kind::ModelExchange { MIN_BOUNCE } else { 0.0 };
        let options = Options {
            relative_tolerance: *tolerance,
            absolute_tolerance: tolerance.max(lowest),
            max_step: *max_step,
            surfaces: given,
            ..Options::default()
        };
        let running =
            Running::begin(Arc::from(mechanism), &now.state(), options).map_err(|error| error.told())?;
        self.events = 0;
        self.now = now;
        self.running = Some(running);
        // Handle the events at the start.
        self.advance(self.now.time)
    }

    /// Advances the motion to a time and copies its state.
    fn advance(&mut self, until: f64) -> Result<(), Refusal> {
        let (now, events) = (&mut self.now, &mut self.events);
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        running.with(|simulation| {
            loop {
                let progress = simulation.advance_exactly(until);
                take(now, simulation);
                match progress.map_err(|error| error.told())? {
                    Progress::Event(_) => *events += 1,
                    Progress::Reached => return Ok(()),
                }
            }
        })
    }

    /// Reads variables of type `Float64`.
    ///
    /// # Errors
    ///
    /// A value reference does not denote such a variable, or its value cannot be computed.
    pub fn floats(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let kinds = layout.kinds(references, values.len())?;
        for (what, value) in kinds.iter().zip(&mut *values) {
            if let Some(number) = self.setting(*what) {
                *value = number;
            }
        }
        if kinds.iter().all(|what| self.setting(*what).is_some()) {
            return Ok(());
        }
        if self.mode == Mode::Instantiated {
            return refused("values are computed from the initialization on");
        }
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        let mut found = Values::new(running, &self.now);
        for (what, value) in kinds.iter().zip(values) {
            if self.setting(*what).is_none() {
                *value = found.number(*what)?;
            }
        }
        Ok(())
    }

    /// The value of a variable that is not computed.
    fn setting(&self, what: VariableKind) -> Option<f64> {
        let settings = &self.settings;
        let surface = |contact| settings.surfaces.iter().find(|(index, ..)| *index == contact);
        match what {
            VariableKind::Tolerance => Some(settings.tolerance),
            VariableKind::MaxStep => Some(settings.max_step),
            VariableKind::Parameter(index) => settings.parameters.get(index).copied(),
            VariableKind::Mu(contact) => surface(contact).map(|surface| surface.1),
            VariableKind::Restitution(contact) => surface(contact).map(|surface| surface.2),
            _ if self.running.is_some() => None,
            VariableKind::Time => Some(settings.start.time),
            VariableKind::Coordinate(index) if self.mode == Mode::Instantiated => {
                settings.start.coordinates.get(index).copied()
            }
            VariableKind::Speed(index) if self.mode == Mode::Instantiated => {
                settings.start.speeds.get(index).copied()
            }
            VariableKind::Input(index) => settings.start.inputs.get(index).copied(),
            _ => None,
        }
    }

    /// Reads integers: laws, phases, the number of events.
    ///
    /// # Errors
    ///
    /// Those of [`Instance::floats`].
    pub fn integers(&mut self, references: &[u32], values: &mut [i64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        for (what, value) in layout.kinds(references, values.len())?.into_iter().zip(values) {
            *value = match what {
                VariableKind::Law(contact) => {
                    let found = self.settings.surfaces.iter().find(|(index, ..)| *index == contact);
                    found.map_or(0, |surface| surface.3)
                }
                VariableKind::Events if self.mode != Mode::Instantiated => {
                    self.running()?;
                    i64::try_from(self.events).unwrap_or(i64::MAX)
                }
                VariableKind::Phase(contact) if self.mode != Mode::Instantiated => {
                    self.running()?;
                    let Some(running) = &self.running else { return refused("there is no motion") };
                    Values::new(running, &self.now).phase(contact)
                }
                _ => return refused("the variable is not an integer, or not known yet"),
            };
        }
        Ok(())
    }

    /// Sets variables of type `Float64`: parameters and start values before the end of the initialization,
    /// later inputs and, in model exchange, states.
    ///
    /// # Errors
    ///
    /// The variable cannot be set now, or the number is not finite.
    pub fn set_floats(&mut self, references: &[u32], values: &[f64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let kinds = layout.kinds(references, values.len())?;
        let before = matches!(self.mode, Mode::Instantiated | Mode::Initialization);
        for ((&what, &value), &reference) in kinds.iter().zip(values).zip(references) {
            let name = layout.get(reference).map_or("?", |variable| &variable.name);
            let unbounded = what == VariableKind::MaxStep && value == f64::INFINITY;
            if !(value.is_finite() || unbounded) {
                return refused(not_finite(name, value));
            }
            let exchanged =
                self.kind == Kind::ModelExchange && matches!(self.mode, Mode::Event | Mode::ContinuousTime);
            let later = match what {
                VariableKind::Input(_) => self.mode != Mode::Terminated,
                VariableKind::Coordinate(_) | VariableKind::Speed(_) => exchanged,
                _ => false,
            };
            if !before && !later {
                return refused(format!("{name} cannot be set any more"));
            }
            let target = if before { &mut self.settings.start } else { &mut self.now };
            let surface = |surfaces: &mut Vec<(usize, f64, f64, i64)>, contact: usize| {
                surfaces.iter().position(|(index, ..)| *index == contact)
            };
            let place = match what {
                VariableKind::Tolerance => Some(&mut self.settings.tolerance),
                VariableKind::MaxStep => Some(&mut self.settings.max_step),
                VariableKind::Parameter(index) => self.settings.parameters.get_mut(index),
                VariableKind::Mu(contact) => surface(&mut self.settings.surfaces, contact)
                    .map(|place| &mut self.settings.surfaces[place].1),
                VariableKind::Restitution(contact) => surface(&mut self.settings.surfaces, contact)
                    .map(|place| &mut self.settings.surfaces[place].2),
                VariableKind::Input(index) => target.inputs.get_mut(index),
                VariableKind::Coordinate(index) => target.coordinates.get_mut(index),
                VariableKind::Speed(index) => target.speeds.get_mut(index),
                _ => None,
            };
            let Some(place) = place else { return refused(format!("{name} is computed: it cannot be set")) };
            *place = value;
            if before {
                // the motion must be started again
                self.running = None;
            }
        }
        Ok(())
    }

    /// Sets integers: laws of restitution.
    ///
    /// # Errors
    ///
    /// The variable cannot be set, or not any more.
    pub fn set_integers(&mut self, references: &[u32], values: &[i64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        for (what, &value) in layout.kinds(references, values.len())?.into_iter().zip(values) {
            let VariableKind::Law(contact) = what else {
                return refused("of whole numbers only the laws of restitution can be set");
            };
            if !matches!(self.mode, Mode::Instantiated | Mode::Initialization) {
                return refused("the law of restitution cannot be set any more");
            }
            law_of(value)?;
            for surface in self.settings.surfaces.iter_mut().filter(|(index, ..)| *index == contact) {
                surface.3 = value;
            }
            self.running = None;
        }
        Ok(())
    }

    /// Enters the initialization at a start time, s.
    ///
    /// # Errors
    ///
    /// The call is not allowed now.
    pub fn enter_initialization(&mut self, start: f64) -> Result<(), Refusal> {
        self.expect(&[Mode::Instantiated])?;
        if !start.is_finite() {
            return refused(not_finite("the start time", start));
        }
        self.settings.start.time = start;
        self.now.time = start;
        self.running = None;
        self.mode = Mode::Initialization;
        Ok(())
    }

    /// Ends the initialization and starts the motion.
    ///
    /// # Errors
    ///
    /// The motion cannot start with these parameters in this state.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Initialization])?;
        self.running()?;
        self.mode = if self.kind == Kind::CoSimulation { Mode::Step } else { Mode::Event };
        Ok(())
    }

    /// Model exchange: enters event mode.
    ///
    /// # Errors
    ///
    /// The call is not allowed now.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::ContinuousTime])?;
        self.mode = Mode::Event;
        Ok(())
    }

    /// Model exchange: enters continuous-time mode.
    ///
    /// # Errors
    ///
    /// The call is not allowed now.
    pub fn enter_continuous_time(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Event])?;
        self.mode = Mode::ContinuousTime;
        Ok(())
    }

    /// Model exchange: handles the events in the present state.
    ///
    /// # Errors
    ///
    /// The call is not allowed now, or the motion cannot continue.
    pub fn update_discrete_states(&mut self) -> Result<Updated, Refusal> {
        self.expect(&[Mode::Event])?;
        let (now, events) = (&mut self.now, &mut self.events);
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        let before = now.clone();
        running.with(|simulation| {
            let happened =
                simulation.continue_from(&before.state()).map_err(|error| Refusal(error.told()))?;
            *events += happened.len() as u64;
            take(now, simulation);
            let states_changed = before != *now;
            Ok(Updated {
                terminates: simulation.has_ended(),
                states_changed,
                next_time: simulation.next_time(),
            })
        })
    }

    /// Model exchange: the importer has completed an integration step.
    ///
    /// # Errors
    ///
    /// The call is not allowed now, or the mechanism cannot be evaluated.
    pub fn step_completed(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::ContinuousTime])?;
        let state = self.now.state();
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        running.with(|simulation| simulation.step_completed(&state)).map_err(|error| Refusal(error.told()))
    }

    /// Model exchange: sets the time, s.
    ///
    /// # Errors
    ///
    /// The time is not finite, or the call is not allowed now.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime])?;
        if !time.is_finite() {
            return refused(not_finite("the time", time));
        }
        self.now.time = time;
        Ok(())
    }

    /// Reads coordinates, then speeds.
    ///
    /// # Errors
    ///
    /// `states` has another length, or the call is not allowed now.
    pub fn states(&mut self, states: &mut [f64]) -> Result<(), Refusal> {
        self.expect(&ONCE_BEGUN)?;
        self.running()?;
        let all = [&self.now.coordinates[..], &self.now.speeds].concat();
        fill(states, &all)
    }

    /// Model exchange: sets coordinates, then speeds.
    ///
    /// # Errors
    ///
    /// They are not finite, `states` has another length, or the call is not allowed now.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime])?;
        let n = self.now.coordinates.len();
        if states.len() != n + self.now.speeds.len() {
            let (count, found) = (n + self.now.speeds.len(), states.len());
            return refused(StateError::Length { what: "states", expected: count, found }.told());
        }
        if let Some(place) = states.iter().position(|value| !value.is_finite()) {
            let kind =
                if place < n { VariableKind::Coordinate(place) } else { VariableKind::Speed(place - n) };
            let variable = self.layout.variables.iter().find(|variable| variable.kind == kind);
            return refused(not_finite(variable.map_or("a state", |variable| &variable.name), states[place]));
        }
        self.now.coordinates.copy_from_slice(&states[..n]);
        self.now.speeds.copy_from_slice(&states[n..]);
        Ok(())
    }

    /// Reads the rates of the states.
    ///
    /// # Errors
    ///
    /// They cannot be computed, `rates` has another length, or the call is not allowed now.
    pub fn rates(&mut self, rates: &mut [f64]) -> Result<(), Refusal> {
        self.expect(&ONCE_BEGUN)?;
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        fill(rates, Values::new(running, &self.now).rates()?)
    }

    /// Reads the event indicators.
    ///
    /// # Errors
    ///
    /// They cannot be computed, `values` has another length, or the call is not allowed now.
    pub fn indicators(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        self.expect(&ONCE_BEGUN)?;
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        fill(values, Values::new(running, &self.now).indicators()?)
    }

    /// Co-simulation: advances the motion by `step` from the time `from`, which must be the present one.
    ///
    /// # Errors
    ///
    /// The motion cannot continue, the step is not positive, or `from` is not the present time.
    pub fn do_step(&mut self, from: f64, step: f64) -> Result<(), Refusal> {
        self.expect(&[Mode::Step])?;
        if !(step > 0.0 && step.is_finite()) {
            return refused(format!("the step is {step} s: it must be positive"));
        }
        let now = self.now.time;
        if (from - now).abs() > SAME_TIME * now.abs().max(step) {
            return refused(format!("the step begins at {from} s, but the motion is at {now} s"));
        }
        let inputs = self.now.inputs.clone();
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        running.with(|simulation| simulation.set_inputs(&inputs)).map_err(|error| Refusal(error.told()))?;
        let done = self.advance(from + step);
        // Simulations keep the inputs of their last step.
        self.now.inputs = inputs;
        done
    }

    /// The present time, s.
    pub fn time(&self) -> f64 {
        self.now.time
    }

    /// Terminates the motion.
    ///
    /// # Errors
    ///
    /// The motion has not started.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime, Mode::Step])?;
        self.mode = Mode::Terminated;
        Ok(())
    }

    /// Resets the unit to its state after instantiation.
    pub fn reset(&mut self) {
        self.settings = Settings::of(&self.layout, &self.defaults);
        self.now = self.settings.start.clone();
        (self.mode, self.running, self.events) = (Mode::Instantiated, None, 0);
    }

    /// Derivatives of `unknowns` along the direction that changes each of `knowns` by its seed.
    ///
    /// # Errors
    ///
    /// A variable cannot be an unknown or a known, or values cannot be computed near the state.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let unknowns = layout.kinds(unknowns, sensitivity.len())?;
        let knowns = layout.kinds(knowns, seed.len())?;
        if self.mode == Mode::Instantiated {
            return refused("there are no derivatives before the initialization");
        }
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        let knowns: Vec<(VariableKind, f64)> = knowns.into_iter().zip(seed.iter().copied()).collect();
        fill(sensitivity, &directional(running, &self.now, &unknowns, &knowns)?)
    }

    fn expect(&self, modes: &[Mode]) -> Result<(), Refusal> {
        if modes.contains(&self.mode) {
            return Ok(());
        }
        let name = match self.mode {
            Mode::Instantiated => "instantiated, and not yet initialized",
            Mode::Initialization => "being initialized",
            Mode::Event => "in event mode",
            Mode::ContinuousTime => "in continuous-time mode",
            Mode::Step => "in step mode",
            Mode::Terminated => "terminated",
        };
        refused(format!("the call is not allowed now: the unit is {name}"))
    }
}

/// The law of this number; they count from 1.
fn law_of(number: i64) -> Result<Law, Refusal> {
    let place = number.checked_sub(1).and_then(|place| usize::try_from(place).ok());
    match place.and_then(|place| Law::ALL.get(place)) {
        Some(law) => Ok(*law),
        None => Law::read(&number.to_string()).map_err(|error| Refusal(error.told())),
    }
}

/// Copies the time and the state of a motion.
fn take(now: &mut Now, simulation: &Simulation<'_>) {
    now.time = simulation.time();
    now.coordinates.copy_from_slice(simulation.coordinates());
    now.speeds.copy_from_slice(simulation.speeds());
}

fn fill(to: &mut [f64], from: &[f64]) -> Result<(), Refusal> {
    if to.len() != from.len() {
        return refused(format!("there are {} numbers, not {}", from.len(), to.len()));
    }
    to.copy_from_slice(from);
    Ok(())
}
