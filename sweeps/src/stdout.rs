//! What the tool says on standard output. A reader that has enough, as `head`, ends the tool in silence.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use crate::failure::Failure;

/// Writes a line.
///
/// # Errors
///
/// [`Failure::ReaderGone`] where nobody reads any more; a full disk.
pub fn line(text: impl Display) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush()).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => Failure::Engine(format!("cannot write to standard output: {error}")),
    })
}
