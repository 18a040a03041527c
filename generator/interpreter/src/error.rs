//! The errors of loading a model for interpretation.

use std::fmt;

use hodograph::ParameterError;

/// Why a model and its derivation make no mechanism.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The model has mistakes: the text that `hodograph check` prints.
    Model(String),
    /// The derivation is missing, stale or damaged: what is wrong and what to do.
    Derivation(String),
    /// The parameters are refused.
    Parameters(ParameterError),
    /// The model gives no value for this parameter.
    NoValue(String),
}

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Model(report) => out.write_str(report),
            Error::Derivation(message) => out.write_str(message),
            Error::Parameters(error) => error.fmt(out),
            Error::NoValue(name) => {
                write!(out, "the model gives no value for the parameter {name}: use `with_parameters`")
            }
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Error::Parameters(error) => Some(error),
            Error::Model(_) | Error::Derivation(_) | Error::NoValue(_) => None,
        }
    }
}

impl From<ParameterError> for Error {
    fn from(error: ParameterError) -> Self {
        Error::Parameters(error)
    }
}
