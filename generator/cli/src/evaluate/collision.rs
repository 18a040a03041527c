//! Evaluates a collision of a model in a state.

use hodograph::{Budgeted, CollisionOutcome, Contacts, Mechanism};
use hodograph_generator::program::{ContactQuantity, Quantity};
use serde::Serialize;

use super::Machine;
use super::report::{Named, named};
use crate::json::Failure;
use crate::json::answer::Answer;
use crate::json::state::State;

/// The answer of `collide`.
#[derive(Clone, Debug, Serialize)]
pub struct Collision<'a> {
    /// along n, t, s of the contact
    #[serde(flatten)]
    pub answer: Answer,
    /// all speeds after the collision, independent ones first
    pub u_after: Named<'a, f64>,
    /// J
    pub kinetic_energy_change: f64,
}

/// Solves the collision of a contact by the trait that simulations and generated modules use, too. Also
/// returns the outcome.
///
/// # Errors
///
/// `singular_state`, and those of the solver.
pub fn collide<'a>(
    machine: &'a Machine,
    state: &State,
    index: usize,
    surface: &Budgeted<f64>,
) -> Result<(Collision<'a>, CollisionOutcome<f64>), Failure> {
    // If the equations have no solution in this state, the error names the place of the fault.
    let response = Quantity::Contact(index as u32, ContactQuantity::Response);
    machine.evaluate(state, &[Quantity::MassMatrix, Quantity::DependentSpeeds, response])?;
    let mechanism = machine.interpreted(state)?;
    let before = state.borrowed();
    let mut after = state.speeds.clone();
    let outcome = mechanism.collide_with_budget(index, &before, surface, &mut after)?;
    let answer = Answer::try_from(&outcome.impact)?;
    let mut dependent = vec![0.0; machine.mechanism.speeds.len() - after.len()];
    mechanism.dependent_speeds(&hodograph::State { speeds: &after, ..before }, &mut dependent)?;
    let speeds = after.into_iter().chain(dependent);
    let collision = Collision {
        answer,
        u_after: named(&machine.mechanism.speeds, speeds.map(|speed| speed + 0.0)),
        kinetic_energy_change: outcome.energy_change + 0.0,
    };
    Ok((collision, outcome))
}
