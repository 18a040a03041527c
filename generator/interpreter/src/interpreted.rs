//! [`InterpretedMechanism`]: a model with its program and parameters.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use hodograph::generated::check_length;
use hodograph::{ParameterError, State, StateError};
use hodograph_model::model::mechanism::{self, Mechanism};
use hodograph_program::interpret::{Arguments, Constants, Failed};
use hodograph_program::program::{Program, Quantity};
use hodograph_program::{artifact, program};

use crate::intern::intern;
use crate::routines::{OfSeveral, Request, Routines};
use crate::{Error, description, motion, parameters, read};

/// A mechanism whose equations are interpreted. It has the traits [`hodograph::Mechanism`] and
/// [`hodograph::Contacts`].
///
/// What a routine needs is prepared at its first call; later calls compute numbers only. Clones share the
/// model and the program.
#[derive(Clone, Debug)]
pub struct InterpretedMechanism {
    pub(crate) model: Arc<Mechanism>,
    pub(crate) program: Arc<Program>,
    /// how many numbers the program has for each quantity
    pub(crate) sizes: Arc<BTreeMap<Quantity, usize>>,
    /// all, in file order, `fixed` ones too
    parameters: Vec<f64>,
    pub(crate) constants: Constants,
    routines: Routines,
    quaternions: Vec<[usize; 4]>,
    dependent_coordinates: Vec<usize>,
}

impl InterpretedMechanism {
    /// Reads a model file and the derivation beside it.
    ///
    /// # Errors
    ///
    /// [`Error`]
    pub fn read(path: &Path) -> Result<Self, Error> {
        let (model, source) = read::model(path)?;
        let kept = artifact::place::beside(path);
        let advice = format!("run `hodograph derive {}`", path.display());
        let program = artifact::load(&kept, &source).program().map_err(|fault| {
            Error::Derivation(format!("the derivation {} {fault}; {advice}", kept.display()))
        })?;
        Self::with_stated_parameters(model, program)
    }

    /// The mechanism of a model and its program, with the parameters that the model states.
    pub(crate) fn with_stated_parameters(model: Mechanism, program: Program) -> Result<Self, Error> {
        let value = |parameter: &mechanism::Variable| {
            parameter
                .value
                .or(parameter.fixed.then_some(0.0))
                .ok_or_else(|| Error::NoValue(parameter.name.clone()))
        };
        let parameters = model.parameters.iter().map(value).collect::<Result<Vec<f64>, Error>>()?;
        Self::with(model, program, parameters)
    }

    pub(crate) fn with(model: Mechanism, program: Program, parameters: Vec<f64>) -> Result<Self, Error> {
        program::fits(&model, &program).map_err(Error::Derivation)?;
        let constants = parameters::constants(&model, &program, &parameters)?;
        Ok(InterpretedMechanism {
            routines: Routines::new(&model),
            quaternions: description::quaternions(&model),
            dependent_coordinates: description::dependent_coordinates(&model),
            model: Arc::new(model),
            sizes: Arc::new(
                program.outputs.iter().map(|output| (output.quantity, output.values.len())).collect(),
            ),
            program: Arc::new(program),
            parameters,
            constants,
        })
    }

    /// The greatest step of the integration of a motion, s; `driven` says whether inputs are functions of
    /// time.
    pub fn greatest_step(&self, driven: bool) -> f64 {
        motion::greatest_step(&self.program, driven)
    }

    /// The error of a state at which the program failed.
    pub(crate) fn error_of_state(&self, failed: Failed) -> StateError {
        match failed {
            Failed::Singular(guard) => {
                let message = self.program.guards.get(guard).map_or("", |guard| guard.message.as_str());
                StateError::Singular { what: intern(message) }
            }
            Failed::NotFinite => StateError::NotFinite,
        }
    }

    /// All parameters in file order, `fixed` ones too.
    pub fn all_parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// The numbers of the coordinates of each quaternion.
    pub fn quaternions(&self) -> &[[usize; 4]] {
        &self.quaternions
    }

    pub(crate) fn dependent_coordinates(&self) -> &[usize] {
        &self.dependent_coordinates
    }

    /// Number of independent speeds.
    pub(crate) fn freedom(&self) -> usize {
        description::freedom(&self.model)
    }

    pub(crate) fn change_parameters(&mut self, parameters: &[f64]) -> Result<(), ParameterError> {
        let all = parameters::all(&self.model, parameters)?;
        self.constants = parameters::constants(&self.model, &self.program, &all)?;
        self.parameters = all;
        self.routines.refresh(&self.constants);
        Ok(())
    }

    /// Whether the slices of a state have their lengths.
    pub(crate) fn check(&self, state: &State<'_>) -> Result<(), StateError> {
        check_length(state.coordinates, self.model.coordinates.len(), "coordinates")?;
        check_length(state.speeds, self.freedom(), "speeds")?;
        check_length(state.inputs, self.model.inputs.len(), "inputs")
    }

    /// Computes what is requested; `with` receives each number's index and value. `expected` is how many
    /// numbers there are to be.
    pub(crate) fn compute(
        &self,
        request: Request,
        state: &State<'_>,
        accelerations: &[f64],
        with: impl FnMut(usize, f64),
    ) -> Result<(), StateError> {
        let arguments = arguments(state, accelerations);
        let prepared = self.routines.get(request, &self.program, &self.constants);
        prepared.evaluate(&arguments, with).map_err(|failed| self.error_of_state(failed))
    }

    /// Computes what is asked of several contacts, number by number.
    pub(crate) fn compute_together(
        &self,
        what: OfSeveral,
        contacts: &[usize],
        expected: usize,
        state: &State<'_>,
        with: impl FnMut(usize, f64),
    ) -> Result<(), StateError> {
        let prepared = self.routines.together(what, contacts, &self.program, &self.constants);
        if prepared.len() != expected {
            return Err(StateError::Undefined { what: "several contacts" });
        }
        prepared.evaluate(&arguments(state, &[]), with).map_err(|failed| self.error_of_state(failed))
    }

    /// Whether the program has what is requested.
    pub(crate) fn has(&self, request: Request) -> bool {
        !self.routines.get(request, &self.program, &self.constants).is_empty()
    }

    /// Computes what is requested into a slice, which must be as long; where the mechanism has no such thing,
    /// that is empty.
    pub(crate) fn write(
        &self,
        request: Request,
        state: &State<'_>,
        accelerations: &[f64],
        slice: &mut [f64],
        what: &'static str,
    ) -> Result<(), StateError> {
        self.check(state)?;
        check_length(slice, self.routines.get(request, &self.program, &self.constants).len(), what)?;
        self.compute(request, state, accelerations, |index, number| {
            if let Some(slot) = slice.get_mut(index) {
                *slot = number;
            }
        })
    }

    /// Computes numbers of which there are `N`.
    pub(crate) fn array<const N: usize>(
        &self,
        request: Request,
        state: &State<'_>,
        accelerations: &[f64],
    ) -> Result<[f64; N], StateError> {
        self.check(state)?;
        let mut numbers = [0.0; N];
        self.compute(request, state, accelerations, |index, number| {
            if let Some(slot) = numbers.get_mut(index) {
                *slot = number;
            }
        })?;
        Ok(numbers)
    }
}

/// What a routine is given.
fn arguments<'a>(state: &State<'a>, accelerations: &'a [f64]) -> Arguments<'a> {
    let State { time, coordinates, speeds, inputs } = *state;
    Arguments { time, coordinates, speeds, inputs, accelerations, tangent: &[] }
}
