//! A unit that was instantiated: its values, the states of its life, and its motion.

use std::sync::Arc;

use hodograph::{Contacts, Law, Surface};
use hodograph_simulation::{Options, Progress, Simulation};
use serde::{Deserialize, Serialize};

use crate::derivative::directional;
use crate::layout::{Defaults, Layout, What, close_loops};
use crate::running::Running;
use crate::settings::{Now, Settings};
use crate::values::Values;

/// How a unit is used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Kind {
    /// the importer integrates
    ModelExchange,
    /// the unit integrates
    CoSimulation,
}

/// Where a unit is in its life.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    Instantiated,
    Initialization,
    Event,
    ContinuousTime,
    Step,
    Terminated,
}

/// Why a call is refused or fails, in a sentence.
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

/// What [`Instance::update_discrete_states`] tells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Updated {
    /// the motion has ended
    pub terminates: bool,
    /// states are not what they were
    pub states_changed: bool,
    /// when something happens next that no indicator tells
    pub next_time: Option<f64>,
}

/// Bounces of model exchange that are lower than this, m, are the last: importers do not find lower ones.
const LOWEST_BOUNCE: f64 = 1e-9;
/// A communication point may be off by this part of the time.
const SAME_TIME: f64 = 1e-9;

/// A unit.
pub struct Instance {
    pub(crate) layout: Arc<Layout>,
    pub(crate) defaults: Defaults,
    /// makes the mechanism with the parameters of the model
    pub(crate) make: fn() -> Box<dyn Contacts<f64>>,
    pub(crate) kind: Kind,
    pub(crate) mode: Mode,
    pub(crate) settings: Settings,
    pub(crate) now: Now,
    pub(crate) events: u64,
    pub(crate) running: Option<Running>,
}

impl Instance {
    /// A unit as the standard's instantiation leaves it.
    ///
    /// # Errors
    ///
    /// As [`Layout::of`].
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

