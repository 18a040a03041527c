//! Adds the terms of a sum in the order with the least rounding error.
//!
//! The rounding error of a partial sum is proportional to its size. A sum that is used in one other sum only
//! is merged into it. Among the orders of the terms with the fewest operations the pass chooses the one whose
//! partial sums are smallest in the mean over the sample states, each state weighted by the effect of an
//! error on the outputs. Terms that cancel are thereby added early.

use super::adjoint::Sensitivity;
use super::dead_code;
use super::flat_sums::{Sum, Sums, Term, rebuild};
use crate::program::inputs::Inputs;
use crate::program::operation::{Stage, Value};
use crate::program::straight_line::Program;
use hodograph_model::arithmetic::DoubleDouble;

/// Up to this number of terms all orders are compared. For more terms the order is chosen backwards, term by
/// term.
const MAX_EXHAUSTIVE: usize = 10;
/// Beyond this number of terms the order stays, since the work grows with the square of the number.
const MAX_TERMS: usize = 1000;
/// A sum that is at most this times its largest term at all states is a computed rounding error, whose order
/// must not change.
const ROUNDING: f64 = 1e-10;
/// An order counts as better if its cost is below this part of another's, so that the choice does not depend
/// on the last digits of samples.
const MARGIN: f64 = 1.0 - 1e-6;
/// The given order of terms is replaced only if the cost of the best order is below this part of its cost; a
/// few dozen samples do not justify finer decisions.
const MIN_GAIN: f64 = 0.9;

/// The program with the terms of its sums in the order with the least estimated rounding error at the sample
/// states.
pub fn reassociate(program: &Program, states: &[Inputs]) -> Program {
    let states: Vec<Sensitivity> =
        (0..).zip(states).map(|(seed, state)| Sensitivity::new(program, state, seed)).collect();
    if states.is_empty() {
        return program.clone();
    }
    let sums = Sums::new(program);
    let mut plans: Vec<Option<Vec<Term>>> = vec![None; program.operations.len()];
    let mut opened = vec![false; program.operations.len()];
    for index in (0..program.operations.len()).rev() {
        if opened[index] || sums.stage(Value(index as u32)) <= Stage::Parameter {
            continue;
        }
        let sum = sums.open(Value(index as u32));
        if sum.terms.len() > 1 && !sum.is_rounding(index, &states) {
            sum.inner.iter().for_each(|value| opened[value.index()] = true);
            plans[index] = Some(sum.in_order(index, &states));
        }
    }
    dead_code::remove(&rebuild(program, &plans))
}

impl Sum {
    /// Whether the sum is negligible beside its terms at every state where it is finite.
    fn is_rounding(&self, index: usize, states: &[Sensitivity]) -> bool {
        states.iter().all(|state| {
            let largest =
                self.terms.iter().fold(0.0f64, |largest, term| largest.max(term.number(state).abs()));
            let number = state.number(Value(index as u32));
            number.abs() <= ROUNDING * largest || !number.is_finite()
        })
    }

    /// Whether the sum may begin with this term. A product as first term would take an operation of its own,
    /// unless all terms are products.
    fn begins(&self, term: usize) -> bool {
        !self.terms[term].is_product() || self.terms.iter().all(Term::is_product)
    }

    /// The terms in the order with the least rounding error.
    fn in_order(self, index: usize, states: &[Sensitivity]) -> Vec<Term> {
        let weigh = |state: &Sensitivity| {
            let numbers: Vec<f64> = self.terms.iter().map(|term| term.number(state)).collect();
            let total: f64 = numbers.iter().map(|number| number * number).sum();
            let weight = state.weights[index];
            (weight > 0.0 && (weight * total).is_finite()).then_some((weight, numbers))
        };
        let samples: Vec<(f64, Vec<f64>)> = states.iter().filter_map(weigh).collect();
        let places =
            if self.terms.len() <= MAX_EXHAUSTIVE { self.best(&samples) } else { self.good(&samples) };
        places.into_iter().map(|place| self.terms[place].clone()).collect()
    }

    /// What rounding costs where the terms of each subset are a partial sum; subsets are sets of bits.
    fn partial_sums(&self, samples: &[(f64, Vec<f64>)]) -> Vec<f64> {
        let mut costs = vec![0.0; 1 << self.terms.len()];
        let mut sums = vec![0.0; costs.len()];
        for (weight, numbers) in samples {
            for set in 1..costs.len() {
                sums[set] = sums[set & (set - 1)] + numbers[set.trailing_zeros() as usize];
                costs[set] += weight * sums[set] * sums[set];
            }
        }
        costs
    }

