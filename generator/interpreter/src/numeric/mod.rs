//! [`NumericMechanism`]: a model without its equations, evaluated numerically.

mod contacts;
mod failure;
mod mechanism;
mod snapshot;

use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};

use hodograph::generated::check_length;
use hodograph::{ComponentKind, ParameterError, State, StateError};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::model::mechanism::PointId;
use hodograph_model::numeric::hyper_dual::HyperDual;
use hodograph_model::numeric::{self, Evaluator, Failure};

use self::failure::state_error;
use self::snapshot::{Basis, Snapshot};
use crate::{Error, description, parameters, read};

/// A mechanism that is evaluated from its model alone: no derivation and no algebra engine are needed. It has
/// the traits [`hodograph::Mechanism`] and [`hodograph::Contacts`], but no named quantities.
///
/// Its numbers agree with those of [`InterpretedMechanism`](crate::InterpretedMechanism) but for rounding; a
/// state costs some hundred times as much. What was computed of the last state is kept.
#[derive(Debug)]
pub struct NumericMechanism {
    pub(crate) model: Arc<Mechanism>,
    /// all, in file order, `fixed` ones too
    parameters: Vec<f64>,
    quaternions: Vec<[usize; 4]>,
    dependent_coordinates: Vec<usize>,
    /// of each contact
    bases: Vec<Basis>,
    last: Mutex<Option<Arc<Snapshot>>>,
}

impl Clone for NumericMechanism {
    fn clone(&self) -> Self {
        NumericMechanism {
            model: Arc::clone(&self.model),
            parameters: self.parameters.clone(),
            quaternions: self.quaternions.clone(),
            dependent_coordinates: self.dependent_coordinates.clone(),
            bases: self.bases.clone(),
            last: Mutex::new(None),
        }
    }
}

impl NumericMechanism {
    /// Reads a model file.
    ///
    /// # Errors
    ///
    /// [`Error`]
    pub fn read(path: &Path) -> Result<Self, Error> {
        Self::with_stated_parameters(read::model(path)?.0)
    }

    /// The mechanism of a model, with the parameters that the model states.
    pub(crate) fn with_stated_parameters(model: Mechanism) -> Result<Self, Error> {
        let value = |parameter: &hodograph_model::model::mechanism::Variable| {
            parameter.value.ok_or_else(|| Error::NoValue(parameter.name.clone()))
        };
        let parameters = model.parameters.iter().map(value).collect::<Result<Vec<f64>, Error>>()?;
        Ok(Self::with(model, parameters)?)
    }

    pub(crate) fn with(model: Mechanism, parameters: Vec<f64>) -> Result<Self, ParameterError> {
        parameters::check(&model, &parameters)?;
        Ok(NumericMechanism {
            quaternions: description::quaternions(&model),
            dependent_coordinates: description::dependent_coordinates(&model),
            bases: snapshot::bases(&model, &parameters),
            model: Arc::new(model),
            parameters,
            last: Mutex::new(None),
        })
    }

    /// All parameters in file order, `fixed` ones too.
    pub fn all_parameters(&self) -> &[f64] {
        &self.parameters
    }

    fn freedom(&self) -> usize {
        description::freedom(&self.model)
    }

    fn exists(&self, kind: ComponentKind, index: usize) -> Result<(), StateError> {
        if index < description::count(&self.model, kind) {
            Ok(())
        } else {
            Err(StateError::Missing { kind, index })
        }
    }

    fn check(&self, state: &State<'_>) -> Result<(), StateError> {
        check_length(state.coordinates, self.model.coordinates.len(), "coordinates")?;
        check_length(state.speeds, self.freedom(), "speeds")?;
        check_length(state.inputs, self.model.inputs.len(), "inputs")?;
        // Else the search for what is singular would blame the mechanism.
        let mut given = [state.coordinates, state.speeds, state.inputs].into_iter().flatten();
        if state.time.is_finite() && given.all(|number| number.is_finite()) {
            Ok(())
        } else {
            Err(StateError::NotFinite)
        }
    }

    /// The state as the numeric evaluation takes it.
    fn numbers(&self, state: &State<'_>) -> Result<numeric::State, StateError> {
        self.check(state)?;
        Ok(numeric::State {
            parameters: self.parameters.clone(),
            inputs: state.inputs.to_vec(),
            time: state.time,
            coordinates: state.coordinates.to_vec(),
            speeds: state.speeds.to_vec(),
        })
    }

    /// Everything of a state: computed once for the calls that follow each other.
    fn snapshot(&self, state: &State<'_>) -> Result<Arc<Snapshot>, StateError> {
        let numbers = self.numbers(state)?;
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last.as_ref().filter(|known| known.is_of(&numbers)) {
            return Ok(Arc::clone(known));
        }
        let new = Arc::new(Snapshot::of(&self.model, numbers, &self.bases)?);
        *last = Some(Arc::clone(&new));
        Ok(new)
    }

    /// What is known of a place and nothing moves: positions, orientations, gaps.
    fn still<T>(
        &self,
        state: &State<'_>,
        ask: impl FnOnce(&Evaluator<'_>) -> Result<T, Failure>,
    ) -> Result<T, StateError> {
        self.check(state)?;
        let coordinates = state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect();
        let speeds = vec![HyperDual::ZERO; self.model.speeds.len()];
        let time = HyperDual::constant(state.time);
        let values = Evaluator::new(&self.model, &self.parameters, state.inputs, time, coordinates, speeds);
        ask(&values).map_err(state_error)
    }
}

/// Numbers that must be finite.
fn finite<const N: usize>(numbers: [f64; N]) -> Result<[f64; N], StateError> {
    if numbers.iter().all(|x| x.is_finite()) { Ok(numbers) } else { Err(StateError::NotFinite) }
}

/// The place of a point; undefined for one of which the model knows the velocity only.
fn place(values: &Evaluator<'_>, point: usize) -> Result<[f64; 3], Failure> {
    let point = PointId(point);
    if values.root(point) != PointId::O {
        return Err(Failure::Unsupported("position of this point"));
    }
    Ok(values.position(point)?.map(|c| c.re))
}
