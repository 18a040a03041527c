//! The errors of the tool, and the exit status that scripts see.

use std::fmt;

use datafusion::error::DataFusionError;

/// The reason why the tool stops.
#[derive(Debug)]
pub enum Failure {
    /// arguments, a query or a model are wrong: status 2
    Input(String),
    /// the engine, a file or the network failed: status 1
    Engine(String),
    /// the reader of standard output has closed it: status 0
    ReaderGone,
}

impl Failure {
    /// The exit status.
    pub fn status(&self) -> u8 {
        match self {
            Self::Input(_) => 2,
            Self::Engine(_) => 1,
            Self::ReaderGone => 0,
        }
    }

    /// A file that cannot be read or written.
    pub fn file(path: &std::path::Path, what: &str, error: impl fmt::Display) -> Self {
        Self::Engine(format!("cannot {what} {}: {error}", path.display()))
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Input(message) | Self::Engine(message) => out.write_str(message),
            Self::ReaderGone => out.write_str("the output is read no further"),
        }
    }
}

impl std::error::Error for Failure {}

impl From<DataFusionError> for Failure {
    fn from(error: DataFusionError) -> Self {
        let message = error.strip_backtrace();
        match error.find_root() {
            DataFusionError::Plan(_) | DataFusionError::SchemaError(..) | DataFusionError::SQL(..) => {
                Self::Input(message)
            }
            _ => Self::Engine(message),
        }
    }
}
