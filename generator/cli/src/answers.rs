//! Writes the answer of a command: as tables for a person, as JSON for a program.

use std::io::IsTerminal;

use crate::output;
use crate::stop::{Outcome, Stop};

/// The form of an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Form {
    /// tables to read
    Table,
    /// an object on one line
    Json,
}

/// The option for the form of an answer.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FormArgument {
    /// how the answer is written [default: tables at a terminal, else JSON]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<Form>,
}

/// Whether standard output is a terminal.
pub fn is_terminal() -> bool {
    std::io::stdout().is_terminal()
}

impl FormArgument {
    /// Writes an answer in its form. An error is written in JSON as an object on standard output, in a table
    /// as text on standard error.
    ///
    /// # Errors
    ///
    /// The error of `answer`, or one of writing.
    pub fn write<T: serde::Serialize>(
        &self,
        answer: impl FnOnce() -> Outcome<T>,
        table: impl FnOnce(&T) -> String,
    ) -> Outcome {
        let form = self.format.unwrap_or(if is_terminal() { Form::Table } else { Form::Json });
        match (form, answer()) {
            (Form::Json, answer) => output::json(&answer?),
            (Form::Table, Ok(answer)) => output::text(&output::visible(&table(&answer))),
            (Form::Table, Err(stop)) => Err(stop.on_standard_error()),
        }
    }
}

impl Stop {
    /// The same error, but reported on standard error in any form.
    pub fn on_standard_error(self) -> Self {
        match self {
            Stop::Object(failure) => Stop::Fault(failure.to_string()),
            other => other,
        }
    }
}
