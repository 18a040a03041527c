//! A transition: one step of the motion, or one change of modes, performed on a copy of the front.
//!
//! Everything that changes a motion is a method of [`Transition`]. [`crate::Simulation`] creates one from its
//! front, and accepts its front and its events only if all of it succeeds.

use hodograph::{ComponentKind, State};

use crate::closed::angles::Angles;
use crate::closed::lengths::Lengths;
use crate::closed::pair::{Friction, Pair};
use crate::closed::phase::{Closed, Modes, Phase};
use crate::closed::scales::SIZE;
use crate::closed::torques::WithTorques;
use crate::integration::motion::{Failure, Motion};
use crate::integration::stepper::Step;
use crate::state::front::Front;
use crate::state::smooth_parts::Parts;
use crate::{ErrorKind, Event, EventKind, Options, SimulationError};

/// A front that is being changed, with the resulting events.
pub(crate) struct Transition<'s> {
    pub mechanism: WithTorques<'s>,
    /// the angular speeds and coordinates
    pub angles: &'s Angles,
    /// the units of the coordinates
    pub lengths: &'s Lengths,
    pub options: &'s Options,
    /// the surfaces of each contact; `None` for a contact without a gap
    pub surfaces: &'s [Option<Pair>],
    pub front: Front,
    /// the events so far
    pub events: Vec<Event>,
    /// the steps that led to the front, each with the modes during it: the last of them ends there, and the end of slip,
    /// which is followed separately, is one of its own
    pub steps: Vec<(Step, Modes)>,
    /// the front at the end of the first of them, before its event was handled: the motion is valid up to there even
    /// if the event cannot be handled
    pub reached: Option<Front>,
    /// the smooth parts, if they are recorded
    pub parts: Option<Parts>,
}

/// How far a transition had come before something was tried.
pub(crate) struct Mark {
    pub front: Front,
    events: usize,
    steps: usize,
    parts: usize,
}

