//! Simulates the motion of mechanisms with impacts and lasting contact.
//!
//! [`Simulation`] follows a motion from event to event. Between events it integrates the equations of motion with the forces of the closed contacts, which
//! follow exactly from their modes (stick, slide). Impacts are solved exactly. There is no penalty stiffness, and a sticking contact does not creep; where
//! rigid bodies do not determine an outcome, the event says so. See `docs/contact.md`.
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
