//! Marks a * b + c where the product serves sums alone, and drops operations that nothing needs.

use std::collections::HashMap;

use crate::program::operation::{Operation, Stage, Value};
use crate::program::{Guard, Output, Program};

/// Marks fused operations.
pub fn fuse(program: &Program) -> Program {
    let stages = program.stages();
    let mut uses: HashMap<Value, Uses> = HashMap::new();
    for operation in &program.operations {
        let in_sum = matches!(operation, Operation::Add(..) | Operation::Sub(..));
        for operand in operation.operands() {
            let uses = uses.entry(operand).or_default();
            uses.all += 1;
            uses.sums += u32::from(in_sum);
        }
    }
    let wanted = program.outputs.iter().flat_map(|output| output.values.iter().copied());
    for value in
        wanted.chain(program.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten())
    {
        uses.entry(value).or_default().all += 1;
    }
    let factors = |value: Value| match program.operation(value) {
        Operation::Mul(a, b) if stages[value.index()] > Stage::Parameter => {
            let uses = uses.get(&value)?;
            (uses.all == uses.sums).then_some((a, b))
        }
        _ => None,
    };
    let mut operations = program.operations.clone();
    for operation in &mut operations {
        *operation = match *operation {
            Operation::Add(a, b) => match (factors(a), factors(b)) {
                (_, Some((x, y))) => Operation::MulAdd(x, y, a),
                (Some((x, y)), None) => Operation::MulAdd(x, y, b),
                _ => *operation,
            },
            Operation::Sub(a, b) => match (factors(a), factors(b)) {
                (_, Some((x, y))) => Operation::NegMulAdd(x, y, a),
                (Some((x, y)), None) => Operation::MulSub(x, y, b),
                _ => *operation,
            },
            other => other,
        };
    }
    compact(&Program { operations, ..program.clone() })
}

#[derive(Default)]
struct Uses {
    all: u32,
    sums: u32,
}

/// The same program without operations that nothing needs.
pub fn compact(program: &Program) -> Program {
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