    /// The best of all orders, from the best orders of all subsets (dynamic programming).
    fn best(&self, samples: &[(f64, Vec<f64>)]) -> Vec<usize> {
        let costs = self.partial_sums(samples);
        let mut best = vec![(f64::INFINITY, 0); costs.len()];
        for set in 1..costs.len() {
            // among equals the given order
            for last in (0..self.terms.len()).rev().filter(|last| set >> last & 1 == 1) {
                let cost = match set ^ (1 << last) {
                    0 if self.begins(last) => self.first(last, &costs),
                    0 => f64::INFINITY,
                    rest => best[rest].0 + costs[set],
                };
                if cost < best[set].0 * MARGIN || best[set].0 == f64::INFINITY {
                    best[set] = (cost, last);
                }
            }
        }
        let present = self.present();
        let mut set = 1 << present[0];
        let mut cost = self.first(present[0], &costs);
        for place in &present[1..] {
            set |= 1 << place;
            cost += costs[set];
        }
        if best[costs.len() - 1].0 >= MIN_GAIN * cost {
            return present;
        }
        let (mut places, mut set) = (Vec::new(), costs.len() - 1);
        while set != 0 {
            places.push(best[set].1);
            set ^= 1 << best[set].1;
        }
        places.reverse();
        places
    }

    /// The cost of the first term: only a product is rounded before another term is added.
    fn first(&self, term: usize, costs: &[f64]) -> f64 {
        if self.terms[term].is_product() { costs[1 << term] } else { 0.0 }
    }

    /// The given order of the terms, with the first admissible term moved to the front.
    fn present(&self) -> Vec<usize> {
        let first = (0..self.terms.len()).find(|&place| self.begins(place)).unwrap_or(0);
        let rest = (0..self.terms.len()).filter(|&place| place != first);
        std::iter::once(first).chain(rest).collect()
    }

