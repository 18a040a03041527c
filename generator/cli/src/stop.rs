//! The ways in which a command fails, with messages and exit codes.

use std::fmt;

use crate::json::Failure;

/// Why a command stopped.
#[derive(Clone, Debug)]
pub enum Stop {
    /// The call was wrong (a missing file, say): told on stderr, exit 2.
    Call(String),
    /// It could not be done: told on stderr, exit 1.
    Fault(String),
    /// An error object for stdout, exit 1.
    Object(Failure),
    /// Everything has been said: exit 1.
    Reported,
    /// Nobody reads any more what is written: exit 0, in silence.
    ReaderGone,
}

/// What commands return.
pub type Outcome<T = ()> = Result<T, Stop>;

impl Stop {
    /// A file that cannot be read.
    pub fn unreadable(path: &std::path::Path, error: &std::io::Error) -> Self {
        Stop::Call(format!("cannot read {}: {error}", path.display()))
    }

    /// A file that cannot be written.
    pub fn unwritable(path: &std::path::Path, error: &std::io::Error) -> Self {
        Stop::Fault(format!("cannot write {}: {error}", path.display()))
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Stop::Call(message) | Stop::Fault(message) => out.write_str(message),
            Stop::Object(failure) => failure.fmt(out),
            Stop::Reported | Stop::ReaderGone => Ok(()),
        }
    }
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Stop::Object(failure)
    }
}
