//! Loads mechanisms at run time: a model file and its derivation become an [`InterpretedMechanism`], which
//! implements the traits [`Mechanism`](hodograph::Mechanism) and [`Contacts`](hodograph::Contacts) as
//! generated modules do.
//!
//! Its numbers have the same bits as those of the generated module. So a program that works on many models,
//! or is called from another language, needs no compiler.
//!
//! A [`NumericMechanism`] needs the model alone, and is slower.
//!
//! With the feature `internal` the other packages of Hodograph reach the model and the equations, and evaluate
//! many states at once (`columns`). The types that this shows belong to packages that promise nothing from
//! version to version.
//!
//! ```no_run
//! use hodograph::{ComponentKind, Mechanism};
//! use hodograph_interpreter::InterpretedMechanism;
//!
//! let pendulum = InterpretedMechanism::read("models/pendulum.mech".as_ref())?;
//! println!("{} has {} speeds", pendulum.name(), pendulum.count(ComponentKind::Speed));
//! # Ok::<(), hodograph_interpreter::Error>(())
//! ```

#[cfg(feature = "internal")]
pub mod columns;
mod contacts;
mod description;
mod error;
mod intern;
#[cfg(feature = "internal")]
mod internal;
mod interpreted;
mod mechanism;
pub mod motion;
mod numeric;
mod parameters;
mod read;
mod routines;

pub use error::Error;
pub use interpreted::InterpretedMechanism;
pub use numeric::NumericMechanism;
