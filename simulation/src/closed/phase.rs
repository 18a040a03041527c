//! The phases of contacts: open, sticking, sliding.

use std::sync::Arc;

use nalgebra::{DMatrix, Vector2};
use smallvec::SmallVec;

/// The state of an open contact.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Leaving {
    /// Its gap is open.
    Apart,
    /// Its gap is open but small, and its faces or edges are bounded.
    Near,
    /// It has just separated with a velocity; its gap is zero up to rounding.
    Bounced,
    /// It lifted off: gap and rate begin at zero. `risen` is its gap at the front by integration of its rate,
    /// without the rounding error of a gap; `rounding` that of its acceleration.
    Lifted { risen: f64, rounding: f64 },
}

impl Leaving {
    /// It lifts off now.
    pub const NOW: Self = Self::Lifted { risen: 0.0, rounding: 0.0 };
}

/// The phase of a contact in the simulation.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum Phase {
    Open(Leaving),
    Stick,
    /// Sliding, with the direction in which slip began.
    Slide(Vector2<f64>),
}

impl Phase {
    pub fn is_closed(&self) -> bool {
        !matches!(self, Phase::Open(_))
    }

    /// The phase as users see it.
    pub fn of_contact(&self) -> ContactPhase {
        match self {
            Self::Open(_) => ContactPhase::Open,
            Self::Stick => ContactPhase::Stick,
            Self::Slide(_) => ContactPhase::Slide,
        }
    }
}

/// The phase of a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ContactPhase {
    /// The bodies are separated or separating.
    Open,
    /// They touch, without slip.
    Stick,
    /// They touch and slide on each other.
    Slide,
}

/// A closed contact during a mode.
#[derive(Clone, Debug)]
pub(crate) struct Closed {
    pub contact: usize,
    /// coefficient of friction up to which it sticks, or at which its slip begins and ends
    pub mu: f64,
    /// whether this coefficient is that in impacts, at any slip: bounces lower than the tolerance have not ended
    pub bounces: bool,
    /// `None` while it sticks; else the direction in which slip began, used as long as slip is too small to
    /// have one
    pub slides: Option<Vector2<f64>>,
    /// rate at which its direction of slip turns if it follows from the state, rad/s
    pub omega: Option<f64>,
    /// polynomial of its direction in this step, if slip is treated as a signed number
    pub turning: Option<Turning>,
}

impl Closed {
    /// Whether the direction of slip matters: not for a contact without friction.
    pub fn rubs(&self) -> bool {
        self.slides.is_some() && self.mu > 0.0
    }

    /// Whether the direction of slip is that of its velocity.
    pub fn has_own_direction(&self) -> bool {
        self.omega.is_none() && self.turning.is_none()
    }
}

/// The turning of the direction of settled slip, from the direction at a given time.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Turning {
    pub since: f64,
    /// its rate as a polynomial of the time since then: rad/s, rad/s^2, rad/s^3
    pub rates: [f64; 3],
    /// slip perpendicular to the direction at that time, m/s, and the time within which it vanishes, s
    pub across: f64,
    pub within: f64,
    /// an approximate inverse of the derivatives of the accelerations perpendicular to all settled
    /// directions, in the order of their indices, with respect to the angles, s^2/m
    pub inverse: Arc<DMatrix<f64>>,
    /// slip along the direction, m/s, at which a step ends
    pub least: f64,
}

impl Turning {
    /// The rate at a time.
    pub fn rate(&self, t: f64) -> f64 {
        let ([rate, change, bend], t) = (self.rates, t - self.since);
        rate + (change + bend * t) * t
    }

    /// The perpendicular slip at a time: it decreases quadratically to zero.
    pub fn across(&self, t: f64) -> f64 {
        let left = (1.0 - (t - self.since) / self.within).max(0.0);
        self.across * left * left
    }

    /// The rate of the perpendicular slip.
    pub fn fading(&self, t: f64) -> f64 {
        -2.0 * self.across / self.within * (1.0 - (t - self.since) / self.within).max(0.0)
    }

    /// The angle of rotation up to a time.
    pub fn angle(&self, t: f64) -> f64 {
        let ([rate, change, bend], t) = (self.rates, t - self.since);
        (rate + (change / 2.0 + bend / 3.0 * t) * t) * t
    }
}

/// The rates at which a settled direction of slip turned, rad/s, with their times; the last one first.
pub(crate) type Turned = [Option<(f64, f64)>; 2];

/// The data that are constant during a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Modes {
    pub closed: Vec<Closed>,
    /// the inputs that are constant
    pub held: Vec<f64>,
    pub resting: bool,
}

/// The coefficients of friction.
pub(crate) fn mus(closed: &[Closed]) -> SmallVec<[f64; 8]> {
    closed.iter().map(|contact| contact.mu).collect()
}
