//! Derivatives of motions: of the state at any time, and of the times of events and the states there, with
//! respect to the start state, parameters of the model, constant inputs, mu and e.
//!
//! [`differentiate`] simulates a motion with [`Simulation`](hodograph_simulation::Simulation), then
//! integrates its smooth parts again together with derivatives: variational equations between events,
//! saltation at events. No finite differences are used. Where the motion is not differentiable, the
//! derivatives are `None` from then on, with the reason.
//!
//! ```no_run
//! use hodograph::State;
//! use hodograph_gradients::{By, differentiate};
//! use hodograph_interpreter::InterpretedMechanism;
//! use hodograph_simulation::Options;
//!
//! let ball = InterpretedMechanism::read("ball.mech".as_ref())?;
//! let start = State { time: 0.0, coordinates: &[1.0], speeds: &[0.0], inputs: &[] };
//! let by = [By::named(&ball, "e")?, By::Coordinate(0)];
//! let motion = differentiate(&ball, &start, Options::default(), &by, &[2.0])?;
//! for event in &motion.events {
//!     println!("{} at {} s: {:?}", event.event.kind.name(), event.event.time, event.time);
//! }
//! println!("{:?}", motion.samples[0].derivative);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! [`Adjoint`] finds derivatives of one function of a motion by many variables, at a cost that does not depend on their
//! number.
//!
//! [`find_orbit`] finds periodic motions by these derivatives, with their multipliers, and [`follow_branch`] follows them
//! through a parameter.
//!
//! [`fit()`] fits parameters, mu and e to measured motions, and [`fit_start`] their start states to what was measured before
//! anything is struck.
//!
//! [`validation`] compares predictions with measured motions, and [`statistics`] sums up their errors.
//!
//! Theory: docs/theory.md, sections 19 to 22.

mod adjoint;
mod branch;
mod by;
mod closed;
mod collocation;
mod family;
mod field;
mod fit;
mod fit_task;
mod followed;
mod force_jumps;
mod gaps;
mod held;
mod junction;
mod least_squares;
mod loss;
mod mode_rates;
mod modes;
mod motion;
mod orbit;
mod periodic;
mod shooting;
mod start_state;
pub mod statistics;
mod stiff;
mod trajectory;
mod transposed;
pub mod validation;

pub use adjoint::Adjoint;
pub use branch::{Branch, BranchPoint, Change, ChangeKind, follow_branch};
pub use by::{By, Reason, Undefined};
pub use family::with_values;
pub use fit::{Fit, fit};
pub use fit_task::{FitError, FitTask};
pub use followed::{GradientError, Sample};
pub use loss::Loss;
pub use motion::{EventGradient, MotionGradient, differentiate};
pub use orbit::find_orbit;
pub use periodic::{Exchange, Orbit, OrbitError, Periodic, Return};
pub use start_state::{FittedStart, fit_start};
pub use trajectory::Trajectory;
