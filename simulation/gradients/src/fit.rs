//! Fits parameters, mu and e to measured motions, by least squares with exact derivatives.
//!
//! Theory: docs/theory.md, section 21.

use std::fmt;

use hodograph::{ComponentKind, Mechanism, State, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use hodograph_simulation::random::next_random;
use nalgebra::{DMatrix, DVector};

use crate::family::{resolve_surfaces, value_of, with_values};
use crate::trajectory::{Trajectory, follow};
use crate::{By, GradientError, Loss, differentiate};

/// The task of a fit.
#[derive(Clone, Debug)]
pub struct FitTask<'a> {
    /// the motions
    pub trajectories: &'a [Trajectory],
    /// the measured quantities: indices into coordinates followed by independent speeds
    pub measured: &'a [usize],
    /// the divisors of the differences of each quantity: its measurement error, or its scale
    pub units: &'a [f64],
    /// parameters, mu and e
    pub variables: &'a [By],
    /// what a difference costs
    pub loss: Loss,
    /// number of bootstrap samples: trajectories are drawn with replacement and fitted again
    pub bootstrap: usize,
    /// the seed of the bootstrap samples
    pub seed: u64,
}

/// The result of a fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// the fitted values, in the order of the variables
    pub values: Vec<f64>,
    /// the surfaces of the contacts with these values
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// root mean square of the differences, in their units
    pub rms: f64,
    /// the number of differences that cost less than their squares
    pub outliers: usize,
    /// the number of differences
    pub differences: usize,
    /// standard errors from the curvature of the sum of what the differences cost, and from what remains of it
    pub errors: Vec<f64>,
    /// correlations of the values
    pub correlations: DMatrix<f64>,
    /// directions that the data do not determine: relative changes of the values that change no difference
    pub undetermined: Vec<Vec<f64>>,
    /// standard deviations of the values over the bootstrap samples; `None` without these
    pub spread: Option<Vec<f64>>,
    /// trajectories without derivatives at the fit; finite differences were used for them
    pub without_derivatives: Vec<String>,
    /// number of steps
    pub steps: usize,
}

/// Why a fit fails.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum FitError {
    /// A motion cannot be simulated with the initial values: the trajectory, and the error.
    Motion(String, GradientError),
    /// The task has a mistake.
    BadRequest(String),
}

impl fmt::Display for FitError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Motion(name, error) => write!(out, "trajectory {name}: {error}"),
            Self::BadRequest(what) => out.write_str(what),
        }
    }
}

impl std::error::Error for FitError {}

/// Largest number of steps of the Levenberg-Marquardt method, and of those for a bootstrap sample, which
/// starts from the fit.
const STEPS: usize = 60;
const BOOTSTRAP_STEPS: usize = 8;
/// Damping: initial value, factors after an accepted and after a rejected step, and largest value.
const DAMPING: f64 = 1e-3;
const DAMPING_DECREASE: f64 = 0.2;
const DAMPING_INCREASE: f64 = 5.0;
const MAX_DAMPING: f64 = 1e12;
/// The method stops if the sum of squares decreases by less than this part.
const MIN_DECREASE: f64 = 1e-14;
/// A singular value of the derivatives with respect to relative changes below this part of the greatest means
/// a direction that the data do not determine.
const UNDETERMINED: f64 = 1e-8;
/// Relative step of finite differences for motions without derivatives.
const STEP: f64 = 1e-5;

