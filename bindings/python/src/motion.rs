//! Motion with impacts and contact that lasts.

use std::ffi::CStr;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use hodograph::{Cause, ComponentKind, Contacts, State};
use hodograph_interpreter::motion::{self as defaults, GivenSurface};
use hodograph_simulation::{
    ContactLaw, ContactPhase, Drive, EnergyAccount, Event, EventFunction, EventKind, ImpactsAtOnce,
    InputFunction, Options, Progress, Samples, Simulation, SimulationError, sample_times,
};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{array, law_named};
use crate::ends::Ends;
use crate::errors;
use crate::laws::{self, GivenParts, Raised, keep};
use crate::machine::Machine;
use crate::record::{Kept, Record};
use crate::states::States;

/// How often Python is asked for signals: after this time, at times this part of the motion apart, and at events.
const LOOK: Duration = Duration::from_millis(50);
const LOOKS: f64 = 1000.0;
/// A motion has at most this many states.
const MOST: f64 = 1e7;

/// mu, e and the name of the law of a surface; what is not given is none.
type Given = (Option<f64>, Option<f64>, Option<String>);

/// What a motion is to be like, from Python. What is none has the default of the command line tool.
#[derive(FromPyObject)]
pub struct Choices {
    /// the surface of all contacts, for what they leave open
    #[pyo3(item)]
    pub surface: Given,
    /// the surfaces of contacts, by number
    #[pyo3(item)]
    surfaces: Vec<(usize, Given)>,
    /// what surfaces do beyond these: of all contacts, and of contacts by number
    #[pyo3(item)]
    pub law: GivenParts,
    #[pyo3(item)]
    laws: Vec<(usize, GivenParts)>,
    #[pyo3(item)]
    pub tolerance: Option<f64>,
    #[pyo3(item)]
    pub max_step: Option<f64>,
    /// what contacts do that are struck at one time, and the seed where that is drawn
    #[pyo3(item)]
    together: Option<String>,
    #[pyo3(item)]
    seed: u64,
    /// inputs as a function of time, coordinates and speeds
    #[pyo3(item)]
    control: Option<Py<PyAny>>,
    /// the sampling time of `control`, s; none: it is evaluated at every time
    #[pyo3(item)]
    period: Option<f64>,
    /// inputs in a table: the sampling time, s, and the values of each sample
    #[pyo3(item)]
    samples: Option<(f64, Vec<Vec<f64>>)>,
    /// functions of time, coordinates and speeds whose zeros are events of these names
    #[pyo3(item)]
    events: Vec<(String, Py<PyAny>)>,
    /// the kinds and names of events at which a motion ends
    #[pyo3(item)]
    stop: Vec<String>,
}

/// A motion as far as it was followed, and why no further.
#[derive(Default)]
struct Found {
    ended: Option<Ended>,
    times: Vec<f64>,
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    inputs: Vec<f64>,
    /// of each contact along n, t, s; zero where it is open
    forces: Vec<f64>,
    /// of each contact: open, stick, slide
    phases: Vec<u8>,
    energy: EnergyAccount,
    kept: Kept,
}

enum Ended {
    Error(SimulationError),
    /// Python was told to stop, as by Ctrl-C
    Interrupted(PyErr),
}

/// A function of Python as a function that writes inputs; where it raises, they are not numbers, which ends
/// the motion.
fn controlled(control: Py<PyAny>, raised: &Raised) -> InputFunction {
    let raised = Arc::clone(raised);
    Arc::new(move |time, coordinates, speeds, inputs: &mut [f64]| {
        let found: PyResult<()> = Python::attach(|py| {
            let arrays = (time, PyArray1::from_slice(py, coordinates), PyArray1::from_slice(py, speeds));
            let found = control.bind(py).call1(arrays)?;
            let numbers: Vec<f64> = match found.extract() {
                Ok(numbers) => numbers,
                Err(_) => vec![found.extract()?],
            };
            if numbers.len() != inputs.len() {
                let message =
                    format!("`control` gave {} numbers: expected {} inputs", numbers.len(), inputs.len());
                return Err(errors::argument(py, "control", "wrong_shape", &message));
            }
            inputs.copy_from_slice(&numbers);
            Ok(())
        });
        if let Err(error) = found {
            inputs.fill(f64::NAN);
            keep(&raised, error);
        }
    })
}

