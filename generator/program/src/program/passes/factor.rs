//! Takes common factors out of sums: a b + a c -> a (b + c), if the products are used in this sum only.
//!
//! Factors known at construction (parameters and numbers) count as one coefficient, since their product is
//! computed once. So m1 l c + m2 l c becomes (m1 l + m2 l) c, whose bracket costs nothing at run time.

use std::collections::BTreeMap;

use super::rewrite::{Survey, rebuild, rewrite, stage};
use super::terms::factors;
use crate::program::derivation::Derived;
use crate::program::graph::{Graph, Node, NodeKind};
use crate::program::operation::Stage;
use hodograph_model::number::Number;

/// Takes out common factors.
pub fn factor(derived: &Derived) -> Derived {
    let survey = Survey::new(derived);
    let mut stages = Stages::default();
    rewrite(derived, &survey, |graph, old, renamed| match derived.graph.kind(old) {
        NodeKind::Sum(terms) if survey.stage(old) > Stage::Parameter => {
            let (owned, others): (Vec<Node>, Vec<Node>) =
                terms.iter().partition(|&&term| survey.is_used_once(term));
            let owned =
                owned.into_iter().map(|term| Term::new(graph, &mut stages, renamed.of(term))).collect();
            let others: Vec<Node> = renamed.all(&others);
            sum(graph, &mut stages, owned, others)
        }
        value => rebuild(graph, value, renamed),
    })
}

/// The stages of the nodes of a growing graph.
#[derive(Default)]
struct Stages(Vec<Stage>);

impl Stages {
    fn of(&mut self, graph: &Graph, node: Node) -> Stage {
        for value in &graph.kinds()[self.0.len()..] {
            let stage = stage(value, |node| self.0[node.0 as usize]);
            self.0.push(stage);
        }
        self.0[node.0 as usize]
    }
}

/// A term: number, factors known at construction, other factors.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Term {
    number: Number,
    early: Vec<Node>,
    late: Vec<Node>,
}

/// A factor that can be taken out.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Factor {
    /// a single factor that is not known at construction
    Late(Node),
    /// the whole coefficient: magnitude of the number, and factors known at construction
    Coefficient(Number, Vec<Node>),
}

impl Term {
    fn new(graph: &Graph, stages: &mut Stages, node: Node) -> Self {
        let (number, all) = factors(graph, node);
        let (early, late) = all.into_iter().partition(|&factor| stages.of(graph, factor) <= Stage::Parameter);
        Term { number, early, late }
    }

    fn magnitude(&self) -> Number {
        if self.number.is_negative() { Number(-self.number.0.clone()) } else { self.number.clone() }
    }

    fn has(&self, factor: &Factor) -> bool {
        match factor {
            Factor::Late(node) => self.late.contains(node),
            Factor::Coefficient(number, early) => self.magnitude() == *number && self.early == *early,
        }
    }

    /// Removes a factor that the term has.
    fn remove(&mut self, factor: &Factor) {
        match factor {
            Factor::Late(node) => {
                if let Some(at) = self.late.iter().position(|factor| factor == node) {
                    self.late.remove(at);
                }
            }
            Factor::Coefficient(number, _) => {
                self.number = Number(&self.number.0 / &number.0);
                self.early.clear();
            }
        }
    }

    /// The factors that a term may have in common with others.
    fn candidates(&self) -> Vec<Factor> {
        let mut candidates: Vec<Factor> = self.late.iter().map(|&node| Factor::Late(node)).collect();
        candidates.dedup();
        let magnitude = self.magnitude();
        let trivial = self.early.is_empty() && magnitude.is_one();
        if !trivial && !self.late.is_empty() {
            candidates.push(Factor::Coefficient(magnitude, self.early.clone()));
        }
        candidates
    }

    fn node(&self, graph: &mut Graph) -> Node {
        let number = graph.number(self.number.clone());
        let all: Vec<Node> = std::iter::once(number)
            .chain(self.early.iter().copied())
            .chain(self.late.iter().copied())
            .collect();
        product(graph, &all)
    }
}

/// The product of nodes, with equal factors as powers.
fn product(graph: &mut Graph, all: &[Node]) -> Node {
    let mut counts: BTreeMap<Node, i32> = BTreeMap::new();
    for &factor in all {
        *counts.entry(factor).or_default() += 1;
    }
    let powers: Vec<Node> = counts
        .into_iter()
        .map(
            |(factor, count)| {
                if graph.as_number(factor).is_some() { factor } else { graph.power(factor, count) }
            },
        )
        .collect();
    graph.product(powers)
}

