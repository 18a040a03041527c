//! The events of a motion: collisions, beginning and end of contact, stick and slip.

use hodograph::{CollisionOutcome, ContactMode, Selection};
use nalgebra::Vector3;

/// An event, with the state at its time.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// time, s
    pub time: f64,
    /// index of the contact, if the event concerns one
    pub contact: Option<usize>,
    /// the kind of event
    pub kind: EventKind,
    /// coordinates at that time
    pub coordinates: Vec<f64>,
    /// independent speeds after it
    pub speeds: Vec<f64>,
}

/// The kinds of events.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum EventKind {
    /// Bodies collided.
    Collision(Box<CollisionRecord>),
    /// Several contacts were struck at once: see [`crate::ImpactsAtOnce`].
    SimultaneousCollision(Box<SimultaneousCollision>),
    /// A sliding contact that no finite force can hold suffered an impact without collision (zero speed of
    /// approach).
    ImpactWithoutCollision(Box<CollisionRecord>),
    /// Lasting contact begins.
    Contact {
        /// the mode of the contact
        mode: ContactMode,
        /// whether other modes were possible
        selection: Selection,
    },
    /// The bodies separate without a collision.
    LiftOff {
        /// whether other modes were possible
        selection: Selection,
    },
    /// A sticking contact begins to slip, or slips in another direction after a stop.
    Slip {
        /// direction along the two tangential axes of the contact basis
        direction: [f64; 2],
        /// the same along N.x, N.y, N.z
        along: [f64; 3],
        /// whether other modes were possible
        selection: Selection,
    },
    /// Slip ended and friction holds the contact.
    Stick {
        /// whether other modes were possible
        selection: Selection,
    },
    /// Bodies that rolling friction held begin to roll relative to each other.
    Roll {
        /// direction of the relative angular velocity along the two tangential axes of the contact basis
        direction: [f64; 2],
        /// the same along N.x, N.y, N.z
        along: [f64; 3],
        /// whether other modes were possible
        selection: Selection,
    },
    /// Rolling ended and rolling friction holds the bodies.
    RollEnds {
        /// whether other modes were possible
        selection: Selection,
    },
    /// Bodies that spinning friction held begin to rotate about the normal.
    Spin {
        /// whether the striking body rotates right-handed about the normal
        positive: bool,
        /// whether other modes were possible
        selection: Selection,
    },
    /// Rotation about the normal ended, and spinning friction holds the bodies.
    SpinEnds {
        /// whether other modes were possible
        selection: Selection,
    },
    /// Everything is at rest, until an event or a load that depends on time sets it in motion.
    Rest,
    /// The motion ends: the coordinates no longer determine the contact point (a disc that lies flat). The
    /// impact of a whole face would follow.
    Singular,
    /// The user's function with this index is zero.
    Zero(usize),
}

/// Names the kinds of events, once for [`EventKind::NAMES`] and [`EventKind::name`]. A kind without a row does not
/// compile.
macro_rules! names {
    ($($kind:pat => $name:literal,)*) => {
        impl EventKind {
            /// The names of all kinds but [`EventKind::Zero`], in a stable order: languages without such enums
            /// number them by it.
            pub const NAMES: &'static [&'static str] = &[$($name),*];

            /// The name of the event: lower case, and stable between versions.
            pub fn name(&self) -> &'static str {
                match self {
                    $($kind => $name,)*
                    Self::Zero(_) => "zero",
                }
            }
        }
    };
}

names! {
    Self::Collision(_) => "collision",
    Self::SimultaneousCollision(_) => "struck_together",
    Self::ImpactWithoutCollision(_) => "impact_without_collision",
    Self::Contact { .. } => "contact",
    Self::LiftOff { .. } => "lift_off",
    Self::Slip { .. } => "slip",
    Self::Stick { .. } => "stick",
    Self::Roll { .. } => "roll",
    Self::RollEnds { .. } => "roll_ends",
    Self::Spin { .. } => "spin",
    Self::SpinEnds { .. } => "spin_ends",
    Self::Rest => "rest",
    Self::Singular => "singular",
}

impl EventKind {
    /// Says whether other modes were possible, of events that select modes.
    pub(crate) fn select(&mut self, found: Selection) {
        match self {
            Self::Contact { selection, .. }
            | Self::LiftOff { selection }
            | Self::Slip { selection, .. }
            | Self::Stick { selection }
            | Self::Roll { selection, .. }
            | Self::RollEnds { selection }
            | Self::Spin { selection, .. }
            | Self::SpinEnds { selection } => *selection = found,
            _ => {}
        }
    }

    /// Whether other modes were possible, for events that select modes.
    pub fn selection(&self) -> Option<Selection> {
        match self {
            Self::Contact { selection, .. }
            | Self::LiftOff { selection }
            | Self::Slip { selection, .. }
            | Self::Stick { selection }
            | Self::Roll { selection, .. }
            | Self::RollEnds { selection }
            | Self::Spin { selection, .. }
            | Self::SpinEnds { selection } => Some(*selection),
            _ => None,
        }
    }
}

/// A solved collision.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct CollisionRecord {
    /// the outcome along n, t, s, and these axes
    pub outcome: CollisionOutcome<f64>,
    /// independent speeds before
    pub speeds_before: Vec<f64>,
    /// whether it was solved with e = 0, because the next bounce would be lower than the tolerance
    pub last_bounce: bool,
    /// for the first of several contacts struck at the same time, on request
    /// ([`crate::Options::compare_orders`]): the greatest kinetic energy of the difference between this
    /// outcome and those of all orders of successive impacts, J; zero if the order does not matter
    pub spread: Option<f64>,
}

/// An impact of several contacts at once.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SimultaneousCollision {
    /// the part of each contact that could take part
    pub shares: Vec<Share>,
    /// change of kinetic energy, J: the sum of the works, except if motion is prescribed (24)
    pub energy_change: f64,
    /// independent speeds before
    pub speeds_before: Vec<f64>,
    /// like [`CollisionRecord::spread`]
    pub spread: Option<f64>,
}

/// The part of one contact in a simultaneous impact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Share {
    /// index of the contact
    pub contact: usize,
    /// normal impulse, N s
    pub impulse: f64,
    /// the impulse on the striking point along N.x, N.y, N.z, N s
    pub impulse_on_point: Vector3<f64>,
    /// normal velocity before, m/s
    pub approach: f64,
    /// normal velocity after, m/s
    pub separation: f64,
    /// work of the impulse, J
    pub work: f64,
}
