//! The events of a motion: collisions, beginning and end of contact, stick and slip.

use hodograph::{CollisionOutcome, ContactMode, Selection};
use nalgebra::Vector3;

/// An event, with the state at its time.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// s
    pub time: f64,
    /// number of the contact, if it happened at one
    pub contact: Option<usize>,
    /// what happened
    pub kind: EventKind,
    /// coordinates at that time
    pub coordinates: Vec<f64>,
    /// independent speeds after it
    pub speeds: Vec<f64>,
}

/// What happened.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
#[non_exhaustive]
pub enum EventKind {
    /// Bodies collided.
    Collision(Box<CollisionRecord>),
    /// Several contacts struck at once: see [`crate::ImpactsAtOnce`].
    SimultaneousCollision(Box<SimultaneousCollision>),
    /// A sliding contact that no finite force can hold suffered an impact with zero speed of approach.
    ImpactWithoutCollision(Box<CollisionRecord>),
    /// Lasting contact begins.
    Contact {
        /// how they touch
        mode: ContactMode,
        /// whether this was the only possibility
        selection: Selection,
    },
    /// The bodies separate without a collision.
    LiftOff {
        /// whether this was the only possibility
        selection: Selection,
    },
    /// A contact that stuck begins to slip, or slips in another direction after a stop.
    Slip {
        /// direction along the two tangential axes of the contact basis
        direction: [f64; 2],
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Slip ended and friction holds the contact.
    Stick {
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Bodies that rolling friction held begin to roll on each other.
    Roll {
        /// direction of the relative angular velocity along the two tangential axes of the contact basis
        direction: [f64; 2],
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Rolling ended and rolling friction holds the bodies.
    RollEnds {
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Bodies that spinning friction held begin to turn about the normal.
    Spin {
        /// whether what strikes turns right-handed about the normal
        positive: bool,
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Turning about the normal ended and spinning friction holds the bodies.
    SpinEnds {
        /// whether this was the only possibility
        selection: Selection,
    },
    /// Nothing moves any more.
    Rest,
    /// The motion ends: the coordinates no longer determine the point at which the bodies touch (a disc that
    /// lies flat). What would follow is the impact of a whole face.
    Singular,
    /// The user's function of this number is zero.
    Zero(usize),
}

impl EventKind {
    /// A stable lower-case name.
    pub fn name(&self) -> &'static str {
        match self {
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
            Self::Zero(_) => "zero",
        }
    }

    /// Whether other modes were possible, of events that choose modes.
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
    /// whether it was solved with e = 0 because the next bounce would be lower than the tolerance
    pub last_bounce: bool,
    /// for the first of several contacts struck together, on request ([`crate::Options::compare_orders`]): the
    /// greatest kinetic energy of the difference between this outcome and those of the orders in which they
    /// may strike one after the other, J; zero if the order does not matter
    pub spread: Option<f64>,
}

/// An impact of several contacts at once.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SimultaneousCollision {
    /// what each contact that could take part did
    pub shares: Vec<Share>,
    /// change of kinetic energy, J: the sum of the works, but where motion is prescribed (24)
    pub energy_change: f64,
    /// independent speeds before
    pub speeds_before: Vec<f64>,
    /// as [`CollisionRecord::spread`]
    pub spread: Option<f64>,
}

/// What one contact did in an impact of several at once.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Share {
    /// number of the contact
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
