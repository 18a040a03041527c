//! `hodograph explain`: the equations of a model, to be read.

use std::path::PathBuf;

use clap::ValueEnum;
use hodograph_generator::explain::{Format, explain, usual};
use hodograph_generator::program::routine::Quantity;

use crate::derivation::Limits;
use crate::model;
use crate::output;
use crate::spelling;
use crate::stop::{Outcome, Stop};

/// Write the equations of a model: mass matrix, forcing, contacts, with intermediate symbols z1, z2 .. as in the paper
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// the model file
    model: PathBuf,
    /// how to write them
    #[arg(long, value_enum, default_value_t = Style::Text)]
    format: Style,
    /// only these quantities, as derivations call them (`mass_matrix`, `contact 0 reduced` ..) [default: the usual ones]
    #[arg(long, value_name = "NAME")]
    quantity: Vec<String>,
    #[command(flatten)]
    limits: Limits,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Style {
    /// plain text
    Text,
    /// a LaTeX document
    Latex,
    /// an HTML page
    Html,
}

/// Runs the command.
///
/// # Errors
///
/// The model has errors, cannot be derived, or has no such quantity.
pub fn run(arguments: &Arguments) -> Outcome {
    let machine = model::machine(&arguments.model, &arguments.limits)?;
    let program = &machine.program;
    let known: Vec<String> = program.outputs.iter().map(|output| output.quantity.to_string()).collect();
    let mut quantities = Vec::new();
    for name in &arguments.quantity {
        let quantity = Quantity::from_words(&name.split_whitespace().collect::<Vec<_>>());
        match quantity.filter(|&quantity| program.output(quantity).is_some()) {
            Some(quantity) => quantities.push(quantity),
            None => {
                let hint = spelling::hint(name, known.iter().map(String::as_str));
                return Err(Stop::Call(format!("the model has no quantity `{name}`: {hint}")));
            }
        }
    }
    if quantities.is_empty() {
        quantities = usual(program);
    }
    let format = match arguments.format {
        Style::Text => Format::Text,
        Style::Latex => Format::Latex,
        Style::Html => Format::Html,
    };
    output::text(&explain(&machine.mechanism, program, &quantities, format))
}
