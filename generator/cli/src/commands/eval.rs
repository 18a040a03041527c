//! `hodograph eval`: evaluates the equations of a model in a state.

use std::path::PathBuf;

use crate::answers::FormArgument;
use crate::derivation::{self, Limits};
use crate::evaluate::report::{Report, report};
use crate::json::characteristics::{CharacteristicsArgument, Form};
use crate::output;
use crate::state_arguments::StateArguments;
use crate::stop::Outcome;

/// Evaluate a model in a state: mass matrix, forcing, accelerations, contacts
///
///   hodograph eval models/two_sleds.mech --state q3=0.8,u1=1,u4=1 --parameter m=3
///
/// A whole state is {"parameters":{..},"t":0,"q":{..},"u":{..},"inputs":{..}}; what is missing takes
/// the file's value, else 0. Dependent coordinates of closed loops are completed from the values
/// given as a guess. The answer is a set of tables at a terminal, else one line of JSON.
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    #[command(flatten)]
    characteristics: CharacteristicsArgument,
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
    #[command(flatten)]
    state: StateArguments,
    #[command(flatten)]
    form: FormArgument,
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
    if arguments.characteristics.form == Some(Form::Table) {
        let state = arguments.state.state(&machine)?;
        return output::text(&report(&machine, &state)?.characteristics(arguments.mu));
    }
    arguments.form.write(
        || {
            let state = arguments.state.state(&machine)?;
            let mut report = report(&machine, &state)?;
            if arguments.characteristics.form.is_some() {
                report.characterise(arguments.mu);
            }
            Ok(Evaluated { report, time: state.time, speeds: state.speeds })
        },
        |found| found.report.tables(&machine.mechanism, (found.time, &found.speeds)),
    )
}

/// A report and the mechanism that was evaluated for it.
#[derive(serde::Serialize)]
struct Evaluated<'a> {
    #[serde(flatten)]
    report: Report<'a>,
    #[serde(skip)]
    time: f64,
    #[serde(skip)]
    speeds: Vec<f64>,
}
