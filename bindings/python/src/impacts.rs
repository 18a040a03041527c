//! Collisions by themselves: the reduced matrix and the velocity of approach are given.

use hodograph::nalgebra::{SMatrix, Vector3};
use hodograph::{
    Characteristics, Hodograph, ImpactError, Motion, ReducedMatrix, Surface, phi_bar, snapshot_at,
};
use hodograph_interpreter::columns::{Column, Impacts, over_rows};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arguments::{Rows, Surfaces, array, common, raises, rows};
use crate::collisions::{Answers, Found, impact_error, width};

/// What [`solve_rows`] answers, and how many numbers that are.
pub const FIELDS: [(&str, usize); 5] =
    [("impulse", 3), ("velocity", 3), ("contact_work", 1), ("normal_work", 1), ("energy_gained", 1)];
const WIDTH: usize = width(&FIELDS);
/// What [`derivative_rows`] answers.
pub const DERIVATIVES: [(&str, usize); 3] = [("impulse", 33), ("velocity", 33), ("smooth", 1)];

/// The characteristic quantities of a collision, by the paper's names; NaN where one does not exist.
pub const CHARACTERISTICS: [&str; 16] = [
    "c_n", "c_t", "c_s", "mu_c", "phi_c", "mu_s", "phi_hat", "f_hat", "g_hat", "dh_hat", "phi_bar", "I_nC",
    "E_nC", "I_nS", "v_nS", "E_nS",
];

/// The arguments of a collision.
struct Given<'py> {
    matrix: Rows<'py>,
    velocity: Rows<'py>,
    surfaces: Surfaces<'py>,
    rows: Option<usize>,
}

impl<'py> Given<'py> {
    fn new(
        py: Python<'py>,
        matrix: &Bound<'py, PyAny>,
        velocity: &Bound<'py, PyAny>,
        (mu, e, law): (&Bound<'py, PyAny>, &Bound<'py, PyAny>, &str),
    ) -> PyResult<Self> {
        let matrix = rows(py, Some(matrix), "matrix", 6, &[])?;
        let velocity = rows(py, Some(velocity), "velocity", 3, &[])?;
        let surfaces = Surfaces::new(py, mu, e, law)?;
        let tables = [("matrix", &matrix), ("velocity", &velocity), ("mu", &surfaces.mu), ("e", &surfaces.e)];
        let rows = common(py, &tables)?;
        Ok(Given { matrix, velocity, surfaces, rows })
    }

    fn impacts(&self) -> Impacts<'_> {
        let (matrix, velocity) = (self.matrix.columns(), self.velocity.columns());
        Impacts {
            matrix: std::array::from_fn(|column| matrix[column]),
            velocity: std::array::from_fn(|column| velocity[column]),
        }
    }
}

fn input(impacts: &Impacts<'_>, row: usize) -> (ReducedMatrix<f64>, Vector3<f64>) {
    let get = |column: Column<'_>| column.get(row);
    (impacts.matrix.map(get).into(), impacts.velocity.map(get).into())
}

/// The answers of all rows, or the exception of the first without one.
fn answered(
    py: Python<'_>,
    rows: Option<usize>,
    raise: bool,
    width: usize,
    solve: impl Fn(usize, &mut Answers) -> Result<(), ImpactError<f64>> + Sync,
) -> PyResult<Answers> {
    let parts = py.detach(|| {
        over_rows(rows.unwrap_or(1), |range| {
            let (mut answers, mut first) = (Answers::default(), None);
            for row in range {
                match solve(row, &mut answers) {
                    Ok(()) => answers.kinds.push(0),
                    Err(error) => {
                        answers.none(width, error.cause());
                        first.get_or_insert((row, error));
                    }
                }
            }
            (answers, first)
        })
    });
    let (answers, failed): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    let answers = Answers::joined(answers);
    match failed.into_iter().flatten().next() {
        Some((row, error)) if raise => {
            let count = answers.kinds.iter().filter(|&&kind| kind != 0).count();
            Err(impact_error(py, &error, rows.map(|rows| (row, rows, count))))
        }
        _ => Ok(answers),
    }
}

/// Solves collisions.
#[pyfunction]
#[pyo3(name = "solve")]
pub fn solve_rows<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    mu: &Bound<'py, PyAny>,
    e: &Bound<'py, PyAny>,
    law: &str,
    errors: &str,
) -> PyResult<Found<'py>> {
    let given = Given::new(py, matrix, velocity, (mu, e, law))?;
    let (impacts, surface) = (given.impacts(), given.surfaces.of_rows());
    let answers = answered(py, given.rows, raises(py, errors)?, WIDTH, |row, answers| {
        let mut outcome = Ok(());
        impacts.solve(&surface, row..row + 1, &mut |_, impact| match impact {
            Ok(impact) => {
                answers.numbers.extend(impact.impulse.iter().chain(impact.velocity.iter()));
                let gained = impact.energy_gained().unwrap_or(0.0);
                answers.numbers.extend([impact.contact_work, impact.normal_work, gained]);
                answers.paths.push(impact.path.number());
            }
            Err(error) => outcome = Err(error),
        });
        outcome
    })?;
    answers.found(py, given.rows, WIDTH)
}

