//! The nodes of a graph modulo a prime.

use super::functions::{Parts, Values, call, unknown};
use super::residue::Residue;
use super::{Evaluate, Residues};
use crate::graph::{Graph, Input, Node, NodeKind};
use crate::number::Number;

impl Input {
    /// What stands for it at a place.
    pub fn residue<const P: u64>(self, place: u64) -> Residue<P> {
        let (kind, index) = match self {
            Input::Time => (0, 0),
            Input::Parameter(index) => (1, index),
            Input::Coordinate(index) => (2, index),
            Input::Speed(index) => (3, index),
            Input::Input(index) => (4, index),
            Input::Acceleration(index) => (5, index),
            Input::Tangent(index) => (6, index),
        };
        Residue::arbitrary(&[place, kind, u64::from(index)])
    }
}

impl Graph {
    /// What every node is at arbitrary inputs.
    pub fn residues(&self) -> Vec<Option<Residues>> {
        self.at_both()
    }
}

impl Evaluate for Graph {
    fn at<const P: u64>(&self, place: u64) -> Vec<Option<Residue<P>>> {
        let mut nodes = Nodes { graph: self, residues: Vec::with_capacity(self.kinds().len()) };
        for kind in self.kinds() {
            let residue = nodes.of(kind, place);
            nodes.residues.push(residue);
        }
        nodes.residues
    }
}

/// The first nodes of a graph.
struct Nodes<'a, const P: u64> {
    graph: &'a Graph,
    residues: Vec<Option<Residue<P>>>,
}

impl<const P: u64> Nodes<'_, P> {
    fn of(&self, kind: &NodeKind, place: u64) -> Option<Residue<P>> {
        let at = |node: &Node| self.residues[node.0 as usize];
        match kind {
            NodeKind::Number(number) => Residue::rational(number),
            NodeKind::Pi => Some(Residue::arbitrary(&[place, 3 << 32])),
            NodeKind::Input(input) => Some(input.residue(place)),
            NodeKind::Sum(terms) => terms.iter().try_fold(Residue::ZERO, |sum, term| Some(sum + at(term)?)),
            NodeKind::Product(factors) => {
                factors.iter().try_fold(Residue::ONE, |product, factor| Some(product * at(factor)?))
            }
            NodeKind::Power(base, exponent) => {
                let base = at(base)?;
                let base = if *exponent < 0 { base.reciprocal()? } else { base };
                Some(base.power(i128::from(exponent.unsigned_abs())))
            }
            NodeKind::Call(function, arguments) => match arguments[..] {
                [argument] => call(self, *function, argument.0 as usize, place),
                _ => {
                    let arguments: Option<Vec<Residue<P>>> = arguments.iter().map(at).collect();
                    Some(unknown(*function, &arguments?, place))
                }
            },
        }
    }
}

impl<const P: u64> Values<P> for Nodes<'_, P> {
    fn residue(&self, value: usize) -> Option<Residue<P>> {
        self.residues[value]
    }

    fn parts(&self, value: usize) -> Option<Parts<P>> {
        let number = |node: &Node| match self.graph.kind(*node) {
            NodeKind::Number(number) => Some(number.clone()),
            _ => None,
        };
        Some(match &self.graph.kinds()[value] {
            NodeKind::Number(number) => Parts::Multiple(number.clone(), Residue::ONE),
            NodeKind::Sum(terms) => {
                Parts::Sum(terms.iter().map(|term| (Number::integer(1), term.0 as usize)).collect())
            }
            NodeKind::Product(factors) => match (number(&factors[0]), &factors[1..]) {
                (Some(number), [factor]) => Parts::Sum(vec![(number, factor.0 as usize)]),
                (Some(number), _) => {
                    let rest = self.residues[value]? * Residue::rational(&number)?.reciprocal()?;
                    Parts::Multiple(number, rest)
                }
                _ => Parts::Multiple(Number::integer(1), self.residues[value]?),
            },
            _ => Parts::Multiple(Number::integer(1), self.residues[value]?),
        })
    }
}
