//! Fits parameters, mu and e to measured motions, by least squares with exact derivatives.
//!
//! Theory: docs/theory.md, section 21.

use hodograph::{ComponentKind, Mechanism, Surface};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use hodograph_simulation::random::next_random;
use nalgebra::DMatrix;

use crate::family::{resolve_surfaces, value_of};
use crate::fit_task::{FitError, FitTask};
use crate::least_squares::{Differences, Problem};
use crate::start_state::{FittedStart, fit_start, start_by};
use crate::trajectory::Trajectory;
use crate::{By, Loss};

/// The result of a fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// the fitted values, in the order of the variables
    pub values: Vec<f64>,
    /// the surfaces of the contacts with these values
    pub surfaces: Vec<(usize, Surface<f64>)>,
    /// root mean square of the differences, in their units
    pub rms: f64,
    /// the values and the root mean square at the minimum that each start led to, the least first
    pub minima: Vec<(Vec<f64>, f64)>,
    /// the number of differences that cost less than their squares
    pub outliers: usize,
    /// the number of differences
    pub differences: usize,
    /// standard errors from the curvature of the sum of what the differences cost, and from what remains of it; infinite
    /// where the data do not determine a value, and with no more differences than values
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
    /// the start states that were fitted, with these values; none without a flight
    pub starts: Vec<FittedStart>,
}

/// Largest number of steps of the Levenberg-Marquardt method, and of those for a bootstrap sample, which
/// starts from the fit.
const STEPS: usize = 60;
const BOOTSTRAP_STEPS: usize = 8;
/// Random starts have values between those of the first one divided by this and times this.
const FARTHEST: f64 = 4.0;
/// A singular value of the derivatives with respect to relative changes below this part of the greatest means
/// a direction that the data do not determine.
const UNDETERMINED: f64 = 1e-8;
/// Fits the variables, starting from the values of the mechanism and the options.
///
/// # Errors
///
/// [`FitError`]
pub fn fit(mechanism: &InterpretedMechanism, options: &Options, task: &FitTask<'_>) -> Result<Fit, FitError> {
    check(mechanism, task)?;
    let first: Result<Vec<f64>, String> =
        task.variables.iter().map(|&by| value_of(mechanism, options, by)).collect();
    let first = first.map_err(FitError::BadRequest)?;
    // Start states that depend on no variable are fitted once.
    let known = starts_that_stay(mechanism, options, task)?;
    let trajectories: Vec<Trajectory> =
        known.iter().flatten().map(|start| start.trajectory.clone()).collect();
    let task = &match known {
        Some(_) => FitTask { trajectories: &trajectories, flight: None, ..task.clone() },
        None => task.clone(),
    };
    let problem = Problem { mechanism, options, task, loss: task.loss };
    let mut found = vec![descend(&problem, first.clone())?];
    let mut random = task.seed;
    for _ in 1..task.starts {
        let mut start = first.clone();
        for (value, by) in start.iter_mut().zip(task.variables) {
            let part = next_random(&mut random) as f64 / u64::MAX as f64;
            *value *= FARTHEST.powf(2.0 * part - 1.0);
            if matches!(by, By::Restitution(_)) {
                *value = value.min(1.0);
            }
        }
        // A start whose motions cannot be followed finds nothing.
        found.extend(descend(&problem, start));
    }
    found.sort_by(|a, b| a.1.roots.norm_squared().total_cmp(&b.1.roots.norm_squared()));
    let rms = |here: &Differences| (here.square / here.roots.len().max(1) as f64).sqrt();
    let minima = found.iter().map(|(values, here, _)| (values.clone(), rms(here))).collect();
    let (values, here, steps) = found.swap_remove(0);
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
    // A value in an undetermined direction has no error, and none has one where no difference is left that tells of it.
    let exact = count <= values.len();
    let lost = |place: usize| exact || undetermined.iter().any(|direction| direction[place].abs() > 1e-6);
    let own = |place: usize| f64::sqrt(covariance[(place, place)]);
    let errors =
        (0..values.len()).map(|place| if lost(place) { f64::INFINITY } else { own(place) * scale[place] });
    let correlations = DMatrix::from_fn(values.len(), values.len(), |row, column| {
        let product = own(row) * own(column);
        if product > 0.0 { covariance[(row, column)] / product } else { f64::from(u8::from(row == column)) }
    });
    let spread = if task.bootstrap == 0 { None } else { Some(bootstrap_spread(&problem, &values)?) };
    let (there, mut fitted) = problem.at(&values).map_err(FitError::BadRequest)?;
    let starts = match (known, task.flight) {
        (Some(starts), _) => starts,
        (None, Some(flight)) => fit_starts(&there, &fitted, task, flight)?,
        (None, None) => Vec::new(),
    };
    resolve_surfaces(mechanism, &mut fitted);
    Ok(Fit {
        surfaces: fitted.surfaces,
        errors: errors.collect(),
        rms: rms(&here),
        minima,
        outliers: here.outliers,
        differences: count,
        correlations,
        undetermined,
        spread,
        without_derivatives: here.without,
        steps,
        starts,
        values,
    })
}

