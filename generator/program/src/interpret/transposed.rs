//! Evaluates quantities of a program, and the transpose of their derivative: what a weighted sum of the quantities
//! changes by with each input and parameter, by reverse-mode automatic differentiation. The cost does not depend on
//! the number of inputs and parameters.
//!
//! Values have the bits of [`super::Prepared`]. Derivatives are those of [`super::Directional`] up to rounding.

use super::constants::Constants;
use super::prepared::{Arguments, Failed};
use super::schedule::Schedule;
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::slopes::slopes;
use crate::program::{Program, Quantity};

/// Derivatives of a weighted sum of quantities by the arguments. They are added to what the lists hold, which have a
/// number per component; empty lists are left alone.
#[derive(Debug, Default)]
pub struct Cotangents<'a> {
    /// by the time
    pub time: f64,
    /// by the coordinates
    pub coordinates: &'a mut [f64],
    /// by the independent speeds
    pub speeds: &'a mut [f64],
    /// by the named inputs
    pub inputs: &'a mut [f64],
}

impl Cotangents<'_> {
    fn add(&mut self, input: Input, by: f64) {
        let (list, index) = match input {
            Input::Time => return self.time += by,
            Input::Coordinate(index) => (&mut *self.coordinates, index),
            Input::Speed(index) => (&mut *self.speeds, index),
            Input::Input(index) => (&mut *self.inputs, index),
            Input::Parameter(_) | Input::Acceleration(_) | Input::Tangent(_) => return,
        };
        if let Some(slot) = list.get_mut(index as usize) {
            *slot += by;
        }
    }
}

/// Some quantities of a program, prepared for repeated evaluation with the transpose of their derivative.
#[derive(Clone, Debug)]
pub struct Transposed {
    schedule: Schedule,
    /// the numbers of the schedule's constants
    constants: Vec<f64>,
    /// what the constants are computed from, operands before their users
    early: Vec<(Value, Operation)>,
    /// the numbers of all values that depend on parameters alone; of a pair the sine and the cosine
    numbers: Vec<(f64, f64)>,
    /// places of the results
    results: Vec<usize>,
    parameters: usize,
}

impl Transposed {
    /// Prepares those of the quantities that the program has, in this order. `parameters` is the number of all
    /// parameters, `fixed` ones included.
    pub fn new(program: &Program, constants: &Constants, parameters: usize, quantities: &[Quantity]) -> Self {
        let slice = program.slice(quantities);
        let (schedule, places) = Schedule::new(program, constants, &slice);
        let early = slice.order.iter().filter(|&&value| constants.stage(value) <= Stage::Parameter);
        let early = early.map(|&value| (value, program.operation(value))).collect();
        let mut numbers = vec![(0.0, 0.0); program.operations.len()];
        for &value in slice.order.iter().filter(|&&value| constants.stage(value) <= Stage::Parameter) {
            numbers[value.index()] = constants.pair(value);
        }
        let results = slice.outputs.iter().flat_map(|output| &output.values);
        let results = results.map(|&value| places.of(value)).collect();
        let of_schedule = schedule.constants().iter().map(|&value| constants.get(value)).collect();
        Transposed { schedule, constants: of_schedule, early, numbers, results, parameters }
    }

    /// Number of constants: values that depend on parameters alone, and that the quantities use.
    pub fn constants(&self) -> usize {
        self.constants.len()
    }

    /// Computes the quantities, one after the other, by rows, and keeps all numbers in `tape`.
    ///
    /// # Errors
    ///
    /// [`Failed::NotFinite`] if a value is infinite or not a number. Guards are not checked here, only by
    /// [`super::Prepared`].
    pub fn evaluate(&self, arguments: &Arguments<'_>, tape: &mut Vec<f64>) -> Result<Vec<f64>, Failed> {
        *tape = self.schedule.execute(&self.constants, |input| arguments.get(input));
        let values: Vec<f64> = self.results.iter().map(|&at| tape[at]).collect();
        let finite = values.iter().all(|value| value.is_finite());
        if finite { Ok(values) } else { Err(Failed::NotFinite) }
    }

    /// Adds the derivatives of the sum of the quantities, weighted by `weights`, by the arguments, and by the
    /// constants ([`Transposed::constants`] numbers). `tape` is that of [`Transposed::evaluate`].
    pub fn transpose(&self, tape: &[f64], weights: &[f64], by: &mut Cotangents<'_>, by_constants: &mut [f64]) {
        let mut cotangents = vec![0.0; tape.len()];
        for (&at, weight) in self.results.iter().zip(weights) {
            cotangents[at] += weight;
        }
        self.schedule.transpose(tape, &mut cotangents);
        by_constants.iter_mut().zip(&cotangents).for_each(|(sum, by)| *sum += by);
        let of_inputs = cotangents.iter().skip(self.constants.len());
        self.schedule.inputs().iter().zip(of_inputs).for_each(|(&input, &cotangent)| by.add(input, cotangent));
    }

    /// The derivatives by all parameters, `fixed` ones included, from those by the constants.
    pub fn by_parameters(&self, by_constants: &[f64]) -> Vec<f64> {
        let mut by: Vec<(f64, f64)> = vec![(0.0, 0.0); self.numbers.len()];
        for (value, cotangent) in self.schedule.constants().iter().zip(by_constants) {
            by[value.index()].0 += cotangent;
        }
        let mut parameters = vec![0.0; self.parameters];
        for &(value, operation) in self.early.iter().rev() {
            let (cotangent, of_cosine) = by[value.index()];
            let (own, cosine) = self.numbers[value.index()];
            // What does not depend on a value has no derivative by it, even where its slope is infinite.
            if cotangent == 0.0 && of_cosine == 0.0 {
                continue;
            }
            match operation {
                Operation::Input(Input::Parameter(index)) => {
                    if let Some(slot) = parameters.get_mut(index as usize) {
                        *slot += cotangent;
                    }
                }
                Operation::SinCos(a) => by[a.index()].0 += cotangent * cosine - of_cosine * own,
                Operation::Sine(pair) => by[pair.index()].0 += cotangent,
                Operation::Cosine(pair) => by[pair.index()].1 += cotangent,
                _ => {
                    let number = |value: Value| self.numbers[value.index()].0;
                    slopes(operation, own, number, |a, slope| by[a.index()].0 += cotangent * slope);
                }
            }
        }
        parameters
    }
}