/// What is given of a surface, with its law by name.
pub fn given(py: Python<'_>, (mu, e, law): &Given) -> PyResult<GivenSurface> {
    let law = law.as_deref().map(|law| law_named(py, law)).transpose()?;
    let given = GivenSurface { mu: *mu, e: *e, law };
    given.check().map_err(|error| errors::argument(py, "surface", error.kind(), &error.to_string()))
}

/// A function of Python of time, coordinates and speeds that gives a number.
fn watched(function: &Py<PyAny>, raised: &Raised) -> EventFunction {
    let (function, raised) = (Python::attach(|py| function.clone_ref(py)), Arc::clone(raised));
    Arc::new(move |time, coordinates, speeds| {
        Python::attach(|py| {
            let arrays = (time, PyArray1::from_slice(py, coordinates), PyArray1::from_slice(py, speeds));
            function.bind(py).call1(arrays)?.extract::<f64>()
        })
        .unwrap_or_else(|error| {
            keep(&raised, error);
            f64::NAN
        })
    })
}

/// Warns of contacts that a motion never sees close, as the command line tool does.
pub fn warn_of_no_gap(py: Python<'_>, machine: &Machine, contacts: &[usize]) -> PyResult<()> {
    for &contact in contacts {
        let name = machine.name_of(ComponentKind::Contact, contact);
        let message = format!("contact {name} has no gap in the model: it is never seen to close\0");
        let message = CStr::from_bytes_until_nul(message.as_bytes()).unwrap_or_default();
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), message, 2)?;
    }
    Ok(())
}

type Own = (Vec<(usize, GivenSurface)>, Vec<(usize, ContactLaw)>);

/// The surfaces of contacts that have one of their own, and the laws of all contacts.
pub fn own(
    py: Python<'_>,
    mechanism: &dyn Contacts<f64>,
    choices: &Choices,
    raised: &Raised,
) -> PyResult<Own> {
    let (mut surfaces, mut own) = (Vec::new(), Vec::new());
    for (contact, surface) in &choices.surfaces {
        surfaces.push((*contact, given(py, surface)?));
    }
    for (contact, parts) in &choices.laws {
        own.push((*contact, laws::given(py, parts, raised)?));
    }
    let all = laws::given(py, &choices.law, raised)?;
    let laws = laws::of_contacts(py, mechanism, &all, &own, mechanism.count(ComponentKind::Contact))?;
    Ok((surfaces, laws))
}

impl Choices {
    /// The names of own events, and at which events a motion ends.
    pub fn ends(&self, py: Python<'_>) -> PyResult<Ends> {
        Ends::new(py, self.events.iter().map(|(name, _)| name.clone()).collect(), &self.stop)
    }

    /// What contacts do that are struck at one time.
    pub fn together(&self, py: Python<'_>) -> PyResult<ImpactsAtOnce> {
        let Some(name) = &self.together else { return Ok(ImpactsAtOnce::default()) };
        ImpactsAtOnce::named(name, self.seed).ok_or_else(|| {
            let known = ImpactsAtOnce::NAMES.join(", ");
            let message = format!("`together` is {name:?}: expected one of {known}");
            errors::argument(py, "together", "bad_option", &message)
        })
    }

    /// The functions of own events.
    pub fn functions(&self, raised: &Raised) -> Vec<EventFunction> {
        self.events.iter().map(|(_, function)| watched(function, raised)).collect()
    }
}

