//! A mechanism: its description, and its quantities for one state or many.

use std::collections::HashMap;
use std::sync::{Arc, PoisonError, RwLock};

use hodograph::{ComponentKind, Contacts as _, Mechanism as _, StateError};
use hodograph_generator::artifact::{self, Loaded};
use hodograph_generator::check;
use hodograph_generator::explain::{self, Format};
use hodograph_generator::interpret::{Arguments, Prepared};
use hodograph_generator::program::Quantity;
use hodograph_generator::program::quantity::{Description, Entries, Extent};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_interpreter::columns::{Columns, evaluate_rows};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::{Rows, array, column, common, raises, rows};
use crate::machines::{Machines, Refused, parameter_error};
use crate::motion::Choices;
use crate::states::States;
use crate::{collisions, errors, many, model, motion};

/// A quantity, ready for one state and for many.
struct Routine {
    one: Prepared,
    many: Columns,
    shape: Vec<usize>,
}

/// A model with its derivation and parameters.
#[pyclass(frozen, subclass)]
pub struct Mechanism {
    inner: InterpretedMechanism,
    routines: RwLock<HashMap<String, Arc<Routine>>>,
    /// coordinates, speeds, inputs that the model states
    initial: [Vec<f64>; 3],
    /// parameters of every row, where these are not those of `inner` for all
    machines: Option<Machines>,
}

impl Mechanism {
    fn of(inner: InterpretedMechanism) -> Self {
        let [n, p, w] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
            .map(|kind| inner.count(kind));
        let (mut q, mut u, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
        // the slices have the lengths asked for
        let _ = inner.initial_state(&mut q, &mut u, &mut inputs);
        Mechanism { inner, routines: RwLock::default(), initial: [q, u, inputs], machines: None }
    }

    /// Reads a model and its derivation.
    fn read(py: Python<'_>, model: &str, derivation: Option<&str>) -> PyResult<InterpretedMechanism> {
        let source = model::source(model);
        let checked = check::check(&source);
        let Some(mechanism) = checked.mechanism.clone() else {
            return Err(model::mistakes(py, &checked, &source));
        };
        let wrong = |message: String, kind: &str, place: Option<String>| {
            errors::error(py, "DerivationError", &message, kind, place, None)
        };
        let path = match derivation {
            Some(path) => path.to_owned(),
            None => artifact::place::beside(model.as_ref()).display().to_string(),
        };
        let advice = "`hodograph derive` writes it";
        let found = artifact::load(path.as_ref(), &source);
        let kind = match found {
            Loaded::Fresh(_) | Loaded::Absent => "no_derivation",
            Loaded::Stale => "stale_derivation",
            Loaded::Damaged(_) => "damaged_derivation",
        };
        let program = found.program().map_err(|fault| {
            wrong(format!("the derivation {path} {fault}; {advice}"), kind, Some(path.clone()))
        })?;
        InterpretedMechanism::new(mechanism, program)
            .map_err(|error| wrong(error.to_string(), "parameters", None))
    }

    fn routine(&self, py: Python<'_>, quantity: &str) -> PyResult<Arc<Routine>> {
        let known = self.routines.read().unwrap_or_else(PoisonError::into_inner).get(quantity).cloned();
        if let Some(routine) = known {
            return Ok(routine);
        }
        let unknown = |message: String| errors::argument(py, "quantity", "unknown_name", &message);
        let words: Vec<&str> = quantity.split(' ').collect();
        let found = Quantity::from_words(&words)
            .ok_or_else(|| unknown(format!("there is no quantity '{quantity}'")))?;
        let Some(output) = self.inner.program().output(found) else {
            let message = format!("{} does not determine '{quantity}'", self.inner.name());
            return Err(errors::error(
                py,
                "StateError",
                &message,
                "undefined",
                Some(quantity.to_owned()),
                None,
            ));
        };
        let Description { shape: [_, columns], entries, .. } = *found.description();
        let shape = match (entries, columns) {
            (Entries::Scalar, _) => vec![],
            (_, Extent::Count(1)) => vec![output.values.len()],
            _ => vec![output.rows, output.columns],
        };
        let routine = Arc::new(Routine {
            one: Prepared::new(self.inner.program(), self.inner.constants(), &[found]),
            many: self.inner.columns(&[found]),
            shape,
        });
        let mut routines = self.routines.write().unwrap_or_else(PoisonError::into_inner);
        Ok(routines.entry(quantity.to_owned()).or_insert(routine).clone())
    }

    /// Reads the arguments that make up a state.
    pub fn states<'py>(
        &self,
        py: Python<'py>,
        [q, u, inputs, time, accelerations, tangent]: [Option<&Bound<'py, PyAny>>; 6],
    ) -> PyResult<States<'py>> {
        let [q0, u0, w0] = &self.initial;
        let q = rows(py, q, "q", q0.len(), q0)?;
        let u = rows(py, u, "u", u0.len(), u0)?;
        let inputs = rows(py, inputs, "inputs", w0.len(), w0)?;
        let time = time.map(|time| column(py, time, "time")).transpose()?;
        let model = self.inner.model();
        let width = model.independent_states() + w0.len();
        let of = |given: Option<&Bound<'py, PyAny>>, name, width| {
            given.map(|given| rows(py, Some(given), name, width, &[])).transpose()
        };
        let accelerations = of(accelerations, "accelerations", u0.len())?;
        let tangent = of(tangent, "tangent", width)?;
        let mut tables = vec![("q", &q), ("u", &u), ("inputs", &inputs)];
        tables.extend(time.as_ref().map(|table| ("time", table)));
        tables.extend(accelerations.as_ref().map(|table| ("accelerations", table)));
        tables.extend(tangent.as_ref().map(|table| ("tangent", table)));
        let rows = match (common(py, &tables)?, &self.machines) {
            (Some(rows), Some(machines)) if rows != machines.rows => {
                let message = format!(
                    "the parameters have {} rows, the state has {rows}: expected as many",
                    machines.rows
                );
                return Err(errors::argument(py, "parameters", "wrong_shape", &message));
            }
            (rows, machines) => rows.or(machines.as_ref().map(|machines| machines.rows)),
        };
        Ok(States { q, u, inputs, time, accelerations, tangent, rows })
    }
}

