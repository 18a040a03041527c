//! Modes and forces of closed contacts.

use hodograph::{ClosedContactError, ComponentKind, ContactMode, ContactOutcome, StateError, Surface};
use hodograph_interpreter::columns::over_rows;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Surfaces, array};
use crate::machine::Machine;
use crate::machines::{self, Machines};
use crate::states::States;
use crate::{collisions, errors};

/// What is told of each row beside the accelerations, and how many numbers that are.
const FIELDS: [(&str, usize); 12] = [
    ("normal", 3),
    ("first", 3),
    ("second", 3),
    ("velocity", 3),
    ("reduced", 6),
    ("free_acceleration", 3),
    ("force_on_point", 3),
    ("direction", 3),
    ("force", 3),
    ("acceleration", 3),
    ("margins", 4),
    ("is_unique", 1),
];

/// A row: its numbers, mode and selection, or why it has none.
type Row = Result<(Vec<f64>, &'static str, &'static str), (String, &'static str)>;

fn row(outcome: &ContactOutcome<f64>, accelerations: &[f64]) -> Vec<f64> {
    let answer = &outcome.answer;
    let mut numbers = accelerations.to_vec();
    for vector in [&outcome.normal, &outcome.first, &outcome.second, &outcome.velocity] {
        numbers.extend(vector.iter());
    }
    numbers.extend(<[f64; 6]>::from(outcome.reduced));
    numbers.extend(outcome.free_acceleration.iter().chain(outcome.force_on_point.iter()));
    match outcome.direction {
        Some(direction) => numbers.extend(direction.iter()),
        None => numbers.extend([f64::NAN; 3]),
    }
    numbers.extend(answer.force.iter().chain(answer.acceleration.iter()));
    numbers.extend(answer.margins.named().map(|(_, margin)| margin.unwrap_or(f64::NAN)));
    numbers.push(if answer.force_is_unique { 1.0 } else { 0.0 });
    numbers
}

fn selection(outcome: &ContactOutcome<f64>) -> &'static str {
    match outcome.answer.selection {
        hodograph::Selection::Unique => "unique",
        hodograph::Selection::SeveralModes => "several_modes",
        hodograph::Selection::Indeterminate => "indeterminate",
        _ => "unknown",
    }
}

/// The modes and forces of a contact at all rows.
pub fn closed<'py>(
    py: Python<'py>,
    (machine, machines, contact): (&Machine, Option<&Machines>, usize),
    states: States<'py>,
    mu: &Bound<'py, PyAny>,
    mode: Option<&str>,
    raises: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let mode: Option<ContactMode> = match mode {
        None => None,
        Some(name) => Some(name.parse().map_err(|_| {
            let names: Vec<&str> = ContactMode::ALL.iter().map(|mode| mode.name()).collect();
            let message = format!("the mode is '{name}': expected one of {}", names.join(", "));
            errors::argument(py, "mode", "unknown_name", &message)
        })?),
    };
    let none = 0.0_f64.into_pyobject(py)?;
    let surfaces = Surfaces::new(py, mu, none.as_any(), "newton")?;
    let many = collisions::rows(py, &states, &surfaces)?;
    let states = States { rows: many, ..states };
    let mechanism = machine.contacts();
    let wrong = states.not_finite();
    if let Some(&row) = wrong.first().filter(|_| raises) {
        return Err(states.error(py, mechanism, &StateError::NotFinite, row, wrong.len()));
    }
    let p = machine.count(ComponentKind::Speed);
    let table = states.table();
    let surface = surfaces.of_rows();
    let decide = |machine: &Machine, state: &hodograph::State<'_>, surface: &Surface<f64>| {
        let mut accelerations = vec![0.0; p];
        let mechanism = machine.contacts();
        let found: Result<ContactOutcome<f64>, ClosedContactError<f64>> = match mode {
            None => mechanism.contact_mode(contact, state, surface, &mut accelerations),
            Some(mode) => mechanism.contact_force(contact, mode, state, surface, &mut accelerations),
        };
        found.map(|outcome| (row(&outcome, &accelerations), outcome.answer.mode.name(), selection(&outcome)))
    };
    let parts: Vec<Vec<Row>> = py.detach(|| {
        over_rows(table.rows, |range| {
            let mut rows = Vec::with_capacity(range.len());
            machines::each_state((machine, machines), (&table, range), |row, found| {
                rows.push(match found {
                    _ if wrong.binary_search(&row).is_ok() => {
                        Err((StateError::NotFinite.to_string(), StateError::NotFinite.kind()))
                    }
                    Err(error) => Err((error.to_string(), error.kind())),
                    Ok((machine, state)) => decide(machine, state, &surface(row))
                        .map_err(|error| (error.to_string(), error.kind())),
                });
            });
            rows
        })
    });
    let rows: Vec<Row> = parts.into_iter().flatten().collect();
    if raises
        && let Some((place, Err((message, kind)))) = rows.iter().enumerate().find(|(_, row)| row.is_err())
    {
        let count = rows.iter().filter(|row| row.is_err()).count();
        let place = many.map(|_| format!("row {place}"));
        let message = match (&place, many) {
            (Some(place), Some(rows)) => format!(
                "{place}: {message} ({count} of {rows} rows have no answer; errors='nan' answers them with NaN)"
            ),
            _ => message.clone(),
        };
        return Err(errors::error(py, "ContactError", &message, kind, place, None));
    }
    let mut fields = vec![("accelerations", p)];
    fields.extend(FIELDS);
    let width: usize = fields.iter().map(|(_, size)| size).sum();
    let none = vec![f64::NAN; width];
    let all = PyDict::new(py);
    let mut start = 0;
    for (name, size) in fields {
        let of = |row: &Row| row.as_ref().map_or(&none, |row| &row.0)[start..start + size].to_vec();
        let numbers: Vec<f64> = rows.iter().flat_map(of).collect();
        let shape: &[usize] = if name == "is_unique" { &[] } else { &[size] };
        all.set_item(name, array(py, many, shape, numbers)?)?;
        start += size;
    }
    let words = |of: fn(&Row) -> &'static str| -> Vec<&'static str> { rows.iter().map(of).collect() };
    let kinds = words(|row| row.as_ref().err().map_or("", |(_, kind)| kind));
    let modes = words(|row| row.as_ref().map_or("", |row| row.1));
    let selections = words(|row| row.as_ref().map_or("", |row| row.2));
    for (name, words) in [("kind", kinds), ("mode", modes), ("selection", selections)] {
        match many {
            Some(_) => all.set_item(name, words)?,
            None => all.set_item(name, words.first().copied().unwrap_or(""))?,
        }
    }
    Ok(all)
}