/// The options of a motion from a state.
pub fn options(
    py: Python<'_>,
    machine: &Machine,
    state: &State<'_>,
    choices: Choices,
    raised: &Raised,
) -> PyResult<Options> {
    let wrong = |name: &str, message: &str| Err(errors::argument(py, name, "bad_option", message));
    let mechanism = machine.contacts();
    let (own, laws) = own(py, mechanism, &choices, raised)?;
    let surfaces = match defaults::surfaces(mechanism, state, given(py, &choices.surface)?, &own) {
        Ok(surfaces) => {
            warn_of_no_gap(py, machine, &surfaces.without_gap)?;
            surfaces.of_contacts
        }
        Err(error) => {
            let message = format!("{error}: give mu, e and law, or `surfaces`");
            return Err(errors::argument(py, "mu", error.cause().name(), &message));
        }
    };
    let tolerance = choices.tolerance.unwrap_or(Options::default().relative_tolerance);
    if let Err(message) = Options::check_tolerance(tolerance) {
        return wrong("tolerance", &message);
    }
    let driven = choices.control.is_some() && choices.period.is_none();
    let mut options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        max_step: choices.max_step.unwrap_or(machine.greatest_step(driven)),
        together: choices.together(py)?,
        surfaces,
        laws,
        events: choices.functions(raised),
        ..Options::default()
    };
    if let Some((period, values)) = choices.samples {
        options.drive = Drive::Table(Samples { period, values: values.into() });
    }
    if let Some(control) = choices.control {
        let function = controlled(control, raised);
        options.drive = match choices.period {
            None => Drive::Continuous(function),
            Some(period) => Drive::Sampled {
                period,
                controller: Box::new(move |t: f64, q: &[f64], u: &[f64], w: &mut [f64]| function(t, q, u, w)),
            },
        };
    }
    Ok(options)
}

/// The one state that a motion begins in.
pub fn start<'a>(py: Python<'_>, states: &'a States<'_>) -> PyResult<State<'a>> {
    if states.rows.is_some() {
        let message = "a motion begins in one state: expected arrays of shape (p,)";
        return Err(errors::argument(py, "q", "bad_option", message));
    }
    let state = states.one();
    if !state.time.is_finite() {
        let message = format!("`time` is {}: it must be finite", state.time);
        return Err(errors::argument(py, "time", Cause::NotFinite.name(), &message));
    }
    Ok(state)
}

/// Follows a motion to its end, or to an error, or until Python is told to stop.
fn follow(
    mechanism: &dyn Contacts<f64>,
    state: &State<'_>,
    (until, step): (f64, f64),
    options: Options,
    ends: &Ends,
) -> Found {
    let mut found = Found::default();
    let mut simulation = match Simulation::new(mechanism, state, options) {
        Ok(simulation) => simulation,
        Err(error) => return Found { ended: Some(Ended::Error(error)), ..found },
    };
    let mut looked = Instant::now();
    let later = (until > state.time).then(|| sample_times(state.time, step, until));
    let piece = (until - state.time) / LOOKS;
    'samples: for time in std::iter::once(state.time).chain(later.into_iter().flatten()) {
        let mut reached = false;
        while !reached && found.ended.is_none() {
            // To look at a time in between changes nothing of the motion.
            let next = if piece > 0.0 { (simulation.time() + piece).min(time) } else { time };
            match simulation.advance(next) {
                Ok(Progress::Event(event)) => {
                    // The motion may have an end of its own.
                    let over = matches!(event.kind, EventKind::Singular) || ends.stops(&event.kind);
                    found.event(event, &simulation);
                    if over {
                        found.state(&simulation);
                        break 'samples;
                    }
                }
                Ok(Progress::Reached) => reached = next >= time,
                Err(error) => found.ended = Some(Ended::Error(error)),
            }
            if looked.elapsed() > LOOK {
                looked = Instant::now();
                if let Err(told) = Python::attach(|py| py.check_signals()) {
                    found.ended = Some(Ended::Interrupted(told));
                }
            }
        }
        if found.ended.is_some() {
            // As far as it was followed: the end of the last step, or the time looked at.
            if simulation.time() > found.times.last().copied().unwrap_or(f64::NEG_INFINITY) {
                found.state(&simulation);
            }
            break;
        }
        found.state(&simulation);
    }
    found.energy = simulation.energy().unwrap_or_default();
    found
}

