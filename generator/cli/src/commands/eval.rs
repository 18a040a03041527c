//! `hodograph eval`: evaluates the equations of a model in a state.

use std::path::PathBuf;

use crate::derivation::{self, Limits};
use crate::evaluate::report::report;
use crate::model;
use crate::output;
use crate::stop::Outcome;

/// Evaluate a model in a state: mass matrix, forcing, accelerations, contacts, as one line of JSON
///
///   hodograph eval models/two_sleds.mech --state '{"q":{"q3":0.8},"u":{"u1":1,"u4":1}}'
///
/// A state is {"parameters":{..},"t":0,"q":{..},"u":{..},"inputs":{..}}; what is missing takes the
/// file's value, else 0. Dependent coordinates of closed loops are completed from the values given
/// as a guess.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
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
/// An error object for what is wrong with the state.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = derivation::machine(&arguments.model, &arguments.limits)?;
    let text = model::state_text(arguments.state.as_deref())?;
    let state = machine.state(text.as_deref())?;
    output::json(&report(&machine, &state)?)
}
