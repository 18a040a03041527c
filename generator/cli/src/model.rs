//! Reads models from files, checks them and finds their equations.

use std::path::Path;

use hodograph_generator::check::check;
use hodograph_generator::diagnostics::Severity;
use hodograph_generator::files;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::output;
use crate::stop::{Outcome, Stop};

/// A model without mistakes.
#[derive(Clone, Debug)]
pub struct Model {
    /// its text
    pub source: Source,
    /// its meaning
    pub mechanism: Mechanism,
}

/// Reads and checks a model file; says what is wrong on stderr.
///
/// # Errors
///
/// [`Stop::Call`] where there is no such file, [`Stop::Reported`] where it has mistakes.
pub fn load(path: &Path) -> Outcome<Model> {
    if let Err(error) = std::fs::metadata(path) {
        return Err(Stop::unreadable(path, &error));
    }
    checked(files::model(path))
}

/// Checks a model; says what is wrong on stderr, and what makes numbers doubtful. What is only superfluous or
/// missing is said by `hodograph check`.
///
/// # Errors
///
/// [`Stop::Reported`] where it has mistakes.
pub fn checked(source: Source) -> Outcome<Model> {
    let mut found = check(&source);
    found.diagnostics.retain(|found| found.severity == Severity::Error || !found.code.is_of_text());
    if !found.diagnostics.is_empty() {
        output::say(render(&found.diagnostics, &source).trim_end());
    }
    let mechanism = found.mechanism.ok_or(Stop::Reported)?;
    Ok(Model { source, mechanism })
}
