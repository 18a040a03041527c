//! The error object: `{"error":{"kind":"..","message":".."}}`.

use std::fmt;

use hodograph::methods::MethodError;
use hodograph::{CollisionError, ImpactError, StateError};
use serde::Serialize;

/// What kind of error it is: the stable names of the contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// no JSON, or JSON of another shape than asked for
    BadJson,
    /// a field that is needed is not there
    MissingField,
    /// a name that the model does not have, or that must not be given here
    UnknownName,
    /// a number that is infinite or not a number
    NotFinite,
    /// friction below zero
    NegativeFriction,
    /// restitution outside [0, 1]
    RestitutionOutOfRange,
    /// the bodies do not approach
    NotApproaching,
    /// the reduced matrix belongs to no mechanism
    NotPositiveSemidefinite,
    /// no impulse along the normal moves the contact
    NoNormalMobility,
    /// no outcome exists
    Wedged,
    /// no forces are known to exist: a contact that slips jams
    Jam,
    /// no forces were found that obey the laws within their bound
    Unsolved,
    /// rounding forbids an outcome that obeys the laws of impact
    Inaccurate,
    /// the collision needs more quadratures than it may take
    BudgetExceeded,
    /// a method other than the exact one did not come to an end
    Unfinished,
    /// the equations cannot be evaluated in this state
    SingularState,
    /// the coordinates contradict each other
    InconsistentState,
    /// a mass or an inertia that no body has
    ImpossibleBody,
}

/// An error of `solve`, `eval` or `collide`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Failure {
    /// what kind
    pub kind: Kind,
    /// what is wrong and what to do
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

    /// JSON of another shape than asked for.
    pub fn bad_json(message: impl Into<String>) -> Self {
        Self::new(Kind::BadJson, message)
    }

    /// The line to write.
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
        let kind = match error {
            ImpactError::NegativeFriction { .. } => Kind::NegativeFriction,
            ImpactError::RestitutionOutOfRange { .. } => Kind::RestitutionOutOfRange,
            ImpactError::NotApproaching { .. } => Kind::NotApproaching,
            ImpactError::NotPositiveSemidefinite { .. } => Kind::NotPositiveSemidefinite,
            ImpactError::NoNormalMobility { .. } => Kind::NoNormalMobility,
            ImpactError::Wedged { .. } => Kind::Wedged,
            ImpactError::Inaccurate { .. } => Kind::Inaccurate,
            ImpactError::BudgetExceeded { .. } => Kind::BudgetExceeded,
            _ => Kind::NotFinite,
        };
        Failure::new(kind, error.to_string())
    }
}

impl From<StateError> for Failure {
    fn from(error: StateError) -> Self {
        let kind = match error {
            StateError::NotFinite => Kind::NotFinite,
            _ => Kind::SingularState,
        };
        Failure::new(kind, error.to_string())
    }
}

impl From<CollisionError<f64>> for Failure {
    fn from(error: CollisionError<f64>) -> Self {
        match error {
            CollisionError::State(error) => error.into(),
            CollisionError::Impact(error) => error.into(),
            error => Failure::new(Kind::SingularState, error.to_string()),
        }
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
