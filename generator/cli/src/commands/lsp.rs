//! `hodograph lsp`: the language server.

use crate::lsp;
use crate::stop::Outcome;

/// Serve an editor: the Language Server Protocol on standard input and output
///
/// Editors start it. docs/editors.md says how to set them up.
#[derive(Clone, Debug, clap::Args)]
pub struct Arguments {
    /// passed by editors; there is no other way to connect
    #[arg(long, hide = true)]
    stdio: bool,
}

/// Runs the command.
///
/// # Errors
///
/// Those of [`lsp::serve`].
pub fn run(_: &Arguments) -> Outcome {
    lsp::serve()
}
