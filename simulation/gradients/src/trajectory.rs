//! Measured motions, and what a mechanism does at their times.

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Options, Simulation, SimulationError};
use nalgebra::DMatrix;

/// A measured motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// its name, for messages
    pub name: String,
    /// its initial time, s
    pub start: f64,
    /// initial coordinates and independent speeds; [`fit_start`](crate::fit_start) finds them from the first samples
    pub state: Vec<f64>,
    /// times of the samples after the initial one, s, increasing
    pub times: Vec<f64>,
    /// a row per sample, a column per measured quantity; NaN if nothing was measured
    pub samples: DMatrix<f64>,
}

impl Trajectory {
    /// Its samples up to a duration from the start, s; `None` if there are none.
    pub(crate) fn until(&self, horizon: f64) -> Option<Self> {
        let count = self.times.iter().take_while(|&&time| time <= self.start + horizon).count();
        let samples = self.samples.rows(0, count).into_owned();
        let times = self.times[..count].to_vec();
        (count > 0).then(|| Trajectory {
            name: self.name.clone(),
            state: self.state.clone(),
            times,
            samples,
            ..*self
        })
    }
}

/// The states of a mechanism at the times of a motion, from its start: coordinates followed by independent
/// speeds.
///
/// # Errors
///
/// The motion cannot be followed to its last time.
pub(crate) fn follow(
    mechanism: &InterpretedMechanism,
    options: &Options,
    trajectory: &Trajectory,
) -> Result<Vec<Vec<f64>>, SimulationError> {
    let (coordinates, speeds) = trajectory.state.split_at(mechanism.count(ComponentKind::Coordinate));
    let start = State { time: trajectory.start, coordinates, speeds, inputs: &[] };
    let mut simulation = Simulation::new(mechanism, &start, options.clone())?;
    let mut states = Vec::with_capacity(trajectory.times.len());
    for &time in &trajectory.times {
        simulation.advance_to(time)?;
        states.push([simulation.coordinates(), simulation.speeds()].concat());
    }
    Ok(states)
}
