//! The errors of a simulation.

use std::fmt;

use hodograph::{
    Cause, CollisionError, ComponentKind, ContactError, Contacts, ImpactError, ParameterError, StateError,
    UnknownLaw,
};

/// Why a simulation cannot continue, with the time and the contact.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SimulationError {
    /// time, s
    pub time: f64,
    /// name of the contact, if the error concerns one
    pub contact: Option<String>,
    /// the reason
    pub kind: ErrorKind,
}

impl SimulationError {
    /// An error at a time, and at a contact with this index.
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

/// The reason of an error.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum ErrorKind {
    /// The mechanism has no equations of motion in this state.
    State(StateError),
    /// A collision has no outcome.
    Collision(CollisionError<f64>),
    /// A lasting contact has no force.
    Contact(ContactError<f64>),
    /// A contact starts with a negative gap, m.
    Overlap(f64),
    /// An option or a surface is impossible.
    BadOption(String),
    /// A surface or a number of the start state is impossible, or not given.
    Argument {
        /// why
        cause: Cause,
        /// the same in words, with the number at fault
        message: String,
    },
    /// A controller or a function of inputs returned a number that is not finite, or the wrong number of
    /// inputs.
    BadInput(String),
    /// The integrator's steps became too small.
    Stalled,
    /// Too many events followed each other without progress in time.
    EventsWithoutEnd {
        /// number of events
        count: usize,
        /// the closed contacts, and whether they stick or slide
        modes: String,
    },
    /// Too many steps followed each other without an event and with hardly any progress in time.
    NoProgress {
        /// number of steps
        steps: usize,
        /// their total duration, s
        time: f64,
        /// the closed contacts, and whether they stick or slide
        modes: String,
    },
    /// The motion ended earlier, with the event [`crate::EventKind::Singular`].
    Singular,
    /// The gap of a closed contact is not zero, m: the rate of the gap is not the normal velocity of the
    /// contact.
    Drift(f64),
    /// The gap of a contact that opens has another rate than the velocity of the point along the normal.
    GapRate {
        /// the rate of the gap, m/s
        rate: f64,
        /// the normal velocity, m/s
        velocity: f64,
    },
    /// A normal velocity is smaller than its rounding error, so that it is not known whether the contact
    /// closes or opens.
    Rounding {
        /// the normal velocity, m/s
        velocity: f64,
        /// the sum of the magnitudes of its terms, m/s
        terms: f64,
    },
    /// A gap is smaller than its rounding error, m.
    GapRounding {
        /// the gap, m
        gap: f64,
        /// the bound of its rounding error, m
        rounding: f64,
    },
    /// Several contacts are struck at the same time, and the options ask for an error then.
    StruckTogether(Vec<String>),
    /// Several contacts are struck at the same time, and the impact cannot be solved by the method of the
    /// options; with the reason and a remedy.
    LzbNotCovered(String),
    /// The forces at several contacts could not be found.
    NoForces(String),
}

impl ErrorKind {
    /// The name of the error: lower case, and stable between versions.
    pub fn name(&self) -> &'static str {
        match self {
            Self::State(error) => error.kind(),
            Self::Collision(error) => error.kind(),
            Self::Contact(error) => error.kind(),
            Self::Overlap(_) => "overlap",
            Self::BadOption(_) => "bad_option",
            Self::Argument { cause, .. } => cause.name(),
            Self::BadInput(_) => "bad_input",
            Self::Stalled => "stalled",
            Self::EventsWithoutEnd { .. } => "events_without_end",
            Self::NoProgress { .. } => "no_progress",
            Self::Singular => "singular",
            Self::Drift(_) => "drift",
            Self::GapRate { .. } => "gap_rate",
            Self::Rounding { .. } | Self::GapRounding { .. } => "rounding",
            Self::StruckTogether(_) => "struck_together",
            Self::LzbNotCovered(_) => "lzb_not_covered",
            Self::NoForces(_) => "no_forces",
        }
    }
}

/// A refused argument with the cause and the words of its error.
macro_rules! argument {
    ($($error:ty),*) => {
        $(impl From<$error> for ErrorKind {
            fn from(error: $error) -> Self {
                Self::Argument { cause: error.cause(), message: error.to_string() }
            }
        })*
    };
}

argument!(ImpactError<f64>, ParameterError, UnknownLaw<'_>);

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
            | ErrorKind::Argument { message, .. }
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
                "the contact is closed, but its gap is {gap:e} m: the rate of the gap is not the velocity of the point along the normal (a face that ends, or a gap that does not belong to the normal), or the kinematical equations are nearly singular there"
            ),
            ErrorKind::GapRate { rate, velocity } => write!(
                out,
                "the gap changes at {rate} m/s, but the velocity of the point along the normal is {velocity} m/s: the gap does not belong to the normal, or the surface that is `against` has a velocity along it"
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
