//! Mechanisms that differ in their parameters: one for every row of a batch.

use std::ops::Range;

use hodograph::{
    Budgeted, CollisionError, CollisionOutcome, ComponentKind, ParameterError, State, StateError,
};
use hodograph_generator::interpret::{Arguments, Prepared};
use hodograph_generator::program::Quantity;
use hodograph_interpreter::columns::{Column, Table, over_rows};
use pyo3::prelude::*;

use crate::machine::Machine;
use crate::{errors, numeric};

/// Parameters of every row.
#[derive(Clone)]
pub struct Machines {
    /// by rows
    pub numbers: Vec<f64>,
    pub rows: usize,
    pub width: usize,
}

/// Why a row has no answer.
pub enum Refused {
    Parameters(ParameterError),
    State(StateError),
}

impl Machines {
    pub fn row(&self, row: usize) -> &[f64] {
        self.numbers.get(row * self.width..(row + 1) * self.width).unwrap_or(&[])
    }
}

/// Calls `with` for these rows, each with the mechanism of its parameters, if they have some of their own, and whether that
/// is another one than that of the row before.
fn each(
    (machine, machines): (&Machine, Option<&Machines>),
    range: Range<usize>,
    mut with: impl FnMut(usize, Result<&Machine, &ParameterError>, bool),
) {
    // Of its own: what was computed of the last state is kept in it.
    let mut machine = machine.clone();
    let mut known: Option<(usize, Result<(), ParameterError>)> = None;
    for row in range {
        let mut new = known.is_none();
        if let Some(machines) = machines {
            let bits = |row: usize| machines.row(row).iter().map(|number| number.to_bits());
            let same = known.as_ref().is_some_and(|(other, _)| bits(*other).eq(bits(row)));
            new = !same;
            if new {
                known = Some((row, machine.set_parameters(machines.row(row))));
            }
        } else {
            known.get_or_insert((row, Ok(())));
        }
        match &known {
            Some((_, Err(error))) => with(row, Err(error), new),
            _ => with(row, Ok(&machine), new),
        }
    }
}

/// What is evaluated at many states, each by a mechanism of its own.
pub enum Asked<'a> {
    /// a routine of the derived equations
    Routine(&'a Prepared),
    /// a quantity of a model without these, of so many numbers
    Quantity(Quantity, usize),
}

/// Evaluates what is asked at all rows: the numbers by rows (of a row without answer they are not numbers), and the rows
/// without answer.
pub fn evaluate(
    of: (&Machine, Option<&Machines>),
    asked: &Asked<'_>,
    table: &Table<'_>,
) -> (Vec<f64>, Vec<(usize, Refused)>) {
    let width = match asked {
        Asked::Routine(routine) => routine.len(),
        Asked::Quantity(_, width) => *width,
    };
    let parts = over_rows(table.rows, |range| {
        let mut routine = match asked {
            Asked::Routine(routine) => Some((*routine).clone()),
            Asked::Quantity(..) => None,
        };
        let mut numbers = vec![f64::NAN; range.len() * width];
        let mut refused = Vec::new();
        let start = range.start;
        each(of, range, |row, machine, new| {
            let machine = match machine {
                Ok(machine) => machine,
                Err(error) => return refused.push((row, Refused::Parameters(*error))),
            };
            let state = OfRow::new(table, row);
            let places = numbers.get_mut((row - start) * width..).unwrap_or(&mut []);
            let outcome = match (&mut routine, machine, asked) {
                (Some(routine), Machine::Derived(derived), _) => {
                    if new {
                        routine.refresh(derived.constants());
                    }
                    let with = |index: usize, number: f64| {
                        if let Some(place) = places.get_mut(index) {
                            *place = number;
                        }
                    };
                    routine.evaluate(&state.arguments(), with).map_err(|failed| derived.state_error(failed))
                }
                (_, _, Asked::Quantity(quantity, _)) => {
                    let [.., accelerations, _] = &state.lists;
                    let places = places.get_mut(..width).unwrap_or(&mut []);
                    numeric::evaluate(machine.contacts(), *quantity, &state.state(), accelerations, places)
                }
                _ => Err(StateError::Undefined { what: "quantity" }),
            };
            if let Err(error) = outcome {
                refused.push((row, Refused::State(error)));
            }
        });
        (numbers, refused)
    });
    let mut all = (Vec::new(), Vec::new());
    for (numbers, refused) in parts {
        all.0.extend(numbers);
        all.1.extend(refused);
    }
    all
}

/// Solves the collisions of these rows of a contact, one by one; `with` receives the row, and the answer with the speeds
/// after it.
pub fn collide(
    of: (&Machine, Option<&Machines>),
    contact: usize,
    (table, range): (&Table<'_>, Range<usize>),
    surface: impl Fn(usize) -> Budgeted<f64>,
    mut with: impl FnMut(usize, Result<(CollisionOutcome<f64>, &[f64]), RowError>),
) {
    let mut speeds = vec![0.0; of.0.count(ComponentKind::Speed)];
    each(of, range, |row, machine, _| {
        let state = OfRow::new(table, row);
        match machine {
            Err(error) => with(row, Err(RowError::Parameters(*error))),
            Ok(machine) => {
                let found = machine.contacts().collide_with_budget(
                    contact,
                    &state.state(),
                    &surface(row),
                    &mut speeds,
                );
                with(row, found.map(|outcome| (outcome, &speeds[..])).map_err(RowError::Collision));
            }
        }
    });
}

/// Calls `with` for these rows with their machines and states.
pub fn each_state(
    of: (&Machine, Option<&Machines>),
    (table, range): (&Table<'_>, Range<usize>),
    mut with: impl FnMut(usize, Result<(&Machine, &State<'_>), &ParameterError>),
) {
    each(of, range, |row, machine, _| {
        let row_state = OfRow::new(table, row);
        let state = row_state.state();
        with(row, machine.map(|machine| (machine, &state)));
    });
}

/// Why a collision of a row has no outcome.
pub enum RowError {
    Parameters(ParameterError),
    Collision(CollisionError<f64>),
}

/// The state of a row.
struct OfRow {
    time: f64,
    lists: [Vec<f64>; 5],
}

impl OfRow {
    fn new(table: &Table<'_>, row: usize) -> Self {
        let of = |columns: &[Column<'_>]| columns.iter().map(|column| column.get(row)).collect();
        OfRow {
            time: table.time.map_or(0.0, |time| time.get(row)),
            lists: [&table.coordinates, &table.speeds, &table.inputs, &table.accelerations, &table.tangent]
                .map(|columns| of(columns)),
        }
    }

    fn state(&self) -> State<'_> {
        let [coordinates, speeds, inputs, ..] = &self.lists;
        State { time: self.time, coordinates, speeds, inputs }
    }

    fn arguments(&self) -> Arguments<'_> {
        let [coordinates, speeds, inputs, accelerations, tangent] = &self.lists;
        Arguments { time: self.time, coordinates, speeds, inputs, accelerations, tangent }
    }
}

/// The exception of a row whose parameters are those of no mechanism; `count` of `rows` rows have no answer.
pub fn parameter_error(
    py: Python<'_>,
    error: &ParameterError,
    (row, rows, count): (usize, usize, usize),
) -> PyErr {
    let message = format!(
        "row {row}: {error} ({count} of {rows} rows have no answer; errors='nan' answers them with NaN)"
    );
    errors::error(py, "ParameterError", &message, error.kind(), Some(format!("row {row}")), None)
}
