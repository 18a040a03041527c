//! Mechanisms as functional mock-up units of FMI 3.0, for model exchange and co-simulation.
//!
//! [`export!`] gives a shared library (`crate-type = ["cdylib"]`) that holds a generated module the functions of the
//! standard, and [`description`] writes the `modelDescription.xml` beside it. Both number the variables by one
//! [`Layout`]. `hodograph export --fmu` writes, builds and packs all of it; docs/fmu.md says what a unit has and how it is
//! used.
//!
//! ```ignore
//! mod mechanism; // the generated module
//! hodograph_fmu::export!(
//!     TwoSleds in crate::mechanism,
//!     token = "..",
//!     defaults = hodograph_fmu::Defaults { max_step: f64::INFINITY, surfaces: &[(0, 0.6, 0.8, "stronge")] }
//! );
//! ```
//!
//! Motion is that of `hodograph-simulation`: co-simulation advances it, model exchange asks it for rates and indicators and
//! leaves to it what happens at an event. Safe code computes ([`Instance`]); `unsafe` is in `abi`, where numbers come from C
//! and go to it, in `running`, which keeps a mechanism beside the simulation that borrows it, and in the symbols of
//! [`export!`].

#![deny(unsafe_code)]

#[doc(hidden)]
#[allow(unsafe_code)]
pub mod abi;
mod derivative;
mod description;
mod image;
mod instance;
mod layout;
#[allow(unsafe_code)]
mod running;
mod settings;
mod symbols;
mod values;

pub use description::{description, escaped};
pub use instance::{Instance, Kind, Refusal};
pub use layout::{Defaults, Layout, Variable, What};

#[doc(hidden)]
pub use hodograph::Contacts;
