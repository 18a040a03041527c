//! The operations and functions of programs in doubles, and the trait [`Arithmetic`] of all number types in
//! which programs are evaluated.

use std::ops::{Add, Div, Mul, Neg, Sub};

use hodograph_arithmetic::elementary::double;
use hodograph_arithmetic::{hyperbolic, mul_add, trigonometry};

use super::function::Function;

/// A number type in which programs can be evaluated.
pub trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// A number of the program or from outside.
    fn exactly(number: f64) -> Self;
    /// `self * b + c`
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// A function of one value.
    fn call(self, function: Function) -> Self;
    /// A function of two values.
    fn call2(self, function: Function, b: Self) -> Self;
}

impl Arithmetic for f64 {
    fn exactly(number: f64) -> Self {
        number
    }
    fn mul_add(self, b: Self, c: Self) -> Self {
        mul_add(self, b, c)
    }
    fn sin_cos(self) -> (Self, Self) {
        sin_cos(self)
    }
    fn call(self, function: Function) -> Self {
        call(function, self)
    }
    fn call2(self, function: Function, b: Self) -> Self {
        call2(function, self, b)
    }
}

/// Sine and cosine.
pub fn sin_cos(a: f64) -> (f64, f64) {
    trigonometry::sin_cos(a, trigonometry::beyond)
}

/// A function of one value. A function of two values gives NaN.
pub fn call(function: Function, a: f64) -> f64 {
    match function {
        Function::Sin => sin_cos(a).0,
        Function::Cos => sin_cos(a).1,
        Function::Tan => double::tan(a),
        Function::Asin => double::asin(a),
        Function::Acos => double::acos(a),
        Function::Atan => double::atan(a),
        Function::Sqrt => a.sqrt(),
        Function::Exp => double::exp(a),
        Function::Log => double::ln(a),
        Function::Sinh => hyperbolic::sinh(a),
        Function::Cosh => hyperbolic::cosh(a),
        Function::Tanh => hyperbolic::tanh(a),
        Function::Abs => a.abs(),
        Function::Sign => {
            if a >= 0.0 {
                1.0
            } else {
                -1.0
            }
        }
        Function::Frozen => a,
        Function::Atan2 | Function::Min | Function::Max => f64::NAN,
    }
}

/// A function of two values. A function of one value gives NaN.
pub fn call2(function: Function, a: f64, b: f64) -> f64 {
    match function {
        Function::Atan2 => double::atan2(a, b),
        Function::Min => {
            if a < b {
                a
            } else {
                b
            }
        }
        Function::Max => {
            if a > b {
                a
            } else {
                b
            }
        }
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::sin_cos;

    /// Distance in units of the last place of the expected number.
    fn ulps(found: f64, expected: f64) -> f64 {
        let unit = (expected.abs().to_bits() + 1).max(1);
        (found - expected).abs() / (f64::from_bits(unit) - expected.abs())
    }

    #[test]
    fn sines_and_cosines_are_right_to_the_last_place() {
        let mut worst: f64 = 0.0;
        let near = (-400..400).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2);
        let spread = (0..200_000).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract() * 200.0 - 100.0);
        let large = (0..20_000).map(|k| f64::from(k) * 26.214_39 + 0.1);
        for x in near.chain(spread).chain(large).chain([0.0, 1e-300, 1e9, 1e300]) {
            let ((s, c), (sine, cosine)) = (sin_cos(x), x.sin_cos());
            worst = worst.max(ulps(s, sine)).max(ulps(c, cosine));
        }
        assert!(worst <= 1.0, "{worst}");
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
