//! Derivatives of motions, periodic motions, and fits.

use hodograph::{ComponentKind, Mechanism as _, State};
use hodograph_gradients::{
    Adjoint, By, Exchange, Fit, FitError, FitTask, GradientError, Loss, Orbit, OrbitError, Periodic, Return,
    Trajectory, differentiate, find_orbit, follow_branch,
};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Event, Options};
use nalgebra::{DMatrix, DVector};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::errors;
use crate::laws::Raised;
use crate::machine::Machine;
use crate::motion::{self, Choices};
use crate::states::States;

/// When a motion has returned.
#[derive(FromPyObject)]
pub struct Periodicity {
    /// s, of motions that are driven in time
    #[pyo3(item)]
    period: Option<f64>,
    /// the event at which a motion returns, its contact, and how many of them make a period
    #[pyo3(item)]
    event: Option<String>,
    #[pyo3(item)]
    contact: Option<usize>,
    #[pyo3(item)]
    count: usize,
    /// numbers of coordinates that take their values of the start again
    #[pyo3(item)]
    reset: Vec<usize>,
    /// what a symmetry does to the state that has returned
    #[pyo3(item)]
    exchange: Vec<String>,
    #[pyo3(item)]
    longest: f64,
    /// segments of a period
    #[pyo3(item)]
    segments: usize,
    #[pyo3(item)]
    by: Vec<String>,
    /// a variable that a branch is followed through, and its range
    #[pyo3(item)]
    follow: Option<(String, f64, f64)>,
    #[pyo3(item)]
    points: usize,
}

/// Measured motions: name, start, state, times and samples of each.
pub type Measured<'py> = Vec<(String, f64, Vec<f64>, Vec<f64>, PyReadonlyArray2<'py, f64>)>;

/// What is fitted to what.
#[derive(FromPyObject)]
pub struct Fitted<'py> {
    #[pyo3(item)]
    trajectories: Measured<'py>,
    #[pyo3(item)]
    measured: Vec<usize>,
    #[pyo3(item)]
    units: Vec<f64>,
    #[pyo3(item)]
    variables: Vec<String>,
    #[pyo3(item)]
    huber: Option<f64>,
    #[pyo3(item)]
    cap: Option<f64>,
    /// s from the start up to which start states are fitted
    #[pyo3(item)]
    flight: Option<f64>,
    /// s from the start that are fitted one after the other
    #[pyo3(item)]
    horizons: Vec<f64>,
    /// number of starts
    #[pyo3(item)]
    starts: usize,
    #[pyo3(item)]
    bootstrap: usize,
    #[pyo3(item)]
    seed: u64,
}

pub fn argument(py: Python<'_>, message: &str) -> PyErr {
    errors::argument(py, "argument", "bad_option", message)
}

fn gradient_error(py: Python<'_>, error: &GradientError) -> PyErr {
    match error {
        GradientError::Simulation(error) => motion::failed(py, error),
        GradientError::NotSupported(_) => {
            errors::error(py, "SimulationError", &error.to_string(), "not_supported", None, None)
        }
        error => argument(py, &error.to_string()),
    }
}

fn orbit_error(py: Python<'_>, error: &OrbitError) -> PyErr {
    let kind = match error {
        OrbitError::Gradient(error) => return gradient_error(py, error),
        OrbitError::BadRequest(message) => return argument(py, message),
        OrbitError::Undefined(_) => "not_differentiable",
        OrbitError::NoReturn(_) => "no_return",
        _ => "not_found",
    };
    errors::error(py, "SimulationError", &error.to_string(), kind, None, None)
}

fn variables(py: Python<'_>, mechanism: &InterpretedMechanism, names: &[String]) -> PyResult<Vec<By>> {
    let named = |name: &String| {
        By::named(mechanism, name).map_err(|message| errors::argument(py, name, "unknown_name", &message))
    };
    names.iter().map(named).collect()
}

/// A matrix by rows.
pub fn matrix<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let numbers = matrix.transpose().as_slice().to_vec();
    PyArray1::from_vec(py, numbers).reshape([matrix.nrows(), matrix.ncols()])
}

