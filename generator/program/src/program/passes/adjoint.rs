//! The sensitivity of the outputs of a program to rounding errors of its operations. The program is evaluated
//! at sample states and differentiated backwards (adjoints); errors are relative to the largest entry of each
//! output. The results are the same on every machine.

use crate::program::inputs::Inputs;
use crate::program::operation::{Operation, Value};
use crate::program::semantics::operate;
use crate::program::slopes;
use crate::program::straight_line::Program;
use hodograph_model::arbitrary::Arbitrary;
use hodograph_model::arithmetic::reproducible::Reproducible;

/// Number of random linear combinations of the outputs that stand for all outputs.
const COMBINATIONS: u64 = 4;
/// An output whose entries are at most this times the largest of all values vanishes identically; it is left
/// out, since errors relative to it have no meaning.
const NEGLIGIBLE: f64 = 1e-24;

/// A sample state with the sensitivities there.
pub struct Sensitivity {
    /// value of each operation; both of a sine-cosine pair
    numbers: Vec<(f64, f64)>,
    /// for each value the mean square of the error of an output that an error of 1 causes; 0 if that is not
    /// finite
    pub weights: Vec<f64>,
}

impl Sensitivity {
    /// Evaluates a program at a state; the seed determines the signs of the combinations.
    pub fn new(program: &Program, state: &Inputs, seed: u64) -> Self {
        let mut exact: Vec<(Reproducible, Reproducible)> = Vec::with_capacity(program.operations.len());
        for &operation in &program.operations {
            let number = operate(operation, state, |value| exact[value.index()]);
            exact.push(number);
        }
        let numbers: Vec<(f64, f64)> = exact.iter().map(|(a, b)| (a.rounded(), b.rounded())).collect();
        let sizes = numbers.iter().map(|number| number.0.abs()).filter(|size| size.is_finite());
        let negligible = NEGLIGIBLE * sizes.fold(0.0, f64::max);
        let mut arbitrary = Arbitrary::after(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(2 * seed + 1));
        let mut sign = || if arbitrary.bits() >> 63 == 0 { 1.0 } else { -1.0 };
        let mut weights = vec![0.0; numbers.len()];
        for _ in 0..COMBINATIONS {
            let mut slopes = vec![0.0; numbers.len()];
            for output in &program.outputs {
                let entries = || output.values.iter().map(|value| value.index());
                let largest = entries().fold(0.0f64, |largest, index| largest.max(numbers[index].0.abs()));
                if largest > negligible && entries().all(|index| numbers[index].0.is_finite()) {
                    entries().for_each(|index| slopes[index] += sign() / largest);
                }
            }
            backwards(program, &numbers, &mut slopes);
            for (weight, slope) in weights.iter_mut().zip(slopes) {
                let square = slope * slope / COMBINATIONS as f64;
                *weight += if square.is_finite() { square } else { 0.0 };
            }
        }
        Sensitivity { numbers, weights }
    }

    /// The number of a value at this state.
    pub fn number(&self, value: Value) -> f64 {
        self.numbers[value.index()].0
    }
}

/// Propagates derivatives with respect to later values back to all values from which they were computed.
fn backwards(program: &Program, numbers: &[(f64, f64)], slopes: &mut [f64]) {
    use Operation::*;
    let of = |value: Value| numbers[value.index()].0;
    for (index, &operation) in program.operations.iter().enumerate().rev() {
        let slope = slopes[index];
        if slope == 0.0 {
            continue;
        }
        let mut to = |value: Value, change: f64| slopes[value.index()] += slope * change;
        match operation {
            Sine(pair) => {
                if let SinCos(angle) = program.operation(pair) {
                    to(angle, numbers[pair.index()].1);
                }
            }
            Cosine(pair) => {
                if let SinCos(angle) = program.operation(pair) {
                    to(angle, -numbers[pair.index()].0);
                }
            }
            // Errors of the arguments of functions matter little: arguments are inputs, or nearly so.
            Call(..) | Call2(..) => {}
            _ => slopes::slopes(operation, numbers[index].0, of, to),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lower;
    use super::super::testing::{inputs, small, speeds};
    use super::*;

    #[test]
    fn a_weight_is_the_square_of_the_slope_relative_to_the_output() {
        let derived = small(|g| {
            let [a, b, c, _] = speeds(g);
            let product = g.product([a, b]);
            vec![g.sum([product, c])]
        });
        let program = lower(&derived);
        let weighed = Sensitivity::new(&program, &inputs(), 1);
        let answer = weighed.number(program.outputs[0].values[0]);
        for (index, operation) in program.operations.iter().enumerate() {
            let expected = match operation {
                Operation::Input(_) => continue,
                _ => 1.0 / (answer * answer),
            };
            assert!((weighed.weights[index] - expected).abs() < 1e-12 * expected, "{operation:?}");
        }
    }

    #[test]
    fn outputs_that_vanish_identically_do_not_count() {
        use hodograph_model::arithmetic::Function::{Cos, Sin};
        let mut derived = small(|g| speeds(g)[..1].to_vec());
        let g = &mut derived.graph;
        let [a, ..] = speeds(g);
        let squares = [Sin, Cos].map(|function| {
            let value = g.call(function, vec![a]);
            g.power(value, 2)
        });
        let minus = g.integer(-1);
        let zero = g.sum([squares[0], squares[1], minus]);
        let more = crate::program::Output {
            quantity: crate::program::Quantity::KineticEnergy,
            rows: 1,
            columns: 1,
            values: vec![zero],
        };
        derived.outputs.push(more);
        let (program, speeds) = (lower(&derived), vec![0.3, 0.0, 0.0, 0.0]);
        let weighed = Sensitivity::new(&program, &Inputs { speeds, ..inputs() }, 1);
        let [speed, zero] = [0, 1].map(|output: usize| program.outputs[output].values[0]);
        assert!((weighed.weights[speed.index()] * 0.09 - 1.0).abs() < 1e-12);
        assert_eq!((weighed.weights[zero.index()], weighed.number(zero) != 0.0), (0.0, true));
    }

    #[test]
    fn weights_are_those_of_differences() {
        let derived = small(|g| {
            let [a, b, c, d] = speeds(g);
            let angle = g.sum([a, b]);
            let sine = g.call(hodograph_model::arithmetic::Function::Sin, vec![angle]);
            let cosine = g.call(hodograph_model::arithmetic::Function::Cos, vec![angle]);
            let quotient = g.power(c, -1);
            let first = g.product([sine, quotient]);
            let second = g.product([cosine, d]);
            vec![g.sum([first, second])]
        });
        let program = super::super::contract::contract(&lower(&derived));
        let at = |speeds: Vec<f64>| Sensitivity::new(&program, &Inputs { speeds, ..inputs() }, 1);
        let speeds = inputs().speeds;
        let there = at(speeds.clone());
        let output = program.outputs[0].values[0];
        for (index, operation) in program.operations.iter().enumerate() {
            let &Operation::Input(crate::program::graph::Input::Speed(which)) = operation else { continue };
            let mut moved = speeds.clone();
            moved[which as usize] += 1e-6;
            let slope = (at(moved).number(output) - there.number(output)) / 1e-6 / there.number(output);
            assert!((there.weights[index] - slope * slope).abs() < 1e-4 * slope * slope, "{which}");
        }
    }
}
