//! Removes operations that no output and no guard needs.

use crate::program::operation::Value;
use crate::program::output::{Guard, Output};
use crate::program::straight_line::Program;

/// The same program without operations that no output and no guard needs.
pub fn remove(program: &Program) -> Program {
    let mut needed = vec![false; program.operations.len()];
    let outputs = program.outputs.iter().flat_map(|output| output.values.iter().copied());
    for value in
        outputs.chain(program.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten())
    {
        needed[value.index()] = true;
    }
    for index in (0..program.operations.len()).rev() {
        if needed[index] {
            for operand in program.operations[index].operands() {
                needed[operand.index()] = true;
            }
        }
    }
    let mut renamed = vec![Value(0); program.operations.len()];
    let mut operations = Vec::new();
    for (index, operation) in program.operations.iter().enumerate() {
        if needed[index] {
            renamed[index] = Value(operations.len() as u32);
            operations.push(operation.map(|operand| renamed[operand.index()]));
        }
    }
    let of = |value: Value| renamed[value.index()];
    let outputs = program.outputs.iter().map(|output| Output {
        values: output.values.iter().map(|&value| of(value)).collect(),
        ..output.clone()
    });
    let guards = program.guards.iter().map(|guard| Guard {
        value: of(guard.value),
        scale: guard.scale.map(of),
        message: guard.message.clone(),
    });
    let (outputs, guards) = (outputs.collect(), guards.collect());
    Program { operations, outputs, guards, structures: program.structures.clone() }
}

#[cfg(test)]
mod tests {
    use super::super::lower;
    use super::super::testing::{bits, operations, random, small, speeds};
    use super::*;
    use crate::program::operation::Operation;

    #[test]
    fn unused_operations_are_removed_and_the_rest_is_renumbered() {
        let mut program = lower(&small(|g| {
            let [a, b, ..] = speeds(g);
            vec![g.product([a, b])]
        }));
        let [a, b] = [Value(0), Value(1)];
        program.operations.insert(2, Operation::Add(a, b));
        program.outputs[0].values = vec![Value(3)];
        let swept = remove(&program);
        assert_eq!(operations(&swept), ["Mul"]);
        assert_eq!(swept.outputs[0].values, [Value(2)]);
    }

    #[test]
    fn operands_of_guards_stay() {
        let mut program = lower(&small(|g| vec![speeds(g)[0]]));
        program.operations.push(Operation::Neg(Value(0)));
        program.guards = vec![Guard { value: Value(1), scale: None, message: String::new() }];
        assert_eq!(remove(&program), program);
    }

    #[test]
    fn every_bit_stays() {
        for seed in 1..150 {
            let program = lower(&random(seed));
            let swept = remove(&program);
            assert!(swept.operations.len() <= program.operations.len());
            assert_eq!(bits(&program), bits(&swept), "seed {seed}");
            assert_eq!(remove(&swept), swept, "seed {seed}: nothing is left to do");
        }
    }
}
