//! Forms Jacobians of nodes in the same graph, by eliminating one intermediate node after the other.
//!
//! The derivatives of nodes with respect to their operands are the edges of a graph from the directions to
//! the results. Eliminating a node joins every edge into it with every edge out of it; the edges that remain
//! at the end are the Jacobian. Every order of elimination gives the same numbers. Operands first is forward
//! differentiation, results first is backward differentiation. A mixed order can be cheaper than both: it
//! adds up the forces of a whole branch before it multiplies them with the derivatives of the velocities on
//! which they depend.

use std::collections::{BTreeMap, BTreeSet};

use super::differentiate::slope_by;
use super::graph::{Graph, Input, Node, NodeKind};
use super::operation::Stage;
use hodograph_model::number::Number;

/// The derivatives of inputs along a direction; inputs that are not listed are constant.
pub type Direction = Vec<(Input, Node)>;

/// The order in which nodes are eliminated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// operands before the nodes that use them: forward differentiation
    OperandsFirst,
    /// results first: backward differentiation
    ResultsFirst,
    /// next the node with the smallest product of the numbers of edges into it and out of it
    FewestEdges,
}

/// All orders.
pub const ORDERS: [Order; 3] = [Order::OperandsFirst, Order::ResultsFirst, Order::FewestEdges];

/// Derivatives of some nodes.
#[derive(Clone, Debug)]
pub struct Jacobian {
    /// by node, then by direction
    pub rows: Vec<Vec<Node>>,
    /// number of operations that the elimination takes
    pub work: usize,
}

/// The derivatives of `nodes` along `directions`.
pub fn jacobian(graph: &mut Graph, nodes: &[Node], directions: &[Direction], order: Order) -> Jacobian {
    let mut edges = Edges::new(graph, nodes, directions);
    let work = edges.eliminate(graph, order);
    let zero = graph.integer(0);
    let entry = |row: usize, column| edges.into[edges.results + row].get(&column).copied().unwrap_or(zero);
    let rows = (0..nodes.len()).map(|row| (0..directions.len()).map(|column| entry(row, column)).collect());
    Jacobian { rows: rows.collect(), work }
}

/// The edges between vertices: directions, then nodes in their order, then results.
struct Edges {
    /// per vertex, its derivatives with respect to earlier vertices
    into: Vec<BTreeMap<usize, Node>>,
    /// per vertex, the vertices that have a derivative with respect to it
    out: Vec<BTreeSet<usize>>,
    /// the first vertex that is a node
    nodes: usize,
    /// the first vertex that is a result
    results: usize,
}

impl Edges {
    fn new(graph: &mut Graph, nodes: &[Node], directions: &[Direction]) -> Self {
        let mut by_input: BTreeMap<Input, Vec<(usize, Node)>> = BTreeMap::new();
        for (number, direction) in directions.iter().enumerate() {
            for &(input, rate) in direction {
                by_input.entry(input).or_default().push((number, rate));
            }
        }
        let reachable = graph.reachable(nodes.iter().copied());
        let mut vertices: BTreeMap<Node, usize> = BTreeMap::new();
        let mut into: Vec<BTreeMap<usize, Node>> = vec![BTreeMap::new(); directions.len()];
        for index in (0..reachable.len()).filter(|&index| reachable[index]) {
            let node = Node(index as u32);
            let kind = graph.kind(node).clone();
            let mut slopes: Vec<(usize, Node)> = match &kind {
                NodeKind::Input(input) => by_input.get(input).cloned().unwrap_or_default(),
                _ => Vec::new(),
            };
            for (at, operand) in kind.operands().iter().enumerate() {
                if let Some(&from) = vertices.get(operand) {
                    slopes.push((from, slope_by(graph, node, at)));
                }
            }
            let mut edges = BTreeMap::new();
            slopes.into_iter().for_each(|(from, slope)| add(graph, &mut edges, from, slope));
            if !edges.is_empty() {
                vertices.insert(node, into.len());
                into.push(edges);
            }
        }
        let results = into.len();
        let one = graph.integer(1);
        into.extend(
            nodes.iter().map(|node| vertices.get(node).map(|&vertex| (vertex, one)).into_iter().collect()),
        );
        let mut out = vec![BTreeSet::new(); into.len()];
        for (to, edges) in into.iter().enumerate() {
            for &from in edges.keys() {
                out[from].insert(to);
            }
        }
        Edges { into, out, nodes: directions.len(), results }
    }