    /// The order chosen backwards: last comes the term without which the partial sum is smallest. The given
    /// order if there are too many terms.
    fn good(&self, samples: &[(f64, Vec<f64>)]) -> Vec<usize> {
        if self.terms.len() > MAX_TERMS {
            return self.present();
        }
        let mut beginnings = (0..self.terms.len()).filter(|&term| self.begins(term)).count();
        let begins: Vec<bool> = (0..self.terms.len()).map(|term| self.begins(term)).collect();
        // in double-double arithmetic, so that terms can be subtracted
        let sum = |numbers: &Vec<f64>| {
            numbers.iter().fold(DoubleDouble::new(0.0), |sum, &n| sum + DoubleDouble::new(n))
        };
        let mut sums: Vec<DoubleDouble<f64>> = samples.iter().map(|(_, numbers)| sum(numbers)).collect();
        let mut left: Vec<usize> = (0..self.terms.len()).collect();
        let mut places = Vec::new();
        while left.len() > 1 {
            let mut best = (f64::INFINITY, None);
            for (place, &term) in left.iter().enumerate().rev() {
                if beginnings == 1 && begins[term] {
                    continue;
                }
                let of_sample = |((weight, numbers), sum): (&(f64, Vec<f64>), &DoubleDouble<f64>)| {
                    let without = (*sum - DoubleDouble::new(numbers[term])).rounded();
                    weight * without * without
                };
                let cost: f64 = samples.iter().zip(&sums).map(of_sample).sum();
                if best.1.is_none() || cost < best.0 * MARGIN {
                    best = (cost, Some(place));
                }
            }
            let term = left.remove(best.1.unwrap_or(0));
            beginnings -= usize::from(begins[term]);
            for ((_, numbers), sum) in samples.iter().zip(&mut sums) {
                *sum = *sum - DoubleDouble::new(numbers[term]);
            }
            places.push(term);
        }
        places.extend(left);
        places.reverse();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{agree, inputs, operations, random, small, speeds};
    use super::super::{contract::contract, lower};
    use super::*;
    use crate::interpret::Evaluator;
    use crate::program::{Derived, Quantity};
    use hodograph_model::arithmetic::Function;

    /// The program before and after the pass, with these speeds as the only sample.
    fn both(derived: &Derived, speeds: [f64; 4]) -> [Program; 2] {
        let before = dead_code::remove(&contract(&lower(derived)));
        let after = reassociate(&before, &[Inputs { speeds: speeds.to_vec(), ..inputs() }]);
        [before, after]
    }

    fn answer(program: &Program, speeds: [f64; 4]) -> f64 {
        let inputs = Inputs { speeds: speeds.to_vec(), ..inputs() };
        Evaluator::new(program).evaluate(&inputs, &[Quantity::Forcing]).unwrap()[0].values[0]
    }

    #[test]
    fn terms_that_cancel_come_first() {
        let derived = small(|g| {
            let speeds = speeds(g);
            vec![g.sum(speeds)]
        });
        let numbers = [0.1, 1e9, 0.2, -1e9];
        let [before, after] = both(&derived, numbers).map(|program| answer(&program, numbers));
        assert!((before - 0.3).abs() > 1e-9 && after == 0.1 + 0.2, "{before} {after}");
    }

    #[test]
    fn the_smaller_of_two_products_is_rounded() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let (first, second) = (g.product([a, b]), g.product([c, d]));
            vec![g.sub(first, second)]
        });
        let first = |numbers| operations(&both(&derived, numbers)[1])[0..2].join(" ");
        assert_eq!(first([9.0, 9.0, 0.1, 0.1]), "Mul MulSub");
        assert_eq!(first([0.1, 0.1, 9.0, 9.0]), "Mul NegMulAdd");
    }

    #[test]
    fn sums_used_in_one_sum_only_are_opened() {
        use crate::program::graph::Input::Speed;
        use crate::program::operation::Operation::{Add, Input, Mul, MulAdd};
        let [a, b, c, d] = [0, 1, 2, 3].map(Value);
        let mut program = lower(&small(|g| vec![g.integer(0)]));
        program.operations = [0, 1, 2, 3].map(|index| Input(Speed(index))).to_vec();
        // (a b + c d) + (a c + b d)
        let more =
            [Mul(a, b), MulAdd(c, d, Value(4)), Mul(a, c), MulAdd(b, d, Value(6)), Add(Value(5), Value(7))];
        program.operations.extend(more);
        program.outputs[0].values = vec![Value(8)];
        let after = reassociate(&program, &[inputs()]);
        assert_eq!(operations(&after), ["Mul", "MulAdd", "MulAdd", "MulAdd"]);
        agree(&program, &after, "opened");
    }

    #[test]
    fn rounding_errors_of_angles_keep_their_order() {
        let derived = small(|g| {
            let [a, b, c, _] = speeds(g);
            let angle = g.sum([a, b, c]);
            [Function::Sin, Function::Cos].map(|function| g.call(function, vec![angle])).to_vec()
        });
        let [before, after] = both(&derived, [0.3, 0.1, 0.7, 0.0]);
        assert_eq!(operations(&before), operations(&after));
        let turned = [1e5, 0.1, -1e5, 0.0];
        assert_eq!(answer(&before, turned), answer(&after, turned));
        assert!((answer(&after, turned) - 0.1f64.sin()).abs() < 1e-16);
    }

    #[test]
    fn long_sums_bring_together_terms_that_cancel() {
        let derived = small(|g| {
            let coordinates = [0, 1, 2].map(|index| g.input(crate::program::graph::Input::Coordinate(index)));
            let speeds = speeds(g);
            let squares = speeds.map(|speed| g.power(speed, 2));
            let parameters = [0, 1, 2].map(|index| g.input(crate::program::graph::Input::Parameter(index)));
            let products = parameters.map(|parameter| g.product([parameter, speeds[0]]));
            vec![g.sum([&coordinates[..], &speeds, &squares, &products].concat())]
        });
        let numbers = [1e-3, 1e8, 2e-3, -1e8];
        let [before, after] = both(&derived, numbers).map(|program| program.operations.len());
        assert!(after <= before && before > 20, "{before} {after}");
        let [before, after] = both(&derived, numbers);
        agree(&before, &after, "long");
    }

    #[test]
    fn nor_where_terms_are_not_finite_at_a_sample() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let root = g.call(Function::Sqrt, vec![d]);
            let angle = g.sum([a, b, c, root]);
            [Function::Sin, Function::Cos].map(|function| g.call(function, vec![angle])).to_vec()
        });
        let before = dead_code::remove(&contract(&lower(&derived)));
        let states = [1.0, -1.0].map(|d| Inputs { speeds: vec![0.3, 0.1, 0.7, d], ..inputs() });
        assert_eq!(reassociate(&before, &states), before);
    }

    #[test]
    fn sums_may_be_nested_as_deep_as_they_are_long() {
        use crate::program::graph::Input::Speed;
        use crate::program::operation::Operation::{Input, MulAdd, Sub};
        for (length, few) in [(300, true), (100_000, false)] {
            let mut program = lower(&small(|g| vec![g.integer(0)]));
            program.operations = [0, 1, 2, 3].map(|index| Input(Speed(index))).to_vec();
            for index in 0..length {
                let (a, b, last) = (Value(index % 4), Value(index / 4 % 4), Value(index + 3));
                program.operations.push(if few { MulAdd(a, b, last) } else { Sub(a, last) });
            }
            program.outputs[0].values = vec![Value(length + 3)];
            let ordered = reassociate(&program, &[inputs()]);
            agree(&program, &ordered, "nested");
            assert!(!few || ordered != program);
        }
    }

    #[test]
    fn without_samples_nothing_changes() {
        let program = dead_code::remove(&contract(&lower(&random(3))));
        assert_eq!(reassociate(&program, &[]), program);
    }

    #[test]
    fn the_meaning_stays_and_no_operation_is_added() {
        for seed in 1..150 {
            let before = dead_code::remove(&contract(&lower(&random(seed))));
            let after = reassociate(&before, &[inputs()]);
            agree(&before, &after, &format!("seed {seed}"));
            assert!(after.operations.len() <= before.operations.len(), "seed {seed}");
        }
    }
}
