//! How answers are written: as tables for a person, as JSON for a program.

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

/// The form that is asked for.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FormArgument {
    /// how the answer is written [default: tables at a terminal, else JSON]
    #[arg(long, value_enum, value_name = "FORMAT")]
    format: Option<Form>,
}

/// Whether a person reads standard output.
pub fn is_read() -> bool {
    std::io::stdout().is_terminal()
}

impl FormArgument {
    /// Writes an answer in its form; so is the error: in JSON as an object on standard output, else as text
    /// on standard error.
    ///
    /// # Errors
    ///
    /// That of `answer`, and those of writing.
    pub fn write<T: serde::Serialize>(
        &self,
        answer: impl FnOnce() -> Outcome<T>,
        table: impl FnOnce(&T) -> String,
    ) -> Outcome {
        let form = self.format.unwrap_or(if is_read() { Form::Table } else { Form::Json });
        match (form, answer()) {
            (Form::Json, answer) => output::json(&answer?),
            (Form::Table, Ok(answer)) => output::text(&output::visible(&table(&answer))),
            (Form::Table, Err(stop)) => Err(stop.told()),
        }
    }
}

impl Stop {
    /// The same, told on standard error in any case.
    pub fn told(self) -> Self {
        match self {
            Stop::Object(failure) => Stop::Fault(failure.to_string()),
            other => other,
        }
    }
}
