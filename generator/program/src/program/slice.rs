//! Selects the operations that a routine needs, in an order in which few values are live at a time.

use super::operation::{Operation, Stage, Value};
use super::output::{Guard, Output};
use super::quantity::Quantity;
use super::straight_line::Program;

/// The operations that a set of quantities needs.
#[derive(Clone, Debug)]
pub struct Slice<'a> {
    /// the quantities, in the order given
    pub outputs: Vec<&'a Output>,
    /// the guards of values that the slice computes
    pub guards: Vec<&'a Guard>,
    /// the values needed, operands before their use
    pub order: Vec<Value>,
}

impl Program {
    /// The slice of the given quantities; quantities that the program does not have are left out.
    pub fn slice(&self, quantities: &[Quantity]) -> Slice<'_> {
        let outputs: Vec<&Output> = quantities.iter().filter_map(|&quantity| self.output(quantity)).collect();
        let mut visit = Visit { program: self, seen: vec![false; self.operations.len()], order: Vec::new() };
        for output in &outputs {
            let by_columns = output.quantity.is_solved_by_columns();
            let count = output.values.len();
            let place = |index: usize| match by_columns {
                true => index % output.rows * output.columns + index / output.rows,
                false => index,
            };
            for value in (0..count).filter_map(|index| output.values.get(place(index))) {
                visit.value(*value);
            }
        }
        let mut guards: Vec<&Guard> =
            self.guards.iter().filter(|guard| visit.seen[guard.value.index()]).collect();
        // A guard is checked before the guards of values computed from its value: the first to fail names the
        // cause.
        guards.sort_by_key(|guard| guard.value);
        for guard in &guards {
            if let Some(scale) = guard.scale {
                visit.value(scale);
            }
        }
        Slice { outputs, guards, order: visit.order }
    }

    /// The stage at which both the value and the scale of a guard are known.
    pub fn guard_stage(&self, guard: &Guard, stages: &[Stage]) -> Stage {
        let stage = |value: Value| stages.get(value.index()).copied().unwrap_or(Stage::Velocity);
        guard.scale.map(stage).into_iter().fold(stage(guard.value), Stage::max)
    }

    /// Values that depend on parameters alone and are used at later stages, in order.
    pub fn kept(&self, stages: &[Stage]) -> Vec<Value> {
        let is_kept = |value: Value| {
            let parameter_only = stages.get(value.index()) == Some(&Stage::Parameter);
            parameter_only && !matches!(self.operation(value), Operation::Input(_) | Operation::SinCos(_))
        };
        let late = |index: usize| stages.get(index).is_some_and(|&stage| stage > Stage::Parameter);
        let operations = self.operations.iter().enumerate().filter(|&(index, _)| late(index));
        let used = operations.flat_map(|(_, operation)| operation.operands());
        let results = self.outputs.iter().flat_map(|output| output.values.iter().copied());
        let checked = self.guards.iter().filter(|guard| self.guard_stage(guard, stages) > Stage::Parameter);
        let checked = checked.flat_map(|guard| [Some(guard.value), guard.scale]).flatten();
        let mut kept: Vec<Value> =
            used.chain(results).chain(checked).filter(|&value| is_kept(value)).collect();
        kept.sort_unstable();
        kept.dedup();
        kept
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
