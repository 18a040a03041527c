//! Finds periodic motions: states to which a motion returns, with their multipliers.
//!
//! Theory: docs/theory.md, section 20.

use std::collections::BTreeSet;

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::{DMatrix, DVector};

use crate::By;
use crate::periodic::{Orbit, OrbitError, Periodic, Return};
use crate::shooting::{Nodes, Returned, Task};

/// Largest numbers of Newton steps, and of halvings of one.
const STEPS: usize = 30;
const HALVINGS: usize = 12;
/// A motion is periodic if it returns to its state up to this relative difference, and Newton's method does
/// not decrease it any more.
const TOLERANCE: f64 = 1e-9;
/// Singular values below this part of the greatest count as zero.
const SINGULAR: f64 = 1e-12;

/// Finds the periodic motion next to a start state by Newton's method with derivatives of the motion in each segment, and
/// differentiates it with respect to `by` (parameters, mu, e).
///
/// # Errors
///
/// [`OrbitError`]
pub fn find_orbit(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
    periodic: &Periodic,
    by: &[By],
) -> Result<Orbit, OrbitError> {
    let Found { states, returned, nodes } = seek(mechanism, start, options, periodic, by)?;
    Ok(returned.orbit(&states, &nodes))
}

/// A periodic motion in segments.
pub(crate) struct Found {
    /// the states at all nodes
    pub states: Vec<f64>,
    pub returned: Returned,
    pub nodes: Nodes,
}

/// Finds the periodic motion of [`find_orbit`].
pub(crate) fn seek(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
    periodic: &Periodic,
    by: &[By],
) -> Result<Found, OrbitError> {
    check(mechanism, start, periodic)?;
    let mut states: Vec<f64> = start.coordinates.iter().chain(start.speeds).copied().collect();
    let mut nodes = Nodes::whole(mechanism, start);
    let task = Task { mechanism, start, options, periodic, by, nodes: &nodes };
    task.close(&mut states)?;
    if periodic.segments > 1 {
        (nodes, states) = task.divided(&states)?;
    }
    let task = Task { mechanism, start, options, periodic, by, nodes: &nodes };
    let mut here = task.returned(&states)?;
    for _ in 0..STEPS {
        let step = solve(&here.jacobian(), &-here.difference());
        let mut nearer = None;
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let mut trial: Vec<f64> =
                states.iter().zip(step.iter()).map(|(value, step)| value + part * step).collect();
            task.close(&mut trial)?;
            if let Ok(there) = task.returned(&trial)
                && there.residual < here.residual
            {
                nearer = Some((trial, there));
                break;
            }
            part *= 0.5;
        }
        let Some(found) = nearer else { break };
        (states, here) = found;
    }
    if here.residual > TOLERANCE {
        return Err(OrbitError::NotFound(here.residual));
    }
    Ok(Found { states, returned: here, nodes })
}

fn check(mechanism: &InterpretedMechanism, start: &State<'_>, periodic: &Periodic) -> Result<(), OrbitError> {
    let bad = |what: &str| Err(OrbitError::BadRequest(what.to_owned()));
    if periodic.reset.iter().any(|&index| index >= mechanism.count(ComponentKind::Coordinate)) {
        return bad("a coordinate that is reset does not exist");
    }
    let count = start.coordinates.len() + start.speeds.len();
    if periodic.symmetry.iter().any(|exchange| exchange.to >= count || exchange.from >= count) {
        return bad("a component that is exchanged does not exist");
    }
    let n = start.coordinates.len();
    if periodic.symmetry.iter().any(|exchange| (exchange.to < n) != (exchange.from < n)) {
        return bad("a coordinate takes the value of a coordinate, and a speed that of a speed");
    }
    let places: BTreeSet<usize> = periodic.symmetry.iter().map(|exchange| exchange.to).collect();
    if places.len() < periodic.symmetry.len() {
        return bad("a component is exchanged twice");
    }
    if !mechanism.quaternions().is_empty() {
        return bad("periodic motions of mechanisms with quaternions are not supported: use angles");
    }
    if periodic.segments == 0 {
        return bad("a period has at least one segment");
    }
    match periodic.returns {
        Return::After(period) if !(period > 0.0 && period.is_finite()) => {
            bad("the period must be positive and finite")
        }
        Return::At { count: 0, .. } => bad("at least one event must make a period"),
        Return::At { .. } if !(periodic.longest > 0.0 && periodic.longest.is_finite()) => {
            bad("the longest period must be positive and finite")
        }
        _ if start.coordinates.len() != mechanism.count(ComponentKind::Coordinate) => {
            bad("the start state has another number of coordinates")
        }
        _ => Ok(()),
    }
}

/// The least-norm solution of a system that may be singular.
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let decomposed = matrix.clone().svd(true, true);
    let least = SINGULAR * decomposed.singular_values.max();
    decomposed.solve(right, least).unwrap_or_else(|_| DVector::zeros(right.len()))
}
