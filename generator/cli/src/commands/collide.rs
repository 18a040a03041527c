//! `hodograph collide`: solves a collision of a model in a state.

use std::path::PathBuf;

use hodograph::Surface;

use crate::answers::FormArgument;
use crate::commands::solve::characteristics_of;
use crate::derivation::{self, Limits};
use crate::evaluate::collision::{Collision, collide};
use crate::json::characteristics::{CharacteristicsArgument, Form};
use crate::output;
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
    characteristics: CharacteristicsArgument,
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
    let solve = || {
        let index = machine.contact(arguments.contact.as_deref())?;
        let state = arguments.state.state(&machine)?;
        let surface = arguments.surface.surface(&machine.interpreted(&state)?, index)?;
        let budget = surface.with_budget(arguments.budget.unwrap_or(u32::MAX));
        let (mut collision, found) = collide(&machine, &state, index, &budget)?;
        let asked = arguments.characteristics.form;
        let of_paper =
            asked.map(|_| characteristics_of(&found.reduced, &found.approach, &surface)).transpose()?;
        collision.answer.characteristics = of_paper;
        Ok(Solved { collision, index, surface, speeds: state.speeds })
    };
    if arguments.characteristics.form == Some(Form::Table) {
        let found = solve()?.collision.answer.characteristics;
        return output::text(&found.map_or(String::new(), |found| found.table()));
    }
    arguments.form.write(solve, |found| {
        let mechanism = &machine.mechanism;
        let Surface { mu, e, law } = &found.surface;
        let contact = &mechanism.contacts[found.index].name;
        let title = format!("{}, contact {contact}: mu = {mu}, e = {e}, {}", mechanism.name, law.name());
        found.collision.tables(&title, mechanism, &found.speeds)
    })
}

/// A collision and the mechanism that was evaluated for it.
#[derive(serde::Serialize)]
struct Solved<'a> {
    #[serde(flatten)]
    collision: Collision<'a>,
    #[serde(skip)]
    index: usize,
    #[serde(skip)]
    surface: Surface<f64>,
    #[serde(skip)]
    speeds: Vec<f64>,
}