/// Outcomes of collisions and their derivatives.
#[pyfunction]
#[pyo3(name = "derivative")]
pub fn derivative_rows<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    mu: &Bound<'py, PyAny>,
    e: &Bound<'py, PyAny>,
    law: &str,
    errors: &str,
) -> PyResult<Found<'py>> {
    let given = Given::new(py, matrix, velocity, (mu, e, law))?;
    let (impacts, surface) = (given.impacts(), given.surfaces.of_rows());
    let by_rows = |m: &SMatrix<f64, 3, 11>| m.transpose().as_slice().to_vec();
    let answers = answered(py, given.rows, raises(py, errors)?, width(&DERIVATIVES), |row, answers| {
        let (matrix, velocity) = input(&impacts, row);
        let found = hodograph::derivative(&matrix, &velocity, &surface(row))?;
        answers.numbers.extend(by_rows(&found.impulse));
        answers.numbers.extend(by_rows(&found.velocity));
        answers.numbers.push(if found.non_smoothness.is_some() { 0.0 } else { 1.0 });
        answers.paths.push(found.impact.path.number());
        Ok(())
    })?;
    answers.found(py, given.rows, width(&DERIVATIVES))
}

/// Characteristic quantities of contacts and of their collisions.
#[pyfunction]
#[pyo3(name = "characteristics")]
pub fn characteristics_rows<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    mu: &Bound<'py, PyAny>,
    e: &Bound<'py, PyAny>,
    law: &str,
    errors: &str,
) -> PyResult<Found<'py>> {
    let given = Given::new(py, matrix, velocity, (mu, e, law))?;
    let (impacts, surface) = (given.impacts(), given.surfaces.of_rows());
    let width = CHARACTERISTICS.len();
    let answers = answered(py, given.rows, raises(py, errors)?, width, |row, answers| {
        let (matrix, velocity) = input(&impacts, row);
        let surface = surface(row);
        // It locates the end of compression under every law.
        let impact = *Hodograph::new(&matrix, &velocity, &surface)?.impact();
        let found = Characteristics::of(&matrix, surface.mu);
        let slips = velocity.y != 0.0 || velocity.z != 0.0;
        let stop = slips.then(|| phi_bar(&matrix, surface.mu, velocity.z.atan2(velocity.y))).flatten();
        let renewal = found.renewal.map(|hat| [hat.phi_hat, hat.f_hat, hat.g_hat, hat.dh_hat]);
        let end = impact.phases.last_compression_end.map(|at| [at.impulse.x, at.normal_work]);
        let slip = impact.phases.slip_end.map(|at| [at.impulse.x, at.velocity.x, at.normal_work]);
        let or_none = |value: Option<f64>| value.unwrap_or(f64::NAN);
        answers.numbers.extend(found.sticking.unwrap_or([f64::NAN; 3]));
        answers.numbers.extend([found.mu_c, found.phi_c, or_none(found.mu_s)]);
        answers.numbers.extend(renewal.unwrap_or([f64::NAN; 4]));
        answers.numbers.push(or_none(stop));
        answers.numbers.extend(end.unwrap_or([f64::NAN; 2]));
        answers.numbers.extend(slip.unwrap_or([f64::NAN; 3]));
        answers.paths.push(impact.path.number());
        Ok(())
    })?;
    answers.found(py, given.rows, width)
}

/// The course of one collision: snapshots at equal steps of the normal impulse, or at given normal impulses.
#[pyfunction]
#[pyo3(name = "hodograph")]
#[allow(clippy::too_many_arguments)]
pub fn course<'py>(
    py: Python<'py>,
    matrix: &Bound<'py, PyAny>,
    velocity: &Bound<'py, PyAny>,
    mu: &Bound<'py, PyAny>,
    e: &Bound<'py, PyAny>,
    law: &str,
    count: usize,
    impulses: Option<Vec<f64>>,
) -> PyResult<Bound<'py, PyDict>> {
    let given = Given::new(py, matrix, velocity, (mu, e, law))?;
    if given.rows.is_some() {
        let message = "a hodograph is of one collision: expected arrays of shape (6,) and (3,), and numbers";
        return Err(crate::errors::argument(py, "matrix", "wrong_shape", message));
    }
    let (matrix, velocity) = input(&given.impacts(), 0);
    let surface: Surface<f64> = given.surfaces.of_rows()(0);
    let found =
        Hodograph::new(&matrix, &velocity, &surface).map_err(|error| impact_error(py, &error, None))?;
    let points = match impulses {
        None => found.points(count).collect(),
        Some(impulses) => {
            let at = impulses.iter().map(|&impulse| snapshot_at(&matrix, &velocity, surface.mu, impulse));
            at.collect::<Result<Vec<_>, _>>().map_err(|error| impact_error(py, &error, None))?
        }
    };
    let rows = Some(points.len());
    let all = PyDict::new(py);
    let impulses = points.iter().flat_map(|point| point.impulse.iter().copied().collect::<Vec<_>>());
    let velocities = points.iter().flat_map(|point| point.velocity.iter().copied().collect::<Vec<_>>());
    all.set_item("impulse", array(py, rows, &[3], impulses.collect())?)?;
    all.set_item("velocity", array(py, rows, &[3], velocities.collect())?)?;
    all.set_item(
        "contact_work",
        array(py, rows, &[], points.iter().map(|point| point.contact_work).collect())?,
    )?;
    all.set_item(
        "normal_work",
        array(py, rows, &[], points.iter().map(|point| point.normal_work).collect())?,
    )?;
    let motion = |motion: Motion| match motion {
        Motion::Sliding => "sliding",
        Motion::Sticking => "sticking",
        Motion::Renewal => "renewal",
    };
    all.set_item("motion", points.iter().map(|point| motion(point.motion)).collect::<Vec<_>>())?;
    all.set_item("path", found.impact().path.to_string())?;
    let end = |snapshot: Option<hodograph::Snapshot<f64>>| snapshot.map(|snapshot| snapshot.normal_impulse());
    all.set_item("compression_end", end(found.impact().phases.compression_end))?;
    all.set_item("slip_end", end(found.impact().phases.slip_end))?;
    Ok(all)
}
