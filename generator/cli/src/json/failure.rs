//! The error object: `{"error":{"kind":"..","message":".."}}`.

use std::fmt;

use hodograph::methods::MethodError;
use hodograph::{Cause, CollisionError, ImpactError, StateError};
use serde::{Serialize, Serializer};

/// The kinds of errors: the stable names that `docs/json.md` lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// the text is not JSON, or has another form than expected
    BadJson,
    /// a required field is missing
    MissingField,
    /// a name that the model does not have, or that must not be given here
    UnknownName,
    /// no forces that obey the laws were found within the bound of the work
    Unsolved,
    /// a method other than `exact` did not converge
    Unfinished,
    /// a motion that is to be differentiated, repeated or fitted ends with an error, or has no derivative
    FailedMotion,
    /// there is no periodic motion near the start
    NotFound,
    /// the coordinates contradict each other
    InconsistentState,
    /// a cause of the runtime, by its name
    Of(Cause),
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::BadJson => "bad_json",
            Self::MissingField => "missing_field",
            Self::UnknownName => "unknown_name",
            Self::Unsolved => "unsolved",
            Self::Unfinished => "unfinished",
            Self::FailedMotion => "failed_motion",
            Self::NotFound => "not_found",
            Self::InconsistentState => "inconsistent_state",
            Self::Of(cause) => cause.name(),
        }
    }
}

impl Serialize for Kind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// An error of a command that answers in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// the kind of the error
    pub kind: Kind,
    /// what is wrong, and what to do
    pub message: String,
}

#[derive(Serialize)]
struct Object<'a> {
    error: &'a Failure,
}

impl Failure {
    /// An error of a kind.
    pub fn new(kind: Kind, message: impl Into<String>) -> Self {
        Failure { kind, message: message.into() }
    }

    /// An error of JSON of another form than expected.
    pub fn bad_json(message: impl Into<String>) -> Self {
        Self::new(Kind::BadJson, message)
    }

    /// The error object as a line.
    pub fn to_line(&self) -> String {
        serde_json::to_string(&Object { error: self }).unwrap_or_default()
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(&self.message)
    }
}

impl From<ImpactError<f64>> for Failure {
    fn from(error: ImpactError<f64>) -> Self {
        Failure::new(Kind::Of(error.cause()), error.to_string())
    }
}

impl From<StateError> for Failure {
    fn from(error: StateError) -> Self {
        Failure::new(Kind::Of(error.cause()), error.to_string())
    }
}

impl From<CollisionError<f64>> for Failure {
    fn from(error: CollisionError<f64>) -> Self {
        Failure::new(Kind::Of(error.cause()), error.to_string())
    }
}

impl From<MethodError> for Failure {
    fn from(error: MethodError) -> Self {
        match error {
            MethodError::Impact(error) => error.into(),
            error => Failure::new(Kind::Unfinished, error.to_string()),
        }
    }
}
