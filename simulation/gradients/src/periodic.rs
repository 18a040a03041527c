//! The definition of a periodic motion, the motion that is found, and why none is.
//!
//! Theory: docs/theory.md, section 20.

use std::fmt;

use hodograph::{ComponentKind, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Event;
use nalgebra::{Complex, DMatrix};

use crate::{GradientError, Undefined};

/// The end of a period.
#[derive(Clone, Debug, PartialEq)]
pub enum Return {
    /// After this time, s: for motions that are driven in time.
    After(f64),
    /// Just after an event: the `count`-th of this name (`collision`, `stick`, ..) at this contact, or at
    /// any.
    At {
        /// its name: [`EventKind::name`](hodograph_simulation::EventKind::name)
        event: String,
        /// index of the contact
        contact: Option<usize>,
        /// number of such events in a period, at least 1
        count: usize,
    },
}

impl Return {
    /// The names of the events that may end a period: those whose times have derivatives.
    pub const EVENTS: [&'static str; 4] = ["collision", "lift_off", "slip", "stick"];
}

/// The definition of a periodic motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// the end of a period
    pub returns: Return,
    /// coordinates that are reset to their initial values after each period: those on which nothing depends,
    /// and those that a symmetry brings back (the next leg, the next spoke)
    pub reset: Vec<usize>,
    /// what a symmetry does to the state that has returned, before that
    pub symmetry: Vec<Exchange>,
    /// the longest period to wait for, s
    pub longest: f64,
    /// the number of segments of a period, at least 1: deviations grow in each of them alone while the motion is sought
    pub segments: usize,
}

/// A component of the returned state (coordinates, then independent speeds) takes the place of another one, as those of the
/// other leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// the component that is replaced
    pub to: usize,
    /// the component whose value it takes
    pub from: usize,
    /// whether its sign is turned
    pub turned: bool,
}

impl Exchange {
    /// The exchange `TO=FROM` or `TO=-FROM` of coordinates or independent speeds of these names.
    ///
    /// # Errors
    ///
    /// A sentence that says what is wrong.
    pub fn named(mechanism: &InterpretedMechanism, text: &str) -> Result<Self, String> {
        let form = || format!("`{text}` is no exchange: give TO=FROM or TO=-FROM, as in q1=q2");
        let (to, from) = text.split_once('=').ok_or_else(form)?;
        let from = from.trim();
        let (turned, from) = from.strip_prefix('-').map_or((false, from), |from| (true, from));
        let n = mechanism.count(ComponentKind::Coordinate);
        let index = |name: &str| {
            let name = name.trim();
            let speed = || mechanism.index(ComponentKind::Speed, name).map(|index| n + index);
            let found = mechanism.index(ComponentKind::Coordinate, name).or_else(speed);
            found.ok_or_else(|| format!("there is no coordinate or independent speed `{name}`"))
        };
        Ok(Exchange { to: index(to)?, from: index(from)?, turned })
    }
}

/// A periodic motion.
#[derive(Clone, Debug)]
pub struct Orbit {
    /// initial coordinates and independent speeds
    pub state: Vec<f64>,
    /// times, s, and states (coordinates, then independent speeds) at the beginnings of its segments, the first of which is
    /// the initial one
    pub nodes: Vec<(f64, Vec<f64>)>,
    /// its period, s
    pub period: f64,
    /// its events, in order
    pub events: Vec<Event>,
    /// derivatives of the returned state with respect to the initial state; columns of coordinates that are
    /// reset are zero, and so are derivatives along directions in which initially closed contacts would
    /// separate or slip
    pub matrix: DMatrix<f64>,
    /// the eigenvalues of that matrix, the greatest first
    pub multipliers: Vec<Complex<f64>>,
    /// derivatives of the returned state with respect to each of the given variables (rows as in `matrix`)
    pub by: DMatrix<f64>,
    /// the remaining difference between both states, relative to their size
    pub residual: f64,
}

impl Orbit {
    /// Whether all multipliers lie inside the unit circle.
    pub fn is_stable(&self) -> bool {
        self.multipliers.first().is_none_or(|first| first.norm() < 1.0)
    }
}

/// Why no periodic motion is found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum OrbitError {
    /// A motion cannot be simulated or differentiated.
    Gradient(GradientError),
    /// The motion from the start has no derivative.
    Undefined(Undefined),
    /// The motion does not return within the longest period, s.
    NoReturn(f64),
    /// Newton's method does not converge: the smallest residual so far.
    NotFound(f64),
    /// The task has a mistake.
    BadRequest(String),
}

impl fmt::Display for OrbitError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gradient(error) => error.fmt(out),
            Self::Undefined(why) => write!(out, "the motion is not differentiable: {why}"),
            Self::NoReturn(longest) => write!(
                out,
                "the motion does not return within {longest} s: begin nearer to the periodic motion, or allow a longer period"
            ),
            Self::NotFound(residual) => write!(
                out,
                "no periodic motion is found: the nearest misses by {residual:e} of the state; begin nearer to one, or divide the period into more segments if deviations grow in it"
            ),
            Self::BadRequest(what) => out.write_str(what),
        }
    }
}

impl std::error::Error for OrbitError {}

impl From<GradientError> for OrbitError {
    fn from(error: GradientError) -> Self {
        Self::Gradient(error)
    }
}
