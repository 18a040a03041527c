//! The passes on the graph, in order. Each keeps what every output means; the interpreter is the referee.

mod collect;
mod factor;
mod fold;
pub mod fuse;
mod pairs;
mod share;
mod terms;

use std::collections::HashMap;

use super::graph::{Graph, Node, Value};
use super::lower::{operands, reachable};
use super::operation::Stage;
use super::routine::{Derived, Guard, Output};

/// A pass on the graph.
#[derive(Clone, Copy)]
pub struct Pass {
    /// its name, as cost tables show it
    pub name: &'static str,
    /// what it does
    pub run: fn(&Derived) -> Derived,
}

/// The passes in their order.
pub const PASSES: [Pass; 4] = [
    Pass { name: "fold", run: fold::fold },
    Pass { name: "collect", run: collect::collect },
    Pass { name: "factor", run: factor::factor },
    Pass { name: "share", run: share::share },
];

/// What passes look up about the nodes of a graph.
pub struct Survey {
    /// is the node needed?
    pub reachable: Vec<bool>,
    /// how many nodes and outputs refer to it
    pub uses: Vec<u32>,
    /// when it can be computed
    pub stages: Vec<Stage>,
}

impl Survey {
    /// Looks at a derivation.
    pub fn new(derived: &Derived) -> Self {
        let graph = &derived.graph;
        let reachable = reachable(graph, roots(derived));
        let mut uses = vec![0; graph.values().len()];
        for root in roots(derived) {
            uses[root.0 as usize] += 1;
        }
        let mut stages: Vec<Stage> = Vec::with_capacity(graph.values().len());
        for (index, value) in graph.values().iter().enumerate() {
            stages.push(stage(value, |node| stages[node.0 as usize]));
            if reachable[index] {
                for operand in operands(value) {
                    uses[operand.0 as usize] += 1;
                }
            }
        }
        Survey { reachable, uses, stages }
    }

    /// When a node can be computed.
    pub fn stage(&self, node: Node) -> Stage {
        self.stages[node.0 as usize]
    }

    /// Is there exactly one that refers to the node?
    pub fn is_used_once(&self, node: Node) -> bool {
        self.uses[node.0 as usize] == 1
    }
}

/// When a node can be computed.
pub fn stage(value: &Value, mut of: impl FnMut(Node) -> Stage) -> Stage {
    match value {
        Value::Input(input) => Stage::of_input(*input),
        _ => operands(value).iter().map(|&operand| of(operand)).max().unwrap_or(Stage::Constant),
    }
}

/// All nodes that a derivation wants.
pub fn roots(derived: &Derived) -> impl Iterator<Item = Node> {
    let outputs = derived.outputs.iter().flat_map(|output| output.nodes.iter().copied());
    outputs.chain(derived.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten())
}

/// Drops the guards that no output needs.
pub fn prune(derived: &Derived) -> Derived {
    let wanted = derived.outputs.iter().flat_map(|output| output.nodes.iter().copied());
    let reachable = reachable(&derived.graph, wanted);
    let mut pruned = derived.clone();
    pruned.guards.retain(|guard| reachable[guard.value.0 as usize]);
    pruned
}

/// A new graph, node by node: `form` makes the new node of an old one, whose operands are new already.
pub fn rewrite(
    derived: &Derived,
    survey: &Survey,
    mut form: impl FnMut(&mut Graph, Node, &Renamed) -> Node,
) -> Derived {
    let mut graph = Graph::new();
    let mut renamed = Renamed { nodes: HashMap::new() };
    for index in 0..derived.graph.values().len() {
        if survey.reachable[index] {
            let old = Node(index as u32);
            let new = form(&mut graph, old, &renamed);
            renamed.nodes.insert(old, new);
        }
    }
    let outputs = derived.outputs.iter().map(|output| Output {
        nodes: output.nodes.iter().map(|&node| renamed.of(node)).collect(),
        ..output.clone()
    });
    let guards = derived.guards.iter().map(|guard| Guard {
        value: renamed.of(guard.value),
        scale: guard.scale.map(|scale| renamed.of(scale)),
        message: guard.message.clone(),
    });
    let (outputs, guards) = (outputs.collect(), guards.collect());
    Derived { graph, outputs, guards, structures: derived.structures.clone() }
}

/// New nodes for old.
pub struct Renamed {
    nodes: HashMap<Node, Node>,
}

impl Renamed {
    /// The new node of an old one.
    pub fn of(&self, old: Node) -> Node {
        // Operands come before their use, so they are there.
        self.nodes.get(&old).copied().unwrap_or(old)
    }

    /// The new nodes of old ones.
    pub fn all(&self, old: &[Node]) -> Vec<Node> {
        old.iter().map(|&node| self.of(node)).collect()
    }
}

/// The new node of an old one that is made as it was, through the simplifying constructors.
pub fn rebuild(graph: &mut Graph, value: &Value, renamed: &Renamed) -> Node {
    match value {
        Value::Number(number) => graph.number(number.clone()),
        Value::Pi => graph.pi(),
        Value::Input(input) => graph.input(*input),
        Value::Sum(terms) => graph.sum(renamed.all(terms)),
        Value::Product(factors) => graph.product(renamed.all(factors)),
        Value::Power(base, exponent) => graph.power(renamed.of(*base), *exponent),
        Value::Call(function, arguments) => {
            let arguments = renamed.all(arguments);
            graph.call(*function, arguments)
        }
    }
}

#[cfg(test)]
mod tests;
