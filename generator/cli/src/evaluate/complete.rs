//! Closed loops: dependent coordinates that satisfy the configuration equations.

use hodograph_generator::model::mechanism::{EquationSides, PointId, Vector};
use hodograph_generator::program::routine::{PointQuantity, Quantity};
use nalgebra::{DMatrix, DVector};

use super::{Machine, listed};
use crate::json::state::State;
use crate::json::{Failure, Kind};

/// Coordinates that need no larger correction than this (rad or m, relative to their own size above 1) are consistent.
const CONSISTENT: f64 = 1e-10;
/// Bound on the steps; from a sensible guess it takes less than ten.
const STEPS: usize = 200;

/// Finds the dependent coordinates by damped Newton steps, starting where they are. Consistent ones stay as they are.
///
/// # Errors
///
/// `inconsistent_state` with the residual; `singular_state`.
pub fn complete(machine: &Machine, state: &mut State) -> Result<(), Failure> {
    let dependent: Vec<usize> = machine
        .mechanism
        .coordinates
        .iter()
        .enumerate()
        .filter(|(_, coordinate)| coordinate.dependent)
        .map(|(index, _)| index)
        .collect();
    if dependent.is_empty() {
        warn_of_open_loops(machine, state);
        return Ok(());
    }
    let guess = state.clone();
    let mut here = newton(machine, state, &dependent)?;
    if here.within(CONSISTENT) {
        return Ok(());
    }
    for _ in 0..STEPS {
        let Some((trial, next)) = advance(machine, state, &here, &dependent) else { break };
        (*state, here) = (trial, next);
        if here.within(4.0 * f64::EPSILON) {
            break;
        }
    }
    if here.within(CONSISTENT) {
        return Ok(());
    }
    let coordinates = &machine.mechanism.coordinates;
    let guess: Vec<String> = dependent
        .iter()
        .map(|&index| format!("{} = {}", coordinates[index].name, guess.coordinates[index]))
        .collect();
    Err(Failure::new(
        Kind::InconsistentState,
        format!(
            "the configuration equations have no solution for {} near the guess {}: their residual stays {:?}; change \
             the other coordinates, or give a guess nearer to the configuration meant",
            listed(dependent.iter().map(|&index| coordinates[index].name.as_str())),
            guess.join(", "),
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
    /// the same relative to the size of the coordinates above 1, at most; with what no step removes at a dead centre
    size: f64,
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
    let cutoff = 1e-13 * svd.singular_values.max();
    let step = svd.solve(&-&residual, cutoff).map_err(|error| {
        Failure::new(Kind::SingularState, format!("the configuration equations: {error}"))
    })?;
    let sizes = dependent
        .iter()
        .zip(step.iter())
        .map(|(&index, step)| step.abs() / state.coordinates[index].abs().max(1.0));
    let left = (jacobian * &step + &residual).norm();
    let left = if left > 1e-6 * residual.norm() { left } else { 0.0 };
    let size = sizes.fold(left, f64::max);
    Ok(Here { residual, step, size })
}

/// A loop that is closed by velocities alone is followed from wherever it begins: says so where it begins open.
fn warn_of_open_loops(machine: &Machine, state: &State) {
    let mechanism = &machine.mechanism;
    for constraint in &mechanism.constraints {
        let EquationSides::Vector(Vector::Velocity(PointId(a)), Vector::Velocity(PointId(b))) =
            constraint.sides
        else {
            continue;
        };
        let wanted = [a, b].map(|point| Quantity::Point(point as u32, PointQuantity::Position));
        let Ok(numbers) = machine.evaluate(state, &wanted) else { continue };
        let apart: Vec<f64> =
            numbers.get(wanted[0]).iter().zip(numbers.get(wanted[1])).map(|(a, b)| a - b).collect();
        if apart.iter().any(|distance| distance.abs() > 1e-9) {
            let [a, b] = [a, b].map(|point| &mechanism.points[point].name);
            eprintln!(
                "note: a constraint holds the velocities of {a} and {b} equal, but here {a} is off {b} by {apart:?}: if they \
                 are one point, say `configuration {{ position({a}) = position({b}); }}` in the model, with dependent \
                 coordinates, and the state will be completed"
            );
        }
    }
}