/// Fits the variables, starting from the values of the mechanism and the options.
///
/// # Errors
///
/// [`FitError`]
pub fn fit(mechanism: &InterpretedMechanism, options: &Options, task: &FitTask<'_>) -> Result<Fit, FitError> {
    check(mechanism, task)?;
    let problem = Problem { mechanism, options, task, loss: task.loss };
    let first: Result<Vec<f64>, String> =
        task.variables.iter().map(|&by| value_of(mechanism, options, by)).collect();
    let first = first.map_err(FitError::BadRequest)?;
    let all: Vec<usize> = (0..task.trajectories.len()).collect();
    let (first, before) = match task.loss {
        // Far from a minimum most differences may be beyond the cap, where nothing tells a direction.
        Loss::Cap(size) => {
            let (first, _, before) =
                Problem { loss: Loss::Huber(size), ..problem }.minimise(first, &all, STEPS)?;
            (first, before)
        }
        _ => (first, 0),
    };
    let (values, here, steps) = problem.minimise(first, &all, STEPS)?;
    let scale: Vec<f64> = values.iter().map(|value| if *value == 0.0 { 1.0 } else { value.abs() }).collect();
    let count = here.roots.len();
    let relative =
        DMatrix::from_fn(count, values.len(), |row, column| here.by[(row, column)] * scale[column]);
    let square = here.roots.norm_squared();
    let decomposed = (relative.transpose() * &relative).symmetric_eigen();
    let greatest = decomposed.eigenvalues.max().max(f64::MIN_POSITIVE);
    let least = UNDETERMINED * UNDETERMINED * greatest;
    let free = count.saturating_sub(values.len()).max(1) as f64;
    let mut covariance = DMatrix::zeros(values.len(), values.len());
    let mut undetermined = Vec::new();
    for (value, vector) in decomposed.eigenvalues.iter().zip(decomposed.eigenvectors.column_iter()) {
        if *value <= least {
            undetermined.push(vector.iter().copied().collect::<Vec<f64>>());
        } else {
            covariance += vector * vector.transpose() * (square / free / value);
        }
    }
    // A value in an undetermined direction has no error.
    let lost = |place: usize| undetermined.iter().any(|direction| direction[place].abs() > 1e-6);
    let own = |place: usize| f64::sqrt(covariance[(place, place)]);
    let errors =
        (0..values.len()).map(|place| if lost(place) { f64::INFINITY } else { own(place) * scale[place] });
    let correlations = DMatrix::from_fn(values.len(), values.len(), |row, column| {
        let product = own(row) * own(column);
        if product > 0.0 { covariance[(row, column)] / product } else { f64::from(u8::from(row == column)) }
    });
    let spread = if task.bootstrap == 0 { None } else { Some(problem.bootstrap_spread(&values)?) };
    let (_, mut fitted) = problem.at(&values).map_err(FitError::BadRequest)?;
    resolve_surfaces(mechanism, &mut fitted);
    Ok(Fit {
        surfaces: fitted.surfaces,
        errors: errors.collect(),
        rms: (here.square / count.max(1) as f64).sqrt(),
        outliers: here.outliers,
        differences: count,
        correlations,
        undetermined,
        spread,
        without_derivatives: here.without,
        steps: before + steps,
        values,
    })
}

fn check(mechanism: &InterpretedMechanism, task: &FitTask<'_>) -> Result<(), FitError> {
    let bad = |what: String| Err(FitError::BadRequest(what));
    let count = mechanism.count(ComponentKind::Coordinate) + mechanism.count(ComponentKind::Speed);
    if task.trajectories.is_empty() || task.measured.is_empty() || task.variables.is_empty() {
        return bad("there is nothing to fit, or nothing to fit to".to_owned());
    }
    if task.measured.iter().any(|&index| index >= count) || task.units.len() != task.measured.len() {
        return bad("a measured quantity does not exist, or has no unit".to_owned());
    }
    if let Some(unit) = task.units.iter().find(|unit| !(unit.is_finite() && **unit > 0.0)) {
        return bad(format!("the unit of a measured quantity is {unit}: it must be positive"));
    }
    if let Loss::Huber(size) | Loss::Cap(size) = task.loss
        && !(size.is_finite() && size > 0.0)
    {
        return bad(format!("differences cost less than their squares from {size} on: it must be positive"));
    }
    if task.bootstrap > 0 && task.trajectories.len() < 2 {
        return bad("a bootstrap draws among trajectories: it needs two at least".to_owned());
    }
    if task.trajectories.iter().all(|trajectory| trajectory.samples.iter().all(|value| value.is_nan())) {
        return bad("no value was measured after the first row of a trajectory".to_owned());
    }
    for trajectory in task.trajectories {
        let Trajectory { name, state, times, samples, start } = trajectory;
        let rises = std::iter::once(start).chain(times).zip(times).all(|(before, time)| before < time);
        if !rises || times.is_empty() {
            return bad(format!("trajectory {name}: its times must rise, and there must be two at least"));
        }
        if samples.nrows() != times.len() || samples.ncols() != task.measured.len() || state.len() != count {
            return bad(format!("trajectory {name}: its samples or its state have the wrong size"));
        }
    }
    Ok(())
}

