//! Loads mechanisms at run time: a model file and its derivation become an [`InterpretedMechanism`], which
//! implements the traits [`Mechanism`](hodograph::Mechanism) and [`Contacts`](hodograph::Contacts) as
//! generated modules do.
//!
//! Its numbers have the same bits as those of the generated module. So a program that works on many models,
//! or is called from another language, needs no compiler.
//!
//! [`columns`] evaluates many states at once. A [`NumericMechanism`] needs the model alone, and is slower.
//!
//! ```no_run
//! use hodograph::{ComponentKind, Mechanism};
//! use hodograph_interpreter::InterpretedMechanism;
//!
//! let pendulum = InterpretedMechanism::read("models/pendulum.mech".as_ref())?;
//! println!("{} has {} speeds", pendulum.name(), pendulum.count(ComponentKind::Speed));
//! # Ok::<(), hodograph_interpreter::Error>(())
//! ```

pub mod columns;
mod contacts;
mod description;
mod error;
mod intern;
mod interpreted;
mod mechanism;
pub mod motion;
mod numeric;
mod parameters;
mod routines;

pub use error::Error;
pub use interpreted::InterpretedMechanism;
pub use numeric::NumericMechanism;
