//! Shares parts of sums and products. For example, x y z and x y w become (x y) z and (x y) w; a + b - c and
//! c - a - b become the same sum and its negative.
//!
//! The factors or terms known at construction count as a single one, since they become one hoisted value.

use std::collections::BTreeMap;

use super::frequent_pairs::{Item, Pair, extract};
use super::rewrite::{Renamed, Survey, rebuild, rewrite};
use super::terms::factors;
use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use crate::program::operation::Stage;
use hodograph_model::number::Number;

/// Computes common parts of sums and products once.
pub fn share(derived: &Derived) -> Derived {
    let derived = separate_signs(derived);
    let survey = Survey::new(&derived);
    let mut parts = Parts::new(derived.graph.kinds().len());
    let products = parts.lists(&derived.graph, &survey, Kind::Product);
    let sums = parts.lists(&derived.graph, &survey, Kind::Sum);
    rewrite(&derived, &survey, |graph, old, renamed| {
        if let Some(items) = products.get(&old) {
            let nodes: Vec<Node> = items.iter().map(|item| parts.build(graph, renamed, item.id)).collect();
            join(graph, Kind::Product, nodes)
        } else if let Some(items) = sums.get(&old) {
            let nodes = items.iter().map(|item| {
                let node = parts.build(graph, renamed, item.id);
                if item.negative { negative(graph, node) } else { node }
            });
            let nodes = nodes.collect();
            join(graph, Kind::Sum, nodes)
        } else {
            match derived.graph.kind(old) {
                NodeKind::Product(factors) if is_sign(&derived.graph, factors) => {
                    negative(graph, renamed.of(factors[1]))
                }
                value => rebuild(graph, value, renamed),
            }
        }
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Sum,
    Product,
}

/// Rewrites products with a negative number as -1 times a positive product, so that both signs share the
/// positive product.
fn separate_signs(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    rewrite(derived, &survey, |graph, old, renamed| {
        let node = rebuild(graph, derived.graph.kind(old), renamed);
        let NodeKind::Product(factors) = graph.kind(node).clone() else { return node };
        match graph.as_number(factors[0]).cloned() {
            Some(number) if number.is_negative() => {
                let magnitude = graph.number(Number(-number.0));
                let positive = graph.product(std::iter::once(magnitude).chain(factors[1..].iter().copied()));
                negative(graph, positive)
            }
            _ => node,
        }
    })
}

fn is_sign(graph: &Graph, factors: &[Node]) -> bool {
    factors.len() == 2 && graph.as_number(factors[0]).is_some_and(|number| Number(-number.0.clone()).is_one())
}

fn negative(graph: &mut Graph, node: Node) -> Node {
    if graph.as_number(node).is_some() {
        return graph.neg(node);
    }
    let minus = graph.integer(-1);
    graph.intern(NodeKind::Product(vec![minus, node]))
}

fn join(graph: &mut Graph, kind: Kind, mut nodes: Vec<Node>) -> Node {
    if let [only] = nodes[..] {
        return only;
    }
    nodes.sort_unstable();
    graph.intern(if kind == Kind::Sum { NodeKind::Sum(nodes) } else { NodeKind::Product(nodes) })
}

/// New items that are not nodes of the old graph, and the new nodes of those that are built.
struct Parts {
    first: u32,
    parts: Vec<Part>,
    known: BTreeMap<Early, u32>,
    built: BTreeMap<u32, Node>,
}

/// Factors or terms known at construction, as one item: whether it is a product, a number, and old nodes.
type Early = (bool, Number, Vec<Node>);

enum Part {
    Early(Kind, Number, Vec<Node>),
    Pair(Kind, Pair),
}

impl Parts {
    fn new(nodes: usize) -> Self {
        Parts { first: nodes as u32, parts: Vec::new(), known: BTreeMap::new(), built: BTreeMap::new() }
    }

    fn add(&mut self, part: Part) -> u32 {
        self.parts.push(part);
        self.first + self.parts.len() as u32 - 1
    }

    fn early(&mut self, kind: Kind, number: Number, nodes: Vec<Node>) -> u32 {
        if number.is_one() && kind == Kind::Product && nodes.len() == 1 {
            return nodes[0].0;
        }
        let key = (kind == Kind::Sum, number.clone(), nodes.clone());
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        let id = self.add(Part::Early(kind, number, nodes));
        self.known.insert(key, id);
        id
    }

    /// The items of every sum or product that is computed at run time, with shared pairs extracted.
    fn lists(&mut self, graph: &Graph, survey: &Survey, kind: Kind) -> BTreeMap<Node, Vec<Item>> {
        let mut nodes = Vec::new();
        let mut lists = Vec::new();
        for (index, value) in graph.kinds().iter().enumerate() {
            let node = Node(index as u32);
            if !survey.reachable[index] || survey.stage(node) <= Stage::Parameter {
                continue;
            }
            let list = match (kind, value) {
                (Kind::Product, NodeKind::Product(factors)) if !is_sign(graph, factors) => {
                    self.factors(graph, survey, node)
                }
                (Kind::Sum, NodeKind::Sum(terms)) => self.terms(graph, survey, terms),
                _ => continue,
            };
            nodes.push(node);
            lists.push(list);
        }
        extract(&mut lists, |pair| self.add(Part::Pair(kind, pair)));
        nodes.into_iter().zip(lists).collect()
    }

    fn factors(&mut self, graph: &Graph, survey: &Survey, node: Node) -> Vec<Item> {
        let (number, all) = factors(graph, node);
        let (early, late): (Vec<Node>, Vec<Node>) =
            all.into_iter().partition(|&factor| survey.stage(factor) <= Stage::Parameter);
        let mut items: Vec<Item> = late.iter().map(|node| Item { id: node.0, negative: false }).collect();
        if !number.is_one() || !early.is_empty() {
            let id = self.early(Kind::Product, number, early);
            items.push(Item { id, negative: false });
        }
        items
    }

    fn terms(&mut self, graph: &Graph, survey: &Survey, terms: &[Node]) -> Vec<Item> {
        let (early, late): (Vec<Node>, Vec<Node>) =
            terms.iter().partition(|&&term| survey.stage(term) <= Stage::Parameter);
        let mut items: Vec<Item> = late
            .iter()
            .map(|&term| match graph.kind(term) {
                NodeKind::Product(factors) if is_sign(graph, factors) => {
                    Item { id: factors[1].0, negative: true }
                }
                _ => Item { id: term.0, negative: false },
            })
            .collect();
        if !early.is_empty() {
            let id = self.early(Kind::Sum, Number::integer(1), early);
            items.push(Item { id, negative: false });
        }
        items
    }

    /// The new node of an item. Its parts are old nodes that have been renamed already, since they precede
    /// every node that uses them.
    fn build(&mut self, graph: &mut Graph, renamed: &Renamed, id: u32) -> Node {
        let Some(part) = id.checked_sub(self.first).and_then(|index| self.parts.get(index as usize)) else {
            return renamed.of(Node(id));
        };
        if let Some(&built) = self.built.get(&id) {
            return built;
        }
        let node = match *part {
            Part::Early(Kind::Sum, _, ref nodes) => graph.sum(renamed.all(nodes)),
            Part::Early(Kind::Product, ref number, ref nodes) => {
                let number = graph.number(number.clone());
                graph.product(std::iter::once(number).chain(renamed.all(nodes)))
            }
            Part::Pair(kind, pair) => {
                let first = self.build(graph, renamed, pair.first);
                let second = self.build(graph, renamed, pair.second);
                let second = if pair.opposite { negative(graph, second) } else { second };
                if kind == Kind::Product && first == second {
                    graph.intern(NodeKind::Power(first, 2))
                } else {
                    join(graph, kind, vec![first, second])
                }
            }
        };
        self.built.insert(id, node);
        node
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{keeps_the_meaning, late, parameters, small, speeds};
    use super::*;

    #[test]
    fn a_part_of_two_products_is_computed_once_whatever_the_signs() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let minus = g.integer(-1);
            vec![g.product([a, b, c]), g.product([minus, a, b, d])]
        });
        assert_eq!(late(&share(&derived)), ["Mul", "Mul", "Mul", "Neg"], "a b, (a b) c, -(a b) d");
    }

    #[test]
    fn a_sum_and_its_negative_share_a_value() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let minus = g.neg(c);
            let (first, opposite) = (g.sum([a, b, minus]), g.sub(c, b));
            let opposite = g.sub(opposite, a);
            vec![first, g.product([opposite, d])]
        });
        let before = late(&derived).len();
        let shared = late(&share(&derived));
        assert_eq!(shared, ["Sub", "Add", "Mul", "Neg"], "x = a + (b - c), -(x d)");
        assert_eq!(before, 5);
    }

    #[test]
    fn factors_known_at_construction_count_as_one() {
        let derived = small(|g| {
            let ([a, b, ..], [m, l, _]) = (speeds(g), parameters(g));
            vec![g.product([m, l, a]), g.product([m, l, b])]
        });
        assert_eq!(late(&share(&derived)), ["Mul", "Mul"], "(m l) a, (m l) b");
    }

    #[test]
    fn parts_that_occur_once_keep_their_operations() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            vec![g.product([a, b]), g.sum([c, d])]
        });
        assert_eq!(late(&share(&derived)), ["Mul", "Add"]);
        keeps_the_meaning(share);
    }
}
