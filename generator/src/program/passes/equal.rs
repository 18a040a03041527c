//! Computes values once that are identically equal although their operations differ: two factored forms of
//! one sum, or the same quantity in programs that went through the passes on their own.
//!
//! Values are compared modulo a prime ([`super::modular`]). The first of equal values stays, so that operands
//! stay before their use.

use std::collections::HashMap;

use super::modular::Residues;
use crate::program::operation::{Operation, Value};
use crate::program::straight_line::Program;

/// The program in which no routine computes a value twice. A value takes the place of another only where
/// every routine that needs the other computes it too, so that none becomes longer. Values that are checked
/// stay, since others need not be checked.
pub fn share(program: &Program) -> Program {
    let count = program.operations.len();
    let words = program.outputs.len().div_ceil(64);
    let mut users = vec![vec![0_u64; words]; count];
    for (number, output) in program.outputs.iter().enumerate() {
        for value in program.slice(&[output.quantity]).order {
            users[value.index()][number / 64] |= 1 << (number % 64);
        }
    }
    let checked: Vec<Value> =
        program.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten().collect();
    let with = |a: &[u64], b: &[u64]| a.iter().zip(b).all(|(a, b)| b & !a == 0);
    let may = |first: Value, second: Value| {
        !checked.contains(&second) && with(&users[first.index()], &users[second.index()])
    };
    renamed(program, &first_equal(program, may))
}

/// For each value the first that is equal to it, itself if there is none. `may` tells whether the first may
/// stand for the second.
fn first_equal(program: &Program, may: impl Fn(Value, Value) -> bool) -> Vec<Value> {
    let stages = program.stages();
    let mut found: HashMap<Residues, Vec<Value>> = HashMap::new();
    let mut first: Vec<Value> = (0..program.operations.len() as u32).map(Value).collect();
    for (value, residues) in first.clone().into_iter().zip(program.residues()) {
        let fetched = matches!(
            program.operation(value),
            Operation::Constant(_) | Operation::Input(_) | Operation::SinCos(_)
        );
        let Some(residues) = residues.filter(|_| !fetched) else { continue };
        let same = found.entry(residues).or_default();
        let earlier = |other: Value| stages[other.index()] <= stages[value.index()] && may(other, value);
        match same.iter().copied().find(|&other| earlier(other)) {
            Some(other) => first[value.index()] = other,
            None => same.push(value),
        }
    }
    first
}

/// The program with other operands in the place of some, and with one value for operations that are the same
/// then. Values keep their numbers.
fn renamed(program: &Program, first: &[Value]) -> Program {
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
        let name = if other == own { *known.entry(*operation).or_insert(own) } else { names[other.index()] };
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
    use super::super::testing::{agree, random, small, speeds};
    use super::*;
    use crate::program::Quantity;
    use crate::program::lower::lower;

    #[test]
    fn meaning_is_kept() {
        for seed in 1..150 {
            let program = lower(&random(seed));
            let shared = share(&program);
            agree(&program, &shared, &format!("seed {seed}"));
            assert_eq!(program.operations.len(), shared.operations.len());
        }
    }

    #[test]
    fn two_forms_of_a_sum_become_one() {
        let derived = small(|graph| {
            let [x, y, z, w] = speeds(graph);
            let sum = graph.sum([x, y]);
            let factored = graph.product([sum, z]);
            let (a, b) = (graph.product([x, z]), graph.product([y, z]));
            let expanded = graph.sum([a, b]);
            vec![graph.product([factored, w]), graph.product([expanded, w])]
        });
        let program = lower(&derived);
        let shared = share(&program);
        let values = &shared.output(Quantity::Forcing).unwrap().values;
        assert_eq!(values[0], values[1]);
        let total = |program: &Program| program.cost(&[Quantity::Forcing]).evaluation().total();
        assert_eq!((total(&program), total(&shared)), (7, 3));
        agree(&program, &shared, "two forms");
    }

    #[test]
    fn no_routine_becomes_longer() {
        let mut shorter = 0;
        for seed in 1..150 {
            let program = Program::new(&random(seed));
            let shared = share(&program);
            agree(&program, &shared, &format!("seed {seed}"));
            for quantity in program.quantities() {
                let total = |program: &Program| program.cost(&[quantity]).evaluation().total();
                assert!(total(&shared) <= total(&program), "seed {seed} {quantity}");
                shorter += usize::from(total(&shared) < total(&program));
            }
        }
        println!("{shorter} routines are shorter");
    }

    #[test]
    fn different_values_stay_apart() {
        let derived = small(|graph| {
            let [x, y, ..] = speeds(graph);
            let tiny =
                graph.number(crate::number::Number(num_rational::BigRational::from_float(1e-40).unwrap()));
            let little = graph.product([tiny, y]);
            let (sum, product) = (graph.sum([x, little]), graph.product([x, y]));
            vec![graph.product([sum, y]), product]
        });
        let program = lower(&derived);
        assert_eq!(share(&program), program);
    }
}
