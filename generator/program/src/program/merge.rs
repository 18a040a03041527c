//! Merges two programs; equal operations become one value.

use std::collections::HashMap;

use super::operation::{Operation, Value};
use super::output::{Guard, Output};
use super::straight_line::Program;

impl Program {
    /// Adds the quantities of another program of the same mechanism.
    pub fn append(&mut self, other: &Program) {
        let mut places: HashMap<Operation, Value> = HashMap::new();
        for (index, &operation) in self.operations.iter().enumerate() {
            places.entry(operation).or_insert(Value(index as u32));
        }
        let mut renamed: Vec<Value> = Vec::with_capacity(other.operations.len());
        for operation in &other.operations {
            let operation = operation.map(|value| renamed[value.index()]);
            let value = *places.entry(operation).or_insert_with(|| {
                self.operations.push(operation);
                Value(self.operations.len() as u32 - 1)
            });
            renamed.push(value);
        }
        let of = |value: Value| renamed[value.index()];
        self.outputs.extend(other.outputs.iter().map(|output| Output {
            values: output.values.iter().map(|&value| of(value)).collect(),
            ..output.clone()
        }));
        for guard in &other.guards {
            let guard =
                Guard { value: of(guard.value), scale: guard.scale.map(of), message: guard.message.clone() };
            if !self.guards.iter().any(|known| known.value == guard.value) {
                self.guards.push(guard);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quantity;
    use super::super::passes::testing::{inputs, random};
    use super::*;
    use crate::interpret::Evaluator;

    fn bits(program: &Program, quantity: Quantity) -> Option<Vec<u64>> {
        let values = Evaluator::new(program).evaluate(&inputs(), &[quantity]).ok()?.remove(0).values;
        Some(values.into_iter().map(f64::to_bits).collect())
    }

    #[test]
    fn both_keep_their_bits_and_share_equal_operations() {
        let mut compared = 0;
        for seed in 1..40 {
            let first = Program::new(&random(seed));
            let mut second = Program::new(&random(seed + 40));
            second.outputs[0].quantity = Quantity::Accelerations;
            let mut both = first.clone();
            both.append(&second);
            assert_eq!(bits(&both, Quantity::Forcing), bits(&first, Quantity::Forcing));
            assert_eq!(bits(&both, Quantity::Accelerations), bits(&second, Quantity::Accelerations));
            compared += usize::from(bits(&both, Quantity::Accelerations).is_some());
            let mut twice = first.clone();
            twice.append(&first);
            assert_eq!(twice.operations, first.operations);
            assert_eq!(twice.guards, first.guards);
        }
        assert!(compared > 10, "{compared}");
    }
}
