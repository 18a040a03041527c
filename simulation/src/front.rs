//! The front of a motion: everything that the future of a motion depends on, as one value.
//!
//! A front is cloned to try a step or a change of modes, and replaced to take it. What fails leaves the
//! front as it was.

use hodograph::State;
use nalgebra::Vector3;

use crate::EnergyAccount;
use crate::motion::WORKS;
use crate::phase::{Leaving, Phase, Turned, Turning};
use crate::scales::Scales;

/// The first step, beside the time of the problem.
const BEGIN: f64 = 5e-3;

/// The state at the end of the last step, after its events.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Front {
    /// time, s
    pub t: f64,
    /// coordinates, speeds, work of friction, work of inputs
    pub y: Vec<f64>,
    /// the inputs that are held
    pub held: Vec<f64>,
    /// phase of each contact
    pub phases: Vec<Phase>,
    /// force of each contact when its mode was last decided, N
    pub forces: Vec<Vector3<f64>>,
    /// rate at which the direction of small slip turns where it follows from the state, rad/s
    pub omegas: Vec<Option<f64>>,
    /// how it turned through the last step, where slip was followed as a signed number
    #[cfg_attr(feature = "serde", serde(skip))]
    pub turnings: Vec<Option<Turning>>,
    /// at which rates that direction turned so far
    pub turned: Vec<Turned>,
    /// slip of each contact, m/s, up to which its direction is integrated, since it did not end as it settled
    pub barred: Vec<f64>,
    /// whether nothing moves
    pub resting: bool,
    /// contacts whose bounces end at a time
    pub chatter: Vec<(f64, usize)>,
    /// size of the next step that the error of the last one allows, s
    pub next: f64,
    /// the same of a step in which directions of slip follow from the state, s
    pub next_settled: f64,
    /// the next sampling time of a controller, s
    pub next_sample: Option<f64>,
    /// samples so far
    pub samples: u64,
    /// greatest size of each speed so far
    pub scale: Vec<f64>,
    /// units of length and time
    pub scales: Scales,
    /// greatest kinetic energy so far, J
    pub greatest: f64,
    /// the works of impacts so far, J
    pub energy: EnergyAccount,
    /// events without progress in time
    pub crowd: usize,
    /// events, and the time of the one from which they are counted, s
    pub events: (usize, f64),
    /// the contact whose point became undefined: the motion has ended
    pub ended: Option<usize>,
    /// steps since the last event, the time of that event, and the greatest step so far, s
    pub steps: (usize, f64, f64),
}

impl Front {
    /// The start of a motion. No contact is closed yet.
    pub fn new(state: &State<'_>, contacts: usize, sampled: bool, scales: Scales) -> Self {
        let mut y = state.coordinates.to_vec();
        y.extend_from_slice(state.speeds);
        y.resize(y.len() + WORKS, 0.0);
        Self {
            t: state.time,
            y,
            held: state.inputs.to_vec(),
            phases: vec![Phase::Open(Leaving::Apart); contacts],
            forces: vec![Vector3::zeros(); contacts],
            omegas: vec![None; contacts],
            turnings: vec![None; contacts],
            turned: vec![Turned::default(); contacts],
            barred: vec![0.0; contacts],
            resting: false,
            chatter: Vec::new(),
            next: BEGIN * scales.time,
            next_settled: BEGIN * scales.time,
            next_sample: sampled.then_some(state.time),
            samples: 0,
            scale: state.speeds.iter().map(|speed| speed.abs()).collect(),
            scales,
            greatest: 0.0,
            energy: EnergyAccount::default(),
            crowd: 0,
            events: (0, state.time),
            ended: None,
            steps: (0, state.time, 0.0),
        }
    }
}
