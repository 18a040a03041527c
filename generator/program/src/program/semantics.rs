//! Evaluates one operation in any number type.

use super::inputs::Inputs;
use super::operation::{Operation, Value};
use hodograph_model::arithmetic::Arithmetic;

/// The result of an operation on earlier values; both numbers of a sine-cosine pair, else the second is 0.
pub fn operate<N: Arithmetic>(
    operation: Operation,
    inputs: &Inputs,
    numbers: impl Fn(Value) -> (N, N),
) -> (N, N) {
    use Operation::*;
    let of = |value: Value| numbers(value).0;
    let number = match operation {
        Constant(bits) => N::exactly(bits.get()),
        Input(input) => N::exactly(inputs.get(input)),
        Neg(a) => -of(a),
        Add(a, b) => of(a) + of(b),
        Sub(a, b) => of(a) - of(b),
        Mul(a, b) => of(a) * of(b),
        Div(a, b) => of(a) / of(b),
        Recip(a) => N::exactly(1.0) / of(a),
        MulAdd(a, b, c) => of(a).mul_add(of(b), of(c)),
        MulSub(a, b, c) => of(a).mul_add(of(b), -of(c)),
        NegMulAdd(a, b, c) => (-of(a)).mul_add(of(b), of(c)),
        SinCos(a) => return of(a).sin_cos(),
        Sine(a) => of(a),
        Cosine(a) => numbers(a).1,
        Call(function, a) => of(a).call(function),
        Call2(function, a, b) => of(a).call2(function, of(b)),
    };
    (number, N::exactly(0.0))
}
