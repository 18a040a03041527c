//! Simulates the motion of mechanisms with impacts and lasting contact.
//!
//! [`Simulation`] advances a motion from event to event. Between events it integrates the equations of motion
//! with the forces of the closed contacts, which follow exactly from their modes (stick, slide). Impacts are
//! solved exactly. There is no penalty stiffness, and a sticking contact does not creep; if rigid bodies do
//! not determine an outcome, the event says so. See `docs/contact.md`.
//!
//! It works with every type that implements [`hodograph::Contacts`]: generated modules, and models that the
//! package `hodograph-interpreter` reads at run time.
//!
//! ```
//! use hodograph::{Law, State, Surface};
//! use hodograph_models::slender_rod_5dof::{Coordinates, SlenderRod5dof, Speeds};
//! use hodograph_simulation::{Options, Progress, Simulation};
//!
//! let rod = SlenderRod5dof::<f64>::default();
//! let q: [f64; 5] = Coordinates { z: 2.0, ..Coordinates::default() }.into();
//! let u: [f64; 5] = Speeds::default().into();
//! let start = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
//! let surface = Surface { mu: 0.3, e: 0.5, law: Law::Stronge };
//! let options = Options { surface: Some(surface), ..Options::default() };
//!
//! let mut simulation = Simulation::new(&rod, &start, options)?;
//! while let Progress::Event(event) = simulation.advance(1.0)? {
//!     println!("{} s: {}", event.time, event.kind.name());
//! }
//! assert_eq!(simulation.time(), 1.0);
//! println!("{:?}", simulation.coordinates());
//! # Ok::<(), hodograph_simulation::SimulationError>(())
//! ```

mod angles;
mod broad_phase;
mod check;
mod closed_contacts;
mod commit;
mod contact_law;
pub mod contact_problem;
mod drift;
mod drive;
mod driven_inputs;
mod ends;
mod energy;
mod error;
mod event;
mod event_functions;
mod event_handling;
mod event_location;
mod event_time;
mod exchange;
mod exchange_events;
mod force_functions;
mod forces;
mod front;
mod given_law;
mod impact_at_once;
mod impact_without_collision;
mod impacts;
mod lengths;
mod look_ahead;
mod lzb;
mod many;
mod mode_changes;
mod mode_selection;
mod motion;
mod options;
mod outcome_set;
mod pair;
mod past_jam;
mod phase;
mod poisson_at_once;
pub mod random;
mod rattling;
mod scales;
mod scheduled_events;
mod settled_direction;
mod settled_slip;
mod signed_slip;
mod simulation;
mod simultaneous_impacts;
mod single_impact;
mod singular;
mod slip_direction;
mod slip_end;
mod smooth_parts;
mod stage_values;
mod start;
pub mod stepper;
mod time_step;
mod torque_modes;
mod torques;
mod transition;
mod watched;

#[cfg(feature = "serde")]
pub use crate::exchange::Saved;
pub use crate::{
    contact_law::{ContactLaw, Restitution, Sliding, SpeedFunction},
    drift::close_loops,
    drive::{Controller, Drive, InputFunction, Samples},
    energy::EnergyAccount,
    error::{ErrorKind, SimulationError},
    event::{CollisionRecord, Event, EventKind, Share, SimultaneousCollision},
    exchange::{Indicator, IndicatorKind},
    given_law::GivenLaw,
    many::{Batch, Case, Outcome, StopAt, Watch, digest, simulate_many},
    options::{EventFunction, ImpactsAtOnce, Options},
    outcome_set::{End, OutcomeSet, Range},
    pair::MOST_FRICTION,
    phase::ContactPhase,
    simulation::{ContactForces, Progress, Simulation},
    smooth_parts::{ClosedPart, Guard, SmoothPart},
};
