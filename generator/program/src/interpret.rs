//! Interprets programs in doubles: the reference for what a program computes.
//!
//! Generated code consists of the same operations and computes the same bits with the same implementation of
//! floating-point functions.

pub mod columns;
mod constants;
mod directional;
mod prepared;
mod schedule;
mod transposed;

use std::collections::BTreeSet;
use std::fmt;

use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::{Guard, Inputs, Program, Quantity, Slice, VANISHING, operate};
use hodograph_model::arithmetic::DoubleDouble;

use constants::holds;

pub use columns::{Column, Columns, Table};
pub use constants::Constants;
pub use directional::{Directional, Rates};
pub use prepared::{Arguments, Failed, Prepared};
pub use transposed::{Cotangents, Transposed};

/// The values of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// the quantity
    pub quantity: Quantity,
    /// number of rows
    pub rows: usize,
    /// number of columns
    pub columns: usize,
    /// rows * columns numbers, by rows
    pub values: Vec<f64>,
}

impl Array {
    /// The entry in a row and a column.
    pub fn at(&self, row: usize, column: usize) -> f64 {
        self.values.get(row * self.columns + column).copied().unwrap_or(f64::NAN)
    }

    /// The rows.
    pub fn rows(&self) -> impl Iterator<Item = &[f64]> {
        self.values.chunks(self.columns.max(1))
    }
}

/// Why a program has no result for some inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// a value vanishes that must not
    Singular {
        /// the meaning of this, in words
        message: String,
        /// the vanishing value
        value: f64,
        /// indices of the coordinates on which this value depends
        coordinates: Vec<u32>,
    },
    /// a result, or a value that must not vanish, is infinite or not a number
    NotFinite,
    /// the program does not compute this quantity
    Absent(Quantity),
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Singular { message, .. } => write!(out, "the state is singular: {message}"),
            Failure::NotFinite => {
                write!(out, "a result is infinite or not a number: check the state and the parameters")
            }
            Failure::Absent(quantity) => write!(out, "this mechanism has no {quantity:?}"),
        }
    }
}

impl std::error::Error for Failure {}

/// Evaluates a program.
#[derive(Clone, Debug)]
pub struct Evaluator<'a> {
    program: &'a Program,
    stages: Vec<Stage>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator of a program.
    pub fn new(program: &'a Program) -> Self {
        Evaluator { program, stages: program.stages() }
    }

    /// The values of the quantities, in the order given.
    pub fn evaluate(&self, inputs: &Inputs, quantities: &[Quantity]) -> Result<Vec<Array>, Failure> {
        if let Some(&absent) = quantities.iter().find(|&&quantity| self.program.output(quantity).is_none()) {
            return Err(Failure::Absent(absent));
        }
        let slice = self.program.slice(quantities);
        let numbers = self.numbers(inputs, &slice);
        for guard in &slice.guards {
            self.check(guard, &numbers)?;
        }
        let mut arrays = Vec::with_capacity(slice.outputs.len());
        for output in &slice.outputs {
            let values: Vec<f64> = output.values.iter().map(|value| numbers[value.index()].0).collect();
            if !values.iter().all(|value| value.is_finite()) {
                return Err(Failure::NotFinite);
            }
            arrays.push(Array {
                quantity: output.quantity,
                rows: output.rows,
                columns: output.columns,
                values,
            });
        }
        Ok(arrays)
    }

    /// The value of every operation of the slice; of a sine-cosine pair both, else the second is 0. Values
    /// that depend on parameters alone are computed in double-double arithmetic and rounded once.
    fn numbers(&self, inputs: &Inputs, slice: &Slice<'_>) -> Vec<(f64, f64)> {
        let (none, nothing) = ((0.0, 0.0), DoubleDouble::new(0.0));
        let mut numbers = vec![none; self.program.operations.len()];
        let mut early = vec![(nothing, nothing); self.program.operations.len()];
        for &value in &slice.order {
            let (operation, index) = (self.program.operation(value), value.index());
            if self.stages[index] <= Stage::Parameter {
                let (first, second) = operate(operation, inputs, |value| early[value.index()]);
                early[index] = (first, second);
                numbers[index] = (first.rounded(), second.rounded());
            } else {
                numbers[index] = operate(operation, inputs, |value| numbers[value.index()]);
            }
        }
        numbers
    }

    fn check(&self, guard: &Guard, numbers: &[(f64, f64)]) -> Result<(), Failure> {
        let value = numbers[guard.value.index()].0;
        let bound = guard.scale.map_or(0.0, |scale| VANISHING * numbers[scale.index()].0.abs());
        if holds(value, bound) {
            Ok(())
        } else if value.is_finite() && bound.is_finite() {
            let coordinates = self.coordinates_of(guard.value);
            Err(Failure::Singular { message: guard.message.clone(), value, coordinates })
        } else {
            Err(Failure::NotFinite)
        }
    }

    fn coordinates_of(&self, value: Value) -> Vec<u32> {
        let (mut seen, mut open, mut found) = (BTreeSet::new(), vec![value], BTreeSet::new());
        while let Some(value) = open.pop() {
            if !seen.insert(value) {
                continue;
            }
            let operation = self.program.operation(value);
            if let Operation::Input(Input::Coordinate(index)) = operation {
                found.insert(index);
            }
            open.extend(operation.operands());
        }
        found.into_iter().collect()
    }
}
