//! Contracts a * b + c to one operation if the product is used in sums only, so that no product is computed
//! twice.

use std::collections::{HashMap, HashSet};

use crate::program::operation::{Operation, Stage, Value};
use crate::program::straight_line::Program;

/// Introduces fused operations and leaves the unused products to [`super::dead_code`]. A product stays if the
/// rounding error of its sum is computed, since that computation needs the rounded product.
pub fn contract(program: &Program) -> Program {
    let stages = program.stages();
    let rounded = terms_of_two_sums(program);
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
            (uses.all == uses.sums && !rounded.contains(&value)).then_some((a, b))
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
    Program { operations, ..program.clone() }
}

/// The terms a and b of sums t = a + b or a - b for which t - a is computed, too, as in Knuth's two-sum.
fn terms_of_two_sums(program: &Program) -> HashSet<Value> {
    let mut terms = HashSet::new();
    for &operation in &program.operations {
        if let Operation::Sub(total, term) = operation
            && let Operation::Add(a, b) | Operation::Sub(a, b) = program.operation(total)
            && (term == a || term == b)
        {
            terms.extend([a, b]);
        }
    }
    terms
}

#[derive(Default)]
struct Uses {
    all: u32,
    sums: u32,
}

#[cfg(test)]
mod tests {
    use super::super::testing::{agree, bits, operations, random, small, speeds};
    use super::super::{dead_code::remove, lower};
    use super::*;
    use hodograph_model::arithmetic::FUSED;

    fn fused(derived: &crate::program::derivation::Derived) -> Vec<String> {
        operations(&remove(&contract(&lower(derived))))
    }

    #[test]
    fn the_three_kinds_of_fused_operations() {
        let plus = small(|g| {
            let [a, b, c, _] = speeds(g);
            let product = g.product([a, b]);
            vec![g.sum([product, c])]
        });
        let minus = small(|g| {
            let [a, b, c, _] = speeds(g);
            let product = g.product([a, b]);
            vec![g.sub(c, product)]
        });
        let less = small(|g| {
            let [a, b, c, d] = speeds(g);
            let (first, second) = (g.product([a, b]), g.product([c, d]));
            vec![g.sub(first, second)]
        });
        assert_eq!(fused(&plus), ["MulAdd"]);
        assert_eq!(fused(&minus), ["NegMulAdd"]);
        assert_eq!(fused(&less), ["Mul", "NegMulAdd"]);
    }

    #[test]
    fn a_product_that_is_an_output_is_not_computed_twice() {
        let derived = small(|g| {
            let [a, b, c, _] = speeds(g);
            let product = g.product([a, b]);
            vec![g.sum([product, c]), product]
        });
        assert_eq!(fused(&derived), ["Mul", "Add"]);
    }

    #[test]
    fn a_product_that_serves_two_sums_goes_into_both() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let product = g.product([a, b]);
            vec![g.sum([product, c]), g.sub(d, product)]
        });
        assert_eq!(fused(&derived), ["MulAdd", "NegMulAdd"]);
    }

    #[test]
    fn operations_at_construction_are_not_fused() {
        let derived = small(|g| {
            let [m, l, j] = super::super::testing::parameters(g);
            let product = g.product([m, l]);
            vec![g.sum([product, j])]
        });
        assert_eq!(fused(&derived), ["Mul", "Add"]);
    }

    #[test]
    fn the_meaning_stays_and_without_the_instruction_every_bit() {
        for seed in 1..150 {
            let program = lower(&random(seed));
            let fused = contract(&program);
            agree(&program, &fused, &format!("seed {seed}"));
            if !FUSED {
                assert_eq!(bits(&program), bits(&fused), "seed {seed}");
            }
        }
    }
}
