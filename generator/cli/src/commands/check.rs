//! `hodograph check`: reports every mistake in models.

use std::path::PathBuf;

use hodograph_generator::check::check;
use hodograph_generator::rendering::render;

use crate::files::collect;
use crate::output;
use crate::stop::{Outcome, Stop};

/// Check models: every mistake with its place
///
/// Exit 0 if there is no error (warnings are allowed), else 1.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// model files, Rust files that use `mechanism!`, or directories of them
    #[arg(required = true)]
    models: Vec<PathBuf>,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Said`] if a model has an error.
pub fn run(arguments: &Arguments) -> Outcome {
    let (mut models, mut wrong, mut report) = (0, 0, output::Report::default());
    for entry in collect(&arguments.models)? {
        let found = check(&entry.source);
        models += 1;
        wrong += usize::from(found.has_errors());
        report.text(&render(&found.diagnostics, &entry.source))?;
        if let Some(message) = found.mechanism.and_then(|mechanism| entry.misnamed(&mechanism.name)) {
            report.text(&format!("{message}: `mechanism!` names its module after the file\n"))?;
        }
    }
    let model = if models == 1 { "model" } else { "models" };
    output::say(format_args!("{models} {model} checked, {wrong} with errors"));
    if wrong == 0 { Ok(()) } else { Err(Stop::Said) }
}