/// The sum of terms, of which `owned` are used in this sum only.
fn sum(graph: &mut Graph, stages: &mut Stages, mut owned: Vec<Term>, mut others: Vec<Node>) -> Node {
    while let Some(best) = best(&owned) {
        let (mut group, rest): (Vec<Term>, Vec<Term>) = owned.into_iter().partition(|term| term.has(&best));
        owned = rest;
        // Other factors that all of these terms have come out, too.
        let mut common = vec![best];
        group.iter_mut().for_each(|term| term.remove(&common[0]));
        while let Some(factor) =
            group[0].candidates().into_iter().find(|factor| group.iter().all(|term| term.has(factor)))
        {
            group.iter_mut().for_each(|term| term.remove(&factor));
            common.push(factor);
        }
        let inner = sum(graph, stages, group, Vec::new());
        let mut taken = vec![inner];
        for factor in common {
            match factor {
                Factor::Late(node) => taken.push(node),
                Factor::Coefficient(number, early) => {
                    taken.push(graph.number(number));
                    taken.extend(early);
                }
            }
        }
        let node = product(graph, &taken);
        match graph.kind(node) {
            NodeKind::Sum(_) => others.push(node),
            _ => owned.push(Term::new(graph, stages, node)),
        }
    }
    others.extend(owned.iter().map(|term| term.node(graph)).collect::<Vec<_>>());
    graph.sum(others)
}

/// The factor that saves most operations, the first of equals; `None` if none saves any.
fn best(terms: &[Term]) -> Option<Factor> {
    let mut counts: BTreeMap<Factor, usize> = BTreeMap::new();
    for term in terms {
        for factor in term.candidates() {
            *counts.entry(factor).or_default() += 1;
        }
    }
    let gain = |factor: &Factor, count: usize| {
        // If only coefficients remain, their sum is computed at construction.
        let group = || terms.iter().filter(|term| term.has(factor));
        let early = matches!(factor, Factor::Late(_)) && group().all(|term| term.late.len() == 1);
        if early { 3 * (count - 1) } else { count - 1 }
    };
    let mut best: Option<(usize, Factor)> = None;
    for (factor, count) in counts.into_iter().filter(|(_, count)| *count > 1) {
        let gain = gain(&factor, count);
        if best.as_ref().is_none_or(|(most, _)| gain > *most) {
            best = Some((gain, factor));
        }
    }
    best.map(|(_, factor)| factor)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{keeps_the_meaning, late, parameters, small, speeds};
    use super::*;

    #[test]
    fn a_common_factor_is_taken_out() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let products = [g.product([a, b]), g.product([a, c]), g.product([a, d])];
            vec![g.sum(products)]
        });
        assert_eq!(late(&factor(&derived)), ["Add", "Add", "Mul"], "a (b + c + d)");
    }

    #[test]
    fn parameters_gather_in_one_coefficient() {
        let derived = small(|g| {
            let ([a, b, ..], [m1, m2, l]) = (speeds(g), parameters(g));
            let products = [g.product([m1, l, a, b]), g.product([m2, l, a, b])];
            vec![g.sum(products)]
        });
        assert_eq!(late(&factor(&derived)), ["Mul", "Mul"], "(m1 l + m2 l) a b");
    }

    #[test]
    fn a_product_that_others_use_is_left_whole() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let (ab, ac, ad) = (g.product([a, b]), g.product([a, c]), g.product([a, d]));
            vec![g.sum([ab, ac, ad]), ab, ac, ad]
        });
        assert_eq!(late(&factor(&derived)), late(&derived));
    }

    #[test]
    fn sums_known_at_construction_stay() {
        let derived = small(|g| {
            let [m1, m2, l] = parameters(g);
            let products = [g.product([m1, l]), g.product([m2, l])];
            vec![g.sum(products)]
        });
        let sum = |derived: &Derived| derived.graph.kind(derived.outputs[0].values[0]).clone();
        assert!(
            matches!((sum(&derived), sum(&factor(&derived))), (NodeKind::Sum(a), NodeKind::Sum(b)) if a.len() == b.len())
        );
    }

    #[test]
    fn squares_and_cubes_are_factors_too() {
        let derived = small(|g| {
            let [a, b, ..] = speeds(g);
            let square = g.power(a, 2);
            let product = g.product([a, b]);
            vec![g.sum([square, product])]
        });
        assert_eq!(late(&factor(&derived)), ["Add", "Mul"], "a (a + b)");
        keeps_the_meaning(factor);
    }
}
