//! Removes operations whose result is identically 0, 1 or -1, as partial sums may be after reassociation: terms that cancel, or the squares of a sine and a
//! cosine.
//!
//! It tests operations as [`super::identities`] tests nodes. The computed rounding error of a sum of angles is 0 in exact arithmetic; it is kept.

use super::known::{Known, PLACES, analytic, arbitrary, seed_of};
use crate::arithmetic::reproducible::Reproducible;
use crate::arithmetic::{Arithmetic, Function};
use crate::program::build::Builder;
use crate::program::operation::{Operation, Value};
use crate::program::straight_line::Program;

/// What an operation may be identically.
const NUMBERS: [f64; 3] = [0.0, 1.0, -1.0];

/// The program without what vanishes or is identically 1 or -1.
pub fn drop(program: &Program) -> Program {
    let all = vec![true; program.operations.len()];
    let places: Vec<Vec<Known>> = (0..PLACES).map(|place| evaluated(program, place, &all)).collect();
    let number = |value: Value| {
        let is_made = matches!(
            program.operation(value),
            Operation::Add(..)
                | Operation::Sub(..)
                | Operation::Mul(..)
                | Operation::Div(..)
                | Operation::Recip(_)
                | Operation::MulAdd(..)
                | Operation::MulSub(..)
                | Operation::NegMulAdd(..)
        );
        let is = |number: &f64| places.iter().all(|known| known[value.index()].is(*number));
        NUMBERS.into_iter().filter(|_| is_made).find(is)
    };
    if (0..program.operations.len()).all(|index| number(Value(index as u32)).is_none()) {
        return program.clone();
    }
    let mut builder = Builder::default();
    let mut renamed: Vec<Value> = Vec::with_capacity(program.operations.len());
    for (index, &operation) in program.operations.iter().enumerate() {
        let new = match number(Value(index as u32)) {
            Some(number) => builder.constant(number),
            None => rebuilt(&mut builder, operation.map(|value| renamed[value.index()])),
        };
        renamed.push(new);
    }
    let of = |value: Value| renamed[value.index()];
    let mut new = Program { operations: builder.finish(), ..program.clone() };
    new.outputs.iter_mut().flat_map(|output| &mut output.values).for_each(|value| *value = of(*value));
    for guard in &mut new.guards {
        guard.value = of(guard.value);
        guard.scale = guard.scale.map(of);
    }
    new
}

/// An operation on new operands, shorter where one of them is 0, 1 or -1.
fn rebuilt(builder: &mut Builder, operation: Operation) -> Value {
    let is_zero = |builder: &Builder, value: Value| builder.number(value) == Some(0.0);
    let is_unit = |builder: &Builder, value: Value| builder.number(value).is_some_and(|x| x.abs() == 1.0);
    match operation {
        Operation::Div(a, b) if is_unit(builder, b) || builder.number(a) == Some(1.0) => builder.div(a, b),
        Operation::Recip(a) if is_unit(builder, a) => builder.recip(a),
        Operation::MulAdd(a, b, c) if is_unit(builder, a) || is_unit(builder, b) => {
            let product = builder.mul(a, b);
            builder.add(product, c)
        }
        Operation::MulSub(a, b, c) if is_unit(builder, a) || is_unit(builder, b) => {
            let product = builder.mul(a, b);
            builder.sub(product, c)
        }
        Operation::NegMulAdd(a, b, c) if is_unit(builder, a) || is_unit(builder, b) => {
            let product = builder.mul(a, b);
            builder.sub(c, product)
        }
        Operation::Neg(a) => builder.neg(a),
        Operation::Add(a, b) => builder.add(a, b),
        Operation::Sub(a, b) => builder.sub(a, b),
        Operation::Mul(a, b) => builder.mul(a, b),
        Operation::MulAdd(a, b, c) if is_zero(builder, a) || is_zero(builder, b) => c,
        Operation::MulAdd(a, b, c) if is_zero(builder, c) => builder.mul(a, b),
        Operation::MulSub(a, b, c) if is_zero(builder, a) || is_zero(builder, b) => builder.neg(c),
        Operation::MulSub(a, b, c) if is_zero(builder, c) => builder.mul(a, b),
        Operation::NegMulAdd(a, b, c) if is_zero(builder, a) || is_zero(builder, b) => c,
        Operation::NegMulAdd(a, b, c) if is_zero(builder, c) => {
            let product = builder.mul(a, b);
            builder.neg(product)
        }
        _ => builder.push(operation),
    }
}

/// The values that are needed at one place; in the place of others stands 0. The operands of what is needed are needed too.
pub fn evaluated(program: &Program, place: usize, needed: &[bool]) -> Vec<Known> {
    let mut numbers: Vec<Known> = Vec::with_capacity(program.operations.len());
    for (index, &operation) in program.operations.iter().enumerate() {
        if !needed[index] {
            numbers.push(Known::exact(Reproducible::exactly(0.0)));
            continue;
        }
        let of = |value: Value| numbers[value.index()];
        let unknown = || arbitrary(1 << 40 | index as u64, place);
        let one = || Known::exact(Reproducible::exactly(1.0));
        let function = |function, a| analytic(function, of(a)).unwrap_or_else(unknown);
        let number = match operation {
            _ if is_rounding(program, operation) => unknown(),
            Operation::Constant(bits) => Known::exact(Reproducible::exactly(bits.get())),
            Operation::Input(input) => arbitrary(seed_of(input), place),
            Operation::Neg(a) => of(a).opposite(),
            Operation::Add(a, b) => Known::sum([of(a), of(b)].into_iter()),
            Operation::Sub(a, b) => Known::sum([of(a), of(b).opposite()].into_iter()),
            Operation::Mul(a, b) => of(a).times(of(b)),
            Operation::Div(a, b) => of(a).times(of(b).reciprocal()),
            Operation::Recip(a) => one().times(of(a).reciprocal()),
            Operation::MulAdd(a, b, c) => Known::sum([of(a).times(of(b)), of(c)].into_iter()),
            Operation::MulSub(a, b, c) => Known::sum([of(a).times(of(b)), of(c).opposite()].into_iter()),
            Operation::NegMulAdd(a, b, c) => Known::sum([of(a).times(of(b)).opposite(), of(c)].into_iter()),
            // the angle: sine and cosine are taken out of it below
            Operation::SinCos(a) => of(a),
            Operation::Sine(pair) => function(Function::Sin, pair),
            Operation::Cosine(pair) => function(Function::Cos, pair),
            Operation::Call(name, a) => function(name, a),
            Operation::Call2(..) => unknown(),
        };
        numbers.push(number);
    }
    numbers
}

