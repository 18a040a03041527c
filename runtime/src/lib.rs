//! Equations of motion of mechanisms, and their frictional impacts and contacts in three dimensions.
//!
//! A *model file* describes a mechanism: bodies, joints, constraints, loads and contacts. [`mechanism!`]
//! makes a Rust module of it at compile time, generic over the scalar, which allocates nothing and does not
//! panic:
//!
//! ```ignore
//! hodograph::mechanism!("models/pendulum.mech");
//!
//! use hodograph::{CollisionError, Law, Surface};
//! use pendulum::{Coordinates, Pendulum, Speeds};
//!
//! /// The speed with which the tip leaves the wall.
//! fn bounce(q1: f64, u1: f64) -> Result<f64, CollisionError<f64>> {
//!     let surface = Surface { mu: 0.3, e: 0.5, law: Law::Poisson };
//!     let hit = Pendulum::default().collide_tip_wall(&Coordinates { q1 }, &Speeds { u1 }, &surface)?;
//!     Ok(hit.speeds.u1)
//! }
//! ```
//!
//! | to | use |
//! | --- | --- |
//! | make a module of a model | [`mechanism!`] |
//! | write one integrator, controller or plot for all mechanisms | the traits [`Mechanism`] and [`Contacts`] |
//! | solve a collision without a model | [`solve`], [`impact_without_collision`], [`structure`] |
//! | follow a collision | [`Hodograph`], [`Phases`] |
//! | differentiate a collision | [`derivative`], [`derivative_without_collision`], [`saltation`] |
//! | find mode and force of a lasting contact | [`contact_mode`], [`contact_force`] |
//!
//! [`solve`] takes the reduced mass matrix of a contact and the velocity of approach, and returns the impulse
//! and the velocity of separation in three dimensions, under Coulomb's law of friction and Newton's,
//! Poisson's or Stronge's hypothesis of restitution:
//!
//! ```
//! use hodograph::nalgebra::Vector3;
//! use hodograph::{Law, ReducedMatrix, Surface, solve};
//!
//! let matrix = ReducedMatrix::new(0.25, -0.125, 0.0, 0.5, 0.0, 0.5); // 1/kg, along n, t, s
//! let approach = Vector3::new(-1.0, 0.5, 0.0); // m/s
//! let impact = solve(&matrix, &approach, &Surface { mu: 0.5, e: 0.5, law: Law::Poisson })?;
//! assert!(impact.velocity.x > 0.0 && impact.contact_work < 0.0);
//! # Ok::<(), hodograph::ImpactError<f64>>(())
//! ```
//!
//! Equation numbers such as (34) in these pages are those of Djerassi, *Three-dimensional, one-point
//! collision with friction* (2012), "the paper".
//!
//! # What may change
//!
//! [`nalgebra`] is re-exported because its types stand in signatures: use `hodograph::nalgebra` and its
//! version always fits; a new incompatible version of it is a new incompatible version of this crate. The
//! module `generated` is hidden: it serves code that [`mechanism!`] makes, and its contents may change in any
//! version; generated code names the format it needs, and does not compile with a runtime of another one.
#![no_std]
#[cfg(feature = "std")]
extern crate std;

mod cause;
mod characteristics;
mod contact;
mod derivative;
mod dual;
mod error;
#[doc(hidden)]
pub mod generated;
mod hodograph;
mod impact;
#[cfg(feature = "lanes")]
pub mod lanes;
mod law;
mod mechanism;
#[cfg(feature = "std")]
pub mod methods;
mod number;
mod phases;
mod phi_bar;
mod reduced;
mod saltation;
mod scalar;
mod sensitivity;
pub mod several;
mod solve;
mod specialised;
pub mod structure;
mod surface;
mod table;
mod tangential_block;

pub use crate::{
    cause::Cause,
    characteristics::{Characteristics, Renewal, rates},
    contact::{
        ContactError, ContactForce, ContactMode, Margins, Selection, contact_force, contact_mode,
        contact_mode_after,
    },
    derivative::{ImpactDerivative, NonSmoothness, derivative, derivative_without_collision},
    error::{ImpactError, UnknownLaw, Violation},
    hodograph::{Hodograph, snapshot_at},
    impact::{Impact, Path, energy_gained},
    law::{Law, UnknownName},
    mechanism::{
        ClosedContactError, ClosedContacts, CollisionError, CollisionOutcome, Component, ComponentKind,
        ContactOutcome, ContactState, Contacts, Distance, Mechanism, ParameterError, RelativeRotation, State,
        StateError,
    },
    number::Number,
    phases::{Motion, Phases, Snapshot},
    phi_bar::{invariant_directions, phi_bar},
    reduced::ReducedMatrix,
    saltation::{Saltation, saltation, speed_derivative},
    scalar::Scalar,
    sensitivity::Sensitivity,
    solve::{impact_without_collision, solve},
    surface::{Budgeted, ContactSurface, StatedLaw, Surface},
};

pub use nalgebra;

#[doc(hidden)]
pub use hodograph_macros::mechanism as __mechanism;

/// Makes a module of a model: `mechanism!("models/two_sleds.mech")`, or the model itself between braces.
///
/// The path is relative to the invoking crate's Cargo.toml; if nothing is there, to the invoking source file.
/// The file's stem is the module's name (for an inline model the snake_case of the mechanism's name). The
/// derivation beside the model, written by `hodograph derive` and checked in, is read; without it, the
/// feature `derive` derives while compiling.
#[macro_export]
macro_rules! mechanism {
    ($($model:tt)*) => {
        $crate::__mechanism! { ($crate) $($model)* }
    };
}
