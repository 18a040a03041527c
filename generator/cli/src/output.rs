//! Standard output, to which nothing but results goes.

use std::io::{self, Write};

use crate::stop::{Outcome, Stop};

/// Writes text and flushes it.
///
/// # Errors
///
/// [`Stop::ReaderGone`] where the other end of the pipe is closed.
pub fn text(text: &str) -> Outcome {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(|error| match error.kind() {
        io::ErrorKind::BrokenPipe => Stop::ReaderGone,
        _ => Stop::Fault(format!("cannot write to standard output: {error}")),
    })
}

/// Writes a line and flushes it.
///
/// # Errors
///
/// As [`text`].
pub fn line(line: &str) -> Outcome {
    text(&format!("{line}\n"))
}

/// Writes a value as one line of JSON.
///
/// # Errors
///
/// As [`text`].
pub fn json(value: &impl serde::Serialize) -> Outcome {
    let line_of =
        serde_json::to_string(value).map_err(|error| Stop::Fault(format!("cannot write JSON: {error}")))?;
    line(&line_of)
}
