//! Completes a state: finds dependent coordinates that satisfy the configuration equations of closed loops.

use hodograph::Cause;
use hodograph_generator::numeric;
use hodograph_generator::program::{PointQuantity, Quantity};
use nalgebra::{DMatrix, DVector};

use super::{Machine, listed};
use crate::json::state::State;
use crate::json::{Failure, Kind};

/// Coordinates are consistent if the Newton step would change them by at most this (rad or m, relative to
/// their size if that is above 1).
const CONSISTENT: f64 = 1e-10;
/// The largest distance between two points that shall coincide, m, relative to their distance from O if that
/// is above 1 m.
const MAX_LOOP_GAP: f64 = 1e-9;
/// Where two configurations of a linkage meet, the residual grows with the square of the error, so that
/// coordinates are known only to the root of the rounding error. The Jacobian counts as singular if its
/// smallest singular value is below this part of the largest.
const SINGULAR: f64 = 1e-7;
/// Bound on the number of steps; from a sensible guess fewer than ten are needed.
const MAX_STEPS: usize = 200;

/// Finds the dependent coordinates by damped Newton steps, starting at their present values. Consistent
/// coordinates are not changed.
///
/// # Errors
///
/// `inconsistent_state` with the residual; `singular_state`.
pub fn assemble(machine: &Machine, state: &mut State) -> Result<(), Failure> {
    let dependent: Vec<usize> = machine
        .mechanism
        .coordinates
        .iter()
        .enumerate()
        .filter(|(_, coordinate)| coordinate.dependent)
        .map(|(index, _)| index)
        .collect();
    if dependent.is_empty() {
        return Ok(());
    }
    let guess = state.clone();
    let mut current = newton(machine, state, &dependent)?;
    if !current.within(CONSISTENT) {
        for _ in 0..MAX_STEPS {
            let Some((trial, next)) = advance(machine, state, &current, &dependent) else { break };
            (*state, current) = (trial, next);
            if current.within(4.0 * f64::EPSILON) {
                break;
            }
        }
    }
    let coordinates = &machine.mechanism.coordinates;
    let values = |state: &State| {
        let of = |&index: &usize| format!("{} = {}", coordinates[index].name, state.coordinates[index]);
        dependent.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let names = listed(dependent.iter().map(|&index| coordinates[index].name.as_str()));
    if current.closed && current.pivot < SINGULAR {
        return Err(Failure::new(
            Kind::Of(Cause::SingularState),
            format!(
                "the configuration equations cannot be solved for {names}: the linkage is at a dead centre where {} (a \
                 relative pivot is {:.1e}, below {SINGULAR:e}); change the other coordinates a little",
                values(state),
                current.pivot,
            ),
        ));
    }
    if current.within(CONSISTENT) {
        return Ok(());
    }
    Err(Failure::new(
        Kind::InconsistentState,
        format!(
            "the configuration equations have no solution for {names} near the guess {}: their residual stays {:?}; change \
             the other coordinates, or give a guess nearer to the configuration meant",
            values(&guess),
            current.residual.as_slice(),
        ),
    ))
}

/// The configuration equations at the current coordinates.
struct Iterate {
    /// of the configuration equations
    residual: DVector<f64>,
    /// the Newton step of the dependent coordinates
    step: DVector<f64>,
    /// the largest component of the step, relative to the size of the coordinate if that is above 1; at a
    /// dead centre including the part of the residual that no step removes
    size: f64,
    /// whether the residual is not larger than its rounding error
    closed: bool,
    /// least singular value of the Jacobian over the largest
    pivot: f64,
}

impl Iterate {
    fn within(&self, bound: f64) -> bool {
        self.size <= bound
    }
}

/// Halves the step until the residual decreases; `None` if no step does.
fn advance(
    machine: &Machine,
    state: &State,
    current: &Iterate,
    dependent: &[usize],
) -> Option<(State, Iterate)> {
    let mut share = 1.0;
    while share > 1e-9 {
        let mut trial = state.clone();
        for (&index, change) in dependent.iter().zip(current.step.iter()) {
            trial.coordinates[index] += share * change;
        }
        if let Ok(next) = newton(machine, &trial, dependent) {
            // Near the solution rounding prevents a smaller residual; then the next step must be as small.
            let falls = next.residual.norm() <= (1.0 - 0.1 * share) * current.residual.norm();
            if falls || (next.within(CONSISTENT) && next.size < 0.5 * current.size) {
                return Some((trial, next));
            }
        }
        share *= 0.5;
    }
    None
}

fn newton(machine: &Machine, state: &State, dependent: &[usize]) -> Result<Iterate, Failure> {
    let count = dependent.len();
    let wanted = [Quantity::ConfigurationResidual, Quantity::ConfigurationJacobian];
    let numbers = machine.evaluate(state, &wanted)?;
    let (residual, jacobian) = (numbers.get(wanted[0]), numbers.get(wanted[1]));
    if residual.len() != count || jacobian.len() != count * count {
        return Err(Failure::new(
            Kind::InconsistentState,
            "the derivation has no configuration equations for its dependent coordinates: derive the model again",
        ));
    }
    let residual = DVector::from_column_slice(residual);
    let jacobian = DMatrix::from_row_slice(count, count, jacobian);
    let svd = jacobian.clone().svd(true, true);
    let largest = svd.singular_values.max();
    let pivot = conditioned(&jacobian);
    let values = DVector::from_iterator(count, dependent.iter().map(|&index| state.coordinates[index]));
    let cutoff = 1e-13 * largest;
    let step = svd.solve(&-&residual, cutoff).map_err(|error| {
        Failure::new(Kind::Of(Cause::SingularState), format!("the configuration equations: {error}"))
    })?;
    let sizes = dependent
        .iter()
        .zip(step.iter())
        .map(|(&index, step)| step.abs() / state.coordinates[index].abs().max(1.0));
    let left = (&jacobian * &step + &residual).norm();
    let left = if left > 1e-6 * residual.norm() { left } else { 0.0 };
    let size = sizes.fold(left, f64::max);
    let terms = jacobian.abs() * values.abs();
    let closed = residual
        .iter()
        .zip(terms.iter())
        .all(|(r, terms)| r.abs() <= 64.0 * f64::EPSILON * terms.max(largest));
    Ok(Iterate { residual, step, size, closed, pivot })
}

/// The smallest singular value over the largest, of the matrix with its columns scaled to length 1, so that
/// the units of coordinates do not matter. Rows are not scaled: at a dead centre one of them vanishes.
fn conditioned(matrix: &DMatrix<f64>) -> f64 {
    let mut scaled = matrix.clone();
    for mut column in scaled.column_iter_mut() {
        let norm = column.norm();
        column /= if norm > 0.0 { norm } else { 1.0 };
    }
    let values = scaled.singular_values();
    values.min() / values.max()
}

/// Checks that points that velocity constraints hold together coincide: the constraints keep their distance.
///
/// # Errors
///
/// `inconsistent_state` with the distance.
pub fn check_loops(machine: &Machine, state: &State) -> Result<(), Failure> {
    let mechanism = &machine.mechanism;
    for [a, b] in numeric::held_together(mechanism, &state.to_numeric()) {
        let wanted = [a, b].map(|point| Quantity::Point(point.0 as u32, PointQuantity::Position));
        let numbers = machine.evaluate(state, &wanted)?;
        let (at, other) = (numbers.get(wanted[0]), numbers.get(wanted[1]));
        let apart: Vec<f64> = at.iter().zip(other).map(|(a, b)| a - b).collect();
        let size = at.iter().chain(other).fold(1.0_f64, |size, x| size.max(x.abs()));
        if apart.iter().any(|distance| distance.abs() > MAX_LOOP_GAP * size) {
            let [a, b] = [a, b].map(|point| &mechanism.points[point.0].name);
            return Err(Failure::new(
                Kind::InconsistentState,
                format!(
                    "a constraint closes a loop by holding the velocities of {a} and {b} equal, but the loop is open: {a} is off \
                     {b} by {apart:?}; give coordinates that close it, or say `configuration {{ position({a}) = position({b}); }}` \
                     in the model, with dependent coordinates, and they will be found (points that are to stay apart are \
                     constrained component by component: `dot(velocity({a}, {b}), N.x) = 0`)"
                ),
            ));
        }
    }
    Ok(())
}
