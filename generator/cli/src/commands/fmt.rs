//! `hodograph fmt`: lays out models in one style.

use std::path::{Path, PathBuf};

use hodograph_generator::files;
use hodograph_generator::format::{Unformatted, format};
use hodograph_generator::rendering::render;
use hodograph_generator::source::{MAX_BYTES, Source};

use crate::files::collect;
use crate::output;
use crate::stop::{Outcome, Stop};

/// Lay out models in one style
///
/// Only blanks and line breaks change: every comment stays, the equations and their hash are the same, and
/// derivations stay fresh. A model that cannot be parsed is left as it is, with its mistakes. Exit 0 if all is
/// laid out, 1 if something could not be, or with `--check` was not.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// model files or directories of them; `-` reads a model from standard input and writes it to standard
    /// output
    #[arg(required = true)]
    models: Vec<PathBuf>,
    /// write nothing: name the models whose layout would change
    #[arg(long)]
    check: bool,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Reported`] if a model cannot be parsed, or with `--check` if its layout would change.
pub fn run(arguments: &Arguments) -> Outcome {
    if arguments.models.iter().any(|path| path == Path::new("-")) {
        return match arguments.models.as_slice() {
            [_] => stream(arguments.check),
            _ => Err(Stop::Call("`-` is standard input: give it alone".to_owned())),
        };
    }
    let (mut changed, mut failed, mut same) = (0_usize, 0_usize, 0_usize);
    let mut report = output::Report::default();
    for entry in collect(&arguments.models)?.into_iter().filter(|entry| !entry.inline) {
        let Some(text) = laid_out(&entry.source)? else {
            failed += 1;
            continue;
        };
        // compare with the text as it was read from the file
        if entry.source.text() == Some(text.as_str()) {
            same += 1;
            continue;
        }
        changed += 1;
        match arguments.check {
            true => report.text(&format!("{}\n", entry.path.display()))?,
            false => output::file(&entry.path, text.as_bytes())?,
        }
    }
    let models = |n: usize| format!("{n} {}", if n == 1 { "model" } else { "models" });
    let verb = if arguments.check { "to lay out" } else { "laid out" };
    let left = if failed > 0 { format!(", {failed} left as they are") } else { String::new() };
    output::say(format_args!("{} {verb}, {same} as they should be{left}", models(changed)));
    if failed > 0 || arguments.check && changed > 0 { Err(Stop::Reported) } else { Ok(()) }
}

/// Lays out standard input and writes it to standard output.
fn stream(check: bool) -> Outcome {
    let bytes = files::up_to(std::io::stdin().lock(), MAX_BYTES)
        .map_err(|error| Stop::Fault(format!("standard input: {error}")))?;
    let source = Source::bytes("standard input", bytes);
    let text = laid_out(&source)?.ok_or(Stop::Reported)?;
    match check {
        false => output::text(&text),
        true if source.text() == Some(text.as_str()) => Ok(()),
        true => Err(Stop::Reported),
    }
}

/// The text of a model in the standard layout; `None` after reporting why it cannot be laid out.
fn laid_out(source: &Source) -> Outcome<Option<String>> {
    match format(source) {
        Ok(text) => Ok(Some(text)),
        Err(Unformatted::Mistakes(mistakes)) => {
            output::say(render(&mistakes, source).trim_end());
            Ok(None)
        }
        Err(Unformatted::Inline | Unformatted::Changed) => Err(Stop::Fault(format!(
            "the layout of {} would have changed its meaning, so nothing was written: please report it with the model",
            source.name()
        ))),
    }
}