    /// How it is used.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The motion; begins it, during the initialization, from what was set so far.
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
        mechanism.set_parameter_values(parameters).map_err(|error| error.to_string())?;
        let mut now = start.clone();
        let (time, inputs) = (now.time, now.inputs.clone());
        let speeds = now.speeds.clone();
        close_loops(&*mechanism, time, &mut now.coordinates, &speeds, &inputs)?;
        let mut given = Vec::new();
        for &(contact, mu, e, law) in surfaces {
            let law = usize::try_from(law - 1).ok().and_then(|place| Law::ALL.get(place));
            let Some(&law) = law else {
                return refused(format!(
                    "there is no law of restitution with this number: {}",
                    Law::NAMES.join(", ")
                ));
            };
            given.push((contact, Surface { mu, e, law }));
        }
        let lowest = if self.kind == Kind::ModelExchange { LOWEST_BOUNCE } else { 0.0 };
        let options = Options {
            relative_tolerance: *tolerance,
            absolute_tolerance: tolerance.max(lowest),
            max_step: *max_step,
            surfaces: given,
            ..Options::default()
        };
        let running =
            Running::begin(Arc::from(mechanism), &now.state(), options).map_err(|error| error.to_string())?;
        self.events = 0;
        self.now = now;
        self.running = Some(running);
        // What happens at the start itself.
        self.advance(self.now.time)
    }

    /// Follows the motion to a time, and takes the state there.
    fn advance(&mut self, until: f64) -> Result<(), Refusal> {
        let (now, events) = (&mut self.now, &mut self.events);
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        running.with(|simulation| {
            loop {
                let progress = simulation.advance_exactly(until);
                take(now, simulation);
                match progress.map_err(|error| error.to_string())? {
                    Progress::Event(_) => *events += 1,
                    Progress::Reached => return Ok(()),
                }
            }
        })
    }

    /// A number of floating point.
    ///
    /// # Errors
    ///
    /// The value reference is none of such a variable, or its value cannot be computed.
    pub fn floats(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let whats = layout.whats(references, values.len())?;
        for (what, value) in whats.iter().zip(&mut *values) {
            if let Some(number) = self.setting(*what) {
                *value = number;
            }
        }
        if whats.iter().all(|what| self.setting(*what).is_some()) {
            return Ok(());
        }
        if self.mode == Mode::Instantiated {
            return refused("values are computed from the initialization on");
        }
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        let mut found = Values::new(running, &self.now);
        for (what, value) in whats.iter().zip(values) {
            if self.setting(*what).is_none() {
                *value = found.number(*what)?;
            }
        }
        Ok(())
    }

    /// A number that follows from nothing else.
    fn setting(&self, what: What) -> Option<f64> {
        let settings = &self.settings;
        let surface = |contact| settings.surfaces.iter().find(|(index, ..)| *index == contact);
        match what {
            What::Tolerance => Some(settings.tolerance),
            What::MaxStep => Some(settings.max_step),
            What::Parameter(index) => settings.parameters.get(index).copied(),
            What::Mu(contact) => surface(contact).map(|surface| surface.1),
            What::Restitution(contact) => surface(contact).map(|surface| surface.2),
            _ if self.running.is_some() => None,
            What::Time => Some(settings.start.time),
            What::Coordinate(index) if self.mode == Mode::Instantiated => {
                settings.start.coordinates.get(index).copied()
            }
            What::Speed(index) if self.mode == Mode::Instantiated => {
                settings.start.speeds.get(index).copied()
            }
            What::Input(index) => settings.start.inputs.get(index).copied(),
            _ => None,
        }
    }

    /// Whole numbers: laws, phases, the count of events.
    ///
    /// # Errors
    ///
    /// As [`Instance::floats`].
    pub fn integers(&mut self, references: &[u32], values: &mut [i64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        for (what, value) in layout.whats(references, values.len())?.into_iter().zip(values) {
            *value = match what {
                What::Law(contact) => {
                    let found = self.settings.surfaces.iter().find(|(index, ..)| *index == contact);
                    found.map_or(0, |surface| surface.3)
                }
                What::Events if self.mode != Mode::Instantiated => {
                    self.running()?;
                    i64::try_from(self.events).unwrap_or(i64::MAX)
                }
                What::Phase(contact) if self.mode != Mode::Instantiated => {
                    self.running()?;
                    let Some(running) = &self.running else { return refused("there is no motion") };
                    Values::new(running, &self.now).phase(contact)
                }
                _ => return refused("the variable is no whole number that is known by now"),
            };
        }
        Ok(())
    }

    /// Sets numbers of floating point: parameters and start values before the end of the initialization, inputs and, in model
    /// exchange, states later.
    ///
    /// # Errors
    ///
    /// The variable cannot be set now, or the number is not finite.
    pub fn set_floats(&mut self, references: &[u32], values: &[f64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let whats = layout.whats(references, values.len())?;
        let before = matches!(self.mode, Mode::Instantiated | Mode::Initialization);
        for ((&what, &value), &reference) in whats.iter().zip(values).zip(references) {
            let name = layout.get(reference).map_or("?", |variable| &variable.name);
            let unbounded = what == What::MaxStep && value == f64::INFINITY;
            if !(value.is_finite() || unbounded) {
                return refused(format!("{name} is {value}: it must be finite"));
            }
            let exchanged =
                self.kind == Kind::ModelExchange && matches!(self.mode, Mode::Event | Mode::ContinuousTime);
            let later = match what {
                What::Input(_) => self.mode != Mode::Terminated,
                What::Coordinate(_) | What::Speed(_) => exchanged,
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
                What::Tolerance => Some(&mut self.settings.tolerance),
                What::MaxStep => Some(&mut self.settings.max_step),
                What::Parameter(index) => self.settings.parameters.get_mut(index),
                What::Mu(contact) => surface(&mut self.settings.surfaces, contact)
                    .map(|place| &mut self.settings.surfaces[place].1),
                What::Restitution(contact) => surface(&mut self.settings.surfaces, contact)
                    .map(|place| &mut self.settings.surfaces[place].2),
                What::Input(index) => target.inputs.get_mut(index),
                What::Coordinate(index) => target.coordinates.get_mut(index),
                What::Speed(index) => target.speeds.get_mut(index),
                _ => None,
            };
            let Some(place) = place else { return refused(format!("{name} is computed: it cannot be set")) };
            *place = value;
            if before {
                // The motion has to begin anew.
                self.running = None;
            }
        }
        Ok(())
    }

    /// Sets whole numbers: laws of restitution.
    ///
    /// # Errors
    ///
    /// The variable is none, or it is too late.
    pub fn set_integers(&mut self, references: &[u32], values: &[i64]) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        for (what, &value) in layout.whats(references, values.len())?.into_iter().zip(values) {
            let What::Law(contact) = what else {
                return refused("of whole numbers only the laws of restitution can be set");
            };
            if !matches!(self.mode, Mode::Instantiated | Mode::Initialization) {
                return refused("the law of restitution cannot be set any more");
            }
            if usize::try_from(value).is_err() || value < 1 || value as usize > Law::ALL.len() {
                return refused(format!("the law is {value}: it must be from 1 to {}", Law::ALL.len()));
            }
            for surface in self.settings.surfaces.iter_mut().filter(|(index, ..)| *index == contact) {
                surface.3 = value;
            }
            self.running = None;
        }
        Ok(())
    }

    /// The initialization begins at a time, s.
    ///
    /// # Errors
    ///
    /// It is not the time for it.
    pub fn enter_initialization(&mut self, start: f64) -> Result<(), Refusal> {
        self.expect(&[Mode::Instantiated])?;
        if !start.is_finite() {
            return refused(format!("the start time is {start}: it must be finite"));
        }
        self.settings.start.time = start;
        self.now.time = start;
        self.mode = Mode::Initialization;
        Ok(())
    }

    /// The initialization ends, and the motion begins.
    ///
    /// # Errors
    ///
    /// The motion cannot begin with these parameters and in this state.
    pub fn exit_initialization(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Initialization])?;
        self.running()?;
        self.mode = if self.kind == Kind::CoSimulation { Mode::Step } else { Mode::Event };
        Ok(())
    }

    /// Model exchange: events are about to be handled.
    ///
    /// # Errors
    ///
    /// It is not the time for it.
    pub fn enter_event_mode(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::ContinuousTime])?;
        self.mode = Mode::Event;
        Ok(())
    }

    /// Model exchange: the integration goes on.
    ///
    /// # Errors
    ///
    /// It is not the time for it.
    pub fn enter_continuous_time(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Event])?;
        self.mode = Mode::ContinuousTime;
        Ok(())
    }

    /// Model exchange: what happens in this state happens.
    ///
    /// # Errors
    ///
    /// It is not the time for it, or the motion cannot go on.
    pub fn update_discrete_states(&mut self) -> Result<Updated, Refusal> {
        self.expect(&[Mode::Event])?;
        let (now, events) = (&mut self.now, &mut self.events);
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        let before = now.clone();
        running.with(|simulation| {
            let happened =
                simulation.continue_from(&before.state()).map_err(|error| Refusal(error.to_string()))?;
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

    /// Model exchange: the integration has come to the present state.
    ///
    /// # Errors
    ///
    /// It is not the time for it, or the mechanism cannot be evaluated.
    pub fn step_completed(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::ContinuousTime])?;
        let state = self.now.state();
        let Some(running) = &mut self.running else { return refused("there is no motion") };
        running
            .with(|simulation| simulation.step_completed(&state))
            .map_err(|error| Refusal(error.to_string()))
    }

    /// Model exchange: the time, s.
    ///
    /// # Errors
    ///
    /// It is not finite, or not the time for it.
    pub fn set_time(&mut self, time: f64) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime])?;
        if !time.is_finite() {
            return refused(format!("the time is {time}: it must be finite"));
        }
        self.now.time = time;
        Ok(())
    }

    /// Coordinates, then speeds.
    ///
    /// # Errors
    ///
    /// `states` has another length.
    pub fn states(&mut self, states: &mut [f64]) -> Result<(), Refusal> {
        self.running()?;
        let all = [&self.now.coordinates[..], &self.now.speeds].concat();
        fill(states, &all)
    }

    /// Model exchange: coordinates, then speeds, as they were integrated.
    ///
    /// # Errors
    ///
    /// They are not finite, `states` has another length, or it is not the time for it.
    pub fn set_states(&mut self, states: &[f64]) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime])?;
        let n = self.now.coordinates.len();
        if states.len() != n + self.now.speeds.len() {
            return refused(format!("there are {} states, not {}", n + self.now.speeds.len(), states.len()));
        }
        if let Some(bad) = states.iter().find(|value| !value.is_finite()) {
            return refused(format!("a state is {bad}: it must be finite"));
        }
        self.now.coordinates.copy_from_slice(&states[..n]);
        self.now.speeds.copy_from_slice(&states[n..]);
        Ok(())
    }

    /// Rates of the states.
    ///
    /// # Errors
    ///
    /// They cannot be computed, or `rates` has another length.
    pub fn rates(&mut self, rates: &mut [f64]) -> Result<(), Refusal> {
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        fill(rates, Values::new(running, &self.now).rates()?)
    }

    /// The indicators of events.
    ///
    /// # Errors
    ///
    /// They cannot be computed, or `values` has another length.
    pub fn indicators(&mut self, values: &mut [f64]) -> Result<(), Refusal> {
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        fill(values, Values::new(running, &self.now).indicators()?)
    }

    /// Co-simulation: goes on by `step` from the time where the motion is.
    ///
    /// # Errors
    ///
    /// The motion cannot go on, the step is not positive, or begins elsewhere.
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
        running
            .with(|simulation| simulation.set_inputs(&inputs))
            .map_err(|error| Refusal(error.to_string()))?;
        let done = self.advance(from + step);
        // Simulations hold the inputs of their last step.
        self.now.inputs = inputs;
        done
    }

    /// The time where it is, s.
    pub fn time(&self) -> f64 {
        self.now.time
    }

    /// Nothing follows.
    ///
    /// # Errors
    ///
    /// It has not begun.
    pub fn terminate(&mut self) -> Result<(), Refusal> {
        self.expect(&[Mode::Event, Mode::ContinuousTime, Mode::Step])?;
        self.mode = Mode::Terminated;
        Ok(())
    }

    /// As it was when it was instantiated.
    pub fn reset(&mut self) {
        self.settings = Settings::of(&self.layout, &self.defaults);
        self.now = self.settings.start.clone();
        (self.mode, self.running, self.events) = (Mode::Instantiated, None, 0);
    }

    /// Derivatives of `unknowns` along a direction that changes each of `knowns` by its seed.
    ///
    /// # Errors
    ///
    /// A variable is no unknown or no known, or values cannot be computed beside the state.
    pub fn directional_derivative(
        &mut self,
        unknowns: &[u32],
        knowns: &[u32],
        seed: &[f64],
        sensitivity: &mut [f64],
    ) -> Result<(), Refusal> {
        let layout = Arc::clone(&self.layout);
        let unknowns = layout.whats(unknowns, sensitivity.len())?;
        let knowns = layout.whats(knowns, seed.len())?;
        if self.mode == Mode::Instantiated {
            return refused("there are no derivatives before the initialization");
        }
        self.running()?;
        let Some(running) = &self.running else { return refused("there is no motion") };
        let knowns: Vec<(What, f64)> = knowns.into_iter().zip(seed.iter().copied()).collect();
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

/// Takes the time and the state to which a motion was advanced.
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