/// Whether it is a part of what rounding takes from a sum, `a - (t - (t - a))` where t is a sum with a, however its operations are fused.
fn is_rounding(program: &Program, operation: Operation) -> bool {
    let (first, second) = match operation {
        Operation::Add(a, b) | Operation::Sub(a, b) => (a, b),
        Operation::MulAdd(_, _, c) | Operation::MulSub(_, _, c) | Operation::NegMulAdd(_, _, c) => (c, c),
        _ => return false,
    };
    let returns = |term: Value, part: Value| match program.operation(part) {
        Operation::Sub(total, other) => {
            let mut parts = program.operation(total).operands();
            let again = matches!(program.operation(other), Operation::Sub(t, _) if t == total);
            again || parts.any(|part| part == term || part == other)
        }
        _ => false,
    };
    returns(first, second) || returns(second, first)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{agree, operations, random, small, speeds};
    use super::*;
    use crate::program::lower::lower;

    #[test]
    fn meaning_is_kept() {
        for seed in 1..150 {
            let program = lower(&random(seed));
            agree(&program, &drop(&program), &format!("seed {seed}"));
        }
    }

    #[test]
    fn a_partial_sum_that_vanishes_is_dropped() {
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let sum = graph.sum([x, y]);
            let minus = graph.integer(-1);
            let (whole, a, b) =
                (graph.product([sum, z]), graph.product([minus, x, z]), graph.product([minus, y, z]));
            let nothing = graph.sum([whole, a, b]);
            vec![graph.sum([nothing, w])]
        });
        let dropped = super::super::dead_code::remove(&drop(&lower(&derived)));
        assert_eq!(operations(&dropped), [""; 0]);
    }

    #[test]
    fn fused_operations_lose_what_vanishes() {
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let (minus, sum, other) = (graph.integer(-1), graph.sum([x, y]), graph.product([w, z]));
            let parts =
                [vec![sum, z], vec![minus, x, z], vec![minus, y, z]].map(|factors| graph.product(factors));
            let nothing = graph.sum(parts);
            let mut outputs = Vec::new();
            for signs in [[1, 1], [1, -1], [-1, 1], [-1, -1]] {
                let [first, second] = signs.map(|sign| graph.integer(sign));
                let (scaled, added) = (graph.product([first, nothing, w]), graph.product([second, x]));
                outputs.push(graph.sum([scaled, added]));
                let (plain, product) = (graph.product([first, nothing]), graph.product([second, other]));
                outputs.push(graph.sum([plain, product]));
            }
            outputs
        });
        let fused = super::super::contract::contract(&lower(&derived));
        let kinds = operations(&fused);
        for kind in ["MulAdd", "MulSub", "NegMulAdd"] {
            assert!(kinds.iter().any(|found| found == kind), "{kind}: {kinds:?}");
        }
        let dropped = super::super::dead_code::remove(&drop(&fused));
        agree(&fused, &dropped, "fused");
        let left = operations(&dropped);
        assert!(left.iter().all(|kind| kind == "Neg" || kind == "Mul"), "{left:?}");
    }

    #[test]
    fn what_is_identically_one_is_no_factor_any_more() {
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let [sine, cosine] = [Function::Sin, Function::Cos].map(|function| graph.call(function, vec![x]));
            let squares = [graph.power(sine, 2), graph.power(cosine, 2)];
            let one = graph.sum(squares);
            let quotient = graph.div(y, one);
            let (product, scaled) = (graph.product([one, z]), graph.product([one, w, z]));
            let sum = graph.sum([product, w]);
            vec![quotient, sum, graph.div(one, w), scaled]
        });
        for program in [lower(&derived), super::super::contract::contract(&lower(&derived))] {
            let dropped = super::super::dead_code::remove(&drop(&program));
            agree(&program, &dropped, "ones");
            let mut left = operations(&dropped);
            left.sort();
            assert_eq!(left, ["Add", "Mul", "Recip"]);
        }
    }

    #[test]
    fn functions_with_branches_of_different_angles_differ() {
        let derived = small(|graph| {
            let [x, y, ..] = speeds(graph);
            let minus = graph.integer(-1);
            let [first, second] = [x, y].map(|angle| graph.call(Function::Abs, vec![angle]));
            let second = graph.product([minus, second]);
            vec![graph.sum([first, second])]
        });
        let program = lower(&derived);
        assert_eq!(drop(&program), program);
    }

    #[test]
    fn what_rounding_takes_from_angles_stays() {
        let derived = small(|graph| {
            let [x, y, ..] = speeds(graph);
            let angle = graph.sum([x, y]);
            vec![graph.call(Function::Sin, vec![angle])]
        });
        let program = lower(&derived);
        assert!(program.operations.len() > 8, "{program:?}");
        assert_eq!(drop(&program), program);
    }
}
