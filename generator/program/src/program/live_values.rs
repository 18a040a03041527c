//! Orders the operations of a routine so that fewer values are live at a time.
//!
//! The depth-first order of a slice computes a shared value at its first use and keeps it until its last. In
//! a long routine, such as the accelerations of an arm, hundreds of values are then live at the same time,
//! and the compiler spills them to memory. The order of this module is built backwards: of the values whose
//! uses are all placed, it places the one that ends most lifetimes and begins fewest. It is used only where
//! it lowers the peak of live values considerably. The operations stay the same, and so do the bits of the
//! results.

use super::operation::Value;
use super::straight_line::Program;

/// Routines with fewer live values are left as they are.
const MIN_PEAK: usize = 64;
/// The backward order is used if its peak is below this percentage of the peak of the first order. Above it
/// the instruction order of the compiler decides more.
const MAX_PERCENT: usize = 75;

impl Program {
    /// The values of `order` (operands before their use), reordered to have fewer live values if that pays.
    /// `fetched` tells which values are only loaded from memory where they are used: inputs, constants,
    /// values known at construction.
    pub fn with_few_live(&self, order: &[Value], fetched: impl Fn(Value) -> bool) -> Vec<Value> {
        let graph = Uses::new(self, order, &fetched);
        let first: Vec<usize> = (0..order.len()).collect();
        let peak = graph.peak(&first);
        if peak < MIN_PEAK {
            return order.to_vec();
        }
        let other = graph.backward_order();
        if 100 * graph.peak(&other) < MAX_PERCENT * peak {
            other.into_iter().map(|place| order[place]).collect()
        } else {
            order.to_vec()
        }
    }
}

/// The uses of the values in a list, by their places in it.
struct Uses {
    /// the places of the operands of each value, without repetition
    operands: Vec<Vec<usize>>,
    /// number of values that use each value
    uses: Vec<usize>,
    /// whether a value takes no register before it is used
    fetched: Vec<bool>,
}

impl Uses {
    fn new(program: &Program, order: &[Value], fetched: &impl Fn(Value) -> bool) -> Self {
        let end = order.iter().map(|value| value.index() + 1).max().unwrap_or(0);
        let mut places = vec![None; end];
        for (place, value) in order.iter().enumerate() {
            places[value.index()] = Some(place);
        }
        let mut uses = vec![0; order.len()];
        let operands: Vec<Vec<usize>> = order
            .iter()
            .map(|&value| {
                let operands = program.operation(value).operands();
                let mut list: Vec<usize> =
                    operands.filter_map(|operand| places.get(operand.index()).copied().flatten()).collect();
                list.sort_unstable();
                list.dedup();
                list.iter().for_each(|&operand| uses[operand] += 1);
                list
            })
            .collect();
        Self { operands, uses, fetched: order.iter().map(|&value| fetched(value)).collect() }
    }

    /// The greatest number of values that are live at a time.
    fn peak(&self, order: &[usize]) -> usize {
        let mut left = self.uses.clone();
        let (mut live, mut peak) = (0_usize, 0);
        for &place in order {
            for &operand in &self.operands[place] {
                left[operand] -= 1;
                if left[operand] == 0 && !self.fetched[operand] {
                    live = live.saturating_sub(1);
                }
            }
            if !self.fetched[place] {
                live += 1;
            }
            peak = peak.max(live);
        }
        peak
    }

    /// The order built backwards.
    fn backward_order(&self) -> Vec<usize> {
        let count = self.operands.len();
        let mut left = self.uses.clone();
        // Results are live until the end.
        let mut live: Vec<bool> = left.iter().map(|&uses| uses == 0).collect();
        // The step in which a value was last used; among equals the latest is preferred.
        let mut asked = vec![0_usize; count];
        let mut ready: Vec<usize> = (0..count).filter(|&place| left[place] == 0).collect();
        let mut order = Vec::with_capacity(count);
        while let Some(at) = (0..ready.len()).max_by_key(|&at| self.priority(ready[at], &live, &asked)) {
            let place = ready.swap_remove(at);
            order.push(place);
            live[place] = false;
            for &operand in &self.operands[place] {
                live[operand] = true;
                asked[operand] = order.len();
                left[operand] -= 1;
                if left[operand] == 0 {
                    ready.push(operand);
                }
            }
        }
        order.reverse();
        order
    }

    /// The priority of placing a value next, backwards: fetched values first, then the number of lifetimes
    /// that it ends less the number that it begins, then the latest use.
    fn priority(&self, place: usize, live: &[bool], asked: &[usize]) -> (isize, usize, usize) {
        if self.fetched[place] {
            return (isize::MAX, 0, place);
        }
        let begins = self.operands[place].iter().filter(|&&o| !live[o] && !self.fetched[o]).count();
        (isize::from(live[place]) - begins.cast_signed(), asked[place], place)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::Quantity;
    use crate::program::graph::Input;
    use crate::program::operation::Operation;
    use crate::program::passes::testing::{random, small};
    use hodograph_model::number::Number;

    /// Whether every value occurs once, after its operands.
    fn is_an_order(graph: &Uses, order: &[usize]) -> bool {
        let mut placed = vec![false; order.len()];
        order.len() == graph.operands.len()
            && order.iter().all(|&place| {
                let ready = graph.operands[place].iter().all(|&operand| placed[operand]);
                ready && !std::mem::replace(&mut placed[place], true)
            })
    }

    fn is_fetched(program: &Program, value: Value) -> bool {
        matches!(program.operation(value), Operation::Input(_) | Operation::Constant(_))
    }

    #[test]
    fn operands_come_before_their_use() {
        for seed in 0..200 {
            let program = crate::program::lower::lower(&random(seed));
            let order = program.slice(&[Quantity::Forcing]).order;
            let graph = Uses::new(&program, &order, &|value| is_fetched(&program, value));
            assert!(is_an_order(&graph, &graph.backward_order()), "{seed}");
        }
    }

    /// Two sums of the same hundred terms. Computed one after the other, they keep all terms live; computed
    /// together, they keep none.
    #[test]
    fn sums_of_the_same_terms_are_made_together() {
        let derived = small(|graph| {
            let x = graph.input(Input::Speed(0));
            let mut sums = [graph.input(Input::Speed(1)), graph.input(Input::Speed(2))];
            for k in 2..102 {
                let number = graph.number(Number::ratio(k, 1));
                let shifted = graph.sum(vec![x, number]);
                let term = graph.power(shifted, -1);
                sums[0] = graph.product(vec![sums[0], term]);
                sums[0] = graph.sum(vec![sums[0], x]);
                let sum = graph.sum(vec![sums[1], term]);
                sums[1] = graph.product(vec![sum, x]);
            }
            sums.to_vec()
        });
        let program = crate::program::lower::lower(&derived);
        let order = program.slice(&[Quantity::Forcing]).order;
        let fetched = |value| is_fetched(&program, value);
        let peak = |order: &[Value]| {
            let graph = Uses::new(&program, order, &fetched);
            graph.peak(&(0..order.len()).collect::<Vec<_>>())
        };
        let better = program.with_few_live(&order, fetched);
        assert!(peak(&order) > 90 && peak(&better) < 10, "{} {}", peak(&order), peak(&better));
        assert_eq!(better, program.with_few_live(&order, fetched));
    }

    #[test]
    fn short_routines_stay_as_they_are() {
        let program = crate::program::lower::lower(&random(3));
        let order = program.slice(&[Quantity::Forcing]).order;
        assert_eq!(program.with_few_live(&order, |value| is_fetched(&program, value)), order);
    }
}
