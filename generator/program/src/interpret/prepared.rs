//! Prepares quantities for repeated evaluation: selects and orders the operations that they need, and
//! computes the values that depend on parameters alone once. The results have the same bits as those of
//! [`super::Evaluator`].

use super::constants::{Constants, holds};
use super::schedule::Schedule;
use crate::program::graph::Input;
use crate::program::operation::{Stage, Value};
use crate::program::{Guard, Program, Quantity, VANISHING};

/// The inputs of a program without the parameters, borrowed; each in the unit that the model declares, in
/// file order.
#[derive(Clone, Copy, Debug, Default)]
pub struct Arguments<'a> {
    /// time, s
    pub time: f64,
    /// coordinates
    pub coordinates: &'a [f64],
    /// independent speeds
    pub speeds: &'a [f64],
    /// named inputs
    pub inputs: &'a [f64],
    /// rates of the independent speeds
    pub accelerations: &'a [f64],
    /// direction of a linearisation
    pub tangent: &'a [f64],
}

impl Arguments<'_> {
    /// The value of an input; NaN if there is none.
    pub(super) fn get(&self, input: Input) -> f64 {
        let (list, index) = match input {
            Input::Time => return self.time,
            Input::Parameter(_) => return f64::NAN,
            Input::Coordinate(index) => (self.coordinates, index),
            Input::Speed(index) => (self.speeds, index),
            Input::Input(index) => (self.inputs, index),
            Input::Acceleration(index) => (self.accelerations, index),
            Input::Tangent(index) => (self.tangent, index),
        };
        list.get(index as usize).copied().unwrap_or(f64::NAN)
    }
}

/// A guard in a prepared routine.
#[derive(Clone, Debug)]
struct Check {
    value: usize,
    scale: Option<usize>,
    /// index of the guard in the program
    guard: usize,
}

/// Some quantities of a program, prepared for repeated evaluation with the same parameters.
#[derive(Clone, Debug)]
pub struct Prepared {
    schedule: Schedule,
    /// the numbers of the schedule's constants
    constants: Vec<f64>,
    checks: Vec<Check>,
    /// places of the results, quantity by quantity, by rows
    results: Vec<usize>,
    /// places of the results that are not constant
    computed: Vec<usize>,
}

/// Why a prepared routine has no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failed {
    /// a value vanishes that must not: index of the guard in the program
    Singular(usize),
    /// a result, or a value that must not vanish, is infinite or not a number
    NotFinite,
}

impl Prepared {
    /// Prepares those of the quantities that the program has, in this order.
    pub fn new(program: &Program, constants: &Constants, quantities: &[Quantity]) -> Self {
        let slice = program.slice(quantities);
        let (schedule, places) = Schedule::new(program, constants, &slice);
        let late = |value: Value| constants.stage(value) > Stage::Parameter;
        let guards = slice
            .guards
            .iter()
            .filter(|guard| program.guard_stage(guard, &constants.stages) > Stage::Parameter);
        let check = |guard: &&Guard| Check {
            value: places.of(guard.value),
            scale: guard.scale.map(|scale| places.of(scale)),
            guard: program.guards.iter().position(|other| other == *guard).unwrap_or(usize::MAX),
        };
        let checks = guards.map(check).collect();
        let values: Vec<Value> =
            slice.outputs.iter().flat_map(|output| output.values.iter().copied()).collect();
        let results = values.iter().map(|&value| places.of(value)).collect();
        let computed = values.iter().filter(|&&value| late(value)).map(|&value| places.of(value)).collect();
        let numbers = schedule.constants().iter().map(|&value| constants.get(value)).collect();
        Prepared { schedule, constants: numbers, checks, results, computed }
    }

    /// Replaces the parameters.
    pub fn refresh(&mut self, constants: &Constants) {
        for (number, &value) in self.constants.iter_mut().zip(self.schedule.constants()) {
            *number = constants.get(value);
        }
    }

    /// Number of results.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// Whether there are no results, because the program has none of the quantities.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Computes the quantities and passes the index and the value of each result to `with`.
    ///
    /// # Errors
    ///
    /// A guard fails, or a result is not finite: [`Failed`].
    pub fn evaluate(
        &self,
        arguments: &Arguments<'_>,
        mut with: impl FnMut(usize, f64),
    ) -> Result<(), Failed> {
        let numbers = self.schedule.execute(&self.constants, |input| arguments.get(input));
        for check in &self.checks {
            let value = numbers[check.value];
            let bound = check.scale.map_or(0.0, |scale| VANISHING * numbers[scale].abs());
            if !holds(value, bound) {
                let finite = value.is_finite() && bound.is_finite();
                return Err(if finite { Failed::Singular(check.guard) } else { Failed::NotFinite });
            }
        }
        if !self.computed.iter().all(|&at| numbers[at].is_finite()) {
            return Err(Failed::NotFinite);
        }
        self.results.iter().enumerate().for_each(|(index, &at)| with(index, numbers[at]));
        Ok(())
    }
}
