//! The part of a program that a routine needs, in an order that keeps few values alive.

use super::operation::Value;
use super::output::{Guard, Output};
use super::quantity::Quantity;
use super::straight_line::Program;

/// What a set of quantities needs.
#[derive(Clone, Debug)]
pub struct Slice<'a> {
    /// the quantities, in the order asked for
    pub outputs: Vec<&'a Output>,
    /// the guards whose value belongs to the slice
    pub guards: Vec<&'a Guard>,
    /// the values needed, operands before their use
    pub order: Vec<Value>,
}

impl Program {
    /// What the given quantities need; those that the program has not are left out.
    pub fn slice(&self, quantities: &[Quantity]) -> Slice<'_> {
        let outputs: Vec<&Output> = quantities.iter().filter_map(|&quantity| self.output(quantity)).collect();
        let mut visit = Visit { program: self, seen: vec![false; self.operations.len()], order: Vec::new() };
        for output in &outputs {
            for &value in &output.values {
                visit.value(value);
            }
        }
        let mut guards: Vec<&Guard> =
            self.guards.iter().filter(|guard| visit.seen[guard.value.index()]).collect();
        // What a value is computed from is checked before it: the first guard to fail names the cause.
        guards.sort_by_key(|guard| guard.value);
        for guard in &guards {
            if let Some(scale) = guard.scale {
                visit.value(scale);
            }
        }
        Slice { outputs, guards, order: visit.order }
    }
}

struct Visit<'a> {
    program: &'a Program,
    seen: Vec<bool>,
    order: Vec<Value>,
}

impl Visit<'_> {
    /// Appends a value after its operands, depth first, without recursion.
    fn value(&mut self, root: Value) {
        let mut stack = vec![(root, false)];
        while let Some((value, operands_done)) = stack.pop() {
            if operands_done {
                self.order.push(value);
            } else if !self.seen[value.index()] {
                self.seen[value.index()] = true;
                stack.push((value, true));
                let operands: Vec<Value> = self.program.operation(value).operands().collect();
                stack
                    .extend(operands.into_iter().rev().filter(|o| !self.seen[o.index()]).map(|o| (o, false)));
            }
        }
    }
}
