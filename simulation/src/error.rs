//! The errors of a simulation.

use std::fmt;

use hodograph::{CollisionError, ComponentKind, ContactError, Contacts, StateError};

/// Why a simulation cannot continue, with time and contact.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SimulationError {
    /// when, s
    pub time: f64,
    /// name of the contact, if it is about one
    pub contact: Option<String>,
    /// what is wrong
    pub kind: ErrorKind,
}

impl SimulationError {
    /// At a time, and at a contact by its number.
    pub(crate) fn new(
        mechanism: &dyn Contacts<f64>,
        time: f64,
        contact: Option<usize>,
        kind: ErrorKind,
    ) -> Self {
        let name = |index| mechanism.component(ComponentKind::Contact, index);
        Self { time, contact: contact.and_then(name).map(|component| component.name.to_owned()), kind }
    }
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum ErrorKind {
    /// The mechanism has no equations of motion there.
    State(StateError),
    /// A collision has no outcome.
    Collision(CollisionError<f64>),
    /// A contact that lasts has no force.
    Contact(ContactError<f64>),
    /// A contact begins with a negative gap, m.
    Overlap(f64),
    /// An option or a surface is impossible.
    BadOption(String),
    /// A controller or a function of inputs gave a number that is not finite, or has the wrong length.
    BadInput(String),
    /// The integrator's steps became too small.
    Stalled,
    /// So many events followed each other without progress in time.
    EventsWithoutEnd {
        /// how many
        count: usize,
        /// the closed contacts, and whether they stick or slide
        modes: String,
    },
    /// So many steps followed each other without an event and with hardly any progress in time.
    NoProgress {
        /// how many
        steps: usize,
        /// over how long, s
        time: f64,
        /// the closed contacts, and whether they stick or slide
        modes: String,
    },
    /// The motion ended before the time asked for, with the event [`crate::EventKind::Singular`].
    Singular,
    /// The gap of a closed contact is not zero, m: its rate is not the normal velocity of the contact.
    Drift(f64),
    /// A normal velocity cannot be told from the rounding of what it is made of: no one knows whether the
    /// contact closes or opens.
    Rounding {
        /// the normal velocity, m/s
        velocity: f64,
        /// the sum of the sizes of its terms, m/s
        terms: f64,
    },
    /// A gap cannot be told from the rounding of what it is made of, m.
    GapRounding {
        /// the gap, m
        gap: f64,
        /// what rounding may be, m
        rounding: f64,
    },
    /// Several contacts were struck together and the option says to stop.
    StruckTogether(Vec<String>),
    /// Several contacts were struck together, and the impact is not one that can be solved as the option
    /// says: why, and what to do.
    LzbNotCovered(String),
    /// The forces at several contacts could not be found.
    NoForces(String),
}

impl ErrorKind {
    /// A stable lower-case name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::State(error) => error.kind(),
            Self::Collision(error) => error.kind(),
            Self::Contact(error) => error.kind(),
            Self::Overlap(_) => "overlap",
            Self::BadOption(_) => "bad_option",
            Self::BadInput(_) => "bad_input",
            Self::Stalled => "stalled",
            Self::EventsWithoutEnd { .. } => "events_without_end",
            Self::NoProgress { .. } => "no_progress",
            Self::Singular => "singular",
            Self::Drift(_) => "drift",
            Self::Rounding { .. } | Self::GapRounding { .. } => "rounding",
            Self::StruckTogether(_) => "struck_together",
            Self::LzbNotCovered(_) => "lzb_not_covered",
            Self::NoForces(_) => "no_forces",
        }
    }
}

impl fmt::Display for SimulationError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "at t = {}", self.time)?;
        if let Some(contact) = &self.contact {
            write!(out, ", contact {contact}")?;
        }
        write!(out, ": ")?;
        match &self.kind {
            ErrorKind::State(error) => error.fmt(out),
            ErrorKind::Collision(error) => error.fmt(out),
            ErrorKind::Contact(error) => error.fmt(out),
            ErrorKind::Overlap(gap) => {
                write!(out, "the negative gap {gap}: start where the bodies are apart, or touch")
            }
            ErrorKind::BadOption(message)
            | ErrorKind::BadInput(message)
            | ErrorKind::NoForces(message)
            | ErrorKind::LzbNotCovered(message) => out.write_str(message),
            ErrorKind::Stalled => write!(
                out,
                "the steps of the integration became too small: the motion is singular or too stiff there"
            ),
            ErrorKind::EventsWithoutEnd { count, modes } => {
                write!(out, "{count} events followed each other without progress in time; closed: {modes}")
            }
            ErrorKind::NoProgress { steps, time, modes } => write!(
                out,
                "{steps} steps of the integration advanced the motion by no more than {time:e} s; closed: {modes}; the model may be singular there"
            ),
            ErrorKind::Singular => write!(
                out,
                "the motion ended: the coordinates no longer determine the point at which the bodies touch, such as the lowest point of a disc that lies flat; give the points of the face contacts of their own if it is to go on"
            ),
            ErrorKind::Drift(gap) => write!(
                out,
                "the contact is closed, but its gap is {gap:e} m: the rate of the gap is not the velocity of the point along the normal (a face that ends, or a gap that does not belong to the normal)"
            ),
            ErrorKind::Rounding { velocity, terms } => write!(
                out,
                "the normal velocity {velocity:e} m/s is a difference of terms of {terms:e} m/s, whose rounding hides it: slow the bodies down, or choose coordinates in which the motion along the surface is not part of the normal velocity"
            ),
            ErrorKind::GapRounding { gap, rounding } => write!(
                out,
                "the gap {gap:e} m is made of numbers so large that their rounding may be {rounding:e} m: count coordinates from a place nearer to the contact"
            ),
            ErrorKind::StruckTogether(names) => {
                write!(out, "{} are struck together, and the option is to stop there", names.join(", "))
            }
        }
    }
}

impl std::error::Error for SimulationError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match &self.kind {
            ErrorKind::State(error) => Some(error),
            ErrorKind::Collision(error) => Some(error),
            ErrorKind::Contact(error) => Some(error),
            _ => None,
        }
    }
}
