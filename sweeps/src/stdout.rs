//! Writes to standard output. If its reader closes it, as `head` does, the tool ends without a message.

use std::fmt::Display;
use std::io::{ErrorKind, Write};

use crate::failure::Failure;

/// Writes a line.
///
/// # Errors
///
/// [`Failure::ReaderGone`] if the reader has closed it; the disk is full.
pub fn line(text: impl Display) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush()).map_err(|error| match error.kind() {
        ErrorKind::BrokenPipe => Failure::ReaderGone,
        _ => Failure::Engine(format!("cannot write to standard output: {error}")),
    })
}
