//! Collisions of a contact of a mechanism.

use hodograph::nalgebra::Vector3;
use hodograph::{Cause, CollisionError, CollisionOutcome, ComponentKind, Mechanism as _, StateError};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::over_rows;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Surfaces, array, common};
use crate::errors;
use crate::machines::{Machines, RowError, parameter_error};
use crate::states::States;

/// Why a row has no answer, by number: 0 is none, and a cause has its own number after it.
pub fn kinds() -> Vec<&'static str> {
    [""].into_iter().chain(Cause::NAMES.iter().copied()).collect()
}

/// What is told of each row beside the speeds, and how many numbers that are.
const FIELDS: [(&str, usize); 12] = [
    ("normal", 3),
    ("tangent", 3),
    ("binormal", 3),
    ("approach", 3),
    ("reduced", 6),
    ("impulse", 3),
    ("velocity", 3),
    ("impulse_on_point", 3),
    ("energy_change", 1),
    ("contact_work", 1),
    ("normal_work", 1),
    ("energy_gained", 1),
];

/// Rows of numbers, and why rows have none.
#[derive(Default)]
pub struct Answers {
    pub numbers: Vec<f64>,
    pub paths: Vec<u8>,
    pub kinds: Vec<u8>,
}

impl Answers {
    /// A row without an answer.
    pub fn none(&mut self, width: usize, cause: Cause) {
        self.numbers.extend(std::iter::repeat_n(f64::NAN, width));
        self.paths.push(u8::MAX);
        self.kinds.push(1 + cause.number());
    }

    /// The rows of several answers.
    pub fn joined(parts: Vec<Answers>) -> Answers {
        let mut all = Answers::default();
        for part in parts {
            all.numbers.extend(part.numbers);
            all.paths.extend(part.paths);
            all.kinds.extend(part.kinds);
        }
        all
    }

    /// A dictionary of arrays, one for each field; one row becomes arrays without rows.
    pub fn into_fields<'py>(
        self,
        py: Python<'py>,
        rows: Option<usize>,
        fields: &[(&str, usize)],
    ) -> PyResult<Bound<'py, PyDict>> {
        let width: usize = fields.iter().map(|(_, size)| size).sum();
        let all = PyDict::new(py);
        let mut start = 0;
        for &(name, size) in fields {
            let chunks = self.numbers.chunks_exact(width.max(1));
            let numbers: Vec<f64> =
                chunks.flat_map(|row| row.get(start..start + size).unwrap_or(&[])).copied().collect();
            let scalar = size == 1 && name != "speeds";
            let shape: &[usize] = if scalar { &[] } else { &[size] };
            all.set_item(name, array(py, rows, shape, numbers)?)?;
            start += size;
        }
        if rows.is_some() {
            all.set_item("path", PyArray1::from_vec(py, self.paths).to_dyn())?;
            all.set_item("kind", PyArray1::from_vec(py, self.kinds).to_dyn())?;
        } else {
            all.set_item("path", self.paths.first().copied())?;
            all.set_item("kind", self.kinds.first().copied())?;
        }
        Ok(all)
    }
}

fn write(numbers: &mut Vec<f64>, outcome: &CollisionOutcome<f64>, speeds: &[f64]) {
    numbers.extend_from_slice(speeds);
    let mut put = |vector: &Vector3<f64>| numbers.extend(vector.iter());
    put(&outcome.normal);
    put(&outcome.tangent);
    put(&outcome.binormal);
    put(&outcome.approach);
    numbers.extend(<[f64; 6]>::from(outcome.reduced));
    let impact = &outcome.impact;
    let mut put = |vector: &Vector3<f64>| numbers.extend(vector.iter());
    put(&impact.impulse);
    put(&impact.velocity);
    put(&outcome.impulse_on_point);
    let gained = impact.energy_gained().unwrap_or(0.0);
    numbers.extend([outcome.energy_change, impact.contact_work, impact.normal_work, gained]);
}

