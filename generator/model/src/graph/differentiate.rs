//! Forms directional derivatives of nodes in the same graph.

use std::collections::HashMap;

use super::{Graph, Input, Node, NodeKind};
use crate::arithmetic::Function;

/// The derivatives of `nodes` along the direction in which each input changes as `rates` says (others do
/// not).
pub fn differentiate(graph: &mut Graph, nodes: &[Node], rates: &HashMap<Input, Node>) -> Vec<Node> {
    let needed = reachable(graph, nodes);
    let zero = graph.integer(0);
    // Operands come before the nodes that use them: one pass in their order, without recursion.
    let mut derivatives: HashMap<Node, Node> = HashMap::new();
    for node in needed {
        let derivative = match graph.kind(node).clone() {
            NodeKind::Number(_) | NodeKind::Pi => zero,
            NodeKind::Input(input) => rates.get(&input).copied().unwrap_or(zero),
            NodeKind::Sum(terms) => {
                let terms: Vec<Node> = terms.iter().map(|term| derivatives[term]).collect();
                graph.sum(terms)
            }
            NodeKind::Product(factors) => {
                let mut terms = Vec::new();
                for (at, factor) in factors.iter().enumerate() {
                    let derivative = derivatives[factor];
                    if !graph.is_zero(derivative) {
                        let mut product = factors.clone();
                        product[at] = derivative;
                        terms.push(graph.product(product));
                    }
                }
                graph.sum(terms)
            }
            NodeKind::Power(base, n) => {
                let derivative = derivatives[&base];
                if graph.is_zero(derivative) {
                    zero
                } else {
                    let (n_node, rest) = (graph.integer(n.into()), graph.power(base, n - 1));
                    graph.product([n_node, rest, derivative])
                }
            }
            NodeKind::Call(function, arguments) => {
                let mut terms = Vec::new();
                for (at, argument) in arguments.iter().enumerate() {
                    let derivative = derivatives[argument];
                    if !graph.is_zero(derivative) {
                        let slope = slope(graph, node, function, &arguments, at);
                        terms.push(graph.product([slope, derivative]));
                    }
                }
                graph.sum(terms)
            }
        };
        derivatives.insert(node, derivative);
    }
    nodes.iter().map(|node| derivatives[node]).collect()
}

/// Derivative of a node with respect to its operand number `at`.
pub fn slope_by(graph: &mut Graph, node: Node, at: usize) -> Node {
    match graph.kind(node).clone() {
        NodeKind::Number(_) | NodeKind::Pi | NodeKind::Input(_) => graph.integer(0),
        NodeKind::Sum(_) => graph.integer(1),
        NodeKind::Product(mut factors) => {
            factors.remove(at);
            graph.product(factors)
        }
        NodeKind::Power(base, n) => {
            let (n_node, rest) = (graph.integer(n.into()), graph.power(base, n - 1));
            graph.product([n_node, rest])
        }
        NodeKind::Call(function, arguments) => slope(graph, node, function, &arguments, at),
    }
}

fn reachable(graph: &Graph, nodes: &[Node]) -> Vec<Node> {
    let mut seen = vec![false; graph.kinds().len()];
    let mut open = nodes.to_vec();
    while let Some(node) = open.pop() {
        if std::mem::replace(&mut seen[node.0 as usize], true) {
            continue;
        }
        match graph.kind(node) {
            NodeKind::Number(_) | NodeKind::Pi | NodeKind::Input(_) => {}
            NodeKind::Sum(parts) | NodeKind::Product(parts) | NodeKind::Call(_, parts) => open.extend(parts),
            NodeKind::Power(base, _) => open.push(*base),
        }
    }
    (0..seen.len()).filter(|&i| seen[i]).map(|i| Node(i as u32)).collect()
}

/// Derivative of a function (whose value is `node`) with respect to its argument number `at`.
fn slope(graph: &mut Graph, node: Node, function: Function, arguments: &[Node], at: usize) -> Node {
    use Function::*;
    let a = arguments[0];
    let one = graph.integer(1);
    let square = |graph: &mut Graph, a: Node| graph.power(a, 2);
    match function {
        Sin => graph.call(Cos, vec![a]),
        Cos => {
            let sine = graph.call(Sin, vec![a]);
            graph.neg(sine)
        }
        Tan => {
            let square = square(graph, node);
            graph.sum([one, square])
        }
        Asin | Acos => {
            let square = square(graph, a);
            let rest = graph.sub(one, square);
            let root = graph.call(Sqrt, vec![rest]);
            let slope = graph.power(root, -1);
            if function == Acos { graph.neg(slope) } else { slope }
        }
        Atan => {
            let square = square(graph, a);
            let sum = graph.sum([one, square]);
            graph.power(sum, -1)
        }
        Atan2 => {
            let b = arguments[1];
            let (aa, bb) = (square(graph, a), square(graph, b));
            let sum = graph.sum([aa, bb]);
            let numerator = if at == 0 { b } else { graph.neg(a) };
            graph.div(numerator, sum)
        }
        Sqrt => {
            let two = graph.integer(2);
            let twice = graph.product([two, node]);
            graph.power(twice, -1)
        }
        Exp => node,
        Log => graph.power(a, -1),
        Sinh => graph.call(Cosh, vec![a]),
        Cosh => graph.call(Sinh, vec![a]),
        Tanh => {
            let square = square(graph, node);
            graph.sub(one, square)
        }
        Abs => graph.call(Sign, vec![a]),
        Sign | Frozen => graph.integer(0),
        Min | Max => {
            // (1 +- sign(a - b)) / 2: the branch that is taken
            let difference = graph.sub(a, arguments[1]);
            let sign = graph.call(Sign, vec![difference]);
            let sign = if (function == Max) == (at == 0) { sign } else { graph.neg(sign) };
            let (sum, two) = (graph.sum([one, sign]), graph.integer(2));
            graph.div(sum, two)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// d/dx of a product, a quotient and functions against hand-made results, as nodes.
    #[test]
    fn rules_give_the_textbook_nodes() {
        let mut graph = Graph::new();
        let (x, y) = (graph.input(Input::Coordinate(0)), graph.input(Input::Coordinate(1)));
        let one = graph.integer(1);
        let rates = HashMap::from([(Input::Coordinate(0), one)]);
        let (sine, product, quotient) =
            (graph.call(Function::Sin, vec![x]), graph.product([x, x, y]), graph.div(y, x));
        let derivatives = differentiate(&mut graph, &[sine, product, quotient, y], &rates);
        let cosine = graph.call(Function::Cos, vec![x]);
        assert_eq!(derivatives[0], cosine);
        let twice = graph.product([x, y]);
        let twice = graph.sum([twice, twice]);
        assert_eq!(derivatives[1], twice);
        let inverse_square = graph.power(x, -2);
        let minus = graph.integer(-1);
        assert_eq!(derivatives[2], graph.product([minus, inverse_square, y]));
        assert!(graph.is_zero(derivatives[3]));
    }
}
