//! Completes a state: finds dependent coordinates that satisfy the configuration equations of closed loops.

use hodograph::Cause;
use hodograph_generator::numeric;
use hodograph_generator::program::{PointQuantity, Quantity};
use nalgebra::{DMatrix, DVector};

use super::{Machine, listed};
use crate::json::state::State;
use crate::json::{Failure, Kind};

/// Coordinates that need no larger correction than this (rad or m, relative to their own size above 1) are
/// consistent.
const CONSISTENT: f64 = 1e-10;
/// Points that are to be one may be this far apart, relative to their distance from O above 1 m.
const OPEN: f64 = 1e-9;
/// Where two configurations of a linkage meet, the residual grows with the square of the error, so that
/// coordinates are known to the root of the rounding error only. Below this ratio of its singular values the
/// Jacobian counts as singular.
const FOLDED: f64 = 1e-7;
/// Bound on the steps; from a sensible guess it takes less than ten.
const STEPS: usize = 200;

/// Finds the dependent coordinates by damped Newton steps, starting where they are. Consistent ones stay as
/// they are.
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
    let mut here = newton(machine, state, &dependent)?;
    if !here.within(CONSISTENT) {
        for _ in 0..STEPS {
            let Some((trial, next)) = advance(machine, state, &here, &dependent) else { break };
            (*state, here) = (trial, next);
            if here.within(4.0 * f64::EPSILON) {
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
    if here.closed && here.pivot < FOLDED {
        return Err(Failure::new(
            Kind::Of(Cause::SingularState),
            format!(
                "the configuration equations cannot be solved for {names}: the linkage is at a dead centre where {} (a \
                 relative pivot is {:.1e}, below {FOLDED:e}); change the other coordinates a little",
                values(state),
                here.pivot,
            ),
        ));
    }
    if here.within(CONSISTENT) {
        return Ok(());
    }
    Err(Failure::new(
        Kind::InconsistentState,
        format!(
            "the configuration equations have no solution for {names} near the guess {}: their residual stays {:?}; change \
             the other coordinates, or give a guess nearer to the configuration meant",
            values(&guess),
            here.residual.as_slice(),
        ),
    ))
}

/// Where the equations stand.
struct Here {
    /// of the equations
    residual: DVector<f64>,
    /// the change of the dependent coordinates that would remove it
    step: DVector<f64>,
    /// the same relative to the size of the coordinates above 1, at most; with what no step removes at a
    /// dead centre
    size: f64,
    /// whether the residual is no more than rounding.
    closed: bool,
    /// least singular value of the Jacobian over the largest
    pivot: f64,
}

impl Here {
    fn within(&self, bound: f64) -> bool {
        self.size <= bound
    }
}

/// Goes as far along the step as makes the residual smaller; `None` if that is nowhere.
fn advance(machine: &Machine, state: &State, here: &Here, dependent: &[usize]) -> Option<(State, Here)> {
    let mut share = 1.0;
    while share > 1e-9 {
        let mut trial = state.clone();
        for (&index, change) in dependent.iter().zip(here.step.iter()) {
            trial.coordinates[index] += share * change;
        }
        if let Ok(next) = newton(machine, &trial, dependent) {
            // Near the solution rounding keeps the residual from falling, and then the next step is as small.
            let falls = next.residual.norm() <= (1.0 - 0.1 * share) * here.residual.norm();
            if falls || (next.within(CONSISTENT) && next.size < 0.5 * here.size) {
                return Some((trial, next));
            }
        }
        share *= 0.5;
    }
    None
}

fn newton(machine: &Machine, state: &State, dependent: &[usize]) -> Result<Here, Failure> {
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
    Ok(Here { residual, step, size, closed, pivot })
}

/// The least over the largest singular value of the matrix whose columns are scaled to length 1, so that
/// units of coordinates do not matter. Rows are not scaled: at a dead centre one of them vanishes.
fn conditioned(matrix: &DMatrix<f64>) -> f64 {
    let mut scaled = matrix.clone();
    for mut column in scaled.column_iter_mut() {
        let norm = column.norm();
        column /= if norm > 0.0 { norm } else { 1.0 };
    }
    let values = scaled.singular_values();
    values.min() / values.max()
}

/// Points that velocity constraints hold together stay apart as they are, so they must begin as one.
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
        if apart.iter().any(|distance| distance.abs() > OPEN * size) {
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
