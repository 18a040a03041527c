//! Derivations of small models.

mod central_momentum;
mod potential_energy;
mod quaternion_rates;

use hodograph_derive::derive;
use hodograph_model::check::check;
use hodograph_model::diagnostics::Severity;
use hodograph_model::model::mechanism::Mechanism;
use hodograph_model::numeric::State;
use hodograph_model::source::Source;
use hodograph_program::interpret::Evaluator;
use hodograph_program::program::{Inputs, Program, Quantity};

/// A model and its program.
struct Derived {
    mechanism: Mechanism,
    program: Program,
}

impl Derived {
    fn of(text: &str) -> Self {
        let checked = check(&Source::file("model.mech", text));
        let errors: Vec<_> = checked.diagnostics.iter().filter(|d| d.severity == Severity::Error).collect();
        let Some(mechanism) = checked.mechanism else { panic!("{errors:?}\n{text}") };
        let program = Program::new(&derive(&mechanism).unwrap_or_else(|error| panic!("{error}\n{text}")));
        Derived { mechanism, program }
    }

    /// The initial state.
    fn state(&self) -> State {
        State::of(&self.mechanism)
    }

    /// The numbers of a quantity in a state; none where the model does not have it.
    fn get(&self, state: &State, quantity: Quantity) -> Vec<f64> {
        if self.program.output(quantity).is_none() {
            return Vec::new();
        }
        let inputs = Inputs {
            parameters: state.parameters.clone(),
            time: state.time,
            coordinates: state.coordinates.clone(),
            speeds: state.speeds.clone(),
            inputs: state.inputs.clone(),
            ..Inputs::default()
        };
        Evaluator::new(&self.program).evaluate(&inputs, &[quantity]).unwrap().remove(0).values
    }
}
