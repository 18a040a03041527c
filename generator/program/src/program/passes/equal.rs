//! Computes identically equal values once, even if their operations differ: two factored forms of one sum, or
//! the same quantity in programs that went through the passes separately.
//!
//! Values are compared modulo primes ([`super::modular`]). The first of equal values stays, so that operands
//! stay before their use, but only if it is as accurate as the second: a sum does not replace a product,
//! since its terms may cancel where factors do not, and at the sample states the bound of its rounding error
//! may be at most twice that of the second.

use std::collections::{HashMap, HashSet};

use super::adjoint::Sensitivity;
use crate::program::inputs::Inputs;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::straight_line::Program;
use hodograph_model::graph::modular::Residues;

/// A value may replace another if the bound of its rounding error is at most this many times the other's.
const AS_ACCURATE: f64 = 2.0;

/// The program in which no routine computes equal values twice. A value replaces another only if every
/// routine that needs the other computes it, too, so that no routine becomes longer. Guarded values are not
/// replaced.
pub fn share(program: &Program, states: &[Inputs]) -> Program {
    let count = program.operations.len();
    let words = program.outputs.len().div_ceil(64);
    let mut users = vec![vec![0_u64; words]; count];
    for (number, output) in program.outputs.iter().enumerate() {
        for value in program.slice(&[output.quantity]).order {
            users[value.index()][number / 64] |= 1 << (number % 64);
        }
    }
    let looked_at = program.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]);
    let checked: HashSet<Value> = looked_at.flatten().collect();
    let stages = program.stages();
    let errors: Vec<Vec<f64>> =
        (0..).zip(states).map(|(seed, state)| errors(program, state, seed, &stages)).collect();
    let covers = |a: &[u64], b: &[u64]| a.iter().zip(b).all(|(a, b)| b & !a == 0);
    let is_sum = |value: Value| {
        use Operation::*;
        matches!(program.operation(value), Add(..) | Sub(..) | MulAdd(..) | MulSub(..) | NegMulAdd(..))
    };
    let as_accurate = |first: Value, second: Value| {
        let at = |errors: &Vec<f64>| errors[first.index()] <= AS_ACCURATE * errors[second.index()];
        (is_sum(second) || !is_sum(first)) && errors.iter().all(at)
    };
    let may_replace = |first: Value, second: Value| {
        stages[first.index()] <= stages[second.index()]
            && !checked.contains(&second)
            && covers(&users[first.index()], &users[second.index()])
            && as_accurate(first, second)
    };
    renamed(program, &first_equal(program, may_replace), &checked)
}

/// For each value the first that equals it and may replace it; the value itself if there is none.
fn first_equal(program: &Program, may_replace: impl Fn(Value, Value) -> bool) -> Vec<Value> {
    let mut found: HashMap<Residues, Vec<Value>> = HashMap::new();
    let mut first: Vec<Value> = (0..program.operations.len() as u32).map(Value).collect();
    for (value, residues) in first.clone().into_iter().zip(program.residues()) {
        // Constants and inputs take no work. A sine-cosine pair has the residue of its angle, but is a
        // different value.
        let takes_work = !matches!(
            program.operation(value),
            Operation::Constant(_) | Operation::Input(_) | Operation::SinCos(_)
        );
        let Some(residues) = residues.filter(|_| takes_work) else { continue };
        let same = found.entry(residues).or_default();
        match same.iter().copied().find(|&other| may_replace(other, value)) {
            Some(other) => first[value.index()] = other,
            None => same.push(value),
        }
    }
    first
}

