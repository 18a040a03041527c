//! Reads models from files and checks them.

use std::path::{Path, PathBuf};

use hodograph_generator::artifact::place;
use hodograph_generator::check::check;
use hodograph_generator::diagnostics::Severity;
use hodograph_generator::files;
use hodograph_generator::model::mechanism::Mechanism;
use hodograph_generator::parts::Imported;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::output;
use crate::stop::{Outcome, Stop};

/// A model without mistakes.
#[derive(Clone, Debug)]
pub struct Model {
    /// its text
    pub source: Source,
    /// the checked mechanism
    pub mechanism: Mechanism,
}

/// Reads and checks a model file; reports mistakes on standard error.
///
/// # Errors
///
/// [`Stop::Call`] if there is no such file, [`Stop::Reported`] if it has mistakes.
pub fn load(path: &Path) -> Outcome<Model> {
    if let Err(error) = std::fs::metadata(path) {
        return Err(Stop::unreadable(path, &error));
    }
    checked(files::model(path))
}

/// The files that a command reads with a model file: itself, its derivation, and all that it imports.
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    [path.to_path_buf(), place::beside(path)].into_iter().chain(imported(&files::model(path))).collect()
}

/// The files that a model imports, directly or through others.
pub fn imported(source: &Source) -> Vec<PathBuf> {
    let files = source.expansion().into_iter().flat_map(|expansion| &expansion.files);
    let path = |file: &Imported| {
        // by the name that the user knows, where it leads to the file
        let named = PathBuf::from(&file.name);
        if files::key(&named) == file.key { named } else { PathBuf::from(&file.key) }
    };
    files.map(path).collect()
}

/// Checks a model; reports on standard error its mistakes, and the warnings that concern its numbers. Other
/// warnings are reported by `hodograph check`.
///
/// # Errors
///
/// [`Stop::Reported`] if it has mistakes.
pub fn checked(source: Source) -> Outcome<Model> {
    let mut found = check(&source);
    found.diagnostics.retain(|found| found.severity == Severity::Error || !found.code.is_of_text());
    if !found.diagnostics.is_empty() {
        output::say(render(&found.diagnostics, &source).trim_end());
    }
    let mechanism = found.mechanism.ok_or(Stop::Reported)?;
    Ok(Model { source, mechanism })
}
