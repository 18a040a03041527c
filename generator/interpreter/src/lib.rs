//! Mechanisms at run time: a model file and its derivation become an [`InterpretedMechanism`], which has the traits
//! [`Mechanism`](hodograph::Mechanism) and [`Contacts`](hodograph::Contacts) as generated modules have. The numbers are the same to the last
//! bit, so that whoever sweeps over models, or comes from another language, needs no compiler.
//!
//! ```no_run
//! use hodograph::{Kind, Mechanism};
//! use hodograph_interpreter::InterpretedMechanism;
//!
//! let pendulum = InterpretedMechanism::read("models/pendulum.mech".as_ref())?;
//! println!("{} has {} speeds", pendulum.name(), pendulum.count(Kind::Speed));
//! # Ok::<(), hodograph_interpreter::Error>(())
//! ```

mod contacts;
mod error;
mod intern;
mod interpreted;
mod mechanism;
mod parameters;
mod routines;

pub use error::Error;
pub use interpreted::InterpretedMechanism;
