//! Motion with impacts and contact that lasts.

use hodograph::{Kind, Law, Mechanism as _, State, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Options, Progress, Simulation, SimulationError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::array;
use crate::errors;
use crate::states::States;

/// A motion has at most this many states.
const MOST: f64 = 1e7;

struct Found {
    times: Vec<f64>,
    coordinates: Vec<f64>,
    speeds: Vec<f64>,
    events: Vec<(f64, Option<usize>, &'static str)>,
}

fn follow(
    mechanism: &InterpretedMechanism,
    state: &State<'_>,
    (until, step): (f64, f64),
    options: Options,
) -> Result<Found, SimulationError> {
    let mut simulation = Simulation::new(mechanism, state, options)?;
    let mut found = Found { times: vec![], coordinates: vec![], speeds: vec![], events: vec![] };
    let count = ((until - state.time) / step).ceil() as usize;
    for index in 0..=count {
        let time = (state.time + step * index as f64).min(until);
        while let Progress::Event(event) = simulation.advance(time)? {
            found.events.push((event.time, event.contact, event.kind.name()));
        }
        found.times.push(time);
        found.coordinates.extend_from_slice(simulation.coordinates());
        found.speeds.extend_from_slice(simulation.speeds());
    }
    Ok(found)
}

/// Follows a motion.
pub fn simulate<'py>(
    py: Python<'py>,
    mechanism: &InterpretedMechanism,
    states: &States<'py>,
    (until, step): (f64, f64),
    (mu, e, law): (f64, f64, String),
    tolerance: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let wrong = |name: &str, message: &str| Err(errors::argument(py, name, "bad_option", message));
    if states.rows.is_some() {
        return wrong("q", "a motion begins in one state: expected arrays of shape (p,)");
    }
    let law = match law.as_str() {
        "newton" => Law::Newton,
        "poisson" => Law::Poisson,
        "stronge" => Law::Stronge,
        other => {
            return wrong("law", &format!("the law is '{other}': expected 'newton', 'poisson' or 'stronge'"));
        }
    };
    let start = states.time.as_ref().map_or(0.0, |time| time.slice()[0]);
    let lasts = until - start;
    if !(step > 0.0 && lasts >= 0.0 && lasts.is_finite() && lasts / step <= MOST) {
        return wrong("step", "expected step > 0, until not before the beginning, and at most 1e7 steps");
    }
    let options = Options {
        relative_tolerance: tolerance,
        absolute_tolerance: tolerance,
        surface: Some(Surface { mu, e, law }),
        ..Options::default()
    };
    let state = State {
        time: start,
        coordinates: states.q.slice(),
        speeds: states.u.slice(),
        inputs: states.inputs.slice(),
    };
    let found = py.detach(|| follow(mechanism, &state, (until, step), options)).map_err(|error| {
        let place = match &error.contact {
            Some(contact) => format!("{contact}, time {} s", error.time),
            None => format!("time {} s", error.time),
        };
        let (message, kind) = (error.to_string(), error.reason.kind());
        errors::error(py, "SimulationError", &message, kind, Some(place), Some(error.time))
    })?;
    let all = PyDict::new(py);
    let rows = Some(found.times.len());
    let [n, p] = [Kind::Coordinate, Kind::Speed].map(|kind| mechanism.count(kind));
    all.set_item("time", array(py, rows, &[], found.times)?)?;
    all.set_item("q", array(py, rows, &[n], found.coordinates)?)?;
    all.set_item("u", array(py, rows, &[p], found.speeds)?)?;
    let events = PyList::empty(py);
    for (time, contact, kind) in found.events {
        let name = contact.and_then(|contact| mechanism.component(Kind::Contact, contact));
        events.append((time, kind, name.map(|component| component.name)))?;
    }
    all.set_item("events", events)?;
    Ok(all)
}
