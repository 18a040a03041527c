//! Finds equations that say nothing, such as `u1 = u1`: exact arithmetic shows that their sides are the same whatever the
//! state and the parameters are. Theory: docs/theory.md, section 16.6.

use super::exact::nodes::Nodes;
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::Node;
use crate::model::mechanism::{Equation, Mechanism};

/// An error for each equation that holds in every state.
pub fn empty_equations(m: &Mechanism) -> Vec<Diagnostic> {
    let mut nodes = Nodes::new(m);
    let equations = || m.kinematics.iter().chain(&m.constraints).chain(&m.configuration);
    let mut residual = |equation: &Equation| nodes.residual(equation);
    let residuals: Vec<Option<Vec<Node>>> = equations().map(&mut residual).collect();
    let residues = nodes.graph.residues();
    let vanishes = |node: &Node| residues[node.0 as usize].is_some_and(|value| value.is_zero());
    let empty =
        |residual: &Option<Vec<Node>>| residual.as_ref().is_some_and(|rows| rows.iter().all(vanishes));
    let told = |(equation, _): (&Equation, _)| {
        let message = "this equation says nothing: its two sides are the same in every state";
        Diagnostic::new(codes::EMPTY_EQUATION, equation.span, message)
            .help("leave it out, or correct one of its sides")
    };
    equations().zip(residuals).filter(|(_, residual)| empty(residual)).map(told).collect()
}
