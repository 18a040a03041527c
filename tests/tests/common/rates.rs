//! How fast the quantities of a model change along its motion: its program on numbers that carry their rates.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Model;
use hodograph_generator::arithmetic::{Arithmetic, Function, call};
use hodograph_generator::program::graph::Input;
use hodograph_generator::program::operation::Operation;
use hodograph_generator::program::{Inputs, Quantity, operate};
use num_dual::{Dual64, DualNum};

/// A number and its rate.
#[derive(Clone, Copy)]
struct Moving(Dual64);

macro_rules! operator {
    ($($name:ident $method:ident)*) => {
        $(impl $name for Moving {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Moving($name::$method(self.0, other.0))
            }
        })*
    };
}
operator! { Add add Sub sub Mul mul Div div }

impl Neg for Moving {
    type Output = Self;
    fn neg(self) -> Self {
        Moving(-self.0)
    }
}

impl Arithmetic for Moving {
    fn exactly(number: f64) -> Self {
        Moving(Dual64::from_re(number))
    }
    fn mul_add(self, b: Self, c: Self) -> Self {
        Moving(self.0 * b.0 + c.0)
    }
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.0.sin_cos();
        (Moving(sin), Moving(cos))
    }
    fn call(self, function: Function) -> Self {
        let x = self.0;
        Moving(match function {
            Function::Sin => x.sin(),
            Function::Cos => x.cos(),
            Function::Tan => x.tan(),
            Function::Asin => x.asin(),
            Function::Acos => x.acos(),
            Function::Atan => x.atan(),
            Function::Sqrt => x.sqrt(),
            Function::Exp => x.exp(),
            Function::Log => x.ln(),
            Function::Sinh => x.sinh(),
            Function::Cosh => x.cosh(),
            Function::Tanh => x.tanh(),
            Function::Abs => x * x.re.signum(),
            Function::Sign | Function::Frozen => Dual64::from_re(call(function, x.re)),
            Function::Atan2 | Function::Min | Function::Max => panic!("{function:?} of one number"),
        })
    }
    fn call2(self, function: Function, b: Self) -> Self {
        Moving(match function {
            Function::Atan2 => self.0.atan2(b.0),
            Function::Min => {
                if self.0.re <= b.0.re {
                    self.0
                } else {
                    b.0
                }
            }
            Function::Max => {
                if self.0.re >= b.0.re {
                    self.0
                } else {
                    b.0
                }
            }
            _ => panic!("{function:?} of two numbers"),
        })
    }
}

/// Everything that a model's program computes at a state, with its rates.
pub struct Rates<'m> {
    model: &'m Model,
    numbers: Vec<(Moving, Moving)>,
}

impl<'m> Rates<'m> {
    /// At a state of the motion, which the derived rates of the coordinates and the accelerations go on with.
    pub fn along_motion(model: &'m Model, inputs: &Inputs) -> Self {
        let coordinates = model.get(inputs, Quantity::CoordinateRates).values;
        let speeds = model.get(inputs, Quantity::Accelerations).values;
        let mut numbers: Vec<(Moving, Moving)> = Vec::with_capacity(model.program.operations.len());
        for &operation in &model.program.operations {
            let number = match operation {
                Operation::Input(input) => {
                    let rate = match input {
                        Input::Time => 1.0,
                        Input::Coordinate(index) => coordinates[index as usize],
                        Input::Speed(index) => speeds[index as usize],
                        _ => 0.0,
                    };
                    (Moving(Dual64::new(inputs.get(input), rate)), Moving::exactly(0.0))
                }
                _ => operate(operation, inputs, |value| numbers[value.index()]),
            };
            numbers.push(number);
        }
        Rates { model, numbers }
    }

    /// How fast a quantity changes; nothing where the mechanism has none.
    pub fn of(&self, quantity: Quantity) -> Vec<f64> {
        let output = self.model.program.output(quantity);
        output.map_or(Vec::new(), |output| {
            output.values.iter().map(|value| self.numbers[value.index()].0.0.eps).collect()
        })
    }
}