/// Solves the collisions of all rows.
pub fn collide<'py>(
    py: Python<'py>,
    (mechanism, machines, contact): (&InterpretedMechanism, Option<&Machines>, usize),
    states: States<'py>,
    (mu, e, law): (&Bound<'py, PyAny>, &Bound<'py, PyAny>, &str),
    raises: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let surfaces = Surfaces::new(py, mu, e, law)?;
    let wrong = states.not_finite();
    if let Some(&row) = wrong.first().filter(|_| raises) {
        return Err(states.error(py, mechanism, &StateError::NotFinite, row, wrong.len()));
    }
    let collisions = mechanism
        .collisions(contact)
        .map_err(|error| errors::error(py, "StateError", &error.to_string(), error.kind(), None, None))?;
    // `q` stands for the rows of the state
    let mut state_rows = states;
    let tables = [("mu", &surfaces.mu), ("e", &surfaces.e)];
    let extra = common(py, &tables)?;
    let rows = match (state_rows.rows, extra) {
        (Some(rows), Some(extra)) if rows != extra => {
            let message = format!("`mu` or `e` has {extra} rows, the state has {rows}: expected as many");
            return Err(errors::argument(py, "mu", "wrong_shape", &message));
        }
        (rows, extra) => rows.or(extra),
    };
    state_rows.rows = rows;
    let table = state_rows.table();
    let freedom = mechanism.count(ComponentKind::Speed);
    let mut fields = vec![("speeds", freedom)];
    fields.extend(FIELDS);
    let width = fields.iter().map(|(_, size)| size).sum();
    let surface = surfaces.of_rows();
    let solved = |range: std::ops::Range<usize>| {
        let mut answers = Answers::default();
        let mut first: Option<(usize, RowError)> = None;
        let mut answer = |row: usize, struck: Result<(CollisionOutcome<f64>, &[f64]), RowError>| match struck
        {
            // The model may not read what is not finite; such a state has no collision nevertheless.
            Ok(_) if wrong.binary_search(&row).is_ok() => answers.none(width, Cause::NotFinite),
            Ok((outcome, speeds)) => {
                write(&mut answers.numbers, &outcome, speeds);
                answers.paths.push(outcome.impact.path.number());
                answers.kinds.push(0);
            }
            Err(error) => {
                let cause = match &error {
                    RowError::Parameters(error) => error.cause(),
                    RowError::Collision(error) => error.cause(),
                };
                answers.none(width, cause);
                first.get_or_insert((row, error));
            }
        };
        match machines {
            Some(machines) => machines.collide(mechanism, contact, (&table, range), &surface, answer),
            None => collisions.solve(&table, &surface, range, &mut |row, struck| {
                answer(row, struck.map_err(RowError::Collision));
            }),
        }
        (answers, first)
    };
    let parts = py.detach(|| over_rows(rows.unwrap_or(1), solved));
    let (answers, failed): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    let answers = Answers::joined(answers);
    if raises && let Some((row, error)) = failed.into_iter().flatten().next() {
        let count = answers.kinds.iter().filter(|&&kind| kind != 0).count();
        let error = match error {
            RowError::Collision(error) => error,
            RowError::Parameters(error) => {
                return Err(parameter_error(py, &error, (row, rows.unwrap_or(1), count)));
            }
        };
        return Err(match error {
            CollisionError::State(error) => state_rows.error(py, mechanism, &error, row, count),
            CollisionError::Impact(error) => impact_error(py, &error, rows.map(|rows| (row, rows, count))),
            error => errors::error(py, "ImpactError", &error.to_string(), error.kind(), None, None),
        });
    }
    answers.into_fields(py, rows, &fields)
}

/// The exception of a collision without outcome; `place`: its row, of how many, and how many of them have
/// none.
pub fn impact_error(
    py: Python<'_>,
    error: &hodograph::ImpactError<f64>,
    place: Option<(usize, usize, usize)>,
) -> PyErr {
    let message = match place {
        Some((row, rows, count)) => format!(
            "row {row}: {error} ({count} of {rows} rows have no answer; errors='nan' answers them with NaN)"
        ),
        None => error.to_string(),
    };
    let place = place.map(|(row, ..)| format!("row {row}"));
    errors::error(py, "ImpactError", &message, error.kind(), place, errors::number(error))
}
