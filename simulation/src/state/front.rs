//! The front of a motion: everything that the future of a motion depends on, as one value.
//!
//! A front is cloned to try a step or a change of modes, and replaced to accept it. If the attempt fails, the
//! front is unchanged.

use hodograph::State;
use nalgebra::Vector3;

use crate::EnergyAccount;
use crate::closed::phase::{Leaving, Phase, Turned, Turning};
use crate::closed::scales::Scales;
use crate::integration::motion::WORKS;

/// The first step, relative to the time of the problem.
const BEGIN: f64 = 5e-3;

/// The state at the end of the last step, after its events.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Front {
    /// time, s
    pub t: f64,
    /// coordinates, speeds, work of friction, work of inputs
    pub y: Vec<f64>,
    /// the inputs that are held constant
    pub held: Vec<f64>,
    /// phase of each contact
    pub phases: Vec<Phase>,
    /// force of each contact when its mode was last decided, N
    pub forces: Vec<Vector3<f64>>,
    /// rate at which the direction of small slip turns if it follows from the state, rad/s
    pub omegas: Vec<Option<f64>>,
    /// polynomial of its rate in the last step, if slip was treated as a signed number
    #[cfg_attr(feature = "serde", serde(skip))]
    pub turnings: Vec<Option<Turning>>,
    /// the previous rates at which that direction turned
    pub turned: Vec<Turned>,
    /// slip of each contact, m/s, up to which its direction is integrated, because it did not end along its
    /// settled direction
    pub barred: Vec<f64>,
    /// whether the mechanism is at rest
    pub resting: bool,
    /// contacts with the time at which their bounces end
    pub chatter: Vec<(f64, usize)>,
    /// next step size according to the error of the last step, s
    pub next: f64,
    /// the same for steps in which directions of slip follow from the state, s
    pub next_settled: f64,
    /// the next sampling time of a controller, s
    pub next_sample: Option<f64>,
    /// number of samples so far
    pub samples: u64,
    /// greatest size of each speed so far
    pub scale: Vec<f64>,
    /// the units of length and time
    pub scales: Scales,
    /// greatest kinetic energy so far, J
    pub greatest: f64,
    /// the works of impacts so far, J
    pub energy: EnergyAccount,
    /// number of events without progress in time
    pub crowd: usize,
    /// the sum over these events of the number of closed contacts
    pub crowded_contacts: usize,
    /// number of events, and the time from which they are counted, s
    pub events: (usize, f64),
    /// the contact whose point is undefined, if the motion has ended there
    pub ended: Option<usize>,
    /// number of steps in a row before which slip would have ended at once at its rate, and did not
    pub would_end: usize,
    /// number of steps since the last event, the time of that event, and the greatest step so far, s
    pub steps: (usize, f64, f64),
}

impl Front {
    /// The front at the start of a motion; no contact is closed yet.
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
            crowded_contacts: 0,
            events: (0, state.time),
            ended: None,
            would_end: 0,
            steps: (0, state.time, 0.0),
        }
    }
}
