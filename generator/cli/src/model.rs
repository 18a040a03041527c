//! Reads models from files, checks them and finds their equations.

use std::path::Path;

use hodograph_generator::check::check;
use hodograph_generator::diagnostics::Severity;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::reading;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::output;
use crate::stop::{Outcome, Stop};

/// Largest size of a state, in bytes.
const MAX_STATE: usize = 16 << 20;

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
/// [`Stop::Call`] where there is no such file, [`Stop::Said`] where it has mistakes.
pub fn load(path: &Path) -> Outcome<Model> {
    if let Err(error) = std::fs::metadata(path) {
        return Err(Stop::unreadable(path, &error));
    }
    checked(Source::read(path))
}

/// Checks a model; says what is wrong on stderr, and what makes numbers doubtful. What is only superfluous or
/// missing is said by `hodograph check`.
///
/// # Errors
///
/// [`Stop::Said`] where it has mistakes.
pub fn checked(source: Source) -> Outcome<Model> {
    let mut found = check(&source);
    found.diagnostics.retain(|found| found.severity == Severity::Error || !found.code.is_of_text());
    if !found.diagnostics.is_empty() {
        output::say(render(&found.diagnostics, &source).trim_end());
    }
    let mechanism = found.mechanism.ok_or(Stop::Said)?;
    Ok(Model { source, mechanism })
}

/// The text of a state: of a file, of standard input (`-`), or the argument itself where it is an object.
///
/// # Errors
///
/// [`Stop::Call`] where it cannot be read; `bad_json` where it is no text.
pub fn state_text(argument: Option<&str>) -> Outcome<Option<String>> {
    let bytes = match argument {
        None => return Ok(None),
        Some(text) if text.trim_start().starts_with('{') => return Ok(Some(text.to_owned())),
        Some("-") => reading::up_to(std::io::stdin().lock(), MAX_STATE)
            .map_err(|error| Stop::Call(format!("cannot read the state from standard input: {error}")))?,
        Some(path) => reading::bytes(Path::new(path), MAX_STATE).map_err(|error| {
            Stop::Call(format!(
                "cannot read the state from {path}: {error}; a state is a file, `-` for standard input, or the object itself, as in \
                 '{{\"q\":{{\"q1\":0.3}}}}'"
            ))
        })?,
    };
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        crate::json::Failure::bad_json(format!("the state is no UTF-8 at byte {at}"))
    })?;
    Ok(Some(text))
}