/// A bound of the rounding error of every value at a state, in units of rounding, to first order: each
/// operation adds one unit of its result. Values that depend on parameters alone are rounded once.
fn errors(program: &Program, state: &Inputs, seed: u64, stages: &[Stage]) -> Vec<f64> {
    use Operation::*;
    let weighed = Sensitivity::new(program, state, seed);
    let size = |value: Value| weighed.number(value).abs();
    let mut errors: Vec<f64> = Vec::with_capacity(program.operations.len());
    for (index, &operation) in program.operations.iter().enumerate() {
        let value = Value(index as u32);
        let of = |value: Value| errors[value.index()];
        let carried = match operation {
            _ if stages[index] <= Stage::Parameter => 0.0,
            Constant(_) | Input(_) => 0.0,
            Neg(a) | SinCos(a) | Sine(a) | Cosine(a) | Call(_, a) => of(a),
            Add(a, b) | Sub(a, b) | Call2(_, a, b) => of(a) + of(b),
            Mul(a, b) => size(a) * of(b) + size(b) * of(a),
            Div(a, b) => (of(a) + size(value) * of(b)) / size(b),
            Recip(a) => size(value) * size(value) * of(a),
            MulAdd(a, b, c) | MulSub(a, b, c) | NegMulAdd(a, b, c) => {
                size(a) * of(b) + size(b) * of(a) + of(c)
            }
        };
        let rounds = !matches!(operation, Constant(_) | Input(_) | Neg(_));
        let error = carried + if rounds { size(value) } else { 0.0 };
        // A state at which a value is not finite gives no information.
        errors.push(if error.is_finite() { error } else { 0.0 });
    }
    errors
}

/// The program with each value replaced by the first value that equals it. Operations that become equal by
/// this are merged, unless they are guarded. Values keep their indices.
fn renamed(program: &Program, first: &[Value], checked: &HashSet<Value>) -> Program {
    let mut known: HashMap<Operation, Value> = HashMap::new();
    let mut names: Vec<Value> = Vec::with_capacity(first.len());
    let mut new = program.clone();
    for (operation, &other) in new.operations.iter_mut().zip(first) {
        *operation = match operation.map(|value| names[value.index()]) {
            Operation::Add(a, b) => Operation::Add(a.min(b), a.max(b)),
            Operation::Mul(a, b) => Operation::Mul(a.min(b), a.max(b)),
            same => same,
        };
        let own = Value(names.len() as u32);
        let name = match other == own {
            false => names[other.index()],
            true if checked.contains(&own) => own,
            true => *known.entry(*operation).or_insert(own),
        };
        names.push(name);
    }
    let of = |value: Value| names[value.index()];
    new.outputs.iter_mut().flat_map(|output| &mut output.values).for_each(|value| *value = of(*value));
    for guard in &mut new.guards {
        guard.value = of(guard.value);
        guard.scale = guard.scale.map(of);
    }
    new
}

#[cfg(test)]
mod tests {
    use super::super::contract::contract;
    use super::super::testing::{agree, inputs, operations, random, small, speeds};
    use super::*;
    use crate::program::derivation::Derived;
    use crate::program::graph::{Graph, Input, Node, NodeKind};
    use crate::program::lower::lower;
    use crate::program::{Guard, Output, Quantity};
    use hodograph_model::arithmetic::Function;
    use hodograph_model::number::Number;

    fn shared(program: &Program) -> Program {
        share(program, &[inputs()])
    }

    /// (x + y) z and x z + y z.
    fn two_forms(graph: &mut Graph) -> [Node; 2] {
        let [x, y, z, _] = speeds(graph);
        let sum = graph.sum([x, y]);
        let (a, b) = (graph.product([x, z]), graph.product([y, z]));
        [graph.product([sum, z]), graph.sum([a, b])]
    }

    /// A program of two quantities, each of one node.
    fn of_two(build: impl FnOnce(&mut Graph) -> [Vec<Node>; 2]) -> Derived {
        let mut derived = small(|graph| speeds(graph)[..1].to_vec());
        let values = build(&mut derived.graph);
        let quantities = [Quantity::Forcing, Quantity::KineticEnergy];
        let output = |(quantity, values): (Quantity, Vec<Node>)| Output {
            quantity,
            rows: values.len(),
            columns: 1,
            values,
        };
        derived.outputs = quantities.into_iter().zip(values).map(output).collect();
        derived
    }

    fn total(program: &Program, quantity: Quantity) -> usize {
        program.cost(&[quantity]).evaluation().total()
    }

    #[test]
    fn meaning_is_kept_and_no_routine_becomes_longer() {
        let mut shorter = 0;
        for seed in 1..150 {
            for program in [lower(&random(seed)), Program::new(&random(seed))] {
                let shared = shared(&program);
                agree(&program, &shared, &format!("seed {seed}"));
                assert_eq!(program.operations.len(), shared.operations.len());
                for quantity in program.quantities() {
                    assert!(total(&shared, quantity) <= total(&program, quantity), "seed {seed} {quantity}");
                    shorter += usize::from(total(&shared, quantity) < total(&program, quantity));
                }
            }
        }
        assert!(shorter > 0, "no routine became shorter");
    }

