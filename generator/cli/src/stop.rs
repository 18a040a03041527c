//! The errors of commands, with messages and exit codes.

use std::fmt;

use crate::json::Failure;

/// Why a command stopped.
#[derive(Clone, Debug)]
pub enum Stop {
    /// The call was wrong (a missing file, say): reported on standard error, exit 2.
    Call(String),
    /// The work failed: reported on standard error, exit 1.
    Fault(String),
    /// An error object on standard output, exit 1.
    Object(Failure),
    /// The error has been reported already: exit 1.
    Reported,
    /// The reader of standard output has closed the pipe: exit 0, without a message.
    ReaderGone,
}

/// What commands return.
pub type Outcome<T = ()> = Result<T, Stop>;

impl Stop {
    /// The error of a file that cannot be read.
    pub fn unreadable(path: &std::path::Path, error: &std::io::Error) -> Self {
        Stop::Call(format!("cannot read {}: {error}", path.display()))
    }

    /// The error of a file that cannot be written.
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
