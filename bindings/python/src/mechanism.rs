//! A mechanism: its description, and its quantities for one state or many.

use std::collections::HashMap;
use std::sync::{Arc, PoisonError, RwLock};

use hodograph::ComponentKind;
use hodograph_generator::artifact::{self, Loaded};
use hodograph_generator::check;
use hodograph_generator::explain::{self, Format};
use hodograph_generator::format;
use hodograph_generator::source::Source;
use hodograph_interpreter::columns::Collisions;
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arguments::{Surfaces, array, column, common, raises, rows};
use crate::gradients::{self, Fitted, Periodicity};
use crate::machine::Machine;
use crate::machines::Machines;
use crate::motion::Choices;
use crate::record::{Record, Samples};
use crate::routine::Routine;
use crate::states::States;
use crate::validation::{self, Judged};
use crate::{closed, collisions, errors, many, model, motion};

/// A model with its derivation, if it has one, and parameters.
#[pyclass(frozen, subclass)]
pub struct Mechanism {
    pub(crate) inner: Machine,
    /// the text of the model without parts and imports, of which it can be made again
    text: Arc<str>,
    pub(crate) routines: RwLock<HashMap<String, Arc<Routine>>>,
    collisions: RwLock<HashMap<usize, Arc<Collisions>>>,
    /// coordinates, speeds, inputs that the model states
    initial: [Vec<f64>; 3],
    /// parameters of every row, where these are not those of `inner` for all
    pub(crate) machines: Option<Machines>,
}

impl Mechanism {
    fn of(inner: Machine, text: Arc<str>) -> Self {
        let [n, p, w] = [ComponentKind::Coordinate, ComponentKind::Speed, ComponentKind::Input]
            .map(|kind| inner.count(kind));
        let (mut q, mut u, mut inputs) = (vec![0.0; n], vec![0.0; p], vec![0.0; w]);
        // the slices have the lengths asked for
        let _ = inner.contacts().initial_state(&mut q, &mut u, &mut inputs);
        Mechanism {
            inner,
            text,
            routines: RwLock::default(),
            collisions: RwLock::default(),
            initial: [q, u, inputs],
            machines: None,
        }
    }