    #[test]
    fn two_forms_of_a_sum_become_one() {
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let [a, b] = [[x, y], [y, x]].map(|[a, b]| {
                let (a, b) = (graph.product([a, z]), graph.product([b, z]));
                let first = graph.intern(NodeKind::Sum(vec![a, w]));
                graph.intern(NodeKind::Sum(vec![first, b]))
            });
            vec![graph.product([a, w]), graph.product([b, w])]
        });
        let program = lower(&derived);
        let shared = shared(&program);
        let values = &shared.output(Quantity::Forcing).unwrap().values;
        assert_eq!(values[0], values[1]);
        assert!(total(&shared, Quantity::Forcing) < total(&program, Quantity::Forcing));
        agree(&program, &shared, "two forms");
    }

    #[test]
    fn a_sum_does_not_stand_for_a_product() {
        // x^2 - y^2 loses digits near x = y, (x - y) (x + y) does not
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let (xx, yy) = (graph.power(x, 2), graph.power(y, 2));
            let minus = graph.integer(-1);
            let opposite = graph.product([minus, yy]);
            let sum = graph.sum([xx, opposite]);
            let (difference, whole) = (graph.sub(x, y), graph.sum([x, y]));
            let product = graph.intern(NodeKind::Product(vec![difference, whole]));
            vec![graph.product([sum, z]), graph.product([product, w])]
        });
        let program = lower(&derived);
        assert_eq!(shared(&program), program);
    }

    #[test]
    fn a_value_of_one_routine_does_not_replace_that_of_another() {
        let alone = of_two(|graph| {
            let [factored, expanded] = two_forms(graph);
            [vec![factored], vec![expanded]]
        });
        let program = lower(&alone);
        assert_eq!(shared(&program), program, "neither routine computes the other's form");
        let both = of_two(|graph| {
            let [factored, expanded] = two_forms(graph);
            [vec![factored, expanded], vec![factored]]
        });
        let program = lower(&both);
        let shorter = shared(&program);
        assert!(total(&shorter, Quantity::Forcing) < total(&program, Quantity::Forcing));
        assert_eq!(total(&shorter, Quantity::KineticEnergy), total(&program, Quantity::KineticEnergy));
    }

    #[test]
    fn guarded_values_stay() {
        let mut derived = small(|graph| two_forms(graph).to_vec());
        let checked = derived.outputs[0].values[1];
        derived.guards = vec![Guard { value: checked, scale: None, message: "checked".into() }];
        let program = lower(&derived);
        assert_eq!(shared(&program), program);
    }

    #[test]
    fn rounding_errors_of_angles_stay() {
        let angles = |graph: &mut Graph| {
            let [a, b, c] = [0, 1, 2].map(|index| graph.input(Input::Coordinate(index)));
            let (two, three) = (graph.integer(2), graph.integer(3));
            let first = graph.sum([a, b]);
            let second = graph.intern(NodeKind::Sum(vec![first, c]));
            let third = graph.sum([a, c]);
            let (doubled, tripled) = (graph.product([two, a]), graph.product([three, b]));
            let fourth = graph.sum([doubled, tripled]);
            [first, second, third, fourth].map(|angle| graph.call(Function::Sin, vec![angle])).to_vec()
        };
        let program = super::super::dead_code::remove(&contract(&lower(&small(angles))));
        let after = super::super::dead_code::remove(&shared(&super::super::vanishing::drop(&program)));
        assert_eq!(operations(&after), operations(&program));
        let oneself = |operation: &Operation| matches!(operation, Operation::Sub(a, b) if a == b);
        assert!(!after.operations.iter().any(oneself));
    }

    #[test]
    fn different_values_stay_apart() {
        let derived = small(|graph| {
            let [x, y, ..] = speeds(graph);
            let tiny = graph.number(Number(num_rational::BigRational::from_float(1e-40).unwrap()));
            let little = graph.product([tiny, y]);
            let (sum, product) = (graph.sum([x, little]), graph.product([x, y]));
            vec![graph.product([sum, y]), product]
        });
        let program = lower(&derived);
        assert_eq!(shared(&program), program);
    }
}
