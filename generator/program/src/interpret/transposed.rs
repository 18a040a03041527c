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
    pub fn transpose(
        &self,
        tape: &[f64],
        weights: &[f64],
        by: &mut Cotangents<'_>,
        by_constants: &mut [f64],
    ) {
        let mut cotangents = vec![0.0; tape.len()];
        for (&at, weight) in self.results.iter().zip(weights) {
            cotangents[at] += weight;
        }
        self.schedule.transpose(tape, &mut cotangents);
        by_constants.iter_mut().zip(&cotangents).for_each(|(sum, by)| *sum += by);
        let of_inputs = cotangents.iter().skip(self.constants.len());
        self.schedule
            .inputs()
            .iter()
            .zip(of_inputs)
            .for_each(|(&input, &cotangent)| by.add(input, cotangent));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interpret::{Directional, Rates};
    use crate::program::Derived;
    use crate::program::passes::contract;
    use crate::program::passes::lower;
    use crate::program::passes::testing::{inputs, parameters, random, small, speeds};
    use hodograph_model::arithmetic::Function;

    /// Every function, of inputs and of parameters alone.
    fn functions() -> Derived {
        use Function::*;
        small(|g| {
            let (late, early) = (speeds(g), parameters(g));
            let of = |inputs: &[crate::program::graph::Node], g: &mut crate::program::graph::Graph| {
                let square = g.power(inputs[0], 2);
                let one = g.integer(1);
                let above = g.sum([square, one]);
                let below = g.power(above, -1);
                let mut all: Vec<_> = [Sin, Cos, Tan, Atan, Sqrt, Exp, Log, Sinh, Cosh, Tanh, Abs, Sign]
                    .map(|function| g.call(function, vec![above]))
                    .to_vec();
                all.extend([Asin, Acos].map(|function| g.call(function, vec![below])));
                all.extend([Atan2, Min, Max].map(|function| g.call(function, vec![inputs[1], inputs[2]])));
                all
            };
            let (mut all, constants) = (of(&late, g), of(&early, g));
            let products: Vec<_> = all.iter().zip(constants).map(|(&a, b)| g.product([a, b])).collect();
            all.extend(products);
            all
        })
    }

    /// Weights times derivatives along directions are derivatives of the weighted sum along them.
    #[test]
    fn the_transpose_agrees_with_derivatives_along_directions() {
        let derived = (0..40).map(random).chain([functions()]);
        let (mut compared, mut refused) = (0, 0);
        for derived in derived {
            let program = contract::contract(&lower(&derived));
            let values = inputs();
            let constants = Constants::new(&program, &values.parameters);
            let directions = 3;
            let mut bits = 1_u64;
            let mut number = || {
                bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
            };
            let count = [values.parameters.len(), values.coordinates.len(), values.speeds.len()];
            let [by_parameters, by_coordinates, by_speeds] =
                count.map(|count| (0..count * directions).map(|_| number()).collect::<Vec<f64>>());
            let arguments = Arguments {
                coordinates: &values.coordinates,
                speeds: &values.speeds,
                ..Arguments::default()
            };
            let along = Directional::new(
                &program,
                &constants,
                (&values.parameters, &by_parameters),
                directions,
                &[Quantity::Forcing],
            );
            let rates = Rates { coordinates: &by_coordinates, speeds: &by_speeds, ..Rates::default() };
            let (mut results, mut by) = (Vec::new(), Vec::new());
            if along.evaluate(&arguments, &rates, &mut results, &mut by).is_err() {
                refused += 1;
                continue;
            }
            compared += 1;
            let routine = Transposed::new(&program, &constants, count[0], &[Quantity::Forcing]);
            let mut tape = Vec::new();
            assert_eq!(routine.evaluate(&arguments, &mut tape).unwrap(), results);
            let weights: Vec<f64> = results.iter().map(|_| number()).collect();
            let (mut of_coordinates, mut of_speeds) = (vec![0.0; count[1]], vec![0.0; count[2]]);
            let mut of_constants = vec![0.0; routine.constants()];
            let mut cotangents = Cotangents {
                coordinates: &mut of_coordinates,
                speeds: &mut of_speeds,
                ..Cotangents::default()
            };
            routine.transpose(&tape, &weights, &mut cotangents, &mut of_constants);
            let of_parameters = routine.by_parameters(&of_constants);
            for d in 0..directions {
                let terms = |of: &[f64], by: &[f64]| -> Vec<f64> {
                    of.iter().enumerate().map(|(index, of)| of * by[index * directions + d]).collect()
                };
                let forwards = terms(&weights, &by);
                let backwards = [
                    terms(&of_parameters, &by_parameters),
                    terms(&of_coordinates, &by_coordinates),
                    terms(&of_speeds, &by_speeds),
                ]
                .concat();
                let size: f64 = forwards.iter().chain(&backwards).map(|term| term.abs()).sum();
                let off = forwards.iter().sum::<f64>() - backwards.iter().sum::<f64>();
                assert!(off.abs() <= 1e-11 * size, "{off:e} of {size:e}");
            }
        }
        assert!(compared > 30 && refused < 11, "{compared} {refused}");
    }
}
