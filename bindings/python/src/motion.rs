//! Motion with impacts and contact that lasts.

use std::ffi::CStr;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

use hodograph::{ComponentKind, Mechanism as _, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::motion::{self as defaults, GivenSurface};
use hodograph_simulation::{
    ContactLaw, Drive, Event, EventKind, InputFunction, Options, Progress, Simulation, SimulationError,
};
use numpy::PyArray1;
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::{array, law_named};
use crate::errors;
use crate::laws::{self, GivenParts, Raised, keep};
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
    /// inputs as a function of time, coordinates and speeds
    #[pyo3(item)]
    control: Option<Py<PyAny>>,
    /// the sampling time of `control`, s; none: it is evaluated at every time
    #[pyo3(item)]
    period: Option<f64>,
}

/// A motion as far as it was followed, and why no further.
#[derive(Default)]
struct Found {
    ended: Option<Ended>,
    times: Vec<f64>,
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    events: Vec<Event>,
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

/// Warns of contacts that a motion never sees close, as the command line tool does.
pub fn warn_of_no_gap(py: Python<'_>, mechanism: &InterpretedMechanism, contacts: &[usize]) -> PyResult<()> {
    for &contact in contacts {
        let name =
            mechanism.component(ComponentKind::Contact, contact).map_or("", |component| component.name);
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
    mechanism: &InterpretedMechanism,
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

/// Follows a motion to its end, or to an error, or until Python is told to stop.
fn follow(
    mechanism: &InterpretedMechanism,
    state: &State<'_>,
    (until, step): (f64, f64),
    options: Options,
) -> Found {
    let mut found = Found::default();
    let mut simulation = match Simulation::new(mechanism, state, options) {
        Ok(simulation) => simulation,
        Err(error) => return Found { ended: Some(Ended::Error(error)), ..found },
    };
    let mut looked = Instant::now();
    let count = ((until - state.time) / step).ceil() as usize;
    let piece = (until - state.time) / LOOKS;
    for index in 0..=count {
        let time = (state.time + step * index as f64).min(until);
        let mut reached = false;
        while !reached && found.ended.is_none() {
            // To look at a time in between changes nothing of the motion.
            let next = if piece > 0.0 { (simulation.time() + piece).min(time) } else { time };
            match simulation.advance(next) {
                Ok(Progress::Event(event)) => {
                    // The motion may have an end of its own.
                    let ends = matches!(event.kind, EventKind::Singular);
                    found.events.push(event);
                    if ends {
                        found.state(&simulation);
                        return found;
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
    found
}

impl Found {
    fn state(&mut self, simulation: &Simulation<'_>) {
        self.times.push(simulation.time());
        self.coordinates.extend_from_slice(simulation.coordinates());
        self.speeds.extend_from_slice(simulation.speeds());
    }
}

/// Follows a motion.
pub fn simulate<'py>(
    py: Python<'py>,
    mechanism: &InterpretedMechanism,
    states: &States<'py>,
    (until, step): (f64, Option<f64>),
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let step = step.unwrap_or(defaults::STEP);
    let wrong = |name: &str, message: &str| Err(errors::argument(py, name, "bad_option", message));
    if states.rows.is_some() {
        return wrong("q", "a motion begins in one state: expected arrays of shape (p,)");
    }
    let start = states.time.as_ref().map_or(0.0, |time| time.slice()[0]);
    let lasts = until - start;
    if !(step > 0.0 && lasts >= 0.0 && lasts.is_finite() && lasts / step <= MOST) {
        return wrong("step", "expected step > 0, until not before the beginning, and at most 1e7 steps");
    }
    if !start.is_finite() {
        return wrong("time", &format!("`time` is {start}: expected a finite number"));
    }
    let state = State {
        time: start,
        coordinates: states.q.slice(),
        speeds: states.u.slice(),
        inputs: states.inputs.slice(),
    };
    let raised = Raised::default();
    let (own, laws) = own(py, mechanism, &choices, &raised)?;
    let surfaces = match defaults::surfaces(mechanism, &state, given(py, &choices.surface)?, &own) {
        Ok(surfaces) => {
            warn_of_no_gap(py, mechanism, &surfaces.without_gap)?;
            surfaces.of_contacts
        }
        Err(error) => return wrong("mu", &format!("{error}: give mu, e and law, or `surfaces`")),
    };
    let tolerance = choices.tolerance.unwrap_or(Options::default().relative_tolerance);
    if let Err(message) = defaults::check_tolerance(tolerance) {
        return wrong("tolerance", &message);
    }
    let driven = choices.control.is_some() && choices.period.is_none();
    let mut options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        max_step: choices.max_step.unwrap_or(defaults::greatest_step(mechanism.program(), driven)),
        surfaces,
        laws,
        ..Options::default()
    };
    if let Some(control) = choices.control {
        let function = controlled(control, &raised);
        options.drive = match choices.period {
            None => Drive::Continuous(function),
            Some(period) => Drive::Sampled {
                period,
                controller: Box::new(move |t: f64, q: &[f64], u: &[f64], w: &mut [f64]| function(t, q, u, w)),
            },
        };
    }
    let mut found = py.detach(|| follow(mechanism, &state, (until, step), options));
    let raised = raised.lock().unwrap_or_else(PoisonError::into_inner).take();
    let error = match (raised, found.ended.take()) {
        (Some(error), _) | (None, Some(Ended::Interrupted(error))) => Some(error),
        (None, Some(Ended::Error(error))) => {
            let place = match &error.contact {
                Some(contact) => format!("{contact}, time {} s", error.time),
                None => format!("time {} s", error.time),
            };
            let (message, kind) = (error.to_string(), error.kind.name());
            Some(errors::error(py, "SimulationError", &message, kind, Some(place), Some(error.time)))
        }
        (None, None) => None,
    };
    let begun = !found.times.is_empty();
    let told = tell(py, mechanism, found)?;
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

/// The motion by columns, and its events.
fn tell<'py>(
    py: Python<'py>,
    mechanism: &InterpretedMechanism,
    found: Found,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let rows = Some(found.times.len());
    let [n, p] = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| mechanism.count(kind));
    all.set_item("time", array(py, rows, &[], found.times)?)?;
    all.set_item("q", array(py, rows, &[n], found.coordinates)?)?;
    all.set_item("u", array(py, rows, &[p], found.speeds)?)?;
    let events = PyList::empty(py);
    for event in found.events {
        let name = event.contact.and_then(|contact| mechanism.component(ComponentKind::Contact, contact));
        let (impulse, energy) = match &event.kind {
            EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
                let impulse = struck.outcome.impulse_on_point;
                (Some(PyArray1::from_slice(py, impulse.as_slice())), Some(struck.outcome.energy_change))
            }
            EventKind::SimultaneousCollision(all) => (None, Some(all.energy_change)),
            _ => (None, None),
        };
        let state = [&event.coordinates, &event.speeds].map(|numbers| PyArray1::from_slice(py, numbers));
        let [q, u] = state;
        let contact = name.map(|component| component.name);
        events.append((event.time, event.kind.name(), contact, q, u, impulse, energy))?;
    }
    all.set_item("events", events)?;
    Ok(all)
}
