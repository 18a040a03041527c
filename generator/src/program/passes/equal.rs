//! Computes values once that are identically equal although their operations differ: two factored forms of one sum, or the same quantity in programs
//! that went through the passes on their own.
//!
//! It compares values as [`super::vanishing`] compares them with 0. The first of equal values stays, so that operands stay before their use.

use std::collections::HashMap;

use super::known::{Known, PLACES};
use super::vanishing::evaluated;
use crate::program::Quantity;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::straight_line::Program;

/// Bits of a double that are left out where candidates are looked up: beyond them rounding to a double may differ.
const LOOSE: u32 = 12;

impl Program {
    /// The same program in which the routine of these quantities together computes equal values once. Values keep their numbers; what is known at
    /// construction stays as it is.
    pub fn with_equal_values_shared(&self, quantities: &[Quantity]) -> Program {
        let mut needed = vec![false; self.operations.len()];
        self.slice(quantities).order.iter().for_each(|value| needed[value.index()] = true);
        let stages = self.stages();
        let takes_part = |value: Value| needed[value.index()] && stages[value.index()] > Stage::Parameter;
        let first = first_equal(self, &needed, takes_part, |_, _| true);
        renamed(self, &first)
    }
}

/// The program in which no routine computes a value twice. A value takes the place of another only where every routine that needs the other computes it
/// too, so that none becomes longer. Values that are checked stay, since others need not be checked.
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
    let first = first_equal(program, &vec![true; count], |_| true, may);
    renamed(program, &first)
}

/// For each value the first that is equal to it, itself if there is none. `needed` are the values that are evaluated, `takes_part` says which of them are
/// compared, `may` whether the first may stand for the second.
fn first_equal(
    program: &Program,
    needed: &[bool],
    takes_part: impl Fn(Value) -> bool,
    may: impl Fn(Value, Value) -> bool,
) -> Vec<Value> {
    let places: Vec<Vec<Known>> = (0..PLACES).map(|place| evaluated(program, place, needed)).collect();
    let stages = program.stages();
    let equal = |a: Value, b: Value| {
        places.iter().all(|known| {
            let terms = [known[a.index()], known[b.index()].opposite()];
            Known::sum(terms.into_iter()).is(0.0)
        })
    };
    let mut found: HashMap<u64, Vec<Value>> = HashMap::new();
    let mut first: Vec<Value> = (0..program.operations.len() as u32).map(Value).collect();
    for index in 0..program.operations.len() {
        let value = Value(index as u32);
        let fetched = matches!(
            program.operation(value),
            Operation::Constant(_) | Operation::Input(_) | Operation::SinCos(_)
        );
        let number = places[0][index].number.rounded();
        if fetched || !takes_part(value) || !number.is_finite() || number == 0.0 {
            continue;
        }
        let key = number.to_bits() >> LOOSE;
        let candidates = [key, key.wrapping_sub(1), key.wrapping_add(1)].into_iter();
        let candidates = candidates.filter_map(|key| found.get(&key)).flatten().copied();
        let same = candidates
            .filter(|&other| stages[other.index()] <= stages[index] && may(other, value))
            .filter(|&other| equal(other, value))
            .min();
        match same {
            Some(other) => first[index] = other,
            None => found.entry(key).or_default().push(value),
        }
    }
    first
}

/// The program with other operands in the place of some, and with one value for operations that are the same then. Values keep their numbers.
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
    use crate::program::lower::lower;

    #[test]
    fn meaning_is_kept() {
        for seed in 1..150 {
            let program = lower(&random(seed));
            let shared = program.with_equal_values_shared(&program.quantities());
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
        let shared = program.with_equal_values_shared(&[Quantity::Forcing]);
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
            let tiny = graph.number(crate::number::Number::ratio(1, 1 << 50));
            let little = graph.product([tiny, y]);
            let (sum, product) = (graph.sum([x, little]), graph.product([x, y]));
            vec![graph.product([sum, y]), product]
        });
        let program = lower(&derived);
        assert_eq!(program.with_equal_values_shared(&[Quantity::Forcing]), program);
    }
}
