//! Splits sums into terms and products into factors.

use crate::program::graph::{Graph, Node, NodeKind};
use hodograph_model::number::Number;

/// A node as a number times a node without a number in front; `None`: the node is the number alone.
pub fn coefficient(graph: &mut Graph, node: Node) -> (Number, Option<Node>) {
    match graph.kind(node).clone() {
        NodeKind::Number(number) => (number, None),
        NodeKind::Product(factors) => match graph.as_number(factors[0]).cloned() {
            Some(number) => {
                let rest = graph.product(factors[1..].iter().copied());
                (number, Some(rest))
            }
            None => (Number::integer(1), Some(node)),
        },
        _ => (Number::integer(1), Some(node)),
    }
}

/// The terms of a node: the node itself if it is not a sum.
pub fn terms(graph: &Graph, node: Node) -> Vec<Node> {
    match graph.kind(node) {
        NodeKind::Sum(terms) => terms.clone(),
        _ => vec![node],
    }
}

/// The number in front of a node and its factors, positive powers written out.
pub fn factors(graph: &Graph, node: Node) -> (Number, Vec<Node>) {
    let mut number = Number::integer(1);
    let mut factors = Vec::new();
    let listed = match graph.kind(node) {
        NodeKind::Product(listed) => listed.clone(),
        _ => vec![node],
    };
    for factor in listed {
        match graph.kind(factor) {
            NodeKind::Number(coefficient) => number = Number(number.0 * &coefficient.0),
            // A high power is computed by repeated squaring.
            NodeKind::Power(base, exponent @ 2..=3) => {
                factors.extend(std::iter::repeat_n(*base, *exponent as usize))
            }
            _ => factors.push(factor),
        }
    }
    factors.sort_unstable();
    (number, factors)
}

#[cfg(test)]
mod tests {
    use super::super::testing::speeds;
    use super::*;

    #[test]
    fn numbers_are_separated_from_the_other_factors() {
        let mut g = Graph::new();
        let [a, b, ..] = speeds(&mut g);
        let three = g.integer(3);
        let product = g.product([three, a, b]);
        let rest = g.product([a, b]);
        assert_eq!(coefficient(&mut g, product), (Number::integer(3), Some(rest)));
        assert_eq!(coefficient(&mut g, a), (Number::integer(1), Some(a)));
        assert_eq!(coefficient(&mut g, three), (Number::integer(3), None));
    }

    #[test]
    fn low_powers_are_written_out_and_high_ones_and_divisors_are_not() {
        let mut g = Graph::new();
        let [a, b, c, _] = speeds(&mut g);
        let (square, high, inverse) = (g.power(a, 2), g.power(b, 4), g.power(c, -1));
        let product = g.product([square, high, inverse]);
        let mut expected = vec![a, a, high, inverse];
        expected.sort_unstable();
        assert_eq!(factors(&g, product), (Number::integer(1), expected));
        let sum = g.sum([a, b]);
        assert_eq!((terms(&g, sum), terms(&g, a)), (vec![a, b], vec![a]));
    }
}
