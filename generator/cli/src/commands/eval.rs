//! `hodograph eval`: evaluates the equations of a model in a state.

use std::path::PathBuf;

use crate::derivation::{self, Limits};
use crate::evaluate::report::report;
use crate::json::characteristics::{Asked, Form};
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
    #[command(flatten)]
    characteristics: Asked,
    /// with --characteristics: Coulomb's coefficient of friction, on which phi_hat, f_hat, g_hat and
    /// phi_bar depend
    #[arg(
        long,
        value_name = "NUMBER",
        value_parser = friction,
        allow_hyphen_values = true,
        requires = "characteristics"
    )]
    mu: Option<f64>,
    /// a file with the state, `-` for standard input, or the state itself
    #[arg(long, value_name = "FILE|-|JSON", allow_hyphen_values = true)]
    state: Option<String>,
    #[command(flatten)]
    limits: Limits,
}

fn friction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value >= 0.0 && value.is_finite() => Ok(value),
        _ => Err("it must be a number, and not negative".to_owned()),
    }
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
    let mut report = report(&machine, &state)?;
    match arguments.characteristics.form {
        None => output::json(&report),
        Some(Form::Json) => {
            report.characterise(arguments.mu);
            output::json(&report)
        }
        Some(Form::Table) => output::text(&report.tables(arguments.mu)),
    }
}
