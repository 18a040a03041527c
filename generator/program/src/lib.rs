//! The equations of a mechanism as a straight-line program.
//!
//! ```text
//! program     straight-line operations: shared, hoisted, factorised
//!  | interpret   their numbers
//!  | explain     equations to read
//!  | artifact    the checked-in derivation
//! ```

pub mod artifact;
pub mod explain;
pub mod files;
pub mod interpret;
pub mod program;