impl Transition<'_> {
    /// Where the transition can return to.
    pub(crate) fn mark(&self) -> Mark {
        Mark {
            front: self.front.clone(),
            events: self.events.len(),
            steps: self.steps.len(),
            parts: self.parts.as_ref().map_or(0, Parts::count),
        }
    }

    /// Takes back all that was tried since.
    pub(crate) fn return_to(&mut self, mark: &Mark) {
        self.front.clone_from(&mark.front);
        self.events.truncate(mark.events);
        self.steps.truncate(mark.steps);
        if let Some(parts) = &mut self.parts {
            parts.shorten(mark.parts);
        }
    }

    /// The state at the front.
    pub(crate) fn here(&self) -> State<'_> {
        self.here_of(&self.front)
    }

    /// The state of another front.
    pub(crate) fn here_of<'f>(&self, front: &'f Front) -> State<'f> {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        State { time: front.t, coordinates: &front.y[..n], speeds: &front.y[n..n + p], inputs: &front.held }
    }

    /// The size of the coordinates at the front, m or rad: the greatest, or a small length of the problem.
    pub(crate) fn size_of_coordinates(&self) -> f64 {
        self.lengths.greatest(self.here().coordinates).max(SIZE * self.front.scales.length)
    }

    /// The modes at the front.
    pub(crate) fn modes(&self) -> Modes {
        Modes { closed: self.closed(), held: self.front.held.clone(), resting: self.front.resting }
    }

    /// Records an event with the present state.
    pub(crate) fn push(&mut self, contact: Option<usize>, kind: EventKind) {
        let here = self.here();
        let (coordinates, speeds) = (here.coordinates.to_vec(), here.speeds.to_vec());
        let contact = contact.map(|contact| self.mechanism.contact(contact));
        self.events.push(Event { time: self.front.t, contact, kind, coordinates, speeds });
    }

    /// The closed contacts for the integration.
    pub(crate) fn closed(&self) -> Vec<Closed> {
        self.front
            .phases
            .iter()
            .enumerate()
            .filter_map(|(contact, phase)| {
                let slides = match phase {
                    Phase::Open(_) => return None,
                    Phase::Stick => None,
                    Phase::Slide(direction) => Some(*direction),
                };
                Some(Closed {
                    contact,
                    mu: self.mu_in_mode(contact, slides.is_some()),
                    bounces: self.bounces(contact),
                    omega: slides.and(self.front.omegas[contact]),
                    turning: slides.and(self.front.turnings[contact].clone()),
                    slides,
                })
            })
            .collect()
    }

    /// The surfaces of a contact that has a gap.
    pub(crate) fn pair(&self, contact: usize) -> Option<&Pair> {
        self.surfaces.get(contact).and_then(Option::as_ref)
    }

    /// Whether the bounces of a contact, or of that of a torque, which are now lower than the tolerance, have not
    /// yet ended.
    pub(crate) fn bounces(&self, contact: usize) -> bool {
        let own = self.mechanism.contact(contact);
        self.front.chatter.iter().any(|&(time, other)| other == own && time > self.front.t)
    }

    /// The friction of a contact while it bounces: that of impacts, which have no torques.
    fn friction_in_impacts(&self, contact: usize) -> Friction {
        self.pair(contact).map_or(Friction::NONE, |pair| Friction::same(pair.mu_in_impacts()))
    }

    /// The coefficients of friction of a contact at a speed of slip, 0 without slip.
    pub(crate) fn friction(&self, contact: usize, slip: f64) -> Result<Friction, SimulationError> {
        if self.bounces(contact) {
            return Ok(self.friction_in_impacts(contact));
        }
        if let Some(torque) = self.mechanism.torque(contact) {
            return Ok(torque.friction());
        }
        let found = self.pair(contact).map_or(Ok(Friction::NONE), |pair| pair.friction(slip));
        found.map_err(|message| self.error(Some(contact), ErrorKind::BadOption(message)))
    }

    /// The coefficient of a sticking contact, or of one with small slip.
    fn mu_in_mode(&self, contact: usize, slides: bool) -> f64 {
        if self.bounces(contact) {
            return self.friction_in_impacts(contact).slips;
        }
        if let Some(torque) = self.mechanism.torque(contact) {
            return torque.mu;
        }
        // Functions that fail without slip are refused at the start.
        let friction = self.pair(contact).and_then(|pair| pair.friction(0.0).ok()).unwrap_or(Friction::NONE);
        if slides { friction.slips } else { friction.sticks }
    }

    pub(crate) fn motion<'a>(&'a self, closed: &'a [Closed]) -> Motion<'a> {
        Motion {
            mechanism: self.mechanism,
            angles: self.angles,
            drive: &self.options.drive,
            surfaces: self.surfaces,
            held: &self.front.held,
            closed,
            resting: self.front.resting,
            scale: &self.front.scale,
        }
    }

    /// The closed contacts and their modes, in words.
    pub(crate) fn modes_in_words(&self) -> String {
        let name = |contact: usize| {
            self.mechanism.component(ComponentKind::Contact, contact).map_or("?", |component| component.name)
        };
        let modes: Vec<String> = self
            .closed()
            .iter()
            .map(|closed| {
                let what = self.mode_in_words(closed);
                format!("{} {what}", name(self.mechanism.contact(closed.contact)))
            })
            .collect();
        if modes.is_empty() { "no contact".to_owned() } else { modes.join(", ") }
    }

    /// The error of too many events without progress.
    pub(crate) fn without_end(&self, count: usize) -> ErrorKind {
        ErrorKind::EventsWithoutEnd { count, modes: self.modes_in_words() }
    }

    /// An error at the present time.
    pub(crate) fn error(&self, contact: Option<usize>, kind: ErrorKind) -> SimulationError {
        let contact = contact.map(|contact| self.mechanism.contact(contact));
        SimulationError::new(self.mechanism.mechanism, self.front.t, contact, kind)
    }

    pub(crate) fn failure(&self, failure: Failure) -> SimulationError {
        match failure {
            Failure::State(error) => self.error(None, ErrorKind::State(error)),
            Failure::Contact(contact, error) => self.error(Some(contact), ErrorKind::Contact(error)),
            Failure::NoForces => self.error(
                None,
                ErrorKind::NoForces(
                    "the contacts that are closed have no forces under which they keep their modes"
                        .to_owned(),
                ),
            ),
            Failure::Law(contact, message) => self.error(Some(contact), ErrorKind::BadOption(message)),
            Failure::Input(message) => self.error(None, ErrorKind::BadInput(message)),
        }
    }
}
