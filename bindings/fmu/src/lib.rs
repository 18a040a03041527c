//! Mechanisms as functional mock-up units of FMI 3.0, for model exchange and co-simulation.
//!
//! [`export!`] generates the functions of the standard in a shared library (`crate-type = ["cdylib"]`) with a
//! generated module, and [`description`] writes its `modelDescription.xml`. Both use the same numbers of
//! variables, those of a [`Layout`]. `hodograph export --fmu` writes, builds and packs all of it; docs/fmu.md
//! describes the content and the use of a unit.
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
//! Motion is that of `hodograph-simulation`. Co-simulation advances it; model exchange reads rates and
//! indicators from it, and lets it handle events. Computations are safe code ([`Instance`]); `unsafe` is used
//! in `abi`, where data come from C and return to it, in `running`, which stores a mechanism together with
//! the simulation that borrows it, and in the symbols of [`export!`].
//!
//! [`motion`] is that of the libraries which `hodograph export --c` writes.

#![deny(unsafe_code)]

#[doc(hidden)]
#[allow(unsafe_code)]
pub mod abi;
mod derivative;
mod description;
mod image;
mod instance;
mod layout;
pub mod motion;
#[allow(unsafe_code)]
mod running;
mod settings;
mod symbols;
mod values;
mod words;

pub use description::{description, escaped};
pub use instance::{Instance, Kind, Refusal};
pub use layout::{Defaults, Layout, Variable, VariableKind};

#[doc(hidden)]
pub use hodograph::Contacts;