/// The differences between measurements and motions for some values.
struct Differences {
    /// the numbers whose squares the differences cost
    roots: DVector<f64>,
    /// their derivatives with respect to the variables
    by: DMatrix<f64>,
    /// the sum of the squares of the differences
    square: f64,
    /// the number of differences that cost less than their squares
    outliers: usize,
    /// trajectories without derivatives
    without: Vec<String>,
}

#[derive(Clone, Copy)]
struct Problem<'a> {
    mechanism: &'a InterpretedMechanism,
    options: &'a Options,
    task: &'a FitTask<'a>,
    loss: Loss,
}

impl Problem<'_> {
    fn at(&self, values: &[f64]) -> Result<(InterpretedMechanism, Options), String> {
        with_values(self.mechanism, self.options, self.task.variables, values)
    }

    /// The differences between a trajectory and its motion, in their units.
    fn differences_of(&self, trajectory: &Trajectory, states: &[Vec<f64>]) -> Vec<f64> {
        let mut differences = Vec::new();
        for (row, state) in states.iter().enumerate() {
            for (column, (&index, unit)) in self.task.measured.iter().zip(self.task.units).enumerate() {
                let measured = trajectory.samples[(row, column)];
                if !measured.is_nan() {
                    differences.push((state[index] - measured) / unit);
                }
            }
        }
        differences
    }

    /// The differences without derivatives.
    fn plain(&self, values: &[f64], trajectory: &Trajectory) -> Result<Vec<f64>, FitError> {
        let (mechanism, options) = self.at(values).map_err(FitError::BadRequest)?;
        let states = follow(&mechanism, &options, trajectory)
            .map_err(|error| FitError::Motion(trajectory.name.clone(), error.into()))?;
        Ok(self.differences_of(trajectory, &states))
    }

    /// The differences of some trajectories at these values, with derivatives.
    fn evaluate(&self, values: &[f64], places: &[usize]) -> Result<Differences, FitError> {
        let (mechanism, options) = self.at(values).map_err(FitError::BadRequest)?;
        let (mut all, mut rows, mut without) = (Vec::new(), Vec::new(), Vec::new());
        for &place in places {
            let trajectory = &self.task.trajectories[place];
            let (coordinates, speeds) = trajectory.state.split_at(mechanism.count(ComponentKind::Coordinate));
            let start = State { time: trajectory.start, coordinates, speeds, inputs: &[] };
            let found =
                differentiate(&mechanism, &start, options.clone(), self.task.variables, &trajectory.times);
            let found = found.map_err(|error| FitError::Motion(trajectory.name.clone(), error))?;
            let states: Vec<Vec<f64>> = found.samples.iter().map(|sample| sample.state.clone()).collect();
            all.extend(self.differences_of(trajectory, &states));
            if found.undefined.is_some() {
                without.push(trajectory.name.clone());
                rows.extend(self.by_differences(values, trajectory)?);
                continue;
            }
            for (row, sample) in found.samples.iter().enumerate() {
                let Some(by) = &sample.derivative else { continue };
                for (column, (&index, unit)) in self.task.measured.iter().zip(self.task.units).enumerate() {
                    if !trajectory.samples[(row, column)].is_nan() {
                        rows.extend(by.row(index).iter().map(|by| by / unit));
                    }
                }
            }
        }
        let square = all.iter().map(|difference| difference * difference).sum();
        let outliers = all.iter().filter(|difference| difference.abs() > self.loss.size()).count();
        for (difference, row) in all.iter_mut().zip(rows.chunks_exact_mut(values.len().max(1))) {
            let (root, slope) = self.loss.root(*difference);
            *difference = root;
            row.iter_mut().for_each(|by| *by *= slope);
        }
        let by = DMatrix::from_row_slice(all.len(), values.len(), &rows);
        Ok(Differences { roots: DVector::from_vec(all), by, square, outliers, without })
    }

    /// Derivatives of the differences of a trajectory by finite differences, by rows.
    fn by_differences(&self, values: &[f64], trajectory: &Trajectory) -> Result<Vec<f64>, FitError> {
        let mut columns = Vec::with_capacity(values.len());
        for place in 0..values.len() {
            let h = STEP * values[place].abs().max(STEP);
            let moved = |h: f64| {
                let mut moved = values.to_vec();
                moved[place] += h;
                self.plain(&moved, trajectory)
            };
            // At the end of the range of a value a one-sided difference is used.
            let (above, below) = (moved(h), moved(-h));
            let here = || self.plain(values, trajectory);
            let (above, below, width) = match (above, below) {
                (Ok(above), Ok(below)) => (above, below, 2.0 * h),
                (Ok(above), Err(_)) => (above, here()?, h),
                (Err(_), Ok(below)) => (here()?, below, h),
                (Err(error), Err(_)) => return Err(error),
            };
            columns.push(above.iter().zip(&below).map(|(a, b)| (a - b) / width).collect::<Vec<f64>>());
        }
        let rows = columns.first().map_or(0, Vec::len);
        Ok((0..rows).flat_map(|row| columns.iter().map(move |column| column[row])).collect())
    }

    /// Runs the Levenberg-Marquardt method on these trajectories.
    fn minimise(
        &self,
        mut values: Vec<f64>,
        places: &[usize],
        steps: usize,
    ) -> Result<(Vec<f64>, Differences, usize), FitError> {
        let mut here = self.evaluate(&values, places)?;
        let mut damping = DAMPING;
        let mut made = 0;
        while made < steps {
            let normal = here.by.transpose() * &here.by;
            let slope = here.by.transpose() * &here.roots;
            let square = here.roots.norm_squared();
            let mut next = None;
            while damping < MAX_DAMPING {
                // Damping is relative to the curvature along each variable, so that their units do not
                // matter.
                let least = normal.diagonal().max() * f64::EPSILON;
                let damped = DMatrix::from_fn(values.len(), values.len(), |row, column| {
                    let more = if row == column { damping * normal[(row, row)].max(least) } else { 0.0 };
                    normal[(row, column)] + more
                });
                let step = damped.cholesky().map(|factor| factor.solve(&slope));
                let trial: Option<Vec<f64>> = step
                    .map(|step| values.iter().zip(step.iter()).map(|(value, step)| value - step).collect());
                // If the values are refused or their motions cannot be simulated, a shorter step is tried.
                if let Some(trial) = trial
                    && let Ok(there) = self.evaluate(&trial, places)
                    && there.roots.norm_squared() < square
                {
                    next = Some((trial, there));
                    break;
                }
                damping *= DAMPING_INCREASE;
            }
            let Some((trial, there)) = next else { break };
            let fallen = square - there.roots.norm_squared();
            (values, here) = (trial, there);
            damping = (damping * DAMPING_DECREASE).max(f64::EPSILON);
            made += 1;
            if fallen <= MIN_DECREASE * square {
                break;
            }
        }
        Ok((values, here, made))
    }

    /// Standard deviations of the values over bootstrap samples.
    fn bootstrap_spread(&self, values: &[f64]) -> Result<Vec<f64>, FitError> {
        let count = self.task.trajectories.len();
        let mut state = self.task.seed;
        let mut random = || next_random(&mut state);
        let mut sums = vec![(0.0, 0.0); values.len()];
        for _ in 0..self.task.bootstrap {
            let places: Vec<usize> = (0..count).map(|_| (random() % count as u64) as usize).collect();
            let (found, ..) = self.minimise(values.to_vec(), &places, BOOTSTRAP_STEPS)?;
            for (sum, (found, value)) in sums.iter_mut().zip(found.iter().zip(values)) {
                let off = found - value;
                *sum = (sum.0 + off, sum.1 + off * off);
            }
        }
        let n = self.task.bootstrap as f64;
        let deviation =
            |(sum, squares): &(f64, f64)| ((squares - sum * sum / n) / (n - 1.0).max(1.0)).max(0.0).sqrt();
        Ok(sums.iter().map(deviation).collect())
    }
}
