//! Evaluates a mechanism numerically at one state, without algebra. It is an independent check of the derived
//! equations, and `check` finds mistakes with it that only numbers show.
//!
//! Positions and orientations are evaluated with numbers that carry derivatives, velocities are their rates,
//! accelerations the rates of velocities; rates of coordinates and dependent speeds are solved for
//! numerically. Everything is in SI units but quantities that the model declares in another unit, which are
//! counted in that unit.

mod assembly;
mod balance;
mod dynamics;
mod evaluator;
pub mod hyper_dual;
mod linear_system;
mod loops;
mod motion;
pub mod start;
mod state;
pub mod views;

pub use assembly::{assemble, configuration_slopes};
pub use dynamics::{SINGULAR, central_inertia, evaluate, evaluate_views, own_inertia};
pub use evaluator::{Evaluator, Level};
pub use linear_system::{rank, singular_column};
pub use loops::held_together;
pub use motion::{constraint_coefficients, constraint_rank, determining_coefficients};
pub use state::{ContactEvaluation, Evaluation, Failure, State, TurningEvaluation};
pub use views::Views;
