//! `hodograph derive`: derives models and writes the derivation files that are checked in.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use hodograph_generator::artifact::{self, Loaded, MAX_BYTES};
use hodograph_generator::files;

use crate::derivation::{self, Limits};
use crate::files::{Entry, collect};
use crate::model::{self, Model};
use crate::output;
use crate::stop::{Outcome, Stop};

/// Derive the equations of models and keep them: beside each model file, and for inline models in `derived/`
///
/// With a fresh derivation checked in, building a program needs no algebra engine.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// model files, Rust files that use `mechanism!`, or directories of them
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// derive nothing: name the derivations that are stale, damaged or missing, and exit 1 if there are any
    #[arg(long)]
    check: bool,
    /// write nothing: derive again, name the derivations that are not what the model gives, and exit 1 if
    /// there are any
    #[arg(long, conflicts_with = "check")]
    verify: bool,
    /// derive also where the derivation is fresh
    #[arg(long, conflicts_with_all = ["check", "verify"])]
    force: bool,
    #[command(flatten)]
    limits: Limits,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Reported`] if a model has an error, cannot be derived or (`--check`) is stale.
pub fn run(arguments: &Arguments) -> Outcome {
    let (mut all_well, mut report) = (true, output::Report::default());
    let mut taken: HashMap<PathBuf, PathBuf> = HashMap::new();
    for entry in collect(&arguments.models)? {
        // A file of parts has no equations of its own.
        if entry.source.is_library() {
            continue;
        }
        let done = model::checked(entry.source.clone()).and_then(|model| {
            let path = entry.derivation(&model.mechanism.name)?;
            if let Some(other) = taken.insert(path.clone(), entry.path.clone()) {
                return Err(Stop::Fault(format!(
                    "{} and {} would share {}: give the mechanisms different names",
                    other.display(),
                    entry.path.display(),
                    path.display()
                )));
            }
            one(arguments, &entry, &model, path, &mut report)
        });
        match done {
            Ok(well) => all_well &= well,
            Err(Stop::Reported) => all_well = false,
            Err(Stop::Fault(message)) => {
                output::say(format_args!("error: {message}"));
                all_well = false;
            }
            Err(other) => return Err(other),
        }
    }
    if all_well { Ok(()) } else { Err(Stop::Reported) }
}

/// Derives or checks one model; `false` if its derivation is stale.
fn one(
    arguments: &Arguments,
    entry: &Entry,
    model: &Model,
    path: PathBuf,
    report: &mut output::Report,
) -> Outcome<bool> {
    let found = artifact::load(&path, &model.source);
    if arguments.check || arguments.verify {
        let fault = match found.fault() {
            None if arguments.verify => difference(model, &path, &arguments.limits)?,
            fault => fault,
        };
        let Some(fault) = fault else { return Ok(true) };
        let (path, model) = (path.display(), entry.path.display());
        let force = if matches!(found, Loaded::Fresh(_)) { " --force" } else { "" };
        report.text(&format!("{path} {fault}; run `hodograph derive{force} {model}`\n"))?;
        return Ok(false);
    }
    if matches!(found, Loaded::Fresh(_)) && !arguments.force {
        output::say(format_args!("{} is fresh", path.display()));
        return Ok(true);
    }
    output::check_distinct(&[&path], &model::imported(&entry.source))?;
    let (_, text) = derivation::derive(model, &arguments.limits)?;
    derivation::write(&path, &text)?;
    output::say(format_args!("{} written", path.display()));
    Ok(true)
}

/// How a fresh derivation differs from the one that is derived now.
fn difference(model: &Model, path: &Path, limits: &Limits) -> Outcome<Option<String>> {
    let stored = files::text(path, MAX_BYTES).map_err(|error| Stop::unreadable(path, &error))?;
    let (_, derived) = derivation::derive(model, limits)?;
    let [stored, derived]: [Vec<&str>; 2] = [&stored, &derived].map(|text| text.lines().collect());
    if stored == derived {
        return Ok(None);
    }
    let line = stored.iter().zip(&derived).take_while(|(a, b)| a == b).count() + 1;
    let wrote =
        |lines: &[&str]| lines.iter().find_map(|line| line.strip_prefix("generator ")).map(str::to_owned);
    let (before, now) = (wrote(&stored).unwrap_or_default(), wrote(&derived).unwrap_or_default());
    let version = match before == now {
        true => String::new(),
        false => format!(" (version {before} of the generator wrote it, this is {now})"),
    };
    Ok(Some(format!("is not what the model gives: they differ from line {line}{version}")))
}
