//! Straight-line programs: what is computed, in which order, at which stage.
//!
//! ```text
//! graph (sums, products, functions)  ->  passes, one of which lowers it to binary operations  ->  program
//! ```

mod build;
pub mod cost;
pub mod differentiate;
pub mod graph;
pub mod linear;
mod lower;
pub mod operation;
pub mod passes;
pub mod routine;
pub mod slice;
mod words;

use operation::{Operation, Stage, Value};
use routine::{Derived, Quantity, Structure};

/// A straight-line program in static single assignment: every operation once, operands before their use.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Program {
    /// the operations; [`Value`] is an index into them
    pub operations: Vec<Operation>,
    /// what they are for, each quantity at most once
    pub outputs: Vec<Output>,
    /// what must not vanish
    pub guards: Vec<Guard>,
    /// structure of the reduced matrix per contact, in file order
    pub structures: Vec<Structure>,
}

/// A quantity and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// what it is
    pub quantity: Quantity,
    /// number of rows
    pub rows: usize,
    /// number of columns
    pub columns: usize,
    /// rows * columns values, by rows
    pub values: Vec<Value>,
}

/// A value that must not vanish, see [`routine::Guard`].
#[derive(Clone, Debug, PartialEq)]
pub struct Guard {
    /// the value
    pub value: Value,
    /// what it is compared with
    pub scale: Option<Value>,
    /// what is wrong when it vanishes
    pub message: String,
}

/// A value counts as zero where it is at most this times its scale: 2^-40.
pub const VANISHING: f64 = 1.0 / (1u64 << 40) as f64;

impl Program {
    /// The program of a derivation. The same derivation gives the same program.
    pub fn new(derived: &Derived) -> Self {
        passes::run(derived, |_, _| {})
    }

    /// What a value is.
    pub fn operation(&self, value: Value) -> Operation {
        self.operations[value.index()]
    }

    /// The output of a quantity, if the program has it.
    pub fn output(&self, quantity: Quantity) -> Option<&Output> {
        self.outputs.iter().find(|output| output.quantity == quantity)
    }

    /// The stage of every value.
    pub fn stages(&self) -> Vec<Stage> {
        let mut stages: Vec<Stage> = Vec::with_capacity(self.operations.len());
        for &operation in &self.operations {
            stages.push(Stage::of(operation, |operand| stages[operand.index()]));
        }
        stages
    }
}