    /// Sorting key: the vertex with the least is eliminated next.
    fn rank(&self, vertex: usize, order: Order) -> (usize, usize) {
        match order {
            Order::OperandsFirst => (0, vertex),
            Order::ResultsFirst => (0, usize::MAX - vertex),
            Order::FewestEdges => (self.into[vertex].len() * self.out[vertex].len(), vertex),
        }
    }

    /// Eliminates all nodes and returns the number of operations that this takes.
    fn eliminate(&mut self, graph: &mut Graph, order: Order) -> usize {
        let mut stages = Stages::default();
        let mut work = 0;
        let mut ranks: Vec<(usize, usize)> =
            (0..self.results).map(|vertex| self.rank(vertex, order)).collect();
        let mut queue: BTreeSet<((usize, usize), usize)> =
            (self.nodes..self.results).map(|vertex| (ranks[vertex], vertex)).collect();
        while let Some((_, vertex)) = queue.pop_first() {
            let before = std::mem::take(&mut self.into[vertex]);
            let after = std::mem::take(&mut self.out[vertex]);
            for from in before.keys() {
                self.out[*from].remove(&vertex);
            }
            for &to in &after {
                let Some(last) = self.into[to].remove(&vertex) else { continue };
                for (&from, &first) in &before {
                    work += stages.work(graph, first, last, self.into[to].contains_key(&from));
                    let product = graph.product([first, last]);
                    add(graph, &mut self.into[to], from, product);
                    if self.into[to].contains_key(&from) {
                        self.out[from].insert(to);
                    } else {
                        self.out[from].remove(&to);
                    }
                }
            }
            for &near in before.keys().chain(&after) {
                if (self.nodes..self.results).contains(&near) && queue.remove(&(ranks[near], near)) {
                    ranks[near] = self.rank(near, order);
                    queue.insert((ranks[near], near));
                }
            }
        }
        work
    }
}

/// Adds a derivative to an edge; an edge whose derivative is 0 is removed.
fn add(graph: &mut Graph, edges: &mut BTreeMap<usize, Node>, from: usize, slope: Node) {
    let sum = match edges.get(&from) {
        Some(&there) => graph.sum([there, slope]),
        None => slope,
    };
    if graph.is_zero(sum) {
        edges.remove(&from);
    } else {
        edges.insert(from, sum);
    }
}

/// The stages of the nodes of a growing graph.
#[derive(Default)]
struct Stages(Vec<Stage>);

impl Stages {
    fn is_early(&mut self, graph: &Graph, node: Node) -> bool {
        for kind in &graph.kinds()[self.0.len()..] {
            let operands = || kind.operands().iter().map(|operand| self.0[operand.0 as usize]);
            let stage = match kind {
                NodeKind::Input(input) => Stage::of_input(*input),
                _ => operands().max().unwrap_or(Stage::Constant),
            };
            self.0.push(stage);
        }
        self.0[node.0 as usize] <= Stage::Parameter
    }

    /// Number of operations per evaluation of a product that is added to an edge; a fused multiply-add counts
    /// once.
    fn work(&mut self, graph: &Graph, first: Node, last: Node, there: bool) -> usize {
        if self.is_early(graph, first) && self.is_early(graph, last) {
            return 0;
        }
        usize::from(there || !(is_unit(graph, first) || is_unit(graph, last)))
    }
}

/// Whether a node is 1 or -1.
fn is_unit(graph: &Graph, node: Node) -> bool {
    graph.as_number(node).is_some_and(|number| number.is_one() || Number(-number.0.clone()).is_one())
}

