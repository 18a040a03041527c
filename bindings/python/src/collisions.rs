//! Collisions of a contact of a mechanism.

use hodograph::nalgebra::Vector3;
use hodograph::{
    Cause, CollisionError, CollisionOutcome, ComponentKind, Contacts, State, StateError, Surface,
};
use hodograph_interpreter::columns::{Collisions, over_rows};
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;

use crate::arguments::{Surfaces, array, common};
use crate::errors;
use crate::machine::Machine;
use crate::machines::{self, Machines, RowError, parameter_error};
use crate::states::States;

/// Why a row has no answer, by number: 0 is none, and a cause has its own number after it.
pub fn kinds() -> Vec<&'static str> {
    [""].into_iter().chain(Cause::NAMES.iter().copied()).collect()
}

/// What is told of each row beside the speeds, and how many numbers that are.
pub const FIELDS: [(&str, usize); 14] = [
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
    ("compressions", 1),
    ("sensitivity", 1),
];
/// How many numbers that are in all.
const WIDTH: usize = width(&FIELDS);

/// How many numbers these fields are.
pub const fn width(fields: &[(&str, usize)]) -> usize {
    let (mut sum, mut place) = (0, 0);
    while place < fields.len() {
        sum += fields[place].1;
        place += 1;
    }
    sum
}

/// The numbers of rows, the codes of their paths and why rows have none.
pub type Found<'py> = (Bound<'py, PyArrayDyn<f64>>, Bound<'py, PyAny>, Bound<'py, PyAny>);

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

    /// The numbers as an array with a row for each, or of the only one, and the codes of paths and kinds.
    pub fn found(self, py: Python<'_>, rows: Option<usize>, width: usize) -> PyResult<Found<'_>> {
        let numbers = array(py, rows, &[width], self.numbers)?;
        let codes = |codes: Vec<u8>| -> PyResult<Bound<'_, PyAny>> {
            match rows {
                Some(_) => Ok(PyArray1::from_vec(py, codes).to_dyn().clone().into_any()),
                None => Ok(codes.first().copied().unwrap_or(u8::MAX).into_pyobject(py)?.into_any()),
            }
        };
        Ok((numbers, codes(self.paths)?, codes(self.kinds)?))
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
    let flags = &impact.sensitivity;
    let flags = [flags.near_mu_c, flags.grazing, flags.unstable_direction, flags.no_slip, flags.jam];
    let bits = flags.iter().rev().fold(0, |bits, &flag| 2 * bits + u32::from(flag));
    numbers.extend([f64::from(impact.compressions), f64::from(bits)]);
}

/// The rows of states and surfaces; none where there is one for all.
pub fn rows(py: Python<'_>, states: &States<'_>, surfaces: &Surfaces<'_>) -> PyResult<Option<usize>> {
    let tables = [("mu", &surfaces.mu), ("e", &surfaces.e)];
    match (states.rows, common(py, &tables)?) {
        (Some(rows), Some(extra)) if rows != extra => {
            let message = format!("`mu` or `e` has {extra} rows, the state has {rows}: expected as many");
            Err(errors::argument(py, "mu", "wrong_shape", &message))
        }
        (rows, extra) => Ok(rows.or(extra)),
    }
}

/// Solves one collision.
fn solved(
    mechanism: &dyn Contacts<f64>,
    contact: usize,
    state: &State<'_>,
    (surface, budget): (&Surface<f64>, Option<u32>),
    speeds: &mut [f64],
) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
    match budget {
        None => mechanism.collide(contact, state, surface, speeds),
        Some(quadratures) => {
            mechanism.collide_with_budget(contact, state, &surface.with_budget(quadratures), speeds)
        }
    }
}

/// Solves the collision of one state.
pub fn one<'py>(
    py: Python<'py>,
    (machine, _, contact): (&Machine, Option<&Machines>, usize),
    states: &States<'py>,
    surface: &Surface<f64>,
    budget: Option<u32>,
    raises: bool,
) -> PyResult<Found<'py>> {
    let mechanism = machine.contacts();
    let state = states.one();
    let freedom = state.speeds.len();
    let width = freedom + WIDTH;
    let mut answers = Answers::default();
    let outcome = if states.not_finite().is_empty() {
        answers.numbers.reserve_exact(width);
        let mut speeds = vec![0.0; freedom];
        solved(mechanism, contact, &state, (surface, budget), &mut speeds).map(|outcome| {
            write(&mut answers.numbers, &outcome, &speeds);
            answers.paths.push(outcome.impact.path.number());
            answers.kinds.push(0);
        })
    } else {
        Err(StateError::NotFinite.into())
    };
    match outcome {
        Ok(()) => {}
        Err(error) if raises => return Err(refused(py, mechanism, states, error, None)),
        Err(error) => answers.none(width, error.cause()),
    }
    answers.found(py, None, width)
}

/// The exception of a collision without outcome.
fn refused(
    py: Python<'_>,
    mechanism: &dyn Contacts<f64>,
    states: &States<'_>,
    error: CollisionError<f64>,
    place: Option<(usize, usize, usize)>,
) -> PyErr {
    match error {
        CollisionError::State(error) => {
            let (row, _, count) = place.unwrap_or((0, 1, 1));
            states.error(py, mechanism, &error, row, count)
        }
        CollisionError::Impact(error) => impact_error(py, &error, place),
        error => errors::error(py, "ImpactError", &error.to_string(), error.kind(), None, None),
    }
}

/// Solves the collisions of all rows, by a routine of the derived equations where there is one.
pub fn many<'py>(
    py: Python<'py>,
    (machine, machines, contact): (&Machine, Option<&Machines>, usize),
    routine: Option<&Collisions>,
    states: &States<'py>,
    (surfaces, budget): (&Surfaces<'py>, Option<u32>),
    raises: bool,
) -> PyResult<Found<'py>> {
    let mechanism = machine.contacts();
    let wrong = states.not_finite();
    if let Some(&row) = wrong.first().filter(|_| raises) {
        return Err(states.error(py, mechanism, &StateError::NotFinite, row, wrong.len()));
    }
    let table = states.table();
    let rows = table.rows;
    let width = machine.count(ComponentKind::Speed) + WIDTH;
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
        match routine {
            Some(routine) => routine.solve(&table, &surface, range, &mut |row, struck| {
                answer(row, struck.map_err(RowError::Collision));
            }),
            None => {
                let of = (machine, machines);
                let surface = |row| surface(row).with_budget(budget.unwrap_or(u32::MAX));
                machines::collide(of, contact, (&table, range), surface, answer);
            }
        }
        (answers, first)
    };
    let parts = py.detach(|| over_rows(rows, solved));
    let (answers, failed): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    let answers = Answers::joined(answers);
    if raises && let Some((row, error)) = failed.into_iter().flatten().next() {
        let count = answers.kinds.iter().filter(|&&kind| kind != 0).count();
        return Err(match error {
            RowError::Collision(error) => refused(py, mechanism, states, error, Some((row, rows, count))),
            RowError::Parameters(error) => parameter_error(py, &error, (row, rows, count)),
        });
    }
    answers.found(py, Some(rows), width)
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
