//! The type of programs.

use super::operation::{Operation, Stage, Value};
use super::output::{Guard, Output};
use super::quantity::{Quantity, Structure};

/// A straight-line program in static single assignment: every operation once, operands before their use.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Program {
    /// the operations; [`Value`] is an index into them
    pub operations: Vec<Operation>,
    /// the quantities and their values, each quantity at most once
    pub outputs: Vec<Output>,
    /// values that must not vanish
    pub guards: Vec<Guard>,
    /// structure of the reduced matrix per contact, in file order
    pub structures: Vec<Structure>,
}

impl Program {
    /// The operation of a value.
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
