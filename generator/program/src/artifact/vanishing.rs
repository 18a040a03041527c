//! Tests that no shipped derivation computes a value that is identically 0, 1 or -1, or multiplies and
//! divides by the same value.

use std::path::{Path, PathBuf};

use super::decode;
use crate::program::operation::{Operation, Value};
use crate::program::{Inputs, Program, operate};
use hodograph_model::arithmetic::reproducible::Reproducible;
use hodograph_model::arithmetic::{Arithmetic, Function};

/// A value below this part of its largest term counts as zero.
const NEGLIGIBLE: f64 = 1e-22;

fn derivations(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        // derivations in `ui` are damaged on purpose
        if path.is_dir() && path.file_name().is_none_or(|name| name != "target" && name != "ui") {
            derivations(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "derivation") {
            found.push(path);
        }
    }
}

/// Arbitrary numbers, always the same for a seed.
fn numbers(seed: u64) -> Vec<f64> {
    let mut random = hodograph_random::Random::new(seed);
    (0..400).map(|_| random.between(0.3, 2.0)).collect()
}

/// Whether the value is part of the computed rounding error of a sum t = a + b, `a - (t - (t - a))`. That
/// error is 0 in exact arithmetic, but not in doubles.
fn is_rounding(program: &Program, value: Value) -> bool {
    let (term, part) = match program.operation(value) {
        Operation::Add(a, b) | Operation::Sub(a, b) => (a, b),
        Operation::MulSub(_, _, part) => (part, part),
        _ => return false,
    };
    let is_return = |term: Value, part: Value| match program.operation(part) {
        Operation::Sub(total, other) => {
            let parts: Vec<Value> = program.operation(total).operands().collect();
            parts.contains(&term)
                || parts.contains(&other)
                || matches!(program.operation(other), Operation::Sub(t, _) if t == total)
        }
        _ => false,
    };
    is_return(term, part) || is_return(part, term)
}

/// The values that are 0, 1 or -1 at a state.
fn vanishing(program: &Program, seed: u64) -> Vec<Value> {
    let n = |offset: u64| numbers(10 * seed + offset);
    let inputs = Inputs {
        parameters: n(0),
        time: n(1)[0],
        coordinates: n(2),
        speeds: n(3),
        inputs: n(4),
        accelerations: n(5),
        tangent: n(6),
    };
    let unknown = n(7);
    let zero = Reproducible::exactly(0.0);
    let (mut known, mut found) = (vec![(zero, zero); program.operations.len()], Vec::new());
    for (index, &operation) in program.operations.iter().enumerate() {
        let value = Value(index as u32);
        let of = |value: Value| known[value.index()];
        let mut result = operate(operation, &inputs, of);
        let size = |value: Value| of(value).0.rounded().abs();
        let terms = match operation {
            Operation::Add(a, b) | Operation::Sub(a, b) => size(a).max(size(b)),
            Operation::MulAdd(a, b, c) | Operation::MulSub(a, b, c) | Operation::NegMulAdd(a, b, c) => {
                (size(a) * size(b)).max(size(c))
            }
            _ => 0.0,
        };
        if is_rounding(program, value) {
            result.0 = Reproducible::exactly(1e-3 * unknown[index % unknown.len()]);
        } else if result.0.rounded().abs() < NEGLIGIBLE * terms || is_unit(operation, result.0) {
            found.push(value);
            // report a value that is identically constant once, not again in the values computed from it
            result.0 = Reproducible::exactly(unknown[index % unknown.len()]);
        }
        known[index] = result;
    }
    found
}

/// Whether an operation that has operands gives 1 or -1.
fn is_unit(operation: Operation, result: Reproducible) -> bool {
    let made = !matches!(
        operation,
        Operation::Constant(_)
            | Operation::Input(_)
            | Operation::SinCos(_)
            | Operation::Call(..)
            | Operation::Call2(..)
    );
    made && [1.0, -1.0]
        .iter()
        .any(|&unit| (result - Reproducible::exactly(unit)).rounded().abs() < NEGLIGIBLE)
}

/// Operations that have no effect, as their operands show.
fn idle(program: &Program) -> Vec<Value> {
    let constant = |value: Value| match program.operation(value) {
        Operation::Constant(bits) => Some(bits.get()),
        _ => None,
    };
    let is_reciprocal = |a: Value, b: Value| program.operation(a) == Operation::Recip(b);
    let is_trivial = |value: Value| constant(value).is_some_and(|x| x == 0.0 || x.abs() == 1.0);
    let is_idle = |operation: Operation| match operation {
        Operation::Mul(a, b) => is_reciprocal(a, b) || is_reciprocal(b, a) || is_trivial(a) || is_trivial(b),
        Operation::Div(a, b) => a == b || is_trivial(a) || constant(b).is_some(),
        Operation::Recip(a) => constant(a).is_some(),
        Operation::MulAdd(a, b, _) | Operation::MulSub(a, b, _) | Operation::NegMulAdd(a, b, _)
            if is_trivial(a) || is_trivial(b) =>
        {
            true
        }
        Operation::Sub(a, b) => a == b || constant(b) == Some(0.0),
        Operation::Add(a, b) => constant(a) == Some(0.0) || constant(b) == Some(0.0),
        Operation::MulAdd(a, b, c) | Operation::MulSub(a, b, c) | Operation::NegMulAdd(a, b, c) => {
            [a, b, c].iter().any(|&value| constant(value) == Some(0.0))
        }
        _ => false,
    };
    let all = program.operations.iter().enumerate();
    all.filter(|(_, operation)| is_idle(**operation)).map(|(index, _)| Value(index as u32)).collect()
}

#[test]
fn no_shipped_derivation_has_idle_operations() {
    let mut found = Vec::new();
    for folder in ["../../models", "../../tests", "../../simulation"] {
        derivations(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder), &mut found);
    }
    assert!(found.len() > 35, "{found:?}");
    let (mut wrong, mut operations) = (Vec::new(), 0);
    for path in found {
        let program = decode(&std::fs::read_to_string(&path).unwrap()).unwrap().program;
        let branches = program.operations.iter().any(|operation| {
            matches!(
                operation,
                Operation::Call(Function::Abs | Function::Sign, _)
                    | Operation::Call2(Function::Min | Function::Max, ..)
            )
        });
        let at: Vec<Vec<Value>> = (0..3).map(|seed| vanishing(&program, seed)).collect();
        let everywhere =
            at[0].iter().filter(|value| !branches && at.iter().all(|found| found.contains(value)));
        for value in everywhere.copied().chain(idle(&program)) {
            wrong.push(format!("{}: {} {:?}", path.display(), value.0, program.operation(value)));
        }
        operations += program.operations.len();
    }
    assert!(operations > 20_000, "{operations}");
    assert!(wrong.is_empty(), "{}\n{}", wrong.len(), wrong.join("\n"));
}
