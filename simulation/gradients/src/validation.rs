//! How well a model predicts measured motions: errors of each motion, beside those that noise of the start
//! alone would make and those that the best values of each motion leave.
//!
//! Theory: docs/theory.md, section 22.

use hodograph::{ComponentKind, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::random::next_random;
use hodograph_simulation::{Options, SimulationError};
use nalgebra::DMatrix;

use crate::trajectory::follow;
use crate::{By, FitError, FitTask, Loss, Trajectory, fit};

/// The quantities that are compared, and in what they are counted.
#[derive(Clone, Copy, Debug)]
pub struct Measure<'a> {
    /// the quantities: indices into coordinates followed by independent speeds
    pub measured: &'a [usize],
    /// the divisors of their differences: measurement errors, or scales
    pub units: &'a [f64],
}

impl Measure<'_> {
    /// The error of a prediction: the root of the mean square of the differences in their units (22.1); NaN
    /// if nothing was measured. `predicted` has the shape of the samples.
    pub fn error(&self, samples: &DMatrix<f64>, predicted: &DMatrix<f64>) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for (column, unit) in self.units.iter().enumerate() {
            let (samples, predicted) = (samples.column(column), predicted.column(column));
            for (measured, predicted) in
                samples.iter().zip(predicted.iter()).filter(|(measured, _)| !measured.is_nan())
            {
                sum += ((predicted - measured) / unit).powi(2);
                count += 1;
            }
        }
        (sum / count as f64).sqrt()
    }

    /// The measured quantities of a state.
    fn of(&self, state: &[f64]) -> Vec<f64> {
        self.measured.iter().map(|index| state[*index]).collect()
    }

    /// The prediction that nothing moves.
    pub fn at_rest(&self, trajectory: &Trajectory) -> DMatrix<f64> {
        let own = self.of(&trajectory.state);
        DMatrix::from_fn(trajectory.times.len(), own.len(), |_, column| own[column])
    }
}

/// The prediction of a mechanism at the times of a motion: a row per sample, a column per measured quantity.
///
/// # Errors
///
/// The motion cannot be followed to its last time.
pub fn predict(
    mechanism: &InterpretedMechanism,
    options: &Options,
    measure: Measure<'_>,
    trajectory: &Trajectory,
) -> Result<DMatrix<f64>, SimulationError> {
    let states = follow(mechanism, options, trajectory)?;
    let rows: Vec<Vec<f64>> = states.iter().map(|state| measure.of(state)).collect();
    Ok(DMatrix::from_fn(rows.len(), measure.measured.len(), |row, column| rows[row][column]))
}

/// The error that is left where the variables have the best values for this motion alone, found from the values
/// of the mechanism and the options: what no common values can fall below.
///
/// # Errors
///
/// [`FitError`]
pub fn floor(
    mechanism: &InterpretedMechanism,
    options: &Options,
    measure: Measure<'_>,
    variables: &[By],
    trajectory: &Trajectory,
) -> Result<f64, FitError> {
    let task = FitTask {
        trajectories: std::slice::from_ref(trajectory),
        measured: measure.measured,
        units: measure.units,
        variables,
        loss: Loss::Square,
        flight: None,
        horizons: &[],
        starts: 1,
        bootstrap: 0,
        seed: 0,
    };
    fit(mechanism, options, &task).map(|found| found.rms)
}

/// Random numbers with the normal distribution.
#[derive(Clone, Debug)]
pub struct Noise(u64);

impl Noise {
    /// Of a seed.
    pub fn new(seed: u64) -> Noise {
        Noise(seed)
    }

    /// Uniform in (0, 1), by the generator of the bootstrap.
    fn uniform(&mut self) -> f64 {
        let word = next_random(&mut self.0);
        ((word >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// The next number: mean 0, variance 1, by the method of Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let (radius, angle) = (self.uniform(), self.uniform());
        (-2.0 * radius.ln()).sqrt() * (std::f64::consts::TAU * angle).cos()
    }
}

/// The error that would be found if the model were exact and only measured with errors: the motion from the
/// start stands for the truth, is measured with `errors` (of the measured quantities; at the start and at each
/// sample), and predicted from the start that was measured (22.6).
///
/// # Errors
///
/// A motion cannot be followed to its last time.
pub fn noise_replicate(
    mechanism: &InterpretedMechanism,
    options: &Options,
    measure: Measure<'_>,
    (trajectory, errors): (&Trajectory, &[f64]),
    noise: &mut Noise,
) -> Result<f64, SimulationError> {
    let mut samples = predict(mechanism, options, measure, trajectory)?;
    let mut replica = trajectory.clone();
    for ((column, index), error) in measure.measured.iter().enumerate().zip(errors) {
        replica.state[*index] += error * noise.normal();
        for row in 0..samples.nrows() {
            samples[(row, column)] += error * noise.normal();
            // what was not measured is not measured here
            if trajectory.samples[(row, column)].is_nan() {
                samples[(row, column)] = f64::NAN;
            }
        }
    }
    // the coordinates of a quaternion remain a unit quaternion
    let count = mechanism.count(ComponentKind::Coordinate);
    let _ = mechanism.normalise(&mut replica.state[..count]);
    Ok(measure.error(&samples, &predict(mechanism, options, measure, &replica)?))
}
