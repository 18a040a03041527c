//! The arguments of commands that simulate a motion many times: its start, its surfaces and its tolerance.

use std::path::Path;

use hodograph::State as Borrowed;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;

use super::simulate::surfaces::{Found, MotionSurfaces};
use crate::answers::FormArgument;
use crate::derivation::{self, Limits};
use crate::evaluate::Machine;
use crate::state_arguments::StateArguments;
use crate::stop::{Outcome, Stop};

/// The arguments of a motion.
#[derive(Clone, Debug, clap::Args)]
pub struct MotionArguments {
    /// the initial state
    #[command(flatten)]
    pub state: StateArguments,
    /// relative and absolute tolerance of the integration, at least 1e-16 [default: 1e-12]
    #[arg(long, value_name = "NUMBER", allow_hyphen_values = true)]
    tolerance: Option<f64>,
    #[command(flatten)]
    surfaces: MotionSurfaces,
    /// the form of the answer
    #[command(flatten)]
    pub form: FormArgument,
    #[command(flatten)]
    limits: Limits,
}

impl MotionArguments {
    /// The mechanism of a model.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`] for the tolerance, and the errors of [`derivation::machine`].
    pub fn machine(&self, model: &Path) -> Outcome<Machine> {
        Options::check_tolerance(self.tolerance())
            .map_err(|error| Stop::Call(format!("--tolerance: {error}")))?;
        derivation::machine(model, &self.limits)
    }

    /// The options of a simulation from this start.
    ///
    /// # Errors
    ///
    /// [`Stop::Call`] if a contact that can close has no surface.
    pub fn options(&self, mechanism: &InterpretedMechanism, start: &Borrowed<'_>) -> Outcome<Options> {
        let Found { surfaces, laws } = self.surfaces.of(mechanism, start)?;
        Ok(Options {
            relative_tolerance: self.tolerance(),
            absolute_tolerance: self.tolerance(),
            max_step: mechanism.greatest_step(false),
            surfaces,
            laws,
            ..Options::default()
        })
    }

    /// The options as they were given, but for the form of the answer.
    pub fn given(&self) -> Vec<String> {
        let tolerance = self.tolerance.map(|value| ["--tolerance".to_owned(), value.to_string()]);
        let own = tolerance.into_iter().flatten();
        self.state.given().into_iter().chain(own).chain(self.surfaces.given()).collect()
    }

    fn tolerance(&self) -> f64 {
        self.tolerance.unwrap_or(Options::default().relative_tolerance)
    }
}
