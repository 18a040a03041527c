//! Motion of mechanisms with exact impacts and contact that lasts.
//!
//! [`Simulation`] follows a motion from event to event: between events it integrates the equations of motion with the forces of the contacts that
//! are closed, which follow from their modes (stick, slide) exactly; impacts are solved exactly. Nothing is penalised, nothing creeps, and what rigid
//! bodies do not determine is said. See `docs/contact.md`.
//!
//! It works for everything that implements [`hodograph::Contacts`]: generated modules, and the interpreter of the command line tool.

mod check;
mod choose;
mod drift;
mod drive;
mod due;
mod energy;
mod error;
mod event;
mod forces;
mod front;
mod happen;
mod locate;
mod motion;
mod options;
mod phase;
mod proceed;
mod rattle;
mod settle;
mod settled;
mod simulation;
mod slip_direction;
mod slip_end;
mod stepper;
mod strike;
mod support;
mod watch;

pub use crate::{
    drive::{Controller, Drive, InputFunction},
    energy::EnergyAccount,
    error::{Reason, SimulationError},
    event::{Event, EventKind, Struck},
    options::{EventFunction, Options, Together},
    phase::ContactPhase,
    simulation::{ContactForces, Progress, Simulation},
};
