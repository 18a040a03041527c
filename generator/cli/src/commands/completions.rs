//! `hodograph completions` and `hodograph man`: completions for shells and pages for `man`.

use std::path::PathBuf;

use clap::{Command, CommandFactory};
use clap_complete::{Shell, generate};

use crate::output;
use crate::stop::{Outcome, Stop};

/// Write the completions of a shell
///
///   hodograph completions bash > ~/.local/share/bash-completion/completions/hodograph
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct Arguments {
    /// the shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Runs the command.
///
/// # Errors
///
/// Those of [`output::bytes`].
pub fn run(arguments: &Arguments) -> Outcome {
    let mut script = Vec::new();
    generate(arguments.shell, &mut tool(), "hodograph", &mut script);
    output::bytes(&script)
}

/// Write the pages for `man`, one for each command, into a folder
///
///   hodograph man ~/.local/share/man/man1
#[derive(Clone, Debug, clap::Args)]
#[command(verbatim_doc_comment)]
pub struct ManArguments {
    /// the folder; it is made if it is missing
    folder: PathBuf,
}

/// Runs the command.
///
/// # Errors
///
/// [`Stop::Fault`] if the folder cannot be written.
pub fn run_man(arguments: &ManArguments) -> Outcome {
    let folder = &arguments.folder;
    std::fs::create_dir_all(folder).map_err(|error| Stop::unwritable(folder, &error))?;
    clap_mangen::generate_to(tool(), folder).map_err(|error| Stop::unwritable(folder, &error))
}

/// The tool without its hidden commands.
fn tool() -> Command {
    let all = crate::Arguments::command();
    let shown: Vec<Command> =
        all.get_subcommands().filter(|command| !command.is_hide_set()).cloned().collect();
    Command::new("hodograph")
        .version(env!("CARGO_PKG_VERSION"))
        .about(all.get_about().cloned().unwrap_or_default())
        .long_about(all.get_long_about().cloned().unwrap_or_default())
        .subcommands(shown)
}
