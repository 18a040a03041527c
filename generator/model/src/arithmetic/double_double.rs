//! The operations on values that depend on parameters only: computed with twice the digits and rounded once
//! at the end. Constructors of generated code compute the same bits (`hodograph::generated::construction`).

use hodograph_arithmetic::DoubleDouble;

use super::doubles::{self, Arithmetic};
use super::function::Function;

impl Arithmetic for DoubleDouble<f64> {
    fn exactly(number: f64) -> Self {
        DoubleDouble::new(number)
    }

    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = doubles::sin_cos(self.rounded());
        (self.function(sine, cosine), self.function(cosine, -sine))
    }

    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.sin_cos().0,
            Function::Cos => self.sin_cos().1,
            Function::Sqrt => self.sqrt(),
            Function::Abs => {
                if self.rounded() < 0.0 {
                    -self
                } else {
                    self
                }
            }
            // of the nearest double
            _ => DoubleDouble::new(doubles::call(function, self.rounded())),
        }
    }

    fn call2(self, function: Function, b: Self) -> Self {
        match function {
            Function::Min => {
                if self.is_less(b) {
                    self
                } else {
                    b
                }
            }
            Function::Max => {
                if b.is_less(self) {
                    self
                } else {
                    b
                }
            }
            _ => DoubleDouble::new(doubles::call2(function, self.rounded(), b.rounded())),
        }
    }
}
