//! `hodograph check`: reports every mistake in models.

use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use clap::ValueEnum;
use hodograph_generator::check::{Checked, check};
use hodograph_generator::diagnostics::Severity;
use hodograph_generator::diagnostics::codes::EMPTY;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::files::{Entry, collect};
use crate::findings::{Finding, sarif};
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
    /// how mistakes are written
    #[arg(long, value_enum, value_name = "FORMAT", default_value_t = Format::Text)]
    format: Format,
    /// check again whenever a model changes, until interrupted
    #[arg(long, conflicts_with = "format")]
    watch: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// for people, with the lines of the model
    Text,
    /// an object for each mistake on a line of its own
    Json,
    /// a log in the Static Analysis Results Interchange Format 2.1.0, which code hosts and editors read
    Sarif,
}

/// The interval between two looks at the files.
const PAUSE: Duration = Duration::from_millis(250);

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Reported`] if a model has an error.
pub fn run(arguments: &Arguments) -> Outcome {
    match arguments.watch {
        true => watch(&arguments.models),
        false => once(&arguments.models, arguments.format),
    }
}

fn once(paths: &[PathBuf], format: Format) -> Outcome {
    let (mut models, mut wrong, mut report) = (0, 0, output::Report::default());
    let mut findings = Vec::new();
    for entry in collect(paths)? {
        let found = checked_source(&entry.source);
        models += 1;
        wrong += usize::from(found.diagnostics.iter().any(|found| found.severity == Severity::Error));
        let misnamed = found.mechanism.as_ref().and_then(|mechanism| entry.misnamed(&mechanism.name));
        match format {
            Format::Text => {
                report.text(&render(&found.diagnostics, &entry.source))?;
                if let Some(message) = misnamed {
                    report.text(&format!("{message}: `mechanism!` names its module after the file\n"))?;
                }
            }
            Format::Json | Format::Sarif => {
                findings.extend(found.diagnostics.iter().map(|found| Finding::new(found, &entry.source)));
            }
        }
    }
    match format {
        Format::Text => {}
        Format::Json => findings.iter().try_for_each(output::json)?,
        Format::Sarif => output::json(&sarif(&findings))?,
    }
    let model = if models == 1 { "model" } else { "models" };
    output::say(format_args!("{models} {model} checked, {wrong} with errors"));
    if wrong == 0 { Ok(()) } else { Err(Stop::Reported) }
}

/// The mistakes of a model. The absence of bodies is not a mistake in a file of parts, which is checked where
/// its parts are used.
fn checked_source(source: &Source) -> Checked {
    let mut found = check(source);
    if source.is_library() {
        found.diagnostics.retain(|found| found.code != EMPTY);
    }
    found
}

/// Checks again whenever a file has changed.
fn watch(paths: &[PathBuf]) -> Outcome {
    let mut known: Option<Vec<Stamp>> = None;
    loop {
        let now = stamps(paths);
        if known.as_ref() != Some(&now) {
            if known.is_some() {
                output::text("\n")?;
            }
            match once(paths, Format::Text) {
                Ok(()) | Err(Stop::Reported) => {}
                // A file that is being saved may be missing for a moment.
                Err(Stop::Call(message) | Stop::Fault(message)) => output::say(message),
                Err(other) => return Err(other),
            }
            known = Some(now);
        }
        std::thread::sleep(PAUSE);
    }
}

/// What can be read of a file without opening it: path, time of the last change, size.
type Stamp = (PathBuf, Option<SystemTime>, u64);

fn stamps(paths: &[PathBuf]) -> Vec<Stamp> {
    let mut found = Vec::new();
    let with_imports = |entry: Entry| {
        let imported: Vec<PathBuf> = entry.source.imported().map(|file| PathBuf::from(file.name())).collect();
        std::iter::once(entry.path).chain(imported)
    };
    let files =
        collect(paths).map_or(paths.to_vec(), |entries| entries.into_iter().flat_map(with_imports).collect());
    for path in files {
        let data = std::fs::metadata(&path).ok();
        let time = data.as_ref().and_then(|data| data.modified().ok());
        found.push((path, time, data.map_or(0, |data| data.len())));
    }
    found
}
