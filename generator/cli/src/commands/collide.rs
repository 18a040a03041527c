//! `hodograph collide`: solves a collision of a model in a state.

use std::path::PathBuf;

use crate::commands::solve::characteristics_of;
use crate::derivation::{self, Limits};
use crate::evaluate::collision::collide;
use crate::json::characteristics::{Asked, Form};
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
    /// quadratures that the collision may take; if it needs more, the error is `budget_exceeded`
    /// [default: no limit but the solver's own]
    #[arg(long, value_name = "QUADRATURES")]
    budget: Option<u32>,
    #[command(flatten)]
    characteristics: Asked,
    /// a file with the state, `-` for standard input, or the state itself
    #[arg(long, value_name = "FILE|-|JSON", allow_hyphen_values = true)]
    state: Option<String>,
    #[command(flatten)]
    limits: Limits,
}

/// Runs the command.
///
/// # Errors
///
/// An error object for what is wrong with the state or the collision.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let text = model::state_text(arguments.state.as_deref())?;
    let index = machine.contact(arguments.contact.as_deref())?;
    let surface = arguments.surface.surface(&machine.mechanism, index)?;
    let surface = surface.within(arguments.budget.unwrap_or(u32::MAX));
    let state = machine.state(text.as_deref())?;
    let (mut collision, found) = collide(&machine, &state, index, &surface)?;
    match arguments.characteristics.form {
        None => output::json(&collision),
        Some(form) => {
            let found = characteristics_of(&found.reduced.into(), &found.slip, &surface.surface)?;
            if form == Form::Table {
                return output::text(&found.table());
            }
            collision.answer.characteristics = Some(found);
            output::json(&collision)
        }
    }
}
