//! The differences between measured motions and those of a mechanism with some values, and the method of Levenberg and
//! Marquardt, which makes the sum of what they cost least.
//!
//! Theory: docs/theory.md, section 21.

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::{DMatrix, DVector};

use crate::family::with_values;
use crate::fit_task::{FitError, FitTask};
use crate::start_state::{FittedStart, by_state, fit_start, start_by};
use crate::trajectory::{Trajectory, follow};
use crate::{Loss, differentiate};

/// Damping: initial value, factors after an accepted and after a rejected step, and largest value.
const DAMPING: f64 = 1e-3;
const DAMPING_DECREASE: f64 = 0.2;
const DAMPING_INCREASE: f64 = 5.0;
const MAX_DAMPING: f64 = 1e12;
/// The method stops if the sum of squares decreases by less than this part.
const MIN_DECREASE: f64 = 1e-14;
/// Relative step of finite differences for motions without derivatives.
const STEP: f64 = 1e-5;

/// The differences between measurements and motions for some values.
pub(crate) struct Differences {
    /// the numbers whose squares the differences cost
    pub roots: DVector<f64>,
    /// their derivatives with respect to the variables
    pub by: DMatrix<f64>,
    /// the sum of the squares of the differences
    pub square: f64,
    /// the number of differences that cost less than their squares
    pub outliers: usize,
    /// trajectories without derivatives
    pub without: Vec<String>,
}

/// The sum of what the differences cost, as a function of the values.
#[derive(Clone, Copy)]
pub(crate) struct Problem<'a> {
    pub mechanism: &'a InterpretedMechanism,
    pub options: &'a Options,
    pub task: &'a FitTask<'a>,
    pub loss: Loss,
}

impl Problem<'_> {
    /// The mechanism and the options with these values.
    pub fn at(&self, values: &[f64]) -> Result<(InterpretedMechanism, Options), String> {
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

    /// The start of a trajectory with this mechanism, if it follows from its flight.
    fn fitted(
        &self,
        mechanism: &InterpretedMechanism,
        options: &Options,
        trajectory: &Trajectory,
    ) -> Result<Option<FittedStart>, FitError> {
        let measure = (self.task.measured, self.task.units);
        let fitted = |flight| fit_start(mechanism, options, measure, trajectory, flight);
        self.task.flight.map(fitted).transpose()
    }

    /// The differences without derivatives.
    fn plain(&self, values: &[f64], trajectory: &Trajectory) -> Result<Vec<f64>, FitError> {
        let (mechanism, options) = self.at(values).map_err(FitError::BadRequest)?;
        let fitted = self.fitted(&mechanism, &options, trajectory)?;
        let trajectory = fitted.as_ref().map_or(trajectory, |found| &found.trajectory);
        let states = follow(&mechanism, &options, trajectory)
            .map_err(|error| FitError::Motion(trajectory.name.clone(), error.into()))?;
        Ok(self.differences_of(trajectory, &states))
    }

    /// The differences of some trajectories at these values, with derivatives.
    fn evaluate(&self, values: &[f64], places: &[usize]) -> Result<Differences, FitError> {
        let (mechanism, options) = self.at(values).map_err(FitError::BadRequest)?;
        let (mut all, mut rows, mut without) = (Vec::new(), Vec::new(), Vec::new());
        for &place in places {
            let given = &self.task.trajectories[place];
            let fitted = self.fitted(&mechanism, &options, given)?;
            let trajectory = fitted.as_ref().map_or(given, |found| &found.trajectory);
            let (coordinates, speeds) = trajectory.state.split_at(mechanism.count(ComponentKind::Coordinate));
            let start = State { time: trajectory.start, coordinates, speeds, inputs: &[] };
            let own = self.task.variables;
            let mut variables = own.to_vec();
            let mut start_changes = None;
            if let (Some(fitted), Some(flight)) = (&fitted, self.task.flight) {
                variables.extend(by_state(coordinates.len(), speeds.len()));
                let measure = (self.task.measured, self.task.units);
                start_changes = Some(start_by(&mechanism, &options, measure, (given, fitted), flight, own)?);
            }
            let found = differentiate(&mechanism, &start, options.clone(), &variables, &trajectory.times);
            let found = found.map_err(|error| FitError::Motion(trajectory.name.clone(), error))?;
            let states: Vec<Vec<f64>> = found.samples.iter().map(|sample| sample.state.clone()).collect();
            let differences = self.differences_of(trajectory, &states);
            if !differences.iter().map(|difference| difference * difference).sum::<f64>().is_finite() {
                return Err(FitError::NotFinite(trajectory.name.clone()));
            }
            all.extend(differences);
            if found.undefined.is_some() {
                without.push(trajectory.name.clone());
                rows.extend(self.by_differences(values, given)?);
                continue;
            }
            for (row, sample) in found.samples.iter().enumerate() {
                let Some(by) = &sample.derivative else { continue };
                let mut total = by.columns(0, own.len()).into_owned();
                if let Some(changes) = &start_changes {
                    total += by.columns(own.len(), changes.nrows()) * changes;
                }
                for (column, (&index, unit)) in self.task.measured.iter().zip(self.task.units).enumerate() {
                    if !trajectory.samples[(row, column)].is_nan() {
                        rows.extend(total.row(index).iter().map(|by| by / unit));
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
    pub fn minimise(
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
}
