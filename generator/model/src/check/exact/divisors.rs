//! Divisors that are zero whatever the state and the parameters are, such as `tan(q1)*cos(q1) - sin(q1)`: numbers
//! show them as rounding, and the derivation would divide by exactly 0.

use super::nodes::{Divisor, Nodes};
use crate::diagnostics::{Diagnostic, codes};
use crate::graph::Node;
use crate::model::mechanism::*;
use crate::span::Span;

/// The first divisor that vanishes identically.
pub fn vanishing(m: &Mechanism) -> Option<Diagnostic> {
    let mut nodes = Nodes::new(m);
    let mut found: Vec<(Node, Span)> = Vec::new();
    // what cannot be followed to its end is looked at as far as that goes
    let mut look =
        |nodes: &mut Nodes<'_>, span: Span, visit: &mut dyn FnMut(&mut Nodes<'_>) -> Option<()>| {
            let _ = visit(nodes);
            let new = std::mem::take(&mut nodes.divisors);
            found.extend(new.into_iter().map(|Divisor { node, span: own }| (node, own.unwrap_or(span))));
        };
    for definition in &m.definitions {
        look(&mut nodes, definition.span, &mut |nodes| match &definition.value {
            DefinitionValue::Scalar(value) => nodes.scalar(value).map(drop),
            DefinitionValue::Vector(value) => nodes.vector(value).map(drop),
        });
    }
    for point in &m.points {
        look(&mut nodes, point.span, &mut |nodes| match &point.place {
            Place::Offset { by, .. } | Place::Material { by, .. } => nodes.vector(by).map(drop),
            Place::Origin | Place::Velocity(_) => None,
        });
        look(&mut nodes, point.motion_span, &mut |nodes| nodes.vector(point.velocity.as_ref()?).map(drop));
    }
    for load in &m.loads {
        look(&mut nodes, load.span, &mut |nodes| of_load(nodes, &load.kind));
    }
    for contact in &m.contacts {
        look(&mut nodes, contact.normal_span, &mut |nodes| nodes.vector(&contact.normal).map(drop));
        for length in contact.gap.iter().chain(&contact.validity).chain(&contact.clearance) {
            look(&mut nodes, contact.gap_span, &mut |nodes| nodes.scalar(length).map(drop));
        }
    }
    for equation in m.kinematics.iter().chain(&m.constraints).chain(&m.configuration) {
        look(&mut nodes, equation.span, &mut |nodes| nodes.residual(equation).map(drop));
    }
    let residues = nodes.graph.residues();
    let zero = |node: &Node| residues[node.0 as usize].is_some_and(|value| value.is_zero());
    let (_, span) = found.into_iter().find(|(node, _)| zero(node))?;
    let message = "this divides by what is zero whatever the state and the parameters are";
    let help = "simplify the divisor by hand: its terms cancel; tan has no value at a right angle";
    Some(Diagnostic::new(codes::ZERO_DIVISOR, span, message).help(help))
}

fn of_load(nodes: &mut Nodes<'_>, load: &LoadKind) -> Option<()> {
    let (vector, scalars) = match load {
        LoadKind::Gravity(vector)
        | LoadKind::Force { force: vector, .. }
        | LoadKind::Torque { torque: vector, .. } => (Some(vector), vec![]),
        LoadKind::Spring { stiffness, length, damping, .. } => (None, vec![stiffness, length, damping]),
        LoadKind::Torsion { axis, angle, rest, stiffness, damping, .. } => {
            (Some(axis), vec![angle, rest, stiffness, damping])
        }
    };
    for scalar in scalars {
        nodes.scalar(scalar)?;
    }
    nodes.vector(vector?).map(drop)
}
