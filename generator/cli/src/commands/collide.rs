//! `hodograph collide`: a collision of a model in a state.

use std::path::PathBuf;

use hodograph::ReducedMatrix;
use hodograph_generator::program::routine::{ContactQuantity, Quantity};
use serde::Serialize;

use crate::derivation::Limits;
use crate::evaluate::contact::{self, Contact};
use crate::evaluate::report::{Named, named};
use crate::json::answer::Answer;
use crate::model;
use crate::output;
use crate::stop::Outcome;
use crate::surface::SurfaceArguments;

/// Solve the collision of a model in a state: impulse, separation, new speeds, as one line of JSON
///
///   hodograph collide models/two_sleds.mech --contact BcAc --mu 0.6 --e 0.8 --law stronge
///
/// Vectors stand along n, t, s: the normal, the slip of approach, and n x t (see `hodograph eval`).
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// the contact; may be left out if the model has only one
    #[arg(long, value_name = "NAME")]
    contact: Option<String>,
    #[command(flatten)]
    surface: SurfaceArguments,
    /// a file with the state, `-` for standard input, or the state itself
    #[arg(long, value_name = "FILE|-|JSON", allow_hyphen_values = true)]
    state: Option<String>,
    #[command(flatten)]
    limits: Limits,
}

#[derive(Serialize)]
struct Collision<'a> {
    #[serde(flatten)]
    answer: Answer,
    u_after: Named<'a, f64>,
    kinetic_energy_change: f64,
}

/// Runs the command.
///
/// # Errors
///
/// An error object for what is wrong with the state or the collision.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = model::machine(&arguments.model, &arguments.limits)?;
    let text = model::state_text(arguments.state.as_deref())?;
    let surface = arguments.surface.surface()?;
    let index = machine.contact(arguments.contact.as_deref())?;
    let state = machine.state(text.as_deref())?;
    let more =
        [ContactQuantity::Response, ContactQuantity::DependentResponse, ContactQuantity::PrescribedWork];
    let of_contact = contact::QUANTITIES.into_iter().chain(more);
    let mut wanted: Vec<Quantity> =
        of_contact.map(|quantity| Quantity::Contact(index as u32, quantity)).collect();
    wanted.push(Quantity::DependentSpeeds);
    let numbers = machine.evaluate(&state, &wanted)?;
    let contact = Contact::new(&numbers, index, &state.speeds);
    let impact = hodograph::solve(&ReducedMatrix::from(contact.reduced), &contact.slip, &surface)
        .map_err(crate::json::Failure::from)?;
    // (12a), for the dependent speeds too
    let impulse = contact.in_basis(&impact.impulse);
    let responses = more[..2].iter().flat_map(|&quantity| numbers.of_contact(index, quantity).chunks(3));
    let before = state.speeds.iter().chain(numbers.get(Quantity::DependentSpeeds));
    let after = before.zip(responses).map(|(speed, response)| {
        speed + response.iter().zip(impulse.iter()).map(|(response, impulse)| response * impulse).sum::<f64>()
    });
    // (24): the contact's work, less what prescribed motion at the contact takes, and what it does in the bodies
    let prescribed: f64 = numbers
        .three(index, ContactQuantity::PrescribedWork)
        .iter()
        .zip(impulse.iter())
        .map(|(a, b)| a * b)
        .sum();
    let kinetic_energy_change = impact.contact_work - contact.remainder.dot(&impact.impulse) + prescribed;
    let u_after = named(&machine.mechanism.speeds, after);
    output::json(&Collision { answer: Answer::from(&impact), u_after, kinetic_energy_change })
}