/// Makes these rows numbers that are none.
fn blank(numbers: &mut [f64], rows: usize, which: &[usize]) {
    let width = numbers.len() / rows.max(1);
    for &row in which {
        numbers[row * width..(row + 1) * width].fill(f64::NAN);
    }
}

#[pymethods]
impl Mechanism {
    /// Reads a model (a path, or a text) and its derivation (a path; by default the file beside the model),
    /// or takes those of another mechanism. With `parameters`: all that can be changed, in the order of
    /// the model; with many rows of them, one mechanism for every row of a state.
    #[new]
    #[pyo3(signature = (model, derivation = None, parameters = None))]
    fn new(
        py: Python<'_>,
        model: &Bound<'_, PyAny>,
        derivation: Option<&str>,
        parameters: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut inner = match model.cast::<Mechanism>() {
            Ok(other) => other.get().inner.clone(),
            Err(_) => Mechanism::read(py, &model.extract::<String>()?, derivation)?,
        };
        let Some(parameters) = parameters else { return Ok(Mechanism::of(inner)) };
        let width = inner.count(ComponentKind::Parameter);
        let parameters = rows(py, Some(parameters), "parameters", width, &[])?;
        let numbers = parameters.slice();
        if let Some(rows) = parameters.rows {
            let machines = Some(Machines { numbers: numbers.to_vec(), rows, width });
            return Ok(Mechanism { machines, ..Mechanism::of(inner) });
        }
        inner.set_parameter_values(numbers).map_err(|error| {
            errors::error(py, "ParameterError", &error.to_string(), error.kind(), None, None)
        })?;
        Ok(Mechanism::of(inner))
    }

