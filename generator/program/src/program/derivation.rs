//! The result of a derivation: a graph, the quantities that its nodes form, and the values that must not be
//! zero.

use super::graph::{Graph, Node};
use super::inputs::Inputs;
use super::output::{Guard, Output};
use super::quantity::Structure;
use super::solve::Solve;

/// The result of deriving a mechanism.
#[derive(Clone, Debug)]
pub struct Derived {
    /// the nodes
    pub graph: Graph,
    /// what they are for
    pub outputs: Vec<Output<Node>>,
    /// what must not vanish
    pub guards: Vec<Guard<Node>>,
    /// per contact, in file order
    pub structures: Vec<Structure>,
    /// arbitrary states, at which passes weigh what rounding costs; none where it does not matter
    pub samples: Vec<Inputs>,
    /// quantities that go through the passes on their own, so that what they share with others does not
    /// shape the routines of those
    pub apart: Vec<Derived>,
    /// that the only output holds systems of equations, which are solved after the passes
    pub solve: Option<Solve>,
}
