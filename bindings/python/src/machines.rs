//! Mechanisms that differ in their parameters: one for every row of a batch.

use std::ops::Range;

use hodograph::{
    CollisionError, CollisionOutcome, ComponentKind, Contacts as _, Mechanism as _, ParameterError, State,
    StateError, Surface,
};
use hodograph_generator::interpret::{Arguments, Prepared};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Column, Table, over_rows};
use pyo3::prelude::*;

use crate::errors;

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

    /// Calls `with` for these rows, each with the mechanism of its parameters and whether that is another one
    /// than that of the row before.
    fn each(
        &self,
        mechanism: &InterpretedMechanism,
        range: Range<usize>,
        mut with: impl FnMut(usize, Result<&InterpretedMechanism, &ParameterError>, bool),
    ) {
        let mut machine = mechanism.clone();
        let mut known: Option<(usize, Result<(), ParameterError>)> = None;
        for row in range {
            let bits = |row: usize| self.row(row).iter().map(|number| number.to_bits());
            let same = known.as_ref().is_some_and(|(other, _)| bits(*other).eq(bits(row)));
            if !same {
                known = Some((row, machine.set_parameter_values(self.row(row))));
            }
            match &known {
                Some((_, Err(error))) => with(row, Err(error), !same),
                _ => with(row, Ok(&machine), !same),
            }
        }
    }

    /// Evaluates a routine at all rows, each with its parameters: the numbers by rows (of a row without
    /// answer they are not numbers), and the rows without answer.
    pub fn evaluate(
        &self,
        mechanism: &InterpretedMechanism,
        routine: &Prepared,
        table: &Table<'_>,
    ) -> (Vec<f64>, Vec<(usize, Refused)>) {
        let parts = over_rows(self.rows, |range| {
            let mut routine = routine.clone();
            let mut numbers = vec![f64::NAN; range.len() * routine.len()];
            let mut refused = Vec::new();
            let start = range.start;
            self.each(mechanism, range, |row, machine, new| {
                let machine = match machine {
                    Ok(machine) => machine,
                    Err(error) => return refused.push((row, Refused::Parameters(error.clone()))),
                };
                if new {
                    routine.refresh(machine.constants());
                }
                let state = OfRow::new(table, row);
                let places = numbers.get_mut((row - start) * routine.len()..).unwrap_or(&mut []);
                let outcome = routine.evaluate(&state.arguments(), |index, number| {
                    if let Some(place) = places.get_mut(index) {
                        *place = number;
                    }
                });
                if let Err(failed) = outcome {
                    refused.push((row, Refused::State(machine.state_error(failed))));
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

    /// Solves the collisions of these rows of a contact; `with` receives the row, and the answer with the
    /// speeds after it.
    pub fn collide(
        &self,
        mechanism: &InterpretedMechanism,
        contact: usize,
        (table, range): (&Table<'_>, Range<usize>),
        surface: impl Fn(usize) -> Surface<f64>,
        mut with: impl FnMut(usize, Result<(CollisionOutcome<f64>, &[f64]), RowError>),
    ) {
        let mut speeds = vec![0.0; mechanism.count(ComponentKind::Speed)];
        self.each(mechanism, range, |row, machine, _| {
            let state = OfRow::new(table, row);
            match machine {
                Err(error) => with(row, Err(RowError::Parameters(error.clone()))),
                Ok(machine) => match machine.collide(contact, &state.state(), &surface(row), &mut speeds) {
                    Ok(outcome) => with(row, Ok((outcome, &speeds))),
                    Err(error) => with(row, Err(RowError::Collision(error))),
                },
            }
        });
    }
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