/// Derivatives of functions of the states of a motion at these times, found backwards. `weights` is called with the states
/// (k, n + p), and returns the gradients of the functions by them (m, k, n + p).
pub fn adjoint<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    (by, at): (&[String], &[f64]),
    weights: &Bound<'py, PyAny>,
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let mechanism = machine.derived(py, "derivatives of motions")?;
    let state = motion::start(py, states)?;
    let options = motion::options(py, machine, &state, choices, &Raised::default())?;
    let by = variables(py, mechanism, by)?;
    let found = py.detach(|| Adjoint::new(mechanism, &state, options, &by, at));
    let found = found.map_err(|error| gradient_error(py, &error))?;
    let samples = found.samples();
    let size = samples.first().map_or(0, |sample| sample.state.len());
    let numbers: Vec<f64> = samples.iter().flat_map(|sample| &sample.state).copied().collect();
    let seen = PyArray1::from_vec(py, numbers).reshape([samples.len(), size])?;
    let weights: PyReadonlyArray3<'py, f64> = weights.call1((&seen,))?.extract()?;
    let [functions, times, own] = [0, 1, 2].map(|axis| weights.shape()[axis]);
    if (times, own) != (samples.len(), size) {
        let expected = (samples.len(), size);
        return Err(argument(
            py,
            &format!(
                "the weights have the shape (.., {times}, {own}): expected (.., {}, {})",
                expected.0, expected.1
            ),
        ));
    }
    let weights = weights.as_array();
    let mut gradients = Vec::with_capacity(functions * by.len());
    for function in weights.outer_iter() {
        let weights: Vec<DVector<f64>> =
            function.outer_iter().map(|row| DVector::from_iterator(size, row.iter().copied())).collect();
        let gradient = found.of_states(&weights).map_err(|why| {
            let contact = contact_of(mechanism, why.contact).map(str::to_owned);
            errors::error(
                py,
                "SimulationError",
                &why.to_string(),
                "not_differentiable",
                contact,
                Some(why.time),
            )
        })?;
        gradients.extend_from_slice(gradient.as_slice());
    }
    let all = PyDict::new(py);
    all.set_item("states", seen)?;
    all.set_item("by", PyArray1::from_vec(py, gradients).reshape([functions, by.len()])?)?;
    Ok(all)
}

fn contact_of(mechanism: &InterpretedMechanism, contact: Option<usize>) -> Option<&str> {
    mechanism.component(ComponentKind::Contact, contact?).map(|found| found.name)
}

/// A motion at these times, with its derivatives.
pub fn gradient<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    by: &[String],
    at: &[f64],
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let mechanism = machine.derived(py, "derivatives of motions")?;
    let state = motion::start(py, states)?;
    let options = motion::options(py, machine, &state, choices, &Raised::default())?;
    let by = variables(py, mechanism, by)?;
    let found = py.detach(|| differentiate(mechanism, &state, options, &by, at));
    let found = found.map_err(|error| gradient_error(py, &error))?;
    let all = PyDict::new(py);
    let samples = PyList::empty(py);
    for sample in &found.samples {
        let derivative = sample.derivative.as_ref().map(|by| matrix(py, by)).transpose()?;
        samples.append((sample.time, PyArray1::from_slice(py, &sample.state), derivative))?;
    }
    all.set_item("samples", samples)?;
    let events = PyList::empty(py);
    for event in &found.events {
        let of = |by: &Option<DMatrix<f64>>| by.as_ref().map(|by| matrix(py, by)).transpose();
        let time = event.time.as_ref().map(|by: &DVector<f64>| PyArray1::from_slice(py, by.as_slice()));
        let told = told(py, mechanism, &event.event);
        events.append((told, time, of(&event.before)?, of(&event.after)?))?;
    }
    all.set_item("events", events)?;
    let undefined = found.undefined.as_ref();
    let undefined = undefined
        .map(|why| (why.time, contact_of(mechanism, why.contact).map(str::to_owned), why.to_string()));
    all.set_item("undefined", undefined)?;
    Ok(all)
}

