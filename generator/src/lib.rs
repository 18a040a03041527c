//! From the text of a model to Rust code, in stages:
//!
//! ```text
//! source text -> syntax      tokens and an untyped tree, with the place of everything
//!             -> model       names resolved, dimensions and physics checked, all mistakes collected
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
pub mod artifact;
mod compiler;
pub mod diagnostics;
pub mod emit;
pub mod expand;
pub mod explain;
pub mod interpret;
#[cfg(feature = "derive")]
pub mod kane;
#[cfg(feature = "derive")]
pub mod kinematics;
pub mod model;
pub mod number;
pub mod numeric;
pub mod program;
pub mod reading;
pub mod source;
pub mod syntax;

#[cfg(feature = "derive")]
pub use kane::{DerivationError, derive};
