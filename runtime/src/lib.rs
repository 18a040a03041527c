//! Impact with friction in three dimensions.
//!
//! [`solve`] takes the reduced mass matrix of a contact and the velocity of approach, and returns the impulse and the velocity
//! of separation under Coulomb's law of friction and Newton's, Poisson's or Stronge's hypothesis of restitution. The equation numbers in these
//! pages are those of Djerassi, *Three-dimensional, one-point collision with friction* (2012).
#![no_std]
#[cfg(feature = "std")]
extern crate std;

mod characteristics;
mod contact;
mod derivative;
mod dual;
mod error;
#[doc(hidden)]
pub mod generated;
mod hodograph;
mod impact;
mod law;
mod mechanism;
#[cfg(feature = "std")]
pub mod methods;
mod phases;
mod phi_bar;
mod reduced;
mod saltation;
mod scalar;
mod sensitivity;
mod solve;
pub mod structure;
mod surface;

pub use crate::{
    characteristics::{Characteristics, Renewal, rates},
    contact::{
        ContactError, ContactForce, ContactMode, Margins, Selection, contact_force, contact_mode,
        contact_mode_after,
    },
    derivative::{ImpactDerivative, NonSmoothness, derivative},
    error::{ImpactError, Violation},
    generated::{CollisionError, ParameterError, StateError},
    hodograph::Hodograph,
    impact::{Impact, Path},
    law::Law,
    mechanism::{CollisionOutcome, Component, ContactState, Contacts, Kind, Mechanism, State},
    phases::{Motion, Phases, Snapshot},
    phi_bar::phi_bar,
    reduced::ReducedMatrix,
    saltation::{Saltation, saltation, speed_derivative},
    scalar::Scalar,
    sensitivity::Sensitivity,
    solve::{impact_without_collision, solve},
    surface::Surface,
};

#[doc(hidden)]
pub use nalgebra;

#[doc(hidden)]
pub use hodograph_macros::mechanism as __mechanism;

/// Makes a module of a model: `mechanism!("models/two_sleds.mech")`, or the model itself between braces.
///
/// The path is relative to the invoking crate's Cargo.toml; if nothing is there, to the invoking source file. The file's stem is
/// the module's name (for an inline model the snake_case of the mechanism's name). The derivation beside the model, written by
/// `hodograph derive` and checked in, is read; without it, the feature `derive` derives while compiling.
#[macro_export]
macro_rules! mechanism {
    ($($model:tt)*) => {
        $crate::__mechanism! { ($crate) $($model)* }
    };
}
