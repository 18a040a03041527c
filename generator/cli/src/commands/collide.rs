//! `hodograph collide`: solves a collision of a model in a state.

use std::path::PathBuf;

use crate::answers::FormArgument;
use crate::derivation::{self, Limits};
use crate::evaluate::collision::{Collision, collide};
use crate::state_arguments::StateArguments;
use crate::stop::Outcome;
use crate::surface::SurfaceArguments;

/// Solve the collision of a model in a state: impulse, separation, new speeds
///
///   hodograph collide models/two_sleds.mech --contact BcAc --mu 0.6 --e 0.8 --law stronge
///
/// Vectors stand along n, t, s: the normal, the slip of approach, and n x t (see `hodograph eval`).
/// The answer is a set of tables at a terminal, else one line of JSON.
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
    state: StateArguments,
    #[command(flatten)]
    form: FormArgument,
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
    arguments.form.write(
        || {
            let surface = arguments.surface.surface()?.within(arguments.budget.unwrap_or(u32::MAX));
            let index = machine.contact(arguments.contact.as_deref())?;
            let state = arguments.state.state(&machine)?;
            Ok(Solved { collision: collide(&machine, &state, index, &surface)?, index, speeds: state.speeds })
        },
        |found| {
            let mechanism = &machine.mechanism;
            let SurfaceArguments { mu, e, law } = &arguments.surface;
            let contact = &mechanism.contacts[found.index].name;
            let title = format!("{}, contact {contact}: mu = {mu}, e = {e}, {law}", mechanism.name);
            found.collision.tables(&title, mechanism, &found.speeds)
        },
    )
}

/// The collision, and what it was made of.
#[derive(serde::Serialize)]
struct Solved<'a> {
    #[serde(flatten)]
    collision: Collision<'a>,
    #[serde(skip)]
    index: usize,
    #[serde(skip)]
    speeds: Vec<f64>,
}
