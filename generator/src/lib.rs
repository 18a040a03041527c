//! From the text of a model to Rust code, in stages:
//!
//! ```text
//! source text -> syntax      tokens and an untyped tree, with the place of everything
//!             -> model       names resolved, dimensions checked, all mistakes collected
//!             -> check       the model as a whole, counted and in numbers
//!             -> kinematics  frames, points, velocities, contact bases            (feature `derive`)
//!             -> kane        partial velocities, generalized forces, constraints  (feature `derive`)
//!             -> program     straight-line operations: shared, hoisted, factorised
//!             -> emit        Rust tokens
//!              | interpret   numbers
//!              | explain     equations to read
//!              | artifact    the checked-in derivation
//!              | expand      what `mechanism!` becomes: all of this in the compiler
//! ```
//!
//! Only `algebra` (feature `derive`) names the algebra engine; everything else builds without it.

#[cfg(feature = "derive")]
pub mod algebra;
pub mod arithmetic;
pub mod artifact;
pub mod check;
mod compiler;
pub mod diagnostics;
mod dimension;
pub mod emit;
pub mod expand;
pub mod explain;
pub mod explanations;
pub mod interpret;
#[cfg(feature = "derive")]
mod kane;
#[cfg(feature = "derive")]
mod kinematics;
mod letters;
pub mod model;
mod number;
pub mod numeric;
pub mod program;
pub mod reading;
pub mod rendering;
pub mod rust_names;
pub mod source;
mod span;
pub mod suggest;
pub mod syntax;
mod vocabulary;

#[cfg(feature = "derive")]
pub use kane::{DerivationError, derive};
