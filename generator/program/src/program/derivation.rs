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
    /// quantities and their nodes
    pub outputs: Vec<Output<Node>>,
    /// nodes that must not vanish
    pub guards: Vec<Guard<Node>>,
    /// structure of the reduced matrix per contact, in file order
    pub structures: Vec<Structure>,
    /// random states at which passes estimate rounding errors; empty if rounding errors do not matter
    pub samples: Vec<Inputs>,
    /// quantities that pass through the passes separately, so that sharing values with other quantities does
    /// not change the routines of those
    pub apart: Vec<Derived>,
    /// the systems of equations that the only output holds, if any; they are solved after the passes
    pub solve: Option<Solve>,
}
