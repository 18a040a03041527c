//! Start states of measured motions, fitted to what was measured before anything is struck.
//!
//! Theory: docs/theory.md, section 21.

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{EventKind, Options};
use nalgebra::{DMatrix, DVector};

use crate::fit_task::FitError;
use crate::trajectory::Trajectory;
use crate::{By, differentiate};

/// A motion whose start state was fitted.
#[derive(Clone, Debug)]
pub struct FittedStart {
    /// the motion from there
    pub trajectory: Trajectory,
    /// standard errors of coordinates and independent speeds; infinite where the samples do not determine them
    pub errors: Vec<f64>,
    /// their covariance, without what is not determined
    pub covariance: DMatrix<f64>,
    /// root mean square of the differences that are left, in their units
    pub rms: f64,
}

/// Largest number of steps, and of halvings of one.
const STEPS: usize = 20;
const HALVINGS: usize = 8;
/// The method stops if the sum of squares decreases by less than this part.
const MIN_DECREASE: f64 = 1e-12;
/// Singular values below this part of the greatest mean directions that the samples do not determine.
const UNDETERMINED: f64 = 1e-9;

/// Fits the start state of a motion to its first row and to its samples within `flight` s of it, in which nothing may be
/// struck: `measured` are the columns of its samples, `units` their errors.
///
/// # Errors
///
/// [`FitError`]
pub fn fit_start(
    mechanism: &InterpretedMechanism,
    options: &Options,
    (measured, units): (&[usize], &[f64]),
    trajectory: &Trajectory,
    flight: f64,
) -> Result<FittedStart, FitError> {
    let bad = |what: String| Err(FitError::BadRequest(format!("trajectory {}: {what}", trajectory.name)));
    let Some(first) = trajectory.until(flight).filter(|_| flight > 0.0) else {
        return bad(format!("there is no sample in its first {flight} s"));
    };
    let task = Flight { mechanism, options, measured, units, first: &first };
    let mut state = trajectory.state.clone();
    let (mut off, mut by) = task.differences(&state, &[])?;
    for _ in 0..STEPS {
        let step = least(&by, &off);
        let mut part = 1.0;
        let mut next = None;
        for _ in 0..HALVINGS {
            let mut trial: Vec<f64> =
                state.iter().zip(step.iter()).map(|(value, step)| value - part * step).collect();
            let n = mechanism.count(ComponentKind::Coordinate);
            // A rotation that cannot be brought to length one is not near to any.
            if mechanism.normalise(&mut trial[..n]).is_ok()
                && let Ok(there) = task.differences(&trial, &[])
                && there.0.norm_squared() < off.norm_squared()
            {
                next = Some((trial, there));
                break;
            }
            part *= 0.5;
        }
        let Some((trial, there)) = next else { break };
        let fallen = off.norm_squared() - there.0.norm_squared();
        let done = fallen <= MIN_DECREASE * off.norm_squared();
        (state, (off, by)) = (trial, there);
        if done {
            break;
        }
    }
    let decomposed = by.svd(false, true);
    let (values, count) = (&decomposed.singular_values, state.len());
    let floor = UNDETERMINED * values.max();
    let Some(directions) = &decomposed.v_t else { return bad("its start cannot be fitted".to_owned()) };
    let known = values.iter().filter(|value| **value > floor).count();
    let free = off.len().saturating_sub(known);
    let square = off.norm_squared() / free.max(1) as f64;
    let (mut covariance, mut determined) = (DMatrix::zeros(count, count), DMatrix::zeros(count, count));
    for (value, direction) in values.iter().zip(directions.row_iter()) {
        if *value > floor {
            determined += direction.transpose() * direction;
            covariance += direction.transpose() * direction * (square / (value * value));
        }
    }
    let error = |place: usize| {
        // without a difference beyond what they determine, the samples tell no error
        let lost = free == 0 || 1.0 - determined[(place, place)] > 1e-6;
        if lost { f64::INFINITY } else { f64::sqrt(covariance[(place, place)]) }
    };
    let errors = (0..count).map(error).collect();
    let rms = (off.norm_squared() / off.len().max(1) as f64).sqrt();
    Ok(FittedStart { trajectory: Trajectory { state, ..trajectory.clone() }, errors, covariance, rms })
}

