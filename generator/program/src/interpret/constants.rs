//! The values of a program that depend on parameters alone.

use crate::program::operation::{Stage, Value};
use crate::program::{Inputs, Program, VANISHING, operate};
use hodograph_model::arithmetic::DoubleDouble;

/// The values of a program that depend on parameters alone, computed in double-double arithmetic and rounded
/// once.
#[derive(Clone, Debug)]
pub struct Constants {
    pub(super) stages: Vec<Stage>,
    /// for each value the rounded number; 0 for values of later stages
    rounded: Vec<(f64, f64)>,
}

impl Constants {
    /// Computes the constants. `parameters` are all of them in file order, `fixed` ones included (which are
    /// not read).
    pub fn new(program: &Program, parameters: &[f64]) -> Self {
        let stages = program.stages();
        let inputs = Inputs { parameters: parameters.to_vec(), ..Inputs::default() };
        let zero = DoubleDouble::new(0.0);
        let mut early = vec![(zero, zero); program.operations.len()];
        let mut rounded = vec![(0.0, 0.0); program.operations.len()];
        for (index, &operation) in program.operations.iter().enumerate() {
            if stages[index] <= Stage::Parameter {
                early[index] = operate(operation, &inputs, |value| early[value.index()]);
                rounded[index] = (early[index].0.rounded(), early[index].1.rounded());
            }
        }
        Constants { stages, rounded }
    }

    /// The stage of a value.
    pub fn stage(&self, value: Value) -> Stage {
        self.stages.get(value.index()).copied().unwrap_or(Stage::Velocity)
    }

    /// The number of a value that depends on parameters alone.
    pub fn get(&self, value: Value) -> f64 {
        self.rounded.get(value.index()).map_or(f64::NAN, |numbers| numbers.0)
    }

    /// The numbers of such a value; both of a sine-cosine pair.
    pub(super) fn pair(&self, value: Value) -> (f64, f64) {
        self.rounded.get(value.index()).copied().unwrap_or((f64::NAN, f64::NAN))
    }

    /// Whether all constants that later values use are finite.
    pub fn finite(&self, program: &Program) -> bool {
        program.kept(&self.stages).into_iter().all(|value| self.get(value).is_finite())
    }

    /// The first guard on parameters alone that fails: its message, and whether its value is finite.
    pub fn failure<'p>(&self, program: &'p Program) -> Option<(&'p str, bool)> {
        let early = program
            .guards
            .iter()
            .filter(|guard| program.guard_stage(guard, &self.stages) <= Stage::Parameter);
        early.into_iter().find_map(|guard| {
            let (value, scale) = (self.get(guard.value), guard.scale.map_or(0.0, |scale| self.get(scale)));
            let holds = holds(value, VANISHING * scale.abs());
            (!holds).then_some((guard.message.as_str(), value.is_finite() && scale.is_finite()))
        })
    }
}

/// Whether a value counts as nonzero. A divisor that overflows is large, and its quotient is 0.
pub(super) fn holds(value: f64, bound: f64) -> bool {
    value.abs() > bound || value.is_infinite()
}
