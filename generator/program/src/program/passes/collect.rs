//! Collects like terms of sums, opens sums that only one sum uses, and makes the first coefficient positive.

use std::collections::BTreeMap;

use super::rewrite::{Survey, rebuild, rewrite};
use super::terms::{coefficient, terms};
use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use hodograph_model::number::Number;

/// Collects like terms.
pub fn collect(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    rewrite(derived, &survey, |graph, old, renamed| match derived.graph.kind(old) {
        NodeKind::Sum(old_terms) => {
            let mut collected = Collected::default();
            for &old_term in old_terms {
                let once = survey.is_used_once(old_term) && opens(&derived.graph, &survey, old_term);
                collected.add(graph, renamed.of(old_term), once);
            }
            collected.finish(graph)
        }
        value => rebuild(graph, value, renamed),
    })
}

/// Whether the sum in a term may be opened, that is, whether only this term uses it.
fn opens(graph: &Graph, survey: &Survey, term: Node) -> bool {
    match graph.kind(term) {
        NodeKind::Sum(_) => true,
        NodeKind::Product(factors) => match factors[..] {
            [number, sum] => {
                graph.as_number(number).is_some_and(|number| Number(-number.0.clone()).is_one())
                    && survey.is_used_once(sum)
            }
            _ => false,
        },
        _ => false,
    }
}

#[derive(Default)]
struct Collected {
    constant: Option<Number>,
    terms: BTreeMap<Node, Number>,
}

impl Collected {
    fn add(&mut self, graph: &mut Graph, term: Node, open: bool) {
        let (number, rest) = coefficient(graph, term);
        let Some(rest) = rest else {
            return self.constant(number);
        };
        let unit = number.is_one() || Number(-number.0.clone()).is_one();
        if open && unit && matches!(graph.kind(rest), NodeKind::Sum(_)) {
            for inner in terms(graph, rest) {
                let (coefficient, inner) = coefficient(graph, inner);
                let product = Number(&number.0 * coefficient.0);
                match inner {
                    Some(inner) => self.term(inner, product),
                    None => self.constant(product),
                }
            }
        } else {
            self.term(rest, number);
        }
    }

    fn constant(&mut self, number: Number) {
        let sum = self.constant.take().map_or(number.0.clone(), |constant| constant.0 + &number.0);
        self.constant = Some(Number(sum));
    }

    fn term(&mut self, node: Node, number: Number) {
        let sum = self.terms.remove(&node).map_or(number.0.clone(), |known| known.0 + &number.0);
        self.terms.insert(node, Number(sum));
    }

    /// The sum, with the common magnitude of all coefficients and the sign of the first taken out.
    fn finish(self, graph: &mut Graph) -> Node {
        let mut parts: Vec<(Number, Option<Node>)> =
            self.terms.into_iter().map(|(node, number)| (number, Some(node))).collect();
        parts.extend(self.constant.map(|constant| (constant, None)));
        parts.retain(|(number, _)| !number.is_zero());
        let Some((first, _)) = parts.first().cloned() else {
            return graph.integer(0);
        };
        let magnitude =
            |number: &Number| if number.is_negative() { Number(-number.0.clone()) } else { number.clone() };
        let common =
            parts.len() > 1 && parts.iter().all(|(number, _)| magnitude(number) == magnitude(&first));
        let front = match (common, first.is_negative() && parts.len() > 1) {
            (true, _) => first,
            (false, true) => Number::integer(-1),
            (false, false) => Number::integer(1),
        };
        let terms: Vec<Node> = parts
            .into_iter()
            .map(|(number, node)| {
                let number = graph.number(Number(number.0 / &front.0));
                match node {
                    Some(node) => graph.product([number, node]),
                    None => number,
                }
            })
            .collect();
        let sum = graph.sum(terms);
        let front = graph.number(front);
        graph.product([front, sum])
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{keeps_the_meaning, late, small, speeds};
    use super::*;

    #[test]
    fn like_terms_of_nested_sums_become_one() {
        let derived = small(|g| {
            let [a, b, ..] = speeds(g);
            let two = g.integer(2);
            let (inner, twice, minus) = (g.sum([a, b]), g.product([two, a]), g.neg(b));
            vec![g.sum([inner, twice, minus])]
        });
        assert_eq!(late(&derived), ["Add", "Mul", "Sub", "Add"]);
        assert_eq!(late(&collect(&derived)), ["Mul"], "3 a");
    }

    #[test]
    fn terms_that_cancel_give_exactly_zero() {
        let derived = small(|g| {
            let [a, b, ..] = speeds(g);
            let (product, same) = (g.product([a, b]), g.product([b, a]));
            vec![g.sub(product, same)]
        });
        let collected = collect(&derived);
        assert!(collected.graph.is_zero(collected.outputs[0].values[0]));
    }

    #[test]
    fn a_sum_that_others_use_stays_closed() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let shared = g.sum([a, b]);
            vec![g.sum([shared, c]), g.sum([shared, d])]
        });
        assert_eq!(late(&collect(&derived)), ["Add", "Add", "Add"]);
    }

    #[test]
    fn a_common_magnitude_and_the_first_sign_come_out() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let half = g.number(Number::ratio(-1, 2));
            let (x, y) = (g.product([half, a]), g.product([half, b]));
            let minus = g.neg(c);
            vec![g.sum([x, y]), g.sum([minus, d])]
        });
        assert_eq!(late(&collect(&derived)), ["Add", "Mul", "Sub", "Neg", "Neg"], "-1/2 (a + b), -(c - d)");
        keeps_the_meaning(collect);
    }
}