    /// Quantities of a kind: a list of (name, unit, value).
    fn _describe<'py>(&self, py: Python<'py>, kind: &str) -> PyResult<Bound<'py, PyList>> {
        let mut parameters = vec![0.0; self.inner.count(ComponentKind::Parameter)];
        let _ = self.inner.parameter_values(&mut parameters);
        let [q, u, w] = &self.initial;
        let (kind, values): (ComponentKind, &[f64]) = match kind {
            "parameters" => (ComponentKind::Parameter, &parameters),
            "coordinates" => (ComponentKind::Coordinate, q),
            "speeds" => (ComponentKind::Speed, u),
            "inputs" => (ComponentKind::Input, w),
            "dependent_speeds" => (ComponentKind::DependentSpeed, &[]),
            "points" => (ComponentKind::Point, &[]),
            "frames" => (ComponentKind::Frame, &[]),
            "quantities" => (ComponentKind::Quantity, &[]),
            _ => (ComponentKind::Contact, &[]),
        };
        let all = PyList::empty(py);
        for index in 0..self.inner.count(kind) {
            if let Some(component) = self.inner.component(kind, index) {
                let (name, unit) = (component.name, component.unit);
                if let (ComponentKind::Parameter, Some(machines)) = (kind, &self.machines) {
                    let column = (0..machines.rows)
                        .map(|row| machines.row(row).get(index).copied().unwrap_or(f64::NAN));
                    all.append((name, unit, array(py, Some(machines.rows), &[], column.collect())?))?;
                } else {
                    all.append((name, unit, values.get(index).copied()))?;
                }
            }
        }
        Ok(all)
    }

    /// The name of the mechanism in the model.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// The equations as an HTML page, LaTeX or plain text.
    fn _equations(&self, py: Python<'_>, format: &str) -> PyResult<String> {
        let format = match format {
            "html" => Format::Html,
            "latex" => Format::Latex,
            "text" => Format::Text,
            other => {
                let message = format!("the format is '{other}': expected 'text', 'latex' or 'html'");
                return Err(errors::argument(py, "format", "unknown_option", &message));
            }
        };
        let (model, program) = (self.inner.model(), self.inner.program());
        Ok(py.detach(|| explain::explain(model, program, &explain::usual(program), format)))
    }

    /// A quantity at one state or many.
    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (quantity, q, u, inputs, time, errors, accelerations = None, tangent = None))]
    fn _evaluate<'py>(
        &self,
        py: Python<'py>,
        quantity: &str,
        q: Option<&Bound<'py, PyAny>>,
        u: Option<&Bound<'py, PyAny>>,
        inputs: Option<&Bound<'py, PyAny>>,
        time: Option<&Bound<'py, PyAny>>,
        errors: &str,
        accelerations: Option<&Bound<'py, PyAny>>,
        tangent: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let routine = self.routine(py, quantity)?;
        let states = self.states(py, [q, u, inputs, time, accelerations, tangent])?;
        let raises = raises(py, errors)?;
        let wrong = states.not_finite();
        if let Some(&row) = wrong.first().filter(|_| raises) {
            return Err(states.error(py, &self.inner, &StateError::NotFinite, row, wrong.len()));
        }
        let Some(rows) = states.rows else {
            let none: &[f64] = &[];
            let given =
                |rows: &Option<Rows<'_>>| rows.as_ref().map_or(none.to_vec(), |rows| rows.slice().to_vec());
            let (accelerations, tangent) = (given(&states.accelerations), given(&states.tangent));
            let arguments = Arguments {
                time: states.time.as_ref().map_or(0.0, |time| time.slice()[0]),
                coordinates: states.q.slice(),
                speeds: states.u.slice(),
                inputs: states.inputs.slice(),
                accelerations: &accelerations,
                tangent: &tangent,
            };
            let mut numbers = vec![f64::NAN; routine.one.len()];
            if !wrong.is_empty() {
                return array(py, None, &routine.shape, numbers);
            }
            let outcome = routine.one.evaluate(&arguments, |index, number| numbers[index] = number);
            return match outcome {
                Err(failed) if raises => {
                    Err(states.error(py, &self.inner, &self.inner.state_error(failed), 0, 1))
                }
                _ => array(py, None, &routine.shape, numbers),
            };
        };
        let table = states.table();
        if let Some(machines) = &self.machines {
            let (mut numbers, refused) = py.detach(|| machines.evaluate(&self.inner, &routine.one, &table));
            blank(&mut numbers, rows, &wrong);
            return match refused.first() {
                Some((row, Refused::Parameters(error))) if raises => {
                    Err(parameter_error(py, error, (*row, rows, refused.len())))
                }
                Some((row, Refused::State(error))) if raises => {
                    Err(states.error(py, &self.inner, error, *row, refused.len()))
                }
                _ => array(py, Some(rows), &routine.shape, numbers),
            };
        }
        let mut numbers = vec![0.0; rows * routine.many.len()];
        let mut failures = vec![None; rows];
        py.detach(|| evaluate_rows(&routine.many, &table, &mut numbers, &mut failures));
        if raises && let Some((row, Some(failed))) = failures.iter().enumerate().find(|(_, f)| f.is_some()) {
            let count = failures.iter().filter(|failure| failure.is_some()).count();
            return Err(states.error(py, &self.inner, &self.inner.state_error(*failed), row, count));
        }
        blank(&mut numbers, rows, &wrong);
        array(py, Some(rows), &routine.shape, numbers)
    }

    /// Collisions of a contact at one state or many.
    #[allow(clippy::too_many_arguments)]
    fn _collide<'py>(
        &self,
        py: Python<'py>,
        contact: usize,
        states: [Option<Bound<'py, PyAny>>; 4],
        mu: &Bound<'py, PyAny>,
        e: &Bound<'py, PyAny>,
        law: &str,
        errors: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [q, u, inputs, time] = &states;
        let states = self.states(py, [q.as_ref(), u.as_ref(), inputs.as_ref(), time.as_ref(), None, None])?;
        let of = (&self.inner, self.machines.as_ref(), contact);
        collisions::collide(py, of, states, (mu, e, law), raises(py, errors)?)
    }

    /// Friction and restitution that the model states for a contact.
    fn _surface<'py>(&self, py: Python<'py>, contact: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(surface) = self.inner.surface(contact) else { return Ok(None) };
        let found = PyDict::new(py);
        found.set_item("mu", surface.mu)?;
        found.set_item("e", surface.e)?;
        found.set_item("law", surface.law.name())?;
        Ok(Some(found))
    }

    /// A motion from a state to a time.
    fn _simulate<'py>(
        &self,
        py: Python<'py>,
        states: [Option<Bound<'py, PyAny>>; 4],
        until: f64,
        step: Option<f64>,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [q, u, inputs, time] = &states;
        let states = self.states(py, [q.as_ref(), u.as_ref(), inputs.as_ref(), time.as_ref(), None, None])?;
        motion::simulate(py, &self.inner, &states, (until, step), choices)
    }

    /// Many motions at once, by rows of states, parameters and surfaces.
    #[allow(clippy::too_many_arguments)]
    fn _simulate_many<'py>(
        &self,
        py: Python<'py>,
        states: [Option<Bound<'py, PyAny>>; 4],
        until: f64,
        columns: many::Columns<'py>,
        choices: Choices,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let [q, u, inputs, time] = &states;
        let states = self.states(py, [q.as_ref(), u.as_ref(), inputs.as_ref(), time.as_ref(), None, None])?;
        let of = (&self.inner, self.machines.as_ref());
        many::simulate(py, of, &states, until, &columns, &choices, threads, progress)
    }
}
