//! Evaluates quantities of a program and their derivatives along several directions at once, also with
//! respect to parameters, by forward-mode automatic differentiation.
//!
//! Values have the bits of [`super::Prepared`]. Derivatives have no step size and no truncation error.

use super::schedule::Schedule;
use crate::interpret::constants::Constants;
use crate::interpret::prepared::{Arguments, Failed};
use crate::program::graph::Input;
use crate::program::operation::{Operation, Stage, Value};
use crate::program::slopes::{slope, slopes_of_two};
use crate::program::{Inputs, Program, Quantity, operate};
use hodograph_model::arithmetic::{Arithmetic, Function, call, call2, mul_add, sin_cos};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number of directions that are propagated together.
const LANES: usize = 8;

/// Derivatives of the inputs along `k` directions. Each slice has `k` numbers per component; an empty slice
/// means that its inputs are constant.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rates<'a> {
    /// of the time (k)
    pub time: &'a [f64],
    /// of the coordinates (n x k)
    pub coordinates: &'a [f64],
    /// of the independent speeds (p x k)
    pub speeds: &'a [f64],
    /// of the named inputs (w x k)
    pub inputs: &'a [f64],
}

impl Rates<'_> {
    /// The derivatives of an input along the directions from `first` on.
    fn get(&self, input: Input, first: usize, k: usize) -> [f64; LANES] {
        let (list, index) = match input {
            Input::Time => (self.time, 0),
            Input::Coordinate(index) => (self.coordinates, index as usize),
            Input::Speed(index) => (self.speeds, index as usize),
            Input::Input(index) => (self.inputs, index as usize),
            Input::Parameter(_) | Input::Acceleration(_) | Input::Tangent(_) => (&[][..], 0),
        };
        lanes(list, index, first, k)
    }
}

/// The derivatives of a component along the directions from `first` on; beyond the last direction they are 0.
fn lanes(list: &[f64], index: usize, first: usize, k: usize) -> [f64; LANES] {
    let mut rates = [0.0; LANES];
    let row = list.get(index * k + first..(index + 1) * k).unwrap_or(&[]);
    rates.iter_mut().zip(row).for_each(|(slot, rate)| *slot = *rate);
    rates
}

/// Some quantities of a program, prepared for repeated evaluation with their derivatives along `k`
/// directions.
#[derive(Clone, Debug)]
pub struct Directional {
    directions: usize,
    /// for each block of directions the numbers of the schedule's constants
    constants: Vec<Vec<Dual>>,
    schedule: Schedule,
    /// places of the results
    results: Vec<usize>,
}

impl Directional {
    /// Prepares those of the quantities that the program has, in this order. `parameters` are all parameters
    /// in file order, `fixed` ones included; `by_parameters` (number of parameters x k) holds their
    /// derivatives along the directions.
    pub fn new(
        program: &Program,
        constants: &Constants,
        (parameters, by_parameters): (&[f64], &[f64]),
        directions: usize,
        quantities: &[Quantity],
    ) -> Self {
        let slice = program.slice(quantities);
        let (schedule, places) = Schedule::new(program, constants, &slice);
        let blocks = 0..directions.div_ceil(LANES).max(1);
        let early: Vec<Value> =
            slice.order.iter().copied().filter(|&value| constants.stage(value) <= Stage::Parameter).collect();
        let none = Inputs::default();
        let of_block = |block: usize| {
            let mut numbers = vec![(Dual::exactly(0.0), Dual::exactly(0.0)); program.operations.len()];
            for &value in &early {
                numbers[value.index()] = match program.operation(value) {
                    Operation::Input(Input::Parameter(index)) => {
                        let value = parameters.get(index as usize).copied().unwrap_or(f64::NAN);
                        let by = lanes(by_parameters, index as usize, block * LANES, directions);
                        (Dual { value, by }, Dual::exactly(0.0))
                    }
                    operation => {
                        // The values are computed in double-double arithmetic.
                        let (first, second) =
                            operate(operation, &none, |value: Value| numbers[value.index()]);
                        let (a, b) = constants.pair(value);
                        (Dual { value: a, ..first }, Dual { value: b, ..second })
                    }
                };
            }
            schedule.constants().iter().map(|value| numbers[value.index()].0).collect()
        };
        let constants = blocks.map(of_block).collect();
        let results = slice.outputs.iter().flat_map(|output| &output.values);
        let results = results.map(|&value| places.of(value)).collect();
        Directional { directions, constants, schedule, results }
    }

    /// Number of results.
    pub fn len(&self) -> usize {
        self.results.len()
    }

    /// Whether there are no results, because the program has none of the quantities.
    pub fn is_empty(&self) -> bool {
        self.results.is_empty()
    }

    /// Computes the quantities, one after the other, by rows, and their derivatives (one row for each result,
    /// `k` columns).
    ///
    /// # Errors
    ///
    /// [`Failed::NotFinite`] if a value or a derivative is infinite or not a number. Guards are not checked
    /// here, only by [`super::Prepared`].
    pub fn evaluate(
        &self,
        arguments: &Arguments<'_>,
        rates: &Rates<'_>,
        values: &mut Vec<f64>,
        derivatives: &mut Vec<f64>,
    ) -> Result<(), Failed> {
        let k = self.directions;
        values.clear();
        values.resize(self.results.len(), 0.0);
        derivatives.clear();
        derivatives.resize(self.results.len() * k, 0.0);
        for (block, constants) in self.constants.iter().enumerate() {
            let first = block * LANES;
            let input = |input| Dual { value: arguments.get(input), by: rates.get(input, first, k) };
            let numbers = self.schedule.execute(constants, input);
            for (index, &at) in self.results.iter().enumerate() {
                let number = numbers[at];
                values[index] = number.value;
                let row = derivatives.get_mut(index * k + first..(index + 1) * k).unwrap_or(&mut []);
                row.iter_mut().zip(number.by).for_each(|(slot, rate)| *slot = rate);
            }
        }
        let finite = values.iter().chain(derivatives.iter()).all(|number| number.is_finite());
        if finite { Ok(()) } else { Err(Failed::NotFinite) }
    }
}

