//! Input and result of a numerical evaluation: state, evaluated quantities, reasons of failure.

use crate::model::mechanism::{CoordinateId, Mechanism, Orientation, SpeedId, Variable};
use crate::span::Span;

/// A state: every number in the unit of its declaration, in the order of the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct State {
    /// all parameters, `fixed` ones too (their entries are not used)
    pub parameters: Vec<f64>,
    /// all inputs
    pub inputs: Vec<f64>,
    /// time, s
    pub time: f64,
    /// all coordinates, dependent ones too
    pub coordinates: Vec<f64>,
    /// independent speeds
    pub speeds: Vec<f64>,
}

impl State {
    /// The values and initial values of the model; 0 where it gives none, and for quaternions the identity.
    pub fn of(m: &Mechanism) -> State {
        let values = |list: &[Variable]| -> Vec<f64> {
            list.iter().map(|quantity| quantity.value.unwrap_or(0.0)).collect()
        };
        let mut state = State {
            parameters: values(&m.parameters),
            inputs: values(&m.inputs),
            time: 0.0,
            coordinates: values(&m.coordinates),
            speeds: m.speeds.iter().filter(|u| !u.dependent).map(|u| u.value.unwrap_or(0.0)).collect(),
        };
        for frame in &m.frames {
            if let Orientation::Quaternion(ids) = &frame.orientation
                && ids.iter().all(|id| state.coordinates[id.0] == 0.0)
            {
                state.coordinates[ids[0].0] = 1.0;
            }
        }
        state
    }
}

/// What holds at a state. `p` is the number of independent speeds; vectors are along N.x, N.y, N.z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// p x p: sum over bodies of mass m v_r . v_s + w_r . I . w_s
    pub mass_matrix: Vec<Vec<f64>>,
    /// p: mass matrix times rates of the independent speeds
    pub forcing: Vec<f64>,
    /// rates of the coordinates
    pub rates: Vec<f64>,
    /// all speeds, the dependent ones after the independent ones
    pub speeds: Vec<f64>,
    /// kinetic energy, J
    pub kinetic_energy: f64,
    /// power of all loads, W
    pub power: f64,
    /// potential energy of gravity and springs, J, zero with every mass centre at O; `None` where a height is not
    /// known, or one of these loads has none
    pub potential_energy: Option<f64>,
    /// power of the loads that this energy feeds: gravity, and springs without their dampers, W; not of those
    /// that have none
    pub conservative_power: f64,
    /// contacts, in the order of the file
    pub contacts: Vec<ContactEvaluation>,
    /// positions of points from O, where known
    pub positions: Vec<Option<[f64; 3]>>,
    /// velocities of points in N
    pub velocities: Vec<[f64; 3]>,
    /// rates of these while the independent speeds stay
    pub accelerations: Vec<[f64; 3]>,
    /// orientations of frames (their axes are the columns), where known
    pub orientations: Vec<Option<[[f64; 3]; 3]>>,
    /// angular velocities of frames in N
    pub angular_velocities: Vec<[f64; 3]>,
    /// residuals of the configuration equations
    pub configuration: Vec<f64>,
    /// rates of the dependent speeds while the independent ones stay
    pub dependent_accelerations: Vec<f64>,
    /// per independent speed: what its unit adds to each dependent speed
    pub dependent_partials: Vec<Vec<f64>>,
    /// per independent speed: sum over bodies of m v_r . v_t + w_r . I . w_t, where v_t and w_t are what prescribed
    /// motion leaves with all independent speeds 0
    pub prescribed_momentum: Vec<f64>,
}

/// What holds of a contact at a state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactEvaluation {
    /// normal
    pub normal: [f64; 3],
    /// relative velocity, m/s
    pub velocity: [f64; 3],
    /// its partial velocities, one per independent speed
    pub partial_velocities: Vec<[f64; 3]>,
    /// what it is with all independent speeds 0 (prescribed motion), m/s
    pub remainder: [f64; 3],
    /// gap, m, if the model gives one
    pub gap: Option<f64>,
    /// validity, m, where the features that touch end
    pub validity: Option<f64>,
    /// clearance of the two shapes, m, where they have one
    pub clearance: Option<f64>,
    /// rate of the normal
    pub normal_rate: [f64; 3],
    /// rate of the relative velocity while the independent speeds stay, m/s^2
    pub acceleration: [f64; 3],
    /// relative rotation of the two bodies, where friction resists it
    pub turning: Option<TurningEvaluation>,
}

/// The relative rotation of the two bodies in contact, along N's axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TurningEvaluation {
    /// angular velocity of what strikes relative to what is struck, rad/s
    pub angular_velocity: [f64; 3],
    /// its partial velocities, one per independent speed
    pub partial_velocities: Vec<[f64; 3]>,
    /// its rate while the independent speeds stay, rad/s^2
    pub acceleration: [f64; 3],
}

/// Why there are no numbers.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// a divisor is 0 at this state
    DivisionByZero(Span),
    /// a value that is not finite, in what stands here
    NotFinite(Span),
    /// the kinematical equations do not determine this rate
    RatesUndetermined(CoordinateId),
    /// what is declared here contradicts the other kinematical equations; by how much, relatively
    MotionInconsistent(Span, f64),
    /// the constraints do not determine this dependent speed
    SpeedsUndetermined(SpeedId),
    /// the constraint here contradicts the others
    ConstraintsInconsistent(Span),
    /// the dependent coordinates cannot be found; the residual that remains
    NotClosed(f64),
    /// names refer to names too deeply
    TooDeep,
    /// something that has no value here
    Unsupported(&'static str),
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Failure::DivisionByZero(_) => f.write_str("a divisor is zero at this state"),
            Failure::NotFinite(_) => f.write_str("a value is not finite at this state"),
            Failure::RatesUndetermined(q) => write!(f, "the rate of coordinate {} is not determined", q.0),
            Failure::MotionInconsistent(_, by) => {
                write!(f, "a declared motion contradicts the positions (by {by:e})")
            }
            Failure::SpeedsUndetermined(u) => write!(f, "the constraints do not determine speed {}", u.0),
            Failure::ConstraintsInconsistent(_) => f.write_str("the constraints contradict each other"),
            Failure::NotClosed(by) => {
                write!(f, "the configuration equations have no solution near the guess ({by:e})")
            }
            Failure::TooDeep => f.write_str("names refer to names too deeply"),
            Failure::Unsupported(what) => write!(f, "{what} has no value"),
        }
    }
}

impl std::error::Error for Failure {}