/// Time, kind, contact and state of an event.
type Told<'py> = (f64, &'static str, Option<String>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

fn told<'py>(py: Python<'py>, mechanism: &InterpretedMechanism, event: &Event) -> Told<'py> {
    let [q, u] = [&event.coordinates, &event.speeds].map(|numbers| PyArray1::from_slice(py, numbers));
    (event.time, event.kind.name(), contact_of(mechanism, event.contact).map(str::to_owned), q, u)
}

fn of_orbit<'py>(
    py: Python<'py>,
    mechanism: &InterpretedMechanism,
    orbit: &Orbit,
) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("state", PyArray1::from_slice(py, &orbit.state))?;
    let nodes: Vec<(f64, Bound<'py, PyArray1<f64>>)> =
        orbit.nodes.iter().map(|(time, state)| (*time, PyArray1::from_slice(py, state))).collect();
    all.set_item("nodes", nodes)?;
    all.set_item("period", orbit.period)?;
    all.set_item("matrix", matrix(py, &orbit.matrix)?)?;
    all.set_item("by", matrix(py, &orbit.by)?)?;
    all.set_item("multipliers", orbit.multipliers.iter().map(|z| (z.re, z.im)).collect::<Vec<_>>())?;
    all.set_item("stable", orbit.is_stable())?;
    all.set_item("residual", orbit.residual)?;
    let events = PyList::empty(py);
    for event in &orbit.events {
        events.append(told(py, mechanism, event))?;
    }
    all.set_item("events", events)?;
    Ok(all)
}

/// A periodic motion next to a state, or a branch of them.
pub fn orbit<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    of: &Periodicity,
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let mechanism = machine.derived(py, "periodic motions")?;
    let state = motion::start(py, states)?;
    let options = motion::options(py, machine, &state, choices, &Raised::default())?;
    let returns = match (&of.period, &of.event) {
        (Some(period), None) => Return::After(*period),
        (None, Some(event)) if Return::EVENTS.contains(&event.as_str()) => {
            Return::At { event: event.clone(), contact: of.contact, count: of.count }
        }
        (None, Some(event)) => {
            let message = format!(
                "there is no event '{event}' at which a motion returns: expected one of {}",
                Return::EVENTS.join(", ")
            );
            return Err(errors::argument(py, "event", "unknown_name", &message));
        }
        _ => return Err(argument(py, "expected either `period`, or `event` at which a motion returns")),
    };
    let exchanged = |text: &String| {
        Exchange::named(mechanism, text)
            .map_err(|message| errors::argument(py, "exchange", "unknown_name", &message))
    };
    let symmetry = of.exchange.iter().map(exchanged).collect::<PyResult<Vec<Exchange>>>()?;
    let periodic =
        Periodic { returns, reset: of.reset.clone(), symmetry, longest: of.longest, segments: of.segments };
    let all = PyDict::new(py);
    let Some((name, from, to)) = &of.follow else {
        let by = variables(py, mechanism, &of.by)?;
        let found = py.detach(move || {
            let options = options;
            find_orbit(mechanism, &state, &options, &periodic, &by)
        });
        let found = found.map_err(|error| orbit_error(py, &error))?;
        all.set_item("orbit", of_orbit(py, mechanism, &found)?)?;
        return Ok(all);
    };
    let by = variables(py, mechanism, std::slice::from_ref(name))?[0];
    let found = py.detach(move || {
        let options = options;
        follow_branch(mechanism, &state, &options, &periodic, (by, *from, *to), of.points)
    });
    let found = found.map_err(|error| orbit_error(py, &error))?;
    let points = PyList::empty(py);
    for point in &found.points {
        points.append((point.value, of_orbit(py, mechanism, &point.orbit)?))?;
    }
    let changes = PyList::empty(py);
    for change in &found.changes {
        let orbit = of_orbit(py, mechanism, &change.at.orbit)?;
        changes.append((change.kind.name(), change.at.value, orbit))?;
    }
    all.set_item("points", points)?;
    all.set_item("changes", changes)?;
    all.set_item("ended", found.ended)?;
    Ok(all)
}

