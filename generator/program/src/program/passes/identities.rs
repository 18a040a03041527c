//! Replaces nodes that are identically 0, 1 or another simple number although their form does not show it:
//! cos^2 + sin^2, or a term and its opposite in different forms.
//!
//! Nodes are evaluated modulo primes at random inputs ([`super::modular`]): a node that has the residue of
//! the same simple number at all of them is replaced by that number.

use std::collections::HashMap;

use super::rewrite::{Survey, rebuild, rewrite};
use crate::program::derivation::Derived;
use crate::program::graph::{Node, NodeKind};
use crate::program::operation::Stage;
use hodograph_model::graph::modular::Residues;
use hodograph_model::number::Number;

/// Numbers that can be found are multiples of the reciprocal of this, up to [`LARGEST`].
const DENOMINATOR: u32 = 12;
/// The largest number that can be found.
const LARGEST: u32 = 12_000;
/// In longer sums triples of terms that cancel are not sought.
const LONGEST: usize = 16;

/// Replaces nodes that are identically a number, and drops terms that cancel.
pub fn replace(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    let residues = derived.graph.residues();
    let at = |node: Node| residues[node.0 as usize];
    rewrite(derived, &survey, |graph, old, renamed| {
        let kind = derived.graph.kind(old);
        let known = survey.stage(old) == Stage::Constant;
        if let Some(number) =
            at(old).and_then(number_of).filter(|_| !known && !matches!(kind, NodeKind::Input(_)))
        {
            return graph.number(number);
        }
        match kind {
            NodeKind::Sum(terms) => {
                let all: Vec<Option<Residues>> = terms.iter().map(|&term| at(term)).collect();
                let left = without_cancelled(&all);
                let kept = left.into_iter().map(|index| renamed.of(terms[index])).collect::<Vec<_>>();
                graph.sum(kept)
            }
            _ => rebuild(graph, kind, renamed),
        }
    })
}

/// The simple number that a node is identically, if any.
fn number_of(at: Residues) -> Option<Number> {
    let numerator = at.multiple_of(DENOMINATOR, LARGEST)?;
    Some(Number::ratio(numerator, i64::from(DENOMINATOR)))
}

/// The terms of a sum that remain after pairs and triples that cancel are removed.
fn without_cancelled(terms: &[Option<Residues>]) -> Vec<usize> {
    let mut left: Vec<usize> = (0..terms.len()).collect();
    let mut open: HashMap<Residues, Vec<usize>> = HashMap::new();
    for (index, term) in terms.iter().enumerate() {
        let Some(term) = term else { continue };
        match open.get_mut(&term.opposite()).and_then(Vec::pop) {
            Some(opposite) => left.retain(|&kept| kept != index && kept != opposite),
            None => open.entry(*term).or_default().push(index),
        }
    }
    while let Some(group) = three(terms, &left).filter(|_| left.len() > 3) {
        left.retain(|index| !group.contains(index));
    }
    left
}

/// Three terms whose sum is 0.
fn three(terms: &[Option<Residues>], left: &[usize]) -> Option<[usize; 3]> {
    if left.len() > LONGEST {
        return None;
    }
    let cancel = |a: usize, b: usize, c: usize| {
        let [Some(a), Some(b), Some(c)] = [terms[a], terms[b], terms[c]] else { return false };
        Residues::cancel(&[a, b, c])
    };
    for (i, &a) in left.iter().enumerate() {
        for (j, &b) in left.iter().enumerate().skip(i + 1) {
            if let Some(&c) = left[j + 1..].iter().find(|&&c| cancel(a, b, c)) {
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
    use crate::program::graph::Graph;
    use hodograph_model::arithmetic::Function;

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
    fn nodes_that_are_identically_a_number_become_that_number() {
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
    fn nodes_that_are_only_close_to_a_number_stay() {
        let nearly = |graph: &mut Graph| {
            let [x, y, ..] = speeds(graph);
            let tiny = graph.number(Number(num_rational::BigRational::from_float(1e-60).unwrap()));
            let (small, minus) = (graph.product([tiny, y]), graph.integer(-1));
            let square = squares(graph, x);
            graph.sum([square, minus, small])
        };
        assert!(!matches!(replaced(nearly), NodeKind::Number(_)));
        // a node that is 0 for every x below 10: a branch decides
        let branch = |graph: &mut Graph| {
            let ([x, ..], ten) = (speeds(graph), graph.integer(-10));
            let shifted = graph.sum([x, ten]);
            let magnitude = graph.call(Function::Abs, vec![shifted]);
            graph.sum([magnitude, shifted])
        };
        assert!(!matches!(replaced(branch), NodeKind::Number(_)));
    }
}
