//! Leaves out operations that are 0 in exact arithmetic. Programs compute the rounding error of sums of
//! angles in order to correct it; the written equations do without.

use std::collections::{HashMap, HashSet};

use crate::program::Program;
use crate::program::Slice;
use crate::program::operation::{Operation, Value};

/// The values of a slice that are not 0 in exact arithmetic, with the number of their uses.
pub struct Exact {
    uses: HashMap<Value, usize>,
}

impl Exact {
    /// Finds the values that are 0 in exact arithmetic, and counts the uses of the others.
    pub fn new(program: &Program, slice: &Slice<'_>) -> Self {
        let mut zeros = HashSet::new();
        for &value in &slice.order {
            if is_zero(program, value, &zeros) {
                zeros.insert(value);
            }
        }
        let mut uses: HashMap<Value, usize> =
            slice.outputs.iter().flat_map(|output| &output.values).map(|&value| (value, 0)).collect();
        for &value in slice.order.iter().rev().filter(|value| !zeros.contains(value)) {
            if !uses.contains_key(&value) {
                continue;
            }
            for operand in nonzero_operands(program.operation(value), &zeros) {
                *uses.entry(operand).or_default() += 1;
            }
        }
        uses.retain(|value, _| !zeros.contains(value));
        Exact { uses }
    }

    /// How often a value is used; `None` if it is 0 in exact arithmetic, or only such values use it.
    pub fn uses(&self, value: Value) -> Option<usize> {
        self.uses.get(&value).copied()
    }
}

/// The operands of an operation that contribute to its result in exact arithmetic.
fn nonzero_operands(operation: Operation, zeros: &HashSet<Value>) -> impl Iterator<Item = Value> {
    use Operation::*;
    let of: Vec<Value> = match operation {
        MulAdd(a, b, c) | MulSub(a, b, c) | NegMulAdd(a, b, c)
            if [a, b].iter().any(|v| zeros.contains(v)) =>
        {
            vec![c]
        }
        _ => operation.operands().collect(),
    };
    of.into_iter().filter(|value| !zeros.contains(value))
}

fn is_zero(program: &Program, value: Value, zeros: &HashSet<Value>) -> bool {
    use Operation::*;
    match program.operation(value) {
        Neg(a) => zeros.contains(&a),
        Mul(a, b) => zeros.contains(&a) || zeros.contains(&b),
        Add(a, b) => {
            (zeros.contains(&a) && zeros.contains(&b))
                || sum_is_zero(program, a, b)
                || sum_is_zero(program, b, a)
        }
        Sub(a, b) => (zeros.contains(&a) && zeros.contains(&b)) || difference_is_zero(program, a, b),
        // the same as `b c - ((b c + a) - a)`
        MulSub(b, c, part) => match program.operation(part) {
            Sub(total, a) => program.operation(total) == MulAdd(b, c, a),
            _ => false,
        },
        _ => false,
    }
}

/// Whether `a - b` is identically 0: `a - (t - (t - a))`, or `a - ((a + c) - c)`.
fn difference_is_zero(program: &Program, a: Value, b: Value) -> bool {
    use Operation::*;
    let Sub(total, part) = program.operation(b) else { return false };
    let sum = match program.operation(total) {
        Add(c, d) => (c, d) == (a, part) || (d, c) == (a, part),
        _ => false,
    };
    sum || program.operation(part) == Sub(total, a)
}

/// Whether `a + b` is identically 0: `a + ((c - a) - c)`.
fn sum_is_zero(program: &Program, a: Value, b: Value) -> bool {
    use Operation::*;
    let Sub(total, c) = program.operation(b) else { return false };
    program.operation(total) == Sub(c, a)
}