/// The mechanism, the options and the variables with which measured motions are compared.
pub fn compared<'m>(
    py: Python<'_>,
    machine: &'m Machine,
    states: &States<'_>,
    names: &[String],
    choices: Choices,
) -> PyResult<(&'m InterpretedMechanism, Options, Vec<By>)> {
    let mechanism = machine.derived(py, "comparisons with measured motions")?;
    let state: State<'_> = motion::start(py, states)?;
    if !state.inputs.is_empty() {
        return Err(argument(py, "measured motions of mechanisms with inputs are not compared yet"));
    }
    let options = motion::options(py, machine, &state, choices, &Raised::default())?;
    Ok((mechanism, options, variables(py, mechanism, names)?))
}

/// Measured motions as a fit takes them.
pub fn trajectories(measured: &Measured<'_>) -> Vec<Trajectory> {
    let one = |(name, start, state, times, samples): &(_, _, _, _, PyReadonlyArray2<'_, f64>)| Trajectory {
        name: String::clone(name),
        start: *start,
        state: Vec::clone(state),
        times: Vec::clone(times),
        samples: DMatrix::from_row_iterator(
            samples.shape()[0],
            samples.shape()[1],
            samples.as_array().iter().copied(),
        ),
    };
    measured.iter().map(one).collect()
}

/// Parameters, mu and e fitted to measured motions.
pub fn fit<'py>(
    py: Python<'py>,
    machine: &Machine,
    states: &States<'py>,
    fitted: &Fitted<'py>,
    choices: Choices,
) -> PyResult<Bound<'py, PyDict>> {
    let (mechanism, options, by) = compared(py, machine, states, &fitted.variables, choices)?;
    let trajectories = trajectories(&fitted.trajectories);
    let failed = |error: FitError| match error {
        FitError::BadRequest(message) => argument(py, &message),
        error => errors::error(py, "SimulationError", &error.to_string(), "not_fitted", None, None),
    };
    let task = FitTask {
        trajectories: &trajectories,
        measured: &fitted.measured,
        units: &fitted.units,
        variables: &by,
        loss: fitted.huber.map(Loss::Huber).or(fitted.cap.map(Loss::Cap)).unwrap_or_default(),
        flight: fitted.flight,
        horizons: &fitted.horizons,
        starts: fitted.starts,
        bootstrap: fitted.bootstrap,
        seed: fitted.seed,
    };
    let found = py
        .detach(move || {
            let options = options;
            hodograph_gradients::fit(mechanism, &options, &task)
        })
        .map_err(failed)?;
    let Fit {
        values, surfaces, rms, differences, errors, correlations, undetermined, spread, minima, ..
    } = &found;
    let all = PyDict::new(py);
    let starts = PyDict::new(py);
    for start in &found.starts {
        let covariance = matrix(py, &start.covariance)?;
        let Trajectory { name, state, .. } = &start.trajectory;
        starts.set_item(name, (state.clone(), start.errors.clone(), covariance, start.rms))?;
    }
    all.set_item("starts", starts)?;
    all.set_item("minima", minima.clone())?;
    all.set_item("values", PyArray1::from_slice(py, values))?;
    all.set_item("errors", PyArray1::from_slice(py, errors))?;
    all.set_item("correlations", matrix(py, correlations)?)?;
    let directions = undetermined.iter().map(|direction| PyArray1::from_slice(py, direction));
    all.set_item("undetermined", directions.collect::<Vec<_>>())?;
    all.set_item("spread", spread.as_ref().map(|spread| PyArray1::from_slice(py, spread)))?;
    all.set_item("rms", rms)?;
    all.set_item("differences", differences)?;
    all.set_item("outliers", found.outliers)?;
    all.set_item("without_derivatives", &found.without_derivatives)?;
    all.set_item("steps", found.steps)?;
    let surfaces = surfaces.iter().map(|(contact, surface)| {
        let name = contact_of(mechanism, Some(*contact)).map(str::to_owned);
        (name, surface.mu, surface.e, surface.law.name())
    });
    all.set_item("surfaces", surfaces.collect::<Vec<_>>())?;
    Ok(all)
}