#[cfg(test)]
mod tests {
    use super::super::differentiate::differentiate;
    use super::super::passes::testing::{agree, random};
    use super::super::{Derived, Output, Program, Quantity};
    use super::*;

    /// Derivatives of a random derivation along every coordinate and speed, and a mixed direction.
    fn derivatives(seed: u64, order: Option<Order>) -> Derived {
        let mut derived = random(seed);
        let nodes = derived.outputs[0].values.clone();
        let graph = &mut derived.graph;
        let (one, two) = (graph.integer(1), graph.integer(2));
        let sine = graph.input(Input::Speed(1));
        let inputs = (0..3).flat_map(|index| [Input::Coordinate(index), Input::Speed(index)]);
        let mut directions: Vec<Direction> = inputs.map(|input| vec![(input, one)]).collect();
        directions.push(vec![(Input::Coordinate(0), two), (Input::Coordinate(2), sine)]);
        let values: Vec<Node> = match order {
            Some(order) => jacobian(graph, &nodes, &directions, order).rows.concat(),
            None => {
                let columns: Vec<Vec<Node>> = directions
                    .iter()
                    .map(|direction| differentiate(graph, &nodes, &direction.iter().copied().collect()))
                    .collect();
                (0..nodes.len()).flat_map(|row| columns.iter().map(move |column| column[row])).collect()
            }
        };
        derived.outputs = vec![Output { quantity: Quantity::Forcing, rows: nodes.len(), columns: 7, values }];
        derived
    }

    #[test]
    fn every_order_gives_the_directional_derivatives() {
        for seed in 1..25 {
            let expected = Program::new(&derivatives(seed, None));
            for order in ORDERS {
                let found = Program::new(&derivatives(seed, Some(order)));
                agree(&expected, &found, &format!("seed {seed}, {order:?}"));
            }
        }
    }

    #[test]
    fn derivatives_along_unrelated_directions_are_0_and_take_no_work() {
        let mut graph = Graph::new();
        let [x, y, z] = [0, 1, 2].map(|index| graph.input(Input::Coordinate(index)));
        let product = graph.product([x, y]);
        let one = graph.integer(1);
        let directions: Vec<Direction> = (0..3).map(|index| vec![(Input::Coordinate(index), one)]).collect();
        let found = jacobian(&mut graph, &[product, z], &directions, Order::FewestEdges);
        let zero = graph.integer(0);
        assert_eq!((found.rows, found.work), (vec![vec![y, x, zero], vec![zero, zero, one]], 0));
    }

    /// Many inputs combine to one number, on which many results depend: eliminating that number last is
    /// cheapest.
    #[test]
    fn a_mixed_order_takes_less_work_than_forward_and_backward() {
        let mut graph = Graph::new();
        let speeds: Vec<Node> = (0..6).map(|index| graph.input(Input::Speed(index))).collect();
        let factors: Vec<Node> = (0..12).map(|index| graph.input(Input::Coordinate(index))).collect();
        let mut work = |ends: bool| {
            let graph = &mut graph;
            let terms: Vec<Node> =
                speeds.iter().zip(&factors).map(|(&speed, &factor)| graph.product([speed, factor])).collect();
            let sum = graph.sum(terms);
            let mut waist = sum;
            for &factor in &factors[6..] {
                waist = graph.call(hodograph_model::arithmetic::Function::Sin, vec![waist]);
                waist = graph.product([waist, factor]);
            }
            let results: Vec<Node> =
                factors[..6].iter().map(|&factor| graph.product([waist, factor])).collect();
            let one = graph.integer(1);
            let directions: Vec<Direction> = (0..6).map(|index| vec![(Input::Speed(index), one)]).collect();
            let orders: &[Order] = if ends { &ORDERS[..2] } else { &ORDERS[2..] };
            orders.iter().map(|&order| jacobian(graph, &results, &directions, order).work).min()
        };
        assert!(work(false) < work(true), "{:?} {:?}", work(false), work(true));
    }
}
