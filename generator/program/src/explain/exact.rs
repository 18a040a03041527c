//! Leaves out operations that are 0 in exact arithmetic: a program computes the rounding error of sums of
//! angles to correct it; in the equations it has no place.

use std::collections::{HashMap, HashSet};

use crate::program::Program;
use crate::program::Slice;
use crate::program::operation::{Operation, Value};

/// The values of a slice that mean something in exact arithmetic, with the number of their uses.
pub struct Exact {
    uses: HashMap<Value, usize>,
}

impl Exact {
    /// Looks at what a slice computes.
    pub fn new(program: &Program, slice: &Slice<'_>) -> Self {
        let mut nothing = HashSet::new();
        for &value in &slice.order {
            if is_nothing(program, value, &nothing) {
                nothing.insert(value);
            }
        }
        let mut uses: HashMap<Value, usize> =
            slice.outputs.iter().flat_map(|output| &output.values).map(|&value| (value, 0)).collect();
        for &value in slice.order.iter().rev().filter(|value| !nothing.contains(value)) {
            if !uses.contains_key(&value) {
                continue;
            }
            for operand in meant(program.operation(value), &nothing) {
                *uses.entry(operand).or_default() += 1;
            }
        }
        uses.retain(|value, _| !nothing.contains(value));
        Exact { uses }
    }

    /// How often a value is used; `None` if it is nothing, or serves nothing else.
    pub fn uses(&self, value: Value) -> Option<usize> {
        self.uses.get(&value).copied()
    }
}

/// The operands that count.
fn meant(operation: Operation, nothing: &HashSet<Value>) -> impl Iterator<Item = Value> {
    use Operation::*;
    let of: Vec<Value> = match operation {
        MulAdd(a, b, c) | MulSub(a, b, c) | NegMulAdd(a, b, c)
            if [a, b].iter().any(|v| nothing.contains(v)) =>
        {
            vec![c]
        }
        _ => operation.operands().collect(),
    };
    of.into_iter().filter(|value| !nothing.contains(value))
}

fn is_nothing(program: &Program, value: Value, nothing: &HashSet<Value>) -> bool {
    use Operation::*;
    match program.operation(value) {
        Neg(a) => nothing.contains(&a),
        Mul(a, b) => nothing.contains(&a) || nothing.contains(&b),
        Add(a, b) => {
            (nothing.contains(&a) && nothing.contains(&b)) || cancels(program, a, b) || cancels(program, b, a)
        }
        Sub(a, b) => (nothing.contains(&a) && nothing.contains(&b)) || returns(program, a, b),
        // the same as `b c - ((b c + a) - a)`
        MulSub(b, c, part) => match program.operation(part) {
            Sub(total, a) => program.operation(total) == MulAdd(b, c, a),
            _ => false,
        },
        _ => false,
    }
}

/// Whether `a - b` is nothing: `a - (t - (t - a))`, or `a - ((a + c) - c)`.
fn returns(program: &Program, a: Value, b: Value) -> bool {
    use Operation::*;
    let Sub(total, part) = program.operation(b) else { return false };
    let sum = match program.operation(total) {
        Add(c, d) => (c, d) == (a, part) || (d, c) == (a, part),
        _ => false,
    };
    sum || program.operation(part) == Sub(total, a)
}

/// Whether `a + b` is nothing: `a + ((c - a) - c)`.
fn cancels(program: &Program, a: Value, b: Value) -> bool {
    use Operation::*;
    let Sub(total, c) = program.operation(b) else { return false };
    program.operation(total) == Sub(c, a)
}
