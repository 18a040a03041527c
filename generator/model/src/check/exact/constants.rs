//! Whether something is the same in all states, by exact arithmetic.

use std::collections::HashMap;

use super::nodes::Nodes;
use crate::graph::Input;
use crate::graph::differentiate::differentiate;
use crate::model::mechanism::{Mechanism, Scalar};

/// Whether a scalar depends neither on coordinates nor on the time. False where that is not known.
pub fn never_changes(m: &Mechanism, scalar: &Scalar) -> bool {
    decide(m, scalar).unwrap_or(false)
}

fn decide(m: &Mechanism, scalar: &Scalar) -> Option<bool> {
    let mut nodes = Nodes::new(m);
    let value = nodes.scalar(scalar)?;
    let mut graph = nodes.graph;
    let one = graph.integer(1);
    let coordinates = (0..m.coordinates.len() as u32).map(Input::Coordinate);
    let slopes: Vec<_> = coordinates
        .chain([Input::Time])
        .map(|input| differentiate(&mut graph, &[value], &HashMap::from([(input, one)]))[0])
        .collect();
    let residues = graph.residues();
    let zero = |node| residues.get(node as usize).copied().flatten().map(|value| value.is_zero());
    slopes.into_iter().map(|slope| zero(slope.0)).try_fold(true, |all, zero| Some(all && zero?))
}
