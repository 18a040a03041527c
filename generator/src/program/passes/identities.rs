//! Replaces nodes that are identically 0, 1 or another simple number although their form does not show it: cos^2 + sin^2, or a term and its opposite in
//! different forms.
//!
//! Nodes are evaluated at arbitrary inputs with twice the digits. Sums, products, quotients, sines and exponentials are analytic; a node with the same value at
//! all of the inputs is therefore constant with probability 1. Functions with branches (roots, magnitudes, arc functions) count as independent unknowns.

use super::known::{Known, PLACES, analytic, arbitrary, seed_of};
use super::rewrite::{Survey, rebuild, rewrite};
use crate::arithmetic::Arithmetic;
use crate::arithmetic::reproducible::Reproducible;
use crate::number::Number;
use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use crate::program::operation::Stage;

/// Numbers that are found are multiples of the reciprocal of this, up to [`LARGEST`].
const DENOMINATOR: i64 = 12;
/// Larger numbers are left alone.
const LARGEST: f64 = 1000.0;
/// In longer sums no three terms are looked for that cancel.
const LONGEST: usize = 16;

/// Replaces nodes that are identically a number, and drops terms that cancel.
pub fn replace(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    let places: Vec<Vec<Known>> = (0..PLACES).map(|place| evaluated(&derived.graph, place)).collect();
    let at = |node: Node| -> [Known; PLACES] { std::array::from_fn(|place| places[place][node.0 as usize]) };
    rewrite(derived, &survey, |graph, old, renamed| {
        let kind = derived.graph.kind(old);
        let known = survey.stage(old) == Stage::Constant;
        if let Some(number) = number_of(&at(old)).filter(|_| !known && !matches!(kind, NodeKind::Input(_))) {
            return graph.number(number);
        }
        match kind {
            NodeKind::Sum(terms) => {
                let all: Vec<[Known; PLACES]> = terms.iter().map(|&term| at(term)).collect();
                let left = without_cancelled(&all);
                let kept = left.into_iter().map(|index| renamed.of(terms[index])).collect::<Vec<_>>();
                graph.sum(kept)
            }
            _ => rebuild(graph, kind, renamed),
        }
    })
}

/// All nodes at one place.
fn evaluated(graph: &Graph, place: usize) -> Vec<Known> {
    let mut numbers: Vec<Known> = Vec::with_capacity(graph.kinds().len());
    for (index, kind) in graph.kinds().iter().enumerate() {
        let of = |node: Node| numbers[node.0 as usize];
        let number = match kind {
            NodeKind::Number(number) => Known::exact(Reproducible::nearest(number)),
            NodeKind::Pi => Known::exact(Reproducible::pi()),
            NodeKind::Input(input) => arbitrary(seed_of(*input), place),
            NodeKind::Sum(terms) => Known::sum(terms.iter().map(|&term| of(term))),
            NodeKind::Product(factors) => {
                let one = Known::exact(Reproducible::exactly(1.0));
                factors.iter().fold(one, |product, &factor| product.times(of(factor)))
            }
            &NodeKind::Power(base, exponent) => {
                let base = if exponent < 0 { of(base).reciprocal() } else { of(base) };
                (1..exponent.unsigned_abs()).fold(base, |power, _| power.times(base))
            }
            NodeKind::Call(function, arguments) => analytic(*function, of(arguments[0]))
                .unwrap_or_else(|| arbitrary(1 << 40 | index as u64, place)),
        };
        numbers.push(number);
    }
    numbers
}

/// The simple number that a node is at all places, if it is one.
fn number_of(at: &[Known; PLACES]) -> Option<Number> {
    let first = at[0].number.rounded();
    if !at.iter().all(|known| known.number.rounded().is_finite()) || first.abs() > LARGEST {
        return None;
    }
    let multiple = (first * DENOMINATOR as f64).round();
    let number = Number::ratio(multiple as i64, DENOMINATOR);
    let exact = Reproducible::nearest(&number);
    let is = |known: &Known| {
        let rest = Known { number: known.number - exact, ..*known };
        rest.is(0.0)
    };
    at.iter().all(is).then_some(number)
}

/// The terms of a sum that are left when those are gone which cancel in twos and threes.
fn without_cancelled(terms: &[[Known; PLACES]]) -> Vec<usize> {
    let cancel = |group: &[usize]| {
        (0..PLACES).all(|place| Known::sum(group.iter().map(|&index| terms[index][place])).is(0.0))
    };
    let mut left: Vec<usize> = (0..terms.len()).collect();
    // what cancels is of one size: neighbours, when they are in order of it
    let size = |&index: &usize| terms[index][0].size.to_bits();
    let mut sorted = left.clone();
    sorted.sort_by_key(size);
    let mut at = 1;
    while at < sorted.len() {
        if cancel(&sorted[at - 1..=at]) {
            let pair: Vec<usize> = sorted.drain(at - 1..=at).collect();
            left.retain(|index| !pair.contains(index));
            at = at.saturating_sub(1).max(1);
        } else {
            at += 1;
        }
    }
    while let Some(group) = three(&left, &cancel).filter(|_| left.len() > 3) {
        left.retain(|index| !group.contains(index));
    }
    left
}

