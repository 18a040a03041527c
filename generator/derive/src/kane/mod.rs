//! Derives Kane's equations: mass matrix, generalised forces, elimination of constraints, contacts; written
//! as a graph of values.

pub mod accelerations;
pub mod articulated;
pub mod base_parameters;
pub mod bodies;
mod bounds;
pub mod contacts;
pub mod elimination_order;
pub mod energy;
pub mod forces;
pub mod inertia;
mod matrix;
mod momentum;
mod outputs;
mod products;
mod samples;
mod sums;

use crate::algebra::{SessionError, exclusively};
use crate::kinematics::{DeriveError, Kinematics};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_program::program::Derived;

/// Why a mechanism could not be derived.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DerivationError {
    /// the model does not permit it
    Model(DeriveError),
    /// the algebra engine could not be used
    Session(SessionError),
}

impl std::fmt::Display for DerivationError {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            DerivationError::Model(error) => error.fmt(out),
            DerivationError::Session(error) => error.fmt(out),
        }
    }
}

impl std::error::Error for DerivationError {}

/// Derives the equations of a mechanism: waits for its turn at the algebra engine and works there on a thread
/// of its own.
pub fn derive(mechanism: &Mechanism) -> Result<Derived, DerivationError> {
    let mechanism = mechanism.clone();
    match exclusively(move || {
        let mut kinematics = Kinematics::new(&mechanism)?;
        let derived = outputs::write(&mut kinematics);
        kinematics.mistake.map_or(Ok(derived), Err)
    }) {
        Ok(result) => result.map_err(DerivationError::Model),
        Err(error) => Err(DerivationError::Session(error)),
    }
}
