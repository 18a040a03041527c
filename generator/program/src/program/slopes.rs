//! Slopes of operations: what derivatives are made of, forwards and backwards.

use super::operation::{Operation, Value};
use hodograph_model::arithmetic::{Function, call, mul_add, sin_cos};

/// Passes each operand of an operation to `to`, with the slope of the result by it. `own` is the result, `of` gives
/// numbers. Inputs, and sine-cosine pairs and their parts, have no operands here.
pub fn slopes(operation: Operation, own: f64, of: impl Fn(Value) -> f64, mut to: impl FnMut(Value, f64)) {
    use Operation::*;
    match operation {
        Constant(_) | Input(_) | SinCos(_) | Sine(_) | Cosine(_) => {}
        Neg(a) => to(a, -1.0),
        Add(a, b) => {
            to(a, 1.0);
            to(b, 1.0);
        }
        Sub(a, b) => {
            to(a, 1.0);
            to(b, -1.0);
        }
        Mul(a, b) => {
            to(a, of(b));
            to(b, of(a));
        }
        Div(a, b) => {
            to(a, 1.0 / of(b));
            to(b, -own / of(b));
        }
        Recip(a) => to(a, -own * own),
        MulAdd(a, b, c) => {
            to(a, of(b));
            to(b, of(a));
            to(c, 1.0);
        }
        MulSub(a, b, c) => {
            to(a, of(b));
            to(b, of(a));
            to(c, -1.0);
        }
        NegMulAdd(a, b, c) => {
            to(a, -of(b));
            to(b, -of(a));
            to(c, 1.0);
        }
        Call(function, a) => to(a, slope(function, of(a), own)),
        Call2(function, a, b) => {
            let (by_a, by_b) = slopes_of_two(function, (of(a), of(b)), own);
            to(a, by_a);
            to(b, by_b);
        }
    }
}

/// The slope of a function of one number `a`, whose value there is `value`; NaN for a function of two.
pub fn slope(function: Function, a: f64, value: f64) -> f64 {
    match function {
        Function::Sin => sin_cos(a).1,
        Function::Cos => -sin_cos(a).0,
        Function::Tan => mul_add(value, value, 1.0),
        Function::Asin => 1.0 / call(Function::Sqrt, (1.0 - a) * (1.0 + a)),
        Function::Acos => -1.0 / call(Function::Sqrt, (1.0 - a) * (1.0 + a)),
        Function::Atan => 1.0 / mul_add(a, a, 1.0),
        Function::Sqrt => 0.5 / value,
        Function::Exp => value,
        Function::Log => 1.0 / a,
        Function::Sinh => call(Function::Cosh, a),
        Function::Cosh => call(Function::Sinh, a),
        Function::Tanh => (1.0 - value) * (1.0 + value),
        Function::Abs => call(Function::Sign, a),
        Function::Sign | Function::Frozen => 0.0,
        Function::Atan2 | Function::Min | Function::Max => f64::NAN,
    }
}

/// The slopes of a function of two numbers, whose value there is `value`; NaN for a function of one.
pub fn slopes_of_two(function: Function, (a, b): (f64, f64), value: f64) -> (f64, f64) {
    match function {
        Function::Atan2 => {
            let square = a * a + b * b;
            (b / square, -a / square)
        }
        // If both are equal, the derivative is that of the first.
        Function::Min | Function::Max if value == a => (1.0, 0.0),
        Function::Min | Function::Max => (0.0, 1.0),
        _ => (f64::NAN, f64::NAN),
    }
}
