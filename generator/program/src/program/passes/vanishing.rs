//! Removes operations whose result is identically 0, 1 or -1, as partial sums may be after reassociation:
//! terms that cancel, or the sum of the squares of a sine and a cosine.
//!
//! Operations are evaluated modulo primes ([`super::modular`]). The computed rounding error of a sum of
//! angles is 0 in exact arithmetic; it is kept.

use crate::program::build::Builder;
use crate::program::operation::{Operation, Value};
use crate::program::straight_line::Program;

/// The program without operations that are identically 0, 1 or -1.
pub fn drop(program: &Program) -> Program {
    let residues = program.residues();
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
        let residues = residues[value.index()].filter(|_| is_made)?;
        residues.multiple_of(1, 1).map(|number| number as f64)
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

/// An operation on new operands, simplified if one of them is 0, 1 or -1.
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

#[cfg(test)]
mod tests {
    use super::super::testing::{agree, operations, random, small, speeds};
    use super::*;
    use crate::program::graph::NodeKind;
    use crate::program::lower::lower;
    use hodograph_model::arithmetic::Function;

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
    fn fused_operations_lose_operands_that_vanish() {
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
    fn very_small_values_stay() {
        let derived = small(|graph| {
            let [x, y, ..] = speeds(graph);
            let tiny = graph.number(hodograph_model::number::Number(
                num_rational::BigRational::from_float(1e-60).unwrap(),
            ));
            let (little, minus) = (graph.product([tiny, y]), graph.integer(-1));
            let opposite = graph.product([minus, x]);
            let inner = graph.intern(NodeKind::Sum(vec![x, little]));
            vec![graph.intern(NodeKind::Sum(vec![inner, opposite]))]
        });
        let program = lower(&derived);
        assert_eq!(drop(&program), program);
    }

    #[test]
    fn factors_that_are_identically_one_are_dropped() {
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
    fn rounding_errors_of_angles_stay() {
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