impl Found {
    fn state(&mut self, simulation: &Simulation<'_>) {
        self.times.push(simulation.time());
        self.coordinates.extend_from_slice(simulation.coordinates());
        self.speeds.extend_from_slice(simulation.speeds());
        self.inputs.extend_from_slice(simulation.inputs());
        let begin = self.forces.len();
        let contacts = (0..).map_while(|contact| simulation.phase(contact));
        self.phases.extend(contacts.map(|phase| match phase {
            ContactPhase::Open => 0,
            ContactPhase::Stick => 1,
            ContactPhase::Slide => 2,
        }));
        self.forces.resize(3 * self.phases.len(), 0.0);
        let forces = simulation.contact_forces().map_or(Vec::new(), |(forces, _)| forces);
        for (contact, force) in forces {
            if let Some(place) = self.forces.get_mut(begin + 3 * contact..begin + 3 * contact + 3) {
                place.copy_from_slice(force.as_slice());
            }
        }
    }

    fn event(&mut self, event: Event, simulation: &Simulation<'_>) {
        let forces = simulation.contact_forces().map_or(Vec::new(), |(forces, _)| forces);
        self.kept.add(event, forces, simulation.inputs());
    }
}

/// Follows a motion.
pub fn simulate<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    (until, step): (f64, Option<f64>),
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let step = step.unwrap_or(defaults::STEP);
    let state = start(py, states)?;
    let lasts = until - state.time;
    if !(step > 0.0 && lasts >= 0.0 && lasts.is_finite() && lasts / step <= MOST) {
        let message = "expected step > 0, until not before the beginning, and at most 1e7 steps";
        return Err(errors::argument(py, "step", "bad_option", message));
    }
    let raised = Raised::default();
    let ends = choices.ends(py)?;
    let options = options(py, machine, &state, choices, &raised)?;
    let surfaces = options.surfaces.clone();
    let mut found = py.detach(|| follow(machine.contacts(), &state, (until, step), options, &ends));
    found.kept.describe(machine, &ends, surfaces, &state);
    let raised = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
    let error = match (raised, found.ended.take()) {
        (Some(error), _) | (None, Some(Ended::Interrupted(error))) => Some(error),
        (None, Some(Ended::Error(error))) => Some(failed(py, &error)),
        (None, None) => None,
    };
    let begun = !found.times.is_empty();
    let told = tell(py, machine, found)?;
    match error {
        None => Ok(told),
        Some(error) => {
            if begun {
                // What was made is not lost; an exception that takes no attribute goes without.
                let _ = error.value(py).setattr("_motion", told);
            }
            Err(error)
        }
    }
}

/// The exception of a motion that cannot be followed.
pub fn failed(py: Python<'_>, error: &SimulationError) -> PyErr {
    let place = match &error.contact {
        Some(contact) => format!("{contact}, time {} s", error.time),
        None => format!("time {} s", error.time),
    };
    let (message, kind) = (error.to_string(), error.kind.name());
    errors::error(py, "SimulationError", &message, kind, Some(place), Some(error.time))
}

/// The motion by columns, and its events.
fn tell<'py>(py: Python<'py>, machine: &Machine, found: Found) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let count = found.times.len();
    let rows = Some(count);
    let [n, p, w, c] =
        [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input, ComponentKind::Contact]
            .map(|kind| machine.count(kind));
    all.set_item("time", array(py, rows, &[], found.times)?)?;
    all.set_item("q", array(py, rows, &[n], found.coordinates)?)?;
    all.set_item("u", array(py, rows, &[p], found.speeds)?)?;
    all.set_item("inputs", array(py, rows, &[w], found.inputs)?)?;
    all.set_item("forces", array(py, rows, &[c, 3], found.forces)?)?;
    let phases = PyArray1::from_vec(py, found.phases).reshape([count, c])?;
    all.set_item("phases", phases)?;
    all.set_item("account", account(py, &found.energy)?)?;
    all.set_item("record", Bound::new(py, Record::of(found.kept))?)?;
    Ok(all)
}

/// The energies and works at the end.
fn account<'py>(py: Python<'py>, energy: &EnergyAccount) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("kinetic", energy.kinetic)?;
    all.set_item("potential", energy.potential)?;
    all.set_item("friction", energy.friction)?;
    all.set_item("impacts", energy.impacts)?;
    all.set_item("inputs", energy.inputs)?;
    Ok(all)
}
