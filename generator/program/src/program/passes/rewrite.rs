//! Common code of the passes on the graph: facts about nodes, and building a new graph from an old one.

use std::collections::HashMap;

use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use crate::program::operation::Stage;
use crate::program::output::{Guard, Output};

/// Facts about the nodes of a graph that passes look up.
pub struct Survey {
    /// whether an output or a guard needs the node
    pub reachable: Vec<bool>,
    /// number of nodes and outputs that refer to it
    pub uses: Vec<u32>,
    /// the stage of the node
    pub stages: Vec<Stage>,
}

impl Survey {
    /// Collects the facts about the nodes of a derivation.
    pub fn new(derived: &Derived) -> Self {
        let graph = &derived.graph;
        let reachable = graph.reachable(roots(derived));
        let mut uses = vec![0; graph.kinds().len()];
        for root in roots(derived) {
            uses[root.0 as usize] += 1;
        }
        let mut stages: Vec<Stage> = Vec::with_capacity(graph.kinds().len());
        for (index, value) in graph.kinds().iter().enumerate() {
            stages.push(stage(value, |node| stages[node.0 as usize]));
            if reachable[index] {
                for operand in value.operands() {
                    uses[operand.0 as usize] += 1;
                }
            }
        }
        Survey { reachable, uses, stages }
    }

    /// The stage of a node.
    pub fn stage(&self, node: Node) -> Stage {
        self.stages[node.0 as usize]
    }

    /// Whether exactly one node refers to this node.
    pub fn is_used_once(&self, node: Node) -> bool {
        self.uses[node.0 as usize] == 1
    }
}

/// The earliest stage at which a node can be computed.
pub fn stage(value: &NodeKind, mut of: impl FnMut(Node) -> Stage) -> Stage {
    match value {
        NodeKind::Input(input) => Stage::of_input(*input),
        _ => value.operands().iter().map(|&operand| of(operand)).max().unwrap_or(Stage::Constant),
    }
}

/// The nodes of all outputs and guards.
pub fn roots(derived: &Derived) -> impl Iterator<Item = Node> {
    let outputs = derived.outputs.iter().flat_map(|output| output.values.iter().copied());
    outputs.chain(derived.guards.iter().flat_map(|guard| [Some(guard.value), guard.scale]).flatten())
}

/// Builds a new graph, node by node: `form` makes the new node of an old one whose operands are new already.
pub fn rewrite(
    derived: &Derived,
    survey: &Survey,
    mut form: impl FnMut(&mut Graph, Node, &Renamed) -> Node,
) -> Derived {
    let mut graph = Graph::new();
    let mut renamed = Renamed { nodes: HashMap::new() };
    for index in 0..derived.graph.kinds().len() {
        if survey.reachable[index] {
            let old = Node(index as u32);
            let new = form(&mut graph, old, &renamed);
            renamed.nodes.insert(old, new);
        }
    }
    let outputs = derived.outputs.iter().map(|output| Output {
        values: output.values.iter().map(|&node| renamed.of(node)).collect(),
        ..output.clone()
    });
    let guards = derived.guards.iter().map(|guard| Guard {
        value: renamed.of(guard.value),
        scale: guard.scale.map(|scale| renamed.of(scale)),
        message: guard.message.clone(),
    });
    let (outputs, guards) = (outputs.collect(), guards.collect());
    let (structures, samples) = (derived.structures.clone(), derived.samples.clone());
    Derived { graph, outputs, guards, structures, samples, apart: Vec::new(), solve: None }
}

/// The new nodes of old ones.
pub struct Renamed {
    nodes: HashMap<Node, Node>,
}

impl Renamed {
    /// The new node of an old one.
    pub fn of(&self, old: Node) -> Node {
        // Operands precede their use, so their new nodes exist.
        self.nodes.get(&old).copied().unwrap_or(old)
    }

    /// The new nodes of old ones.
    pub fn all(&self, old: &[Node]) -> Vec<Node> {
        old.iter().map(|&node| self.of(node)).collect()
    }
}

/// The new node of an old one with the same operation, built by the simplifying constructors.
pub fn rebuild(graph: &mut Graph, value: &NodeKind, renamed: &Renamed) -> Node {
    match value {
        NodeKind::Number(number) => graph.number(number.clone()),
        NodeKind::Pi => graph.pi(),
        NodeKind::Input(input) => graph.input(*input),
        NodeKind::Sum(terms) => graph.sum(renamed.all(terms)),
        NodeKind::Product(factors) => graph.product(renamed.all(factors)),
        NodeKind::Power(base, exponent) => graph.power(renamed.of(*base), *exponent),
        NodeKind::Call(function, arguments) => {
            let arguments = renamed.all(arguments);
            graph.call(*function, arguments)
        }
    }
}
