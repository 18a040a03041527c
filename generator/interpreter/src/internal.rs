//! What the other packages of Hodograph take from a mechanism beyond its traits: its model and its equations.
//!
//! The types are those of `hodograph-model` and `hodograph-program`, which promise nothing from version to
//! version; so this is there with the feature `internal` only.

use hodograph_model::model::mechanism::Mechanism;
use hodograph_program::interpret::Constants;
use hodograph_program::program::Program;

use crate::{Error, InterpretedMechanism, NumericMechanism, parameters};

impl InterpretedMechanism {
    /// The mechanism of a model and its program, with the parameters that the model states.
    ///
    /// # Errors
    ///
    /// [`Error`]
    pub fn new(model: Mechanism, program: Program) -> Result<Self, Error> {
        Self::with_stated_parameters(model, program)
    }

    /// The mechanism of a model and its program, with these parameters: all that are not `fixed`, in the
    /// order of the model.
    ///
    /// # Errors
    ///
    /// [`Error`]
    pub fn with_parameters(model: Mechanism, program: Program, parameters: &[f64]) -> Result<Self, Error> {
        let all = parameters::all(&model, parameters)?;
        Self::with(model, program, all)
    }

    /// The model.
    pub fn model(&self) -> &Mechanism {
        &self.model
    }

    /// The equations of the model.
    pub fn program(&self) -> &Program {
        &self.program
    }

    /// What the equations compute of the parameters alone.
    pub fn constants(&self) -> &Constants {
        &self.constants
    }
}

impl NumericMechanism {
    /// The mechanism of a model, with the parameters that the model states.
    ///
    /// # Errors
    ///
    /// [`Error::NoValue`], [`Error::Parameters`].
    pub fn new(model: Mechanism) -> Result<Self, Error> {
        Self::with_stated_parameters(model)
    }

    /// The mechanism of a model, with these parameters: all that are not `fixed`, in the order of the model.
    ///
    /// # Errors
    ///
    /// [`Error::Parameters`].
    pub fn with_parameters(model: Mechanism, parameters: &[f64]) -> Result<Self, Error> {
        let all = parameters::all(&model, parameters)?;
        Ok(Self::with(model, all)?)
    }

    /// The model.
    pub fn model(&self) -> &Mechanism {
        &self.model
    }
}
