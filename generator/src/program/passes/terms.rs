//! Terms of sums and factors of products, taken apart.

use crate::number::Number;
use crate::program::graph::{Graph, Node, Value};

/// A number times a node that is no number and has no number in front; `None`: the number alone.
pub fn coefficient(graph: &mut Graph, node: Node) -> (Number, Option<Node>) {
    match graph.value(node).clone() {
        Value::Number(number) => (number, None),
        Value::Product(factors) => match graph.as_number(factors[0]).cloned() {
            Some(number) => {
                let rest = graph.product(factors[1..].iter().copied());
                (number, Some(rest))
            }
            None => (Number::integer(1), Some(node)),
        },
        _ => (Number::integer(1), Some(node)),
    }
}

/// The terms of a node: itself, if it is no sum.
pub fn terms(graph: &Graph, node: Node) -> Vec<Node> {
    match graph.value(node) {
        Value::Sum(terms) => terms.clone(),
        _ => vec![node],
    }
}

/// The number in front of a node and its factors, positive powers written out.
pub fn factors(graph: &Graph, node: Node) -> (Number, Vec<Node>) {
    let mut number = Number::integer(1);
    let mut factors = Vec::new();
    let listed = match graph.value(node) {
        Value::Product(listed) => listed.clone(),
        _ => vec![node],
    };
    for factor in listed {
        match graph.value(factor) {
            Value::Number(coefficient) => number = Number(number.0 * &coefficient.0),
            // A high power is better squared repeatedly.
            Value::Power(base, exponent @ 2..=3) => {
                factors.extend(std::iter::repeat_n(*base, *exponent as usize))
            }
            _ => factors.push(factor),
        }
    }
    factors.sort_unstable();
    (number, factors)
}