/// The start states of all motions with this mechanism.
fn fit_starts(
    mechanism: &InterpretedMechanism,
    options: &Options,
    task: &FitTask<'_>,
    flight: f64,
) -> Result<Vec<FittedStart>, FitError> {
    let measure = (task.measured, task.units);
    task.trajectories.iter().map(|one| fit_start(mechanism, options, measure, one, flight)).collect()
}

/// The start states that are fitted, if none of them depends on a variable, as on friction and restitution in flight.
fn starts_that_stay(
    mechanism: &InterpretedMechanism,
    options: &Options,
    task: &FitTask<'_>,
) -> Result<Option<Vec<FittedStart>>, FitError> {
    let Some(flight) = task.flight else { return Ok(None) };
    let starts = fit_starts(mechanism, options, task, flight)?;
    let measure = (task.measured, task.units);
    for (given, start) in task.trajectories.iter().zip(&starts) {
        let by = start_by(mechanism, options, measure, (given, start), flight, task.variables)?;
        if by.iter().any(|by| *by != 0.0) {
            return Ok(None);
        }
    }
    Ok(Some(starts))
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
    let rise = |pair: &[f64]| pair[0] < pair[1];
    if task.horizons.iter().any(|horizon| horizon.is_nan() || *horizon <= 0.0)
        || !task.horizons.windows(2).all(rise)
    {
        return bad("horizons must be positive and rise".to_owned());
    }
    if let Some(twice) = task.variables.iter().enumerate().find_map(|(place, by)| {
        let overlaps = |other: &&By| match (by, other) {
            (By::Friction(one), By::Friction(other)) | (By::Restitution(one), By::Restitution(other)) => {
                one.is_none() || other.is_none() || one == other
            }
            (by, other) => by == *other,
        };
        task.variables[..place].iter().find(overlaps)
    }) {
        let what = match twice {
            By::Friction(_) => "mu of all contacts and of one of them, or of one twice",
            By::Restitution(_) => "e of all contacts and of one of them, or of one twice",
            _ => "a parameter twice",
        };
        return bad(format!("it would fit {what}: name each value once"));
    }
    if task.flight.is_some_and(|flight| flight.is_nan() || flight <= 0.0) {
        return bad("the duration of the flight must be positive".to_owned());
    }
    if task.starts == 0 {
        return bad("a fit has at least one start".to_owned());
    }
    if task.bootstrap == 1 {
        return bad("one bootstrap sample has no spread: draw two at least".to_owned());
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

/// From a start to the minimum next to it, through all horizons: values, differences and number of steps.
fn descend(problem: &Problem<'_>, first: Vec<f64>) -> Result<(Vec<f64>, Differences, usize), FitError> {
    let (mut values, mut made) = (first, 0);
    let every = |task: &FitTask<'_>| (0..task.trajectories.len()).collect::<Vec<usize>>();
    for &horizon in problem.task.horizons {
        let short: Vec<Trajectory> =
            problem.task.trajectories.iter().filter_map(|one| one.until(horizon)).collect();
        let task = FitTask { trajectories: &short, ..problem.task.clone() };
        let steps;
        (values, _, steps) = Problem { task: &task, ..*problem }.minimise(values, &every(&task), STEPS)?;
        made += steps;
    }
    let all = every(problem.task);
    // Far from a minimum most differences may be beyond the cap, where nothing tells a direction.
    if let Loss::Cap(size) = problem.loss {
        let steps;
        (values, _, steps) = Problem { loss: Loss::Huber(size), ..*problem }.minimise(values, &all, STEPS)?;
        made += steps;
    }
    let (values, here, steps) = problem.minimise(values, &all, STEPS)?;
    Ok((values, here, made + steps))
}

/// Standard deviations of the values over bootstrap samples.
fn bootstrap_spread(problem: &Problem<'_>, values: &[f64]) -> Result<Vec<f64>, FitError> {
    let count = problem.task.trajectories.len();
    let mut state = problem.task.seed;
    let mut random = || next_random(&mut state);
    let mut sums = vec![(0.0, 0.0); values.len()];
    for _ in 0..problem.task.bootstrap {
        let places: Vec<usize> = (0..count).map(|_| (random() % count as u64) as usize).collect();
        let (found, ..) = problem.minimise(values.to_vec(), &places, BOOTSTRAP_STEPS)?;
        for (sum, (found, value)) in sums.iter_mut().zip(found.iter().zip(values)) {
            let off = found - value;
            *sum = (sum.0 + off, sum.1 + off * off);
        }
    }
    let n = problem.task.bootstrap as f64;
    let deviation = |(sum, squares): &(f64, f64)| ((squares - sum * sum / n) / (n - 1.0)).max(0.0).sqrt();
    Ok(sums.iter().map(deviation).collect())
}