/// A number and its derivatives along [`LANES`] directions.
#[derive(Clone, Copy, Debug)]
struct Dual {
    value: f64,
    by: [f64; LANES],
}

impl Dual {
    /// A function of this number with the given value and slope.
    fn with(self, value: f64, slope: f64) -> Self {
        // A derivative of 0 stays 0 even if the slope is infinite.
        Dual { value, by: self.by.map(|rate| if rate == 0.0 { 0.0 } else { slope * rate }) }
    }

    /// A function of two numbers with the given value and slopes.
    fn of_two(self, b: Self, value: f64, slopes: (f64, f64)) -> Self {
        let mut by = [0.0; LANES];
        for ((slot, a), b) in by.iter_mut().zip(self.by).zip(b.by) {
            *slot = slopes.0 * a + slopes.1 * b;
        }
        Dual { value, by }
    }
}

impl Neg for Dual {
    type Output = Self;

    fn neg(self) -> Self {
        Dual { value: -self.value, by: self.by.map(|rate| -rate) }
    }
}

impl Add for Dual {
    type Output = Self;

    fn add(self, b: Self) -> Self {
        self.of_two(b, self.value + b.value, (1.0, 1.0))
    }
}

impl Sub for Dual {
    type Output = Self;

    fn sub(self, b: Self) -> Self {
        self.of_two(b, self.value - b.value, (1.0, -1.0))
    }
}

impl Mul for Dual {
    type Output = Self;

    fn mul(self, b: Self) -> Self {
        self.of_two(b, self.value * b.value, (b.value, self.value))
    }
}

impl Div for Dual {
    type Output = Self;

    fn div(self, b: Self) -> Self {
        let quotient = self.value / b.value;
        self.of_two(b, quotient, (1.0 / b.value, -quotient / b.value))
    }
}

impl Arithmetic for Dual {
    fn exactly(number: f64) -> Self {
        Dual { value: number, by: [0.0; LANES] }
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        let product = self.of_two(b, mul_add(self.value, b.value, c.value), (b.value, self.value));
        product.of_two(c, product.value, (1.0, 1.0))
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = sin_cos(self.value);
        (self.with(sine, cosine), self.with(cosine, -sine))
    }

    fn call(self, function: Function) -> Self {
        let value = call(function, self.value);
        self.with(value, slope(function, self.value, value))
    }

    fn call2(self, function: Function, b: Self) -> Self {
        let value = call2(function, self.value, b.value);
        self.of_two(b, value, slopes_of_two(function, (self.value, b.value), value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes of functions of one number agree with finite differences of order four.
    #[test]
    fn slopes_agree_with_differences() {
        use Function::*;
        for function in [Sin, Cos, Tan, Asin, Acos, Atan, Sqrt, Exp, Log, Sinh, Cosh, Tanh, Abs, Sign] {
            for a in [0.21, 0.83] {
                let mut by = [0.0; LANES];
                by[3] = 2.0;
                let found = Dual { value: a, by }.call(function);
                let f = |x: f64| call(function, x);
                let h = 3e-4;
                let slope = (8.0 * (f(a + h) - f(a - h)) - (f(a + 2.0 * h) - f(a - 2.0 * h))) / (12.0 * h);
                assert_eq!(found.value.to_bits(), f(a).to_bits());
                assert!((found.by[3] - 2.0 * slope).abs() < 1e-9, "{function:?} at {a}: {}", found.by[3]);
                assert_eq!(found.by[0], 0.0);
            }
        }
        // The root of a constant 0 has the derivative 0, not infinity.
        assert_eq!(Dual::exactly(0.0).call(Sqrt).by, [0.0; LANES]);
    }

    /// Products, quotients and functions of two numbers agree with finite differences.
    #[test]
    fn operations_on_two_numbers_agree_with_differences() {
        let number = |value: f64, rate: f64| Dual { value, by: [rate; LANES] };
        type Two = (fn(Dual, Dual) -> Dual, fn(f64, f64) -> f64);
        let cases: [Two; 8] = [
            (|a, b| a + b, |a, b| a + b),
            (|a, b| a - b, |a, b| a - b),
            (|a, b| a * b, |a, b| a * b),
            (|a, b| a / b, |a, b| a / b),
            (|a, b| a.mul_add(b, a), |a, b| a * b + a),
            (|a, b| a.call2(Function::Atan2, b), f64::atan2),
            (|a, b| a.call2(Function::Min, b), f64::min),
            (|a, b| a.call2(Function::Max, b), f64::max),
        ];
        for (dual, plain) in cases {
            let (a, b, x, y) = (0.7, -1.3, 0.4, 2.5);
            let f = |h: f64| plain(a + h * x, b + h * y);
            let h = 3e-4;
            let slope = (8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h);
            let found = dual(number(a, x), number(b, y));
            assert!((found.by[7] - slope).abs() < 1e-9 && (found.value - f(0.0)).abs() < 1e-15);
        }
    }
}
