//! Derives Kane's equations of a mechanism.
//!
//! ```text
//! model -> kinematics  frames, points, velocities, contact bases
//!       -> kane        partial velocities, generalised forces, constraints
//!       -> program     (hodograph-program)
//! ```
//!
//! Only `algebra` names the algebra engine.

pub mod algebra;
mod kane;
mod kinematics;

pub use kane::{DerivationError, derive};
