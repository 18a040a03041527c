//! The passes, in one list: each keeps what every output means, the interpreter is the referee.
//!
//! A derivation is a graph until it is lowered to operations; the list says where.

mod collect;
mod factor;
mod fold;
mod fuse;
mod opened;
mod order;
mod pairs;
mod prune;
mod share;
mod sweep;
mod terms;
#[cfg(test)]
mod testing;
mod weigh;

use std::collections::HashMap;

use super::Program;
use super::graph::{Graph, Node, Value};
use super::lower::{lower, operands, reachable};
use super::operation::Stage;
use super::routine::{Derived, Guard, Output};
use crate::interpret::Inputs;

/// A pass.
#[derive(Clone, Copy)]
pub struct Pass {
    /// its name, as cost tables show it
    pub name: &'static str,
    work: Work,
}

/// What a pass works on.
#[derive(Clone, Copy)]
enum Work {
    Graph(fn(&Derived) -> Derived),
    Lower(fn(&Derived) -> Program),
    Operations(fn(&Program) -> Program),
    Weighed(fn(&Program, &[Inputs]) -> Program),
}

/// The passes in their order.
pub const PASSES: [Pass; 9] = [
    Pass { name: "prune", work: Work::Graph(prune::prune) },
    Pass { name: "fold", work: Work::Graph(fold::fold) },
    Pass { name: "collect", work: Work::Graph(collect::collect) },
    Pass { name: "factor", work: Work::Graph(factor::factor) },
    Pass { name: "share", work: Work::Graph(share::share) },
    Pass { name: "lower", work: Work::Lower(lower) },
    Pass { name: "fuse", work: Work::Operations(fuse::fuse) },
    Pass { name: "sweep", work: Work::Operations(sweep::sweep) },
    Pass { name: "order", work: Work::Weighed(order::order) },
];

/// A derivation on its way through the passes.
enum Form {
    Graph(Derived),
    Operations(Program),
}

/// Sends a derivation through the passes, and shows what it is after each as a program.
pub fn run(derived: &Derived, mut show: impl FnMut(&'static str, &dyn Fn() -> Program)) -> Program {
    let mut form = Form::Graph(derived.clone());
    for pass in PASSES {
        form = match (pass.work, form) {
            (Work::Graph(run), Form::Graph(derived)) => Form::Graph(run(&derived)),
            (Work::Lower(run), Form::Graph(derived)) => Form::Operations(run(&derived)),
            (Work::Operations(run), Form::Operations(program)) => Form::Operations(run(&program)),
            (Work::Weighed(run), Form::Operations(program)) => {
                Form::Operations(run(&program, &derived.samples))
            }
            // The list has one pass that lowers, after those on the graph: a test holds it to that.
            (_, form) => form,
        };
        show(pass.name, &|| form.program());
    }
    form.program()
}

impl Form {
    fn program(&self) -> Program {
        match self {
            Form::Graph(derived) => lower(derived),
            Form::Operations(program) => program.clone(),
        }
    }
}

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
    let (structures, samples) = (derived.structures.clone(), derived.samples.clone());
    Derived { graph, outputs, guards, structures, samples }
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
mod tests {
    use super::testing::{agree, random};
    use super::*;

    #[test]
    fn all_passes_together_keep_the_meaning() {
        for seed in 1..150 {
            let derived = random(seed);
            agree(&lower(&derived), &run(&derived, |_, _| {}), &format!("seed {seed}"));
        }
    }

    #[test]
    fn one_pass_lowers_after_those_on_the_graph_and_before_those_on_operations() {
        let order = PASSES.map(|pass| match pass.work {
            Work::Graph(_) => 0,
            Work::Lower(_) => 1,
            Work::Operations(_) | Work::Weighed(_) => 2,
        });
        assert!(order.is_sorted() && order.iter().filter(|&&kind| kind == 1).count() == 1, "{order:?}");
    }

    #[test]
    fn what_is_shown_is_what_the_next_pass_gets() {
        let (derived, mut shown) = (random(7), Vec::new());
        let last = run(&derived, |name, program| shown.push((name, program())));
        assert!(shown.iter().map(|(name, _)| *name).eq(PASSES.iter().map(|pass| pass.name)));
        assert_eq!(shown.last().map(|(_, program)| program), Some(&last));
        for pair in shown.windows(2) {
            agree(&pair[0].1, &pair[1].1, pair[1].0);
        }
    }
}
