//! Evaluates a collision of a model in a state.

use hodograph::{Budgeted, ReducedMatrix};
use hodograph_generator::program::{ContactQuantity, Quantity};
use serde::Serialize;

use super::Machine;
use super::contact::{self, Contact};
use super::report::{Named, named};
use crate::json::Failure;
use crate::json::answer::Answer;
use crate::json::state::State;

/// What `collide` writes.
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

/// Solves the collision of a contact; also the contact.
///
/// # Errors
///
/// `singular_state`, and those of the solver.
pub fn collide<'a>(
    machine: &'a Machine,
    state: &State,
    index: usize,
    surface: &Budgeted<f64>,
) -> Result<(Collision<'a>, Contact), Failure> {
    let more =
        [ContactQuantity::Response, ContactQuantity::DependentResponse, ContactQuantity::PrescribedWork];
    let of_contact = contact::QUANTITIES.into_iter().chain(more);
    let mut wanted: Vec<Quantity> =
        of_contact.map(|quantity| Quantity::Contact(index as u32, quantity)).collect();
    wanted.extend([Quantity::DependentSpeeds, Quantity::MassMatrix]);
    let numbers = machine.evaluate(state, &wanted)?;
    let contact = Contact::new(&numbers, index, &state.speeds);
    let impact = hodograph::solve(&ReducedMatrix::from(contact.reduced), &contact.slip, surface)?;
    // (12a), for the dependent speeds too
    let impulse = contact.in_basis(&impact.impulse);
    let responses = more[..2].iter().flat_map(|&quantity| numbers.of_contact(index, quantity).chunks(3));
    let before = state.speeds.iter().chain(numbers.get(Quantity::DependentSpeeds));
    let after = before.zip(responses).map(|(speed, response)| {
        speed + response.iter().zip(impulse.iter()).map(|(response, impulse)| response * impulse).sum::<f64>()
    });
    // (24): the contact's work, less what prescribed motion at the contact takes, and what it does in the
    // bodies
    let prescribed: f64 = numbers
        .three(index, ContactQuantity::PrescribedWork)
        .iter()
        .zip(impulse.iter())
        .map(|(a, b)| a * b)
        .sum();
    let collision = Collision {
        answer: Answer::try_from(&impact)?,
        u_after: named(&machine.mechanism.speeds, after),
        kinetic_energy_change: impact.contact_work - contact.remainder.dot(&impact.impulse) + prescribed,
    };
    Ok((collision, contact))
}