    /// Reads a model and its derivation.
    fn read(py: Python<'_>, model: &str, derivation: Option<&str>) -> PyResult<(Machine, Arc<str>)> {
        let source = model::source(model);
        let checked = check::check(&source);
        let Some(mechanism) = checked.mechanism.clone() else {
            return Err(model::mistakes(py, &checked, &source));
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
            wrong(py, format!("the derivation {path} {fault}; {advice}"), kind, Some(path.clone()))
        })?;
        let inner = InterpretedMechanism::new(mechanism, program)
            .map_err(|error| wrong(py, error.to_string(), "parameters", None))?;
        Ok((Machine::Derived(Box::new(inner)), format::plain(&source).into()))
    }

    /// Reads a model alone.
    fn read_numeric(py: Python<'_>, source: &Source) -> PyResult<(Machine, Arc<str>)> {
        let checked = check::check(source);
        let Some(mechanism) = checked.mechanism.clone() else {
            return Err(model::mistakes(py, &checked, source));
        };
        let mechanism = NumericMechanism::new(mechanism).map_err(|error| {
            errors::error(py, "ParameterError", &error.to_string(), "parameters", None, None)
        })?;
        let numeric = Machine::Numeric { mechanism: Box::new(mechanism), timed: source.names_time() };
        Ok((numeric, format::plain(source).into()))
    }

    /// The mechanism with other parameters.
    fn changed(&self, py: Python<'_>, parameters: &Bound<'_, PyAny>) -> PyResult<Self> {
        let mut inner = self.inner.clone();
        let text = Arc::clone(&self.text);
        let width = inner.count(ComponentKind::Parameter);
        let parameters = rows(py, Some(parameters), "parameters", width, &[])?;
        let numbers = parameters.slice();
        if let Some(rows) = parameters.rows {
            let machines = Some(Machines { numbers: numbers.to_vec(), rows, width });
            return Ok(Mechanism { machines, ..Mechanism::of(inner, text) });
        }
        inner.set_parameters(numbers).map_err(|error| {
            errors::error(py, "ParameterError", &error.to_string(), error.kind(), None, None)
        })?;
        Ok(Mechanism::of(inner, text))
    }

    /// The routine of the collisions of a contact at many states.
    fn collisions(&self, py: Python<'_>, contact: usize) -> PyResult<Option<Arc<Collisions>>> {
        let (Machine::Derived(inner), None) = (&self.inner, &self.machines) else { return Ok(None) };
        let known = self.collisions.read().unwrap_or_else(PoisonError::into_inner).get(&contact).cloned();
        if known.is_some() {
            return Ok(known);
        }
        let made = inner
            .collisions(contact)
            .map_err(|error| errors::error(py, "StateError", &error.to_string(), error.kind(), None, None))?;
        let mut all = self.collisions.write().unwrap_or_else(PoisonError::into_inner);
        Ok(Some(Arc::clone(all.entry(contact).or_insert_with(|| Arc::new(made)))))
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

/// The exception of a derivation.
fn wrong(py: Python<'_>, message: String, kind: &str, place: Option<String>) -> PyErr {
    errors::error(py, "DerivationError", &message, kind, place, None)
}

#[pymethods]
impl Mechanism {
    /// Reads a model (a path, or a text) and its derivation (a path; by default the file beside the model),
    /// or takes those of another mechanism. With `numeric`, the model alone. With `parameters`: all that can be changed, in
    /// the order of the model; with many rows of them, one mechanism for every row of a state.
    #[new]
    #[pyo3(signature = (model, derivation = None, parameters = None, numeric = false))]
    fn new(
        py: Python<'_>,
        model: &Bound<'_, PyAny>,
        derivation: Option<&str>,
        parameters: Option<&Bound<'_, PyAny>>,
        numeric: bool,
    ) -> PyResult<Self> {
        let made = match model.cast::<Mechanism>() {
            Ok(other) => Mechanism::of(other.get().inner.clone(), Arc::clone(&other.get().text)),
            Err(_) => {
                let model = model.extract::<String>()?;
                let (inner, text) = match numeric {
                    true => Mechanism::read_numeric(py, &model::source(&model))?,
                    false => Mechanism::read(py, &model, derivation)?,
                };
                Mechanism::of(inner, text)
            }
        };
        match parameters {
            Some(parameters) => made.changed(py, parameters),
            None => Ok(made),
        }
    }

    /// The texts of model and derivation (none without one), and the parameters, of which it can be made again.
    fn _state<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(String, Option<String>, Bound<'py, PyArrayDyn<f64>>)> {
        let derivation = match &self.inner {
            Machine::Derived(inner) => {
                let hash = artifact::model_hash(&Source::file("the model", &*self.text));
                Some(artifact::encode(inner.program(), &hash))
            }
            Machine::Numeric { .. } => None,
        };
        let width = self.inner.count(ComponentKind::Parameter);
        let (rows, numbers) = match &self.machines {
            Some(machines) => (Some(machines.rows), machines.numbers.clone()),
            None => {
                let mut numbers = vec![0.0; width];
                let _ = self.inner.contacts().parameter_values(&mut numbers);
                (None, numbers)
            }
        };
        Ok((self.text.to_string(), derivation, array(py, rows, &[width], numbers)?))
    }

    /// A mechanism of what [`Mechanism::_state`] gave.
    #[classmethod]
    fn _restored<'py>(
        class: &Bound<'py, pyo3::types::PyType>,
        text: &str,
        derivation: Option<&str>,
        parameters: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = class.py();
        let source = Source::file("the model", text);
        let (inner, text) = match derivation {
            None => Mechanism::read_numeric(py, &source)?,
            Some(derivation) => {
                let checked = check::check(&source);
                let Some(mechanism) = checked.mechanism.clone() else {
                    return Err(model::mistakes(py, &checked, &source));
                };
                let program = artifact::load_text(derivation, &source).program().map_err(|fault| {
                    wrong(py, format!("the derivation {fault}"), "damaged_derivation", None)
                })?;
                let inner = InterpretedMechanism::new(mechanism, program)
                    .map_err(|error| wrong(py, error.to_string(), "parameters", None))?;
                (Machine::Derived(Box::new(inner)), text.into())
            }
        };
        let plain = Bound::new(py, Mechanism::of(inner, text))?;
        class.call1((plain, py.None(), parameters))
    }

    /// Whether there are derived equations.
    #[getter]
    fn _is_derived(&self) -> bool {
        matches!(self.inner, Machine::Derived(_))
    }

    /// The numbers of the independent coordinates.
    #[getter]
    fn _independent(&self) -> Vec<usize> {
        let coordinates = self.inner.model().coordinates.iter().enumerate();
        coordinates.filter(|(_, coordinate)| !coordinate.dependent).map(|(index, _)| index).collect()
    }

    /// The text of the model, without parts and imports.
    #[getter]
    fn _text(&self) -> &str {
        &self.text
    }

    /// Quantities of a kind: a list of (name, unit, value).
    fn _describe<'py>(&self, py: Python<'py>, kind: &str) -> PyResult<Bound<'py, PyList>> {
        let mut parameters = vec![0.0; self.inner.count(ComponentKind::Parameter)];
        let _ = self.inner.contacts().parameter_values(&mut parameters);
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
            if let Some(component) = self.inner.contacts().component(kind, index) {
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
        self.inner.contacts().name()
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
        let inner = self.inner.derived(py, "its equations")?;
        let (model, program) = (inner.model(), inner.program());
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
        let states = self.states(py, [q, u, inputs, time, accelerations, tangent])?;
        self.evaluated(py, quantity, &states, raises(py, errors)?)
    }

    /// Collisions of a contact at one state or many.
    #[allow(clippy::too_many_arguments)]
    fn _collide<'py>(
        &self,
        py: Python<'py>,
        contact: usize,
        q: Option<&Bound<'py, PyAny>>,
        u: Option<&Bound<'py, PyAny>>,
        inputs: Option<&Bound<'py, PyAny>>,
        time: Option<&Bound<'py, PyAny>>,
        mu: &Bound<'py, PyAny>,
        e: &Bound<'py, PyAny>,
        law: &str,
        errors: &str,
        budget: Option<u32>,
    ) -> PyResult<collisions::Found<'py>> {
        let states = self.states(py, [q, u, inputs, time, None, None])?;
        let surfaces = Surfaces::new(py, mu, e, law)?;
        let raises = raises(py, errors)?;
        let rows = collisions::rows(py, &states, &surfaces)?;
        let of = (&self.inner, self.machines.as_ref(), contact);
        let Some(rows) = rows else {
            return collisions::one(py, of, &states, &surfaces.one(), budget, raises);
        };
        let routine = if budget.is_none() { self.collisions(py, contact)? } else { None };
        let states = States { rows: Some(rows), ..states };
        collisions::many(py, of, routine.as_deref(), &states, (&surfaces, budget), raises)
    }

    /// Modes and forces of a closed contact at one state or many; of a given mode, if one is given.
    #[allow(clippy::too_many_arguments)]
    fn _closed<'py>(
        &self,
        py: Python<'py>,
        contact: usize,
        states: [Option<Bound<'py, PyAny>>; 4],
        mu: &Bound<'py, PyAny>,
        mode: Option<&str>,
        errors: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, borrowed(&states))?;
        let of = (&self.inner, self.machines.as_ref(), contact);
        closed::closed(py, of, states, mu, mode, raises(py, errors)?)
    }

    /// Friction and restitution that the model states for a contact.
    fn _surface<'py>(&self, py: Python<'py>, contact: usize) -> PyResult<Option<Bound<'py, PyDict>>> {
        let Some(surface) = self.inner.contacts().surface(contact) else { return Ok(None) };
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
        let states = self.states(py, borrowed(&states))?;
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
        let states = self.states(py, borrowed(&states))?;
        let of = (&self.inner, self.machines.as_ref());
        many::simulate(py, of, &states, until, &columns, choices, threads, progress)
    }

    /// A motion at these times, with its derivatives by these variables.
    fn _gradient<'py>(
        &self,
        py: Python<'py>,
        states: [Option<Bound<'py, PyAny>>; 4],
        by: Vec<String>,
        at: Vec<f64>,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, borrowed(&states))?;
        gradients::gradient(py, &self.inner, &states, &by, &at, choices)
    }

    /// Derivatives of functions of a motion at these times by these variables, found backwards.
    fn _adjoint<'py>(
        &self,
        py: Python<'py>,
        states: [Option<Bound<'py, PyAny>>; 4],
        by: Vec<String>,
        at: Vec<f64>,
        weights: &Bound<'py, PyAny>,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, borrowed(&states))?;
        gradients::adjoint(py, &self.inner, &states, (&by, &at), weights, choices)
    }

    /// Periodic motions: one next to a state, or a branch of them through a variable.
    fn _orbit<'py>(
        &self,
        py: Python<'py>,
        states: [Option<Bound<'py, PyAny>>; 4],
        periodicity: Periodicity,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, borrowed(&states))?;
        gradients::orbit(py, &self.inner, &states, &periodicity, choices)
    }

    /// Parameters, mu and e fitted to measured motions.
    fn _fit<'py>(
        &self,
        py: Python<'py>,
        fitted: Fitted<'py>,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, [None; 6])?;
        gradients::fit(py, &self.inner, &states, &fitted, choices)
    }

    /// Errors of predictions of motions.
    fn _validate<'py>(
        &self,
        py: Python<'py>,
        judged: Judged<'py>,
        choices: Choices,
    ) -> PyResult<Bound<'py, PyDict>> {
        let states = self.states(py, [None; 6])?;
        validation::validate(py, &self.inner, &states, &judged, choices)
    }

    /// The page, the recording or the curves of a motion.
    fn _shown<'py>(
        &self,
        py: Python<'py>,
        what: &str,
        record: &Bound<'py, Record>,
        samples: Samples<'py>,
    ) -> PyResult<Bound<'py, PyAny>> {
        record.get().shown(py, (&self.inner, &self.text), what, &samples)
    }
}

/// The arguments of a state without accelerations and tangent.
fn borrowed<'a, 'py>(states: &'a [Option<Bound<'py, PyAny>>; 4]) -> [Option<&'a Bound<'py, PyAny>>; 6] {
    let [q, u, inputs, time] = states;
    [q.as_ref(), u.as_ref(), inputs.as_ref(), time.as_ref(), None, None]
}
