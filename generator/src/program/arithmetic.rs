//! What the operations mean in doubles. Generated code means the same (`hodograph::generated`).

use crate::model::mechanism::Function;

/// a * b + c, with one rounding where this build's target has the instruction.
pub fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
}

/// A function of one value. A function of two values gives NaN.
pub fn call(function: Function, a: f64) -> f64 {
    match function {
        Function::Sin => a.sin(),
        Function::Cos => a.cos(),
        Function::Tan => a.tan(),
        Function::Asin => a.asin(),
        Function::Acos => a.acos(),
        Function::Atan => a.atan(),
        Function::Sqrt => a.sqrt(),
        Function::Exp => a.exp(),
        Function::Log => a.ln(),
        Function::Abs => a.abs(),
        Function::Sign => {
            if a >= 0.0 {
                1.0
            } else {
                -1.0
            }
        }
        Function::Atan2 | Function::Min | Function::Max => f64::NAN,
    }
}

/// A function of two values. A function of one value gives NaN.
pub fn call2(function: Function, a: f64, b: f64) -> f64 {
    match function {
        Function::Atan2 => a.atan2(b),
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
