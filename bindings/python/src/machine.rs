//! The mechanism of a model: by its derived equations, or by the model alone.

use hodograph::{ComponentKind, Contacts, Mechanism as _, ParameterError};
use hodograph_generator::model::mechanism::Mechanism as Model;
use hodograph_interpreter::motion::STEP_OF_TIME;
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
use pyo3::prelude::*;

use crate::errors;

/// A mechanism with its parameters.
#[derive(Clone)]
pub enum Machine {
    /// by its derivation
    Derived(Box<InterpretedMechanism>),
    /// by its model alone
    Numeric {
        mechanism: Box<NumericMechanism>,
        /// whether the model depends on time by itself
        timed: bool,
    },
}

impl Machine {
    /// All that both can do.
    pub fn contacts(&self) -> &dyn Contacts<f64> {
        match self {
            Machine::Derived(mechanism) => mechanism.as_ref(),
            Machine::Numeric { mechanism, .. } => mechanism.as_ref(),
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        match self {
            Machine::Derived(mechanism) => mechanism.model(),
            Machine::Numeric { mechanism, .. } => mechanism.model(),
        }
    }

    /// The equations, where they are there.
    pub fn derived(&self, py: Python<'_>, what: &str) -> PyResult<&InterpretedMechanism> {
        match self {
            Machine::Derived(mechanism) => Ok(mechanism),
            Machine::Numeric { .. } => {
                let message = format!(
                    "{} is evaluated without derived equations, and they alone determine {what}: `hodograph derive` writes them",
                    self.model().name
                );
                Err(errors::error(py, "StateError", &message, "undefined", Some(what.to_owned()), None))
            }
        }
    }

    /// Gives the parameters other values.
    pub fn set_parameters(&mut self, values: &[f64]) -> Result<(), ParameterError> {
        match self {
            Machine::Derived(mechanism) => mechanism.set_parameter_values(values),
            Machine::Numeric { mechanism, .. } => mechanism.set_parameter_values(values),
        }
    }

    /// All parameters in file order, `fixed` ones too.
    pub fn all_parameters(&self) -> &[f64] {
        match self {
            Machine::Derived(mechanism) => mechanism.all_parameters(),
            Machine::Numeric { mechanism, .. } => mechanism.all_parameters(),
        }
    }

    /// The greatest step of an integration, s.
    pub fn greatest_step(&self, driven: bool) -> f64 {
        match self {
            Machine::Derived(mechanism) => mechanism.greatest_step(driven),
            Machine::Numeric { timed, .. } if driven || *timed => STEP_OF_TIME,
            Machine::Numeric { .. } => f64::INFINITY,
        }
    }

    /// How many components of a kind there are.
    pub fn count(&self, kind: ComponentKind) -> usize {
        self.contacts().count(kind)
    }

    /// The name of a component.
    pub fn name_of(&self, kind: ComponentKind, index: usize) -> &str {
        self.contacts().component(kind, index).map_or("", |component| component.name)
    }
}
