//! A motion as programs in C follow it: from event to event, with inputs that they change.
//!
//! The functions of C stand in the crates that `hodograph export --c` writes; what they do is here, in safe
//! code.

use std::ffi::{CStr, CString};
use std::sync::Arc;

use hodograph::{Cause, ComponentKind, Contacts, State, Surface};
use hodograph_simulation::{Event, EventKind, Options, Progress, Simulation, SimulationError};

use crate::running::Running;
use crate::words::Told;

/// [`Motion::advance`] came to the time asked for.
pub const REACHED: i32 = 0;
/// [`Motion::advance`] came to an event.
pub const EVENT: i32 = 1;
/// The motion refuses a call, or goes no further: [`Motion::message`] says why.
pub const REFUSED: i32 = -1;

/// An event as C has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionEvent {
    /// s
    pub time: f64,
    /// change of kinetic energy of an impact, J; zero of others
    pub energy_change: f64,
    /// impulse of a collision on the striking point along N.x, N.y, N.z, N s; zero of others
    pub impulse_on_point: [f64; 3],
    /// number of the kind, its place in [`EventKind::NAMES`]
    pub kind: i32,
    /// number of the contact; -1 where it is about none, or about several
    pub contact: i32,
}

/// What a motion begins with.
#[derive(Clone, Debug)]
pub struct Start<'a> {
    /// the state
    pub state: State<'a>,
    /// the surfaces of all contacts
    pub surfaces: &'a [Surface<f64>],
    /// relative and absolute tolerance of the integration
    pub tolerance: f64,
    /// greatest step of the integration, s
    pub max_step: f64,
}

/// A motion under way, or why it cannot begin.
pub struct Motion {
    running: Option<Running>,
    message: CString,
}

impl Motion {
    /// A motion that begins there; where it cannot, [`Motion::has_begun`] is false and [`Motion::message`]
    /// says why.
    pub fn begin(mechanism: Arc<dyn Contacts<f64>>, start: &Start<'_>) -> Self {
        // Contacts without a gap never close, and a simulation takes no surfaces of them.
        let can_close = |&(contact, _): &(usize, Surface<f64>)| {
            matches!(mechanism.gap(contact, &start.state), Ok(Some(_)) | Err(_))
        };
        let options = Options {
            relative_tolerance: start.tolerance,
            absolute_tolerance: start.tolerance,
            max_step: start.max_step,
            surfaces: start.surfaces.iter().copied().enumerate().filter(can_close).collect(),
            ..Options::default()
        };
        match Running::begin(Arc::clone(&mechanism), &start.state, options) {
            Ok(running) => Motion { running: Some(running), message: CString::default() },
            Err(error) => Motion { running: None, message: message(&error.told()) },
        }
    }

    /// Whether the motion could begin.
    pub fn has_begun(&self) -> bool {
        self.running.is_some()
    }

    /// Why the motion did not begin, or what was wrong with the last call that changes it or asks for forces;
    /// empty where nothing was.
    pub fn message(&self) -> &CStr {
        &self.message
    }

    /// Asks the simulation, and keeps what it refuses.
    fn ask<R>(&mut self, ask: impl FnOnce(&mut Simulation<'_>) -> Result<R, SimulationError>) -> Option<R> {
        let answer = self.running.as_mut()?.with(ask);
        self.message = answer.as_ref().err().map_or_else(CString::default, |error| message(&error.told()));
        answer.ok()
    }

    /// Advances to an event or to a time (s), whichever comes first, and no further: inputs may be changed
    /// there. Answers [`REACHED`], [`EVENT`] with the event, or [`REFUSED`].
    pub fn advance(&mut self, until: f64) -> (i32, Option<MotionEvent>) {
        match self.ask(|simulation| simulation.advance_exactly(until)) {
            Some(Progress::Reached) => (REACHED, None),
            Some(Progress::Event(event)) => (EVENT, Some(told(&event))),
            None => (REFUSED, None),
        }
    }

    /// Changes the held inputs; false where they are refused, and then nothing changes.
    pub fn set_inputs(&mut self, inputs: &[f64]) -> bool {
        self.ask(|simulation| simulation.set_inputs(inputs)).is_some()
    }

    /// The time reached, s; not a number where the motion never began.
    pub fn time(&self) -> f64 {
        self.running.as_ref().map_or(f64::NAN, |running| running.simulation().time())
    }

    /// Writes coordinates and independent speeds at that time; false where the motion never began.
    pub fn state(&self, coordinates: &mut [f64], speeds: &mut [f64]) -> bool {
        let Some(running) = &self.running else { return false };
        let simulation = running.simulation();
        coordinates.iter_mut().zip(simulation.coordinates()).for_each(|(to, from)| *to = *from);
        speeds.iter_mut().zip(simulation.speeds()).for_each(|(to, from)| *to = *from);
        true
    }

    /// The force of a contact on its striking point along its n, t, s, N; zero where it is open. `None` where
    /// there is no such contact, or no forces.
    pub fn contact_force(&mut self, contact: i32) -> Option<[f64; 3]> {
        let count = self.running.as_ref()?.mechanism().count(ComponentKind::Contact);
        let Some(contact) = usize::try_from(contact).ok().filter(|contact| *contact < count) else {
            let cause = Cause::UnknownName.name();
            self.message =
                message(&format!("{cause}: there is no contact {contact}: the mechanism has {count}"));
            return None;
        };
        let (forces, _) = self.ask(|simulation| simulation.contact_forces())?;
        let force = forces.iter().find(|(other, _)| *other == contact);
        Some(force.map_or([0.0; 3], |(_, force)| (*force).into()))
    }
}

/// A text as C has it.
fn message(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// The event as C has it.
fn told(event: &Event) -> MotionEvent {
    let kind = EventKind::NAMES.iter().position(|kind| *kind == event.kind.name());
    let (energy_change, impulse_on_point) = match &event.kind {
        EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) => {
            (struck.outcome.energy_change, struck.outcome.impulse_on_point.into())
        }
        EventKind::SimultaneousCollision(struck) => (struck.energy_change, [0.0; 3]),
        _ => (0.0, [0.0; 3]),
    };
    let number = |index: Option<usize>| index.and_then(|index| i32::try_from(index).ok()).unwrap_or(-1);
    MotionEvent {
        time: event.time,
        energy_change,
        impulse_on_point,
        kind: number(kind),
        contact: number(event.contact),
    }
}
