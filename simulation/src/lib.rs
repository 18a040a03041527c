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

mod closed;
pub mod contact_problem;
mod events;
mod exchange;
mod exchange_events;
mod impact;
mod integration;
mod interface;
mod many;
mod modes;
mod outcome_set;
pub mod random;
mod simulation;
mod state;

#[cfg(feature = "serde")]
pub use crate::exchange::Saved;
pub use crate::{
    closed::{pair::MOST_FRICTION, phase::ContactPhase},
    exchange::{Indicator, IndicatorKind},
    integration::{drift::close_loops, stepper},
    interface::{
        contact_law::{ContactLaw, Restitution, Sliding, SpeedFunction},
        drive::{Controller, Drive, InputFunction, Samples},
        error::{ErrorKind, SimulationError},
        event::{CollisionRecord, Event, EventKind, Share, SimultaneousCollision},
        given_law::GivenLaw,
        options::{EventFunction, ImpactsAtOnce, Options},
        sample_times::sample_times,
    },
    many::{Batch, Case, Outcome, StopAt, Watch, digest, simulate_many},
    outcome_set::{End, OutcomeSet, Range},
    simulation::{ContactForces, Progress, Simulation},
    state::{
        energy::EnergyAccount,
        smooth_parts::{ClosedPart, Guard, SmoothPart},
    },
};
