//! Many motions at once.

use std::sync::PoisonError;
use std::time::Duration;

use hodograph::{ComponentKind, Mechanism as _, State, StateError};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::motion as defaults;
use hodograph_simulation::{
    Batch, Case, ErrorKind, Options, Outcome, SimulationError, Watch, digest, simulate_many,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Rows, array, column, common};
use crate::errors;
use crate::laws::Raised;
use crate::machines::Machines;
use crate::motion::{Choices, given, own, warn_of_no_gap};
use crate::states::States;

/// Numbers that may differ from row to row: mu, e, mu_static, mu_impact, rolling, spinning.
pub type Columns<'py> = [Option<Bound<'py, PyAny>>; 6];
const NAMES: [&str; 6] = ["mu", "e", "mu_static", "mu_impact", "rolling", "spinning"];

/// How often Python is asked for signals, and told of the progress.
const LOOK: Duration = Duration::from_millis(50);

/// Follows many motions, by rows.
#[allow(clippy::too_many_arguments)]
pub fn simulate<'py>(
    py: Python<'py>,
    (mechanism, machines): (&InterpretedMechanism, Option<&Machines>),
    states: &States<'py>,
    until: f64,
    columns: &Columns<'py>,
    choices: &Choices,
    threads: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let mut given_columns: Vec<(&str, Rows<'py>)> = Vec::new();
    for (name, column_given) in NAMES.into_iter().zip(columns) {
        if let Some(numbers) = column_given {
            given_columns.push((name, column(py, numbers, name)?));
        }
    }
    let tables: Vec<(&str, &Rows<'_>)> = given_columns.iter().map(|(name, rows)| (*name, rows)).collect();
    let rows = match (states.rows, common(py, &tables)?) {
        (Some(rows), Some(others)) if rows != others => {
            let message =
                format!("the states have {rows} rows, the surfaces have {others}: expected as many");
            return Err(errors::argument(py, "mu", "wrong_shape", &message));
        }
        (rows, others) => rows.or(others).unwrap_or(1),
    };
    if threads == Some(0) {
        return Err(errors::argument(py, "threads", "bad_option", "`threads` is 0: expected at least 1"));
    }
    let tolerance = choices.tolerance.unwrap_or(Options::default().relative_tolerance);
    if let Err(message) = defaults::check_tolerance(tolerance) {
        return Err(errors::argument(py, "tolerance", "bad_option", &message));
    }
    let raised = Raised::default();
    let (own, laws) = own(py, mechanism, choices, &raised)?;
    let all = given(py, &choices.surface)?;
    let max_step = choices.max_step.unwrap_or(defaults::greatest_step(mechanism.program(), false));
    let of = |rows: &Rows<'_>| (rows.slice().to_vec(), rows.width, usize::from(rows.rows.is_some()));
    let (q, u, inputs) = (of(&states.q), of(&states.u), of(&states.inputs));
    let time = states.time.as_ref().map(of);
    let numbers: Vec<(&str, Vec<f64>, usize)> = given_columns
        .iter()
        .map(|(name, rows)| (*name, rows.slice().to_vec(), usize::from(rows.rows.is_some())))
        .collect();
    let row_of = |(numbers, width, many): &(Vec<f64>, usize, usize), row: usize| {
        numbers.get(row * many * width..(row * many + 1) * width).unwrap_or(&[]).to_vec()
    };
    let never_closed: Vec<usize> = (0..mechanism.count(ComponentKind::Contact))
        .filter(|&contact| {
            mechanism.model().contacts.get(contact).is_some_and(|contact| contact.gap.is_none())
        })
        .collect();
    warn_of_no_gap(py, mechanism, &never_closed)?;
    let not_finite = states.not_finite();
    let case = |row: usize| -> Result<Case<Box<InterpretedMechanism>>, SimulationError> {
        let start = time.as_ref().map_or(0.0, |time| row_of(time, row)[0]);
        let wrong = |message: String| SimulationError {
            time: start,
            contact: None,
            kind: ErrorKind::BadOption(message),
        };
        if not_finite.binary_search(&row).is_ok() {
            let kind = ErrorKind::State(StateError::NotFinite);
            return Err(SimulationError { time: start, contact: None, kind });
        }
        let number = |name: &str| {
            let found = numbers.iter().find(|(other, ..)| *other == name);
            found.and_then(|(_, numbers, many)| numbers.get(row * many).copied())
        };
        let mut machine = mechanism.clone();
        if let Some(machines) = machines {
            machine.set_parameter_values(machines.row(row)).map_err(|error| wrong(error.to_string()))?;
        }
        let (coordinates, speeds, inputs) = (row_of(&q, row), row_of(&u, row), row_of(&inputs, row));
        let state = State { time: start, coordinates: &coordinates, speeds: &speeds, inputs: &inputs };
        let mut all = all;
        all.mu = number("mu").or(all.mu);
        all.e = number("e").or(all.e);
        let all = all.check().map_err(|error| wrong(error.to_string()))?;
        let mut options = Options {
            relative_tolerance: tolerance,
            absolute_tolerance: tolerance,
            max_step,
            ..Options::default()
        };
        options.surfaces = defaults::surfaces(&machine, &state, all, &own)
            .map_err(|error| wrong(format!("{error}: give mu, e and law, or `surfaces`")))?
            .of_contacts;
        options.laws = laws.clone();
        for (contact, law) in &mut options.laws {
            if own.iter().all(|(other, _)| other != contact) {
                law.mu_static = number("mu_static").or(law.mu_static);
                law.mu_impact = number("mu_impact").or(law.mu_impact);
                law.rolling = number("rolling").or(law.rolling);
                law.spinning = number("spinning").or(law.spinning);
            }
        }
        Ok(Case { mechanism: Box::new(machine), time: start, coordinates, speeds, inputs, options, until })
    };
    let watch = Watch::new();
    let mut interrupted = None;
    let outcomes = py.detach(|| {
        std::thread::scope(|scope| {
            let batch = scope.spawn(|| simulate_many(rows, case, &Batch { threads, watch: Some(&watch) }));
            while !batch.is_finished() {
                std::thread::sleep(LOOK);
                let told: PyResult<()> = Python::attach(|py| {
                    py.check_signals()?;
                    if let Some(progress) = &progress {
                        progress.call1(py, (watch.done(), rows))?;
                    }
                    Ok(())
                });
                if let Err(error) = told {
                    interrupted = Some(error);
                    watch.cancel();
                    break;
                }
            }
            batch.join().unwrap_or_default()
        })
    });
    let error = interrupted.or(raised.lock().unwrap_or_else(PoisonError::into_inner).take());
    if let Some(error) = error {
        return Err(error);
    }
    let outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
    tell(py, mechanism, &outcomes)
}

/// The outcomes by columns.
fn tell<'py>(
    py: Python<'py>,
    mechanism: &InterpretedMechanism,
    outcomes: &[Outcome],
) -> PyResult<Bound<'py, PyDict>> {
    let found = PyDict::new(py);
    let rows = Some(outcomes.len());
    let [n, p] = [ComponentKind::Coordinate, ComponentKind::Speed].map(|kind| mechanism.count(kind));
    let wide = |width: usize, of: fn(&Outcome) -> &[f64]| -> Vec<f64> {
        let row = |outcome: &Outcome| {
            // A row that did not begin has no state.
            let mut row = of(outcome).to_vec();
            row.resize(width, f64::NAN);
            row
        };
        outcomes.iter().flat_map(row).collect()
    };
    found.set_item("q", array(py, rows, &[n], wide(n, |outcome| &outcome.coordinates))?)?;
    found.set_item("u", array(py, rows, &[p], wide(p, |outcome| &outcome.speeds))?)?;
    let numbers: [(&str, fn(&Outcome) -> f64); 7] = [
        ("time", |outcome| outcome.time),
        ("rest", |outcome| outcome.rest.unwrap_or(f64::NAN)),
        ("kinetic", |outcome| outcome.energy.kinetic),
        ("potential", |outcome| outcome.energy.potential.unwrap_or(f64::NAN)),
        ("friction", |outcome| outcome.energy.friction),
        ("impacts", |outcome| outcome.energy.impacts),
        ("input_work", |outcome| outcome.energy.inputs),
    ];
    for (name, of) in numbers {
        found.set_item(name, array(py, rows, &[], outcomes.iter().map(of).collect())?)?;
    }
    let counts: [(&str, fn(&Outcome) -> usize); 2] =
        [("collisions", |outcome| outcome.collisions), ("events", |outcome| outcome.events)];
    for (name, of) in counts {
        let counts: Vec<i64> = outcomes.iter().map(|outcome| of(outcome) as i64).collect();
        found.set_item(name, PyArray1::from_vec(py, counts))?;
    }
    let several: Vec<bool> = outcomes.iter().map(|outcome| outcome.several_modes).collect();
    found.set_item("several_modes", PyArray1::from_vec(py, several))?;
    let kinds: Vec<&str> = outcomes.iter().map(Outcome::kind).collect();
    found.set_item("kind", kinds)?;
    let name = |&contact: &usize| {
        mechanism.component(ComponentKind::Contact, contact).map_or("", |found| found.name)
    };
    let closed: Vec<Vec<&str>> =
        outcomes.iter().map(|outcome| outcome.closed.iter().map(name).collect()).collect();
    found.set_item("closed", closed)?;
    let messages: Vec<Option<String>> =
        outcomes.iter().map(|outcome| outcome.error.as_ref().map(ToString::to_string)).collect();
    found.set_item("message", messages)?;
    found.set_item("digest", digest(outcomes))?;
    Ok(found)
}