fn three(left: &[usize], cancel: &impl Fn(&[usize]) -> bool) -> Option<[usize; 3]> {
    if left.len() > LONGEST {
        return None;
    }
    for (i, &a) in left.iter().enumerate() {
        for (j, &b) in left.iter().enumerate().skip(i + 1) {
            if let Some(&c) = left[j + 1..].iter().find(|&&c| cancel(&[a, b, c])) {
                return Some([a, b, c]);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::testing::{keeps_the_meaning, parameters, small, speeds};
    use super::*;
    use crate::arithmetic::Function;

    fn replaced(build: impl FnOnce(&mut Graph) -> Node) -> NodeKind {
        let replaced = replace(&small(|graph| vec![build(graph)]));
        replaced.graph.kind(replaced.outputs[0].values[0]).clone()
    }

    fn squares(graph: &mut Graph, angle: Node) -> Node {
        let squares = [Function::Sin, Function::Cos].map(|function| {
            let call = graph.call(function, vec![angle]);
            graph.product([call, call])
        });
        graph.sum(squares)
    }

    #[test]
    fn meaning_is_kept() {
        keeps_the_meaning(replace);
    }

    #[test]
    fn functions_with_branches_of_different_angles_differ() {
        let kind = replaced(|graph| {
            let [x, y, ..] = speeds(graph);
            let minus = graph.integer(-1);
            let [first, second] = [x, y].map(|angle| graph.call(Function::Abs, vec![angle]));
            let second = graph.product([minus, second]);
            graph.sum([first, second])
        });
        assert!(matches!(kind, NodeKind::Sum(_)), "{kind:?}");
    }

    #[test]
    fn what_is_identically_a_number_becomes_it() {
        let number = |n, d| NodeKind::Number(Number::ratio(n, d));
        let one = |graph: &mut Graph| {
            let [x, ..] = speeds(graph);
            squares(graph, x)
        };
        assert_eq!(replaced(one), number(1, 1));
        let nothing = |graph: &mut Graph| {
            let [x, y, z, _] = speeds(graph);
            let (sum, minus) = (graph.sum([x, y]), graph.integer(-1));
            let (whole, a, b) =
                (graph.product([sum, z]), graph.product([minus, x, z]), graph.product([minus, y, z]));
            graph.sum([whole, a, b])
        };
        assert_eq!(replaced(nothing), number(0, 1));
        let third = |graph: &mut Graph| {
            let ([x, y, ..], [m, ..]) = (speeds(graph), parameters(graph));
            let (sum, three) = (graph.sum([x, y, m]), graph.integer(3));
            let parts = [x, y, m].map(|part| {
                let bottom = graph.product([three, sum]);
                graph.div(part, bottom)
            });
            graph.sum(parts)
        };
        assert_eq!(replaced(third), number(1, 3));
    }

    #[test]
    fn terms_that_cancel_leave_a_sum() {
        let rest = |graph: &mut Graph| {
            let [x, y, z, w] = speeds(graph);
            let (square, minus) = (squares(graph, x), graph.integer(-1));
            let (a, b) = (graph.product([square, y]), graph.product([minus, y]));
            let last = graph.product([z, w]);
            graph.sum([a, b, last])
        };
        assert!(matches!(replaced(rest), NodeKind::Product(factors) if factors.len() == 2));
    }

    #[test]
    fn what_only_looks_like_a_number_is_left() {
        let nearly = |graph: &mut Graph| {
            let [x, y, ..] = speeds(graph);
            let tiny = graph.number(Number(num_rational::BigRational::from_float(1e-25).unwrap()));
            let (small, minus) = (graph.product([tiny, y]), graph.integer(-1));
            let square = squares(graph, x);
            graph.sum([square, minus, small])
        };
        assert!(!matches!(replaced(nearly), NodeKind::Number(_)));
        // 0 for every x below 10: a branch decides
        let branch = |graph: &mut Graph| {
            let ([x, ..], ten) = (speeds(graph), graph.integer(-10));
            let shifted = graph.sum([x, ten]);
            let magnitude = graph.call(Function::Abs, vec![shifted]);
            graph.sum([magnitude, shifted])
        };
        assert!(!matches!(replaced(branch), NodeKind::Number(_)));
    }
}