/// How a start state that was fitted changes with these variables: a row for each coordinate and independent speed, a
/// column for each variable. To the order of the differences that are left it is that of the least squares at a state
/// that follows the variables.
pub(crate) fn start_by(
    mechanism: &InterpretedMechanism,
    options: &Options,
    (measured, units): (&[usize], &[f64]),
    (given, found): (&Trajectory, &FittedStart),
    flight: f64,
    variables: &[By],
) -> Result<DMatrix<f64>, FitError> {
    let count = found.trajectory.state.len();
    let Some(first) = given.until(flight) else { return Ok(DMatrix::zeros(count, variables.len())) };
    let task = Flight { mechanism, options, measured, units, first: &first };
    let (_, by) = task.differences(&found.trajectory.state, variables)?;
    let (own, others) = (by.columns(0, count).into_owned(), by.columns(count, variables.len()));
    let columns: Vec<DVector<f64>> =
        others.column_iter().map(|column| -least(&own, &column.into_owned())).collect();
    Ok(DMatrix::from_fn(count, variables.len(), |row, column| columns[column][row]))
}

/// The first samples of a motion.
struct Flight<'a> {
    mechanism: &'a InterpretedMechanism,
    options: &'a Options,
    measured: &'a [usize],
    units: &'a [f64],
    first: &'a Trajectory,
}

impl Flight<'_> {
    /// The differences of the motion from a state and its samples, its first row among them, in their units, and their
    /// derivatives by the state and by other variables.
    fn differences(&self, state: &[f64], others: &[By]) -> Result<(DVector<f64>, DMatrix<f64>), FitError> {
        let Trajectory { name, start, times, samples, state: given } = self.first;
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let (coordinates, speeds) = state.split_at(n);
        let variables: Vec<By> = by_state(n, speeds.len()).chain(others.iter().copied()).collect();
        let from = State { time: *start, coordinates, speeds, inputs: &[] };
        let found = differentiate(self.mechanism, &from, self.options.clone(), &variables, times)
            .map_err(|error| FitError::Motion(name.clone(), error))?;
        let bad = |what: String| FitError::BadRequest(format!("trajectory {name}: {what}"));
        let struck = found.events.iter().map(|event| &event.event);
        let mut struck = struck.filter(|event| !matches!(event.kind, EventKind::Rest));
        if let Some(event) = struck.next() {
            let contact =
                event.contact.and_then(|index| self.mechanism.component(ComponentKind::Contact, index));
            let at = contact.map_or("?", |contact| contact.name);
            return Err(bad(format!(
                "something is struck ({at}) at {} s: give a shorter flight",
                event.time
            )));
        }
        if let Some(why) = found.undefined {
            return Err(bad(why.to_string()));
        }
        let (mut off, mut rows) = (Vec::new(), Vec::new());
        for (&index, unit) in self.measured.iter().zip(self.units) {
            off.push((state[index] - given[index]) / unit);
            rows.extend((0..variables.len()).map(|place| f64::from(u8::from(place == index)) / unit));
        }
        for (row, sample) in found.samples.iter().enumerate() {
            let Some(by) = &sample.derivative else { continue };
            for (column, (&index, unit)) in self.measured.iter().zip(self.units).enumerate() {
                let measured = samples[(row, column)];
                if !measured.is_nan() {
                    off.push((sample.state[index] - measured) / unit);
                    rows.extend(by.row(index).iter().map(|by| by / unit));
                }
            }
        }
        let by = DMatrix::from_row_slice(off.len(), variables.len(), &rows);
        Ok((DVector::from_vec(off), by))
    }
}

/// Each coordinate and each speed of a start state, as variables.
pub(crate) fn by_state(coordinates: usize, speeds: usize) -> impl Iterator<Item = By> {
    (0..coordinates).map(By::Coordinate).chain((0..speeds).map(By::Speed))
}

/// The least squares step in columns of unit size, so that units of the state do not matter.
fn least(by: &DMatrix<f64>, off: &DVector<f64>) -> DVector<f64> {
    let sizes: Vec<f64> = by.column_iter().map(|column| column.norm()).collect();
    let size = |place: usize| if sizes[place] > 0.0 { sizes[place] } else { 1.0 };
    let scaled = DMatrix::from_fn(by.nrows(), by.ncols(), |row, column| by[(row, column)] / size(column));
    let decomposed = scaled.svd(true, true);
    let floor = UNDETERMINED * decomposed.singular_values.max();
    let step = decomposed.solve(off, floor).unwrap_or_else(|_| DVector::zeros(by.ncols()));
    DVector::from_fn(by.ncols(), |place, _| step[place] / size(place))
}
