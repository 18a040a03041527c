//! Values of nodes in doubles, and nodes in which inputs are replaced.

use std::collections::HashMap;

use super::nodes::times;
use crate::arithmetic::{call, call2};
use crate::graph::{Graph, Input, Node, NodeKind};

/// A node with the inputs in doubles.
pub fn value(graph: &Graph, node: Node, inputs: &impl Fn(Input) -> f64) -> f64 {
    let needed = graph.reachable([node]);
    let mut values = vec![0.0; needed.len()];
    for (index, kind) in graph.kinds().iter().enumerate().filter(|(index, _)| needed[*index]) {
        let at = |node: &Node| values[node.0 as usize];
        values[index] = match kind {
            NodeKind::Number(number) => number.to_f64(),
            NodeKind::Pi => std::f64::consts::PI,
            NodeKind::Input(input) => inputs(*input),
            NodeKind::Sum(terms) => terms.iter().map(at).sum(),
            NodeKind::Product(factors) => factors.iter().map(at).product(),
            NodeKind::Power(base, exponent) => at(base).powi(*exponent),
            NodeKind::Call(function, arguments) => match arguments[..] {
                [ref a, ref b] => call2(*function, at(a), at(b)),
                _ => call(*function, at(&arguments[0])),
            },
        };
    }
    values[node.0 as usize]
}

/// Nodes in which an input is replaced, with all else as it stands.
pub fn substituted(graph: &mut Graph, nodes: &[Node], input: Input, by: Node) -> Vec<Node> {
    let needed = graph.reachable(nodes.iter().copied());
    let mut renamed: HashMap<Node, Node> = HashMap::new();
    for index in (0..needed.len()).filter(|&index| needed[index]) {
        let node = Node(index as u32);
        let kind = graph.kind(node).clone();
        let changed = kind.operands().iter().any(|operand| renamed.contains_key(operand));
        let of = |node: &Node| renamed.get(node).copied().unwrap_or(*node);
        let new = match kind {
            NodeKind::Input(found) => (found == input).then_some(by),
            _ if !changed => None,
            NodeKind::Sum(terms) => Some(graph.sum(terms.iter().map(of).collect::<Vec<_>>())),
            NodeKind::Product(factors) => {
                let one = graph.integer(1);
                Some(factors.iter().map(of).fold(one, |product, factor| times(graph, product, factor)))
            }
            NodeKind::Power(base, exponent) => Some(graph.power(of(&base), exponent)),
            NodeKind::Call(function, arguments) => {
                Some(graph.call(function, arguments.iter().map(of).collect()))
            }
            NodeKind::Number(_) | NodeKind::Pi => None,
        };
        renamed.extend(new.map(|new| (node, new)));
    }
    nodes.iter().map(|node| renamed.get(node).copied().unwrap_or(*node)).collect()
}
