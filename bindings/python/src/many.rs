//! Many motions at once.

use std::sync::PoisonError;
use std::time::Duration;

use hodograph::{ComponentKind, Contacts, State, StateError};
use hodograph_interpreter::motion::{self as defaults, GivenSurface};
use hodograph_simulation::{
    Batch, Case, ContactLaw, ErrorKind, Event, EventFunction, ImpactsAtOnce, Options, Outcome,
    SimulationError, StopAt, Watch, digest, simulate_many,
};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Rows, array, column, common};
use crate::errors;
use crate::laws::Raised;
use crate::machine::Machine;
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
    (machine, machines): (&Machine, Option<&Machines>),
    states: &States<'py>,
    until: f64,
    columns: &Columns<'py>,
    choices: Choices,
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
    if let Err(message) = Options::check_tolerance(tolerance) {
        return Err(errors::argument(py, "tolerance", "bad_option", &message));
    }
    let raised = Raised::default();
    let contacts = machine.contacts();
    let ends = choices.ends(py)?;
    let (own, laws) = own(py, contacts, &choices, &raised)?;
    let never_closed: Vec<usize> = (0..machine.count(ComponentKind::Contact))
        .filter(|&contact| machine.model().contacts.get(contact).is_some_and(|contact| contact.gap.is_none()))
        .collect();
    warn_of_no_gap(py, machine, &never_closed)?;
    let plan = Plan {
        machines,
        state: [Table::of(&states.q), Table::of(&states.u), Table::of(&states.inputs)],
        time: states.time.as_ref().map(Table::of),
        numbers: given_columns.iter().map(|(name, rows)| (*name, Table::of(rows))).collect(),
        not_finite: states.not_finite(),
        all: given(py, &choices.surface)?,
        own,
        laws,
        tolerance,
        max_step: choices.max_step.unwrap_or(machine.greatest_step(false)),
        together: choices.together(py)?,
        events: choices.functions(&raised),
        until,
    };
    let watch = Watch::new();
    let mut interrupted = None;
    let stop = |_: usize, event: &Event| ends.stops(&event.kind);
    let stop: StopAt<'_> = &stop;
    let batch = Batch { threads, watch: Some(&watch), stop: Some(stop) };
    let outcomes = py.detach(|| {
        std::thread::scope(|scope| {
            let waiting = std::thread::current();
            let batch = scope.spawn(move || {
                let outcomes = match machine {
                    Machine::Derived(mechanism) => {
                        simulate_many(rows, |row| plan.case(mechanism.as_ref(), row), &batch)
                    }
                    Machine::Numeric { mechanism, .. } => {
                        simulate_many(rows, |row| plan.case(mechanism.as_ref(), row), &batch)
                    }
                };
                waiting.unpark();
                outcomes
            });
            while !batch.is_finished() {
                std::thread::park_timeout(LOOK);
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
            batch.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    });
    let error = interrupted.or(raised.lock().unwrap_or_else(PoisonError::into_inner).take());
    if let Some(error) = error {
        return Err(error);
    }
    let outcomes: Vec<Outcome> = outcomes.into_iter().flatten().collect();
    tell(py, contacts, &outcomes)
}

/// Numbers of rows, for other threads; one row serves all.
struct Table {
    numbers: Vec<f64>,
    width: usize,
    many: bool,
}

impl Table {
    fn of(rows: &Rows<'_>) -> Self {
        Table { numbers: rows.slice().to_vec(), width: rows.width, many: rows.rows.is_some() }
    }

    fn row(&self, row: usize) -> &[f64] {
        let row = if self.many { row } else { 0 };
        self.numbers.get(row * self.width..(row + 1) * self.width).unwrap_or(&[])
    }
}

/// What the rows are.
struct Plan<'a> {
    machines: Option<&'a Machines>,
    /// coordinates, speeds, inputs
    state: [Table; 3],
    time: Option<Table>,
    /// numbers of surfaces that differ from row to row, by name
    numbers: Vec<(&'a str, Table)>,
    not_finite: Vec<usize>,
    all: GivenSurface,
    own: Vec<(usize, GivenSurface)>,
    laws: Vec<(usize, ContactLaw)>,
    tolerance: f64,
    max_step: f64,
    together: ImpactsAtOnce,
    events: Vec<EventFunction>,
    until: f64,
}

impl Plan<'_> {
    fn case<M: Contacts<f64> + Clone>(
        &self,
        mechanism: &M,
        row: usize,
    ) -> Result<Case<Box<M>>, SimulationError> {
        let first = |table: &Table| table.row(row).first().copied();
        let time = self.time.as_ref().and_then(first).unwrap_or(0.0);
        let failed = |kind| SimulationError { time, contact: None, kind };
        if self.not_finite.binary_search(&row).is_ok() {
            return Err(failed(ErrorKind::State(StateError::NotFinite)));
        }
        let number = |name: &str| {
            let found = self.numbers.iter().find(|(other, _)| *other == name);
            found.and_then(|(_, table)| first(table))
        };
        let mut machine = mechanism.clone();
        if let Some(machines) = self.machines {
            machine.set_parameter_values(machines.row(row)).map_err(|error| failed(error.into()))?;
        }
        let [coordinates, speeds, inputs] = self.state.each_ref().map(|table| table.row(row).to_vec());
        let state = State { time, coordinates: &coordinates, speeds: &speeds, inputs: &inputs };
        let given = GivenSurface { mu: number("mu"), e: number("e"), law: None };
        let all = given.or(self.all).check().map_err(|error| failed(error.into()))?;
        let mut options = Options {
            relative_tolerance: self.tolerance,
            absolute_tolerance: self.tolerance,
            max_step: self.max_step,
            events: self.events.clone(),
            together: match self.together {
                // Each row has draws of its own.
                ImpactsAtOnce::Sampled(seed) => ImpactsAtOnce::Sampled(seed.wrapping_add(row as u64)),
                together => together,
            },
            ..Options::default()
        };
        options.surfaces = defaults::surfaces(&machine, &state, all, &self.own)
            .map_err(|error| {
                let message = format!("{error}: give mu, e and law, or `surfaces`");
                failed(ErrorKind::Argument { cause: error.cause(), message })
            })?
            .of_contacts;
        options.laws.clone_from(&self.laws);
        for (contact, law) in &mut options.laws {
            if self.own.iter().all(|(other, _)| other != contact) {
                law.mu_static = number("mu_static").or(law.mu_static);
                law.mu_impact = number("mu_impact").or(law.mu_impact);
                law.rolling = number("rolling").or(law.rolling);
                law.spinning = number("spinning").or(law.spinning);
            }
        }
        let until = self.until;
        Ok(Case { mechanism: Box::new(machine), time, coordinates, speeds, inputs, options, until })
    }
}

/// What is taken of an outcome.
type Of<R> = fn(&Outcome) -> R;

/// The outcomes by columns.
fn tell<'py>(
    py: Python<'py>,
    mechanism: &dyn Contacts<f64>,
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
    let numbers: [(&str, Of<f64>); 7] = [
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
    let counts: [(&str, Of<usize>); 2] =
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
