//! Errors of predictions of measured motions.

use hodograph_gradients::validation::{Measure, Noise, floor, noise_replicate, predict};
use hodograph_gradients::{statistics, with_values};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::gradients::{Measured, argument, compared, matrix, trajectories};
use crate::machine::Machine;
use crate::motion::Choices;
use crate::states::States;

/// What is predicted, with what, and what it is compared with.
#[derive(FromPyObject)]
pub struct Judged<'py> {
    #[pyo3(item)]
    trajectories: Measured<'py>,
    #[pyo3(item)]
    measured: Vec<usize>,
    #[pyo3(item)]
    units: Vec<f64>,
    /// the names of the values that were fitted, and these
    #[pyo3(item)]
    variables: Vec<String>,
    #[pyo3(item)]
    values: Vec<f64>,
    /// standard deviations of the measured quantities; none: no replicas
    #[pyo3(item)]
    noise: Option<Vec<f64>>,
    #[pyo3(item)]
    floor: bool,
    #[pyo3(item)]
    seed: u64,
}

/// The errors of each motion, NaN where it cannot be predicted, and the predictions.
pub fn validate<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    judged: &Judged<'py>,
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let (mechanism, options, by) = compared(py, machine, states, &judged.variables, choices)?;
    let (mechanism, options) =
        with_values(mechanism, &options, &by, &judged.values).map_err(|message| argument(py, &message))?;
    let list = trajectories(&judged.trajectories);
    let measure = Measure { measured: &judged.measured, units: &judged.units };
    let (noise, with_floor, seed) = (judged.noise.as_deref(), judged.floor, judged.seed);
    let found = py.detach(|| {
        let (mechanism, options, mut random) = (mechanism, options, Noise::new(seed));
        let one = |trajectory| {
            let predicted = predict(&mechanism, &options, measure, trajectory);
            let at_rest = measure.error(&trajectory.samples, &measure.at_rest(trajectory));
            let noise = noise.map(|errors| {
                let replica =
                    noise_replicate(&mechanism, &options, measure, (trajectory, errors), &mut random);
                replica.unwrap_or(f64::NAN)
            });
            let least =
                with_floor.then(|| floor(&mechanism, &options, measure, &by, trajectory).unwrap_or(f64::NAN));
            (predicted, at_rest, noise, least)
        };
        list.iter().map(one).collect::<Vec<_>>()
    });
    let errors = found.iter().zip(&list).map(|((predicted, ..), trajectory)| match predicted {
        Ok(predicted) => measure.error(&trajectory.samples, predicted),
        Err(_) => f64::NAN,
    });
    let all = PyDict::new(py);
    all.set_item("errors", PyArray1::from_iter(py, errors))?;
    all.set_item("at_rest", PyArray1::from_iter(py, found.iter().map(|(_, at_rest, ..)| *at_rest)))?;
    let noise: Option<Vec<f64>> = found.iter().map(|(_, _, noise, _)| *noise).collect();
    all.set_item(
        "noise",
        noise.filter(|_| judged.noise.is_some()).map(|noise| PyArray1::from_vec(py, noise)),
    )?;
    let least: Option<Vec<f64>> = found.iter().map(|(.., least)| *least).collect();
    all.set_item("floor", least.filter(|_| judged.floor).map(|least| PyArray1::from_vec(py, least)))?;
    let predictions = found.iter().map(|(predicted, ..)| match predicted {
        Ok(predicted) => Ok(Some(matrix(py, predicted)?)),
        Err(_) => Ok(None),
    });
    all.set_item("predictions", predictions.collect::<PyResult<Vec<_>>>()?)?;
    let failed = found.iter().map(|(predicted, ..)| predicted.as_ref().err().map(ToString::to_string));
    all.set_item("failed", failed.collect::<Vec<_>>())?;
    Ok(all)
}

/// Wilcoxon's signed-rank test of differences: the two-sided p, and whether it is exact.
#[pyfunction]
pub fn signed_ranks(differences: Vec<f64>) -> (f64, bool) {
    let found = statistics::signed_ranks(&differences);
    (found.p, found.is_exact)
}

/// Wilson's interval, of 95 %, for the probability of what happened `right` times of `count`.
#[pyfunction]
pub fn wilson_interval(right: usize, count: usize) -> (f64, f64) {
    let [low, high] = statistics::wilson_interval(right, count);
    (low, high)
}
