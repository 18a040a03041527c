//! The operations of a program, and the stages: build time, construction, configuration, velocity.

use super::graph::Input;
use hodograph_model::arithmetic::Function;

/// A value of a program: the result of the operation with this index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Value(pub u32);

impl Value {
    /// The index into [`super::Program::operations`].
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A double by its bits, so that operations can be compared and hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Bits(u64);

impl Bits {
    /// The bits of a double; both zeros become the positive one.
    pub fn new(number: f64) -> Self {
        Bits(if number == 0.0 { 0 } else { number.to_bits() })
    }

    /// The double.
    pub fn get(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// One operation. Operands are earlier values.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Operation {
    /// a number
    Constant(Bits),
    /// an input
    Input(Input),
    /// -a
    Neg(Value),
    /// a + b
    Add(Value, Value),
    /// a - b
    Sub(Value, Value),
    /// a * b
    Mul(Value, Value),
    /// a / b
    Div(Value, Value),
    /// 1 / a
    Recip(Value),
    /// a * b + c, with one rounding where the target has the instruction
    MulAdd(Value, Value, Value),
    /// a * b - c, likewise
    MulSub(Value, Value, Value),
    /// c - a * b, likewise
    NegMulAdd(Value, Value, Value),
    /// sine and cosine of a at once; only [`Operation::Sine`] and [`Operation::Cosine`] may use the result
    SinCos(Value),
    /// the sine out of a [`Operation::SinCos`]
    Sine(Value),
    /// the cosine out of a [`Operation::SinCos`]
    Cosine(Value),
    /// a function of one value
    Call(Function, Value),
    /// a function of two values
    Call2(Function, Value, Value),
}

impl Operation {
    /// The operands.
    pub fn operands(self) -> impl Iterator<Item = Value> {
        use Operation::*;
        let operands = match self {
            Constant(_) | Input(_) => [None; 3],
            Neg(a) | Recip(a) | SinCos(a) | Sine(a) | Cosine(a) | Call(_, a) => [Some(a), None, None],
            Add(a, b) | Sub(a, b) | Mul(a, b) | Div(a, b) | Call2(_, a, b) => [Some(a), Some(b), None],
            MulAdd(a, b, c) | MulSub(a, b, c) | NegMulAdd(a, b, c) => [Some(a), Some(b), Some(c)],
        };
        operands.into_iter().flatten()
    }

    /// The same operation on other values.
    pub fn map(self, mut f: impl FnMut(Value) -> Value) -> Self {
        use Operation::*;
        match self {
            Constant(_) | Input(_) => self,
            Neg(a) => Neg(f(a)),
            Recip(a) => Recip(f(a)),
            SinCos(a) => SinCos(f(a)),
            Sine(a) => Sine(f(a)),
            Cosine(a) => Cosine(f(a)),
            Call(function, a) => Call(function, f(a)),
            Add(a, b) => Add(f(a), f(b)),
            Sub(a, b) => Sub(f(a), f(b)),
            Mul(a, b) => Mul(f(a), f(b)),
            Div(a, b) => Div(f(a), f(b)),
            Call2(function, a, b) => Call2(function, f(a), f(b)),
            MulAdd(a, b, c) => MulAdd(f(a), f(b), f(c)),
            MulSub(a, b, c) => MulSub(f(a), f(b), f(c)),
            NegMulAdd(a, b, c) => NegMulAdd(f(a), f(b), f(c)),
        }
    }
}

/// The earliest stage at which a value can be computed. Later stages include earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// at build time
    Constant,
    /// once, at construction: depends on parameters alone
    Parameter,
    /// depends on coordinates or time
    Configuration,
    /// depends on speeds, inputs or accelerations
    Velocity,
}

impl Stage {
    /// The stage of an input.
    pub fn of_input(input: Input) -> Self {
        match input {
            Input::Parameter(_) => Stage::Parameter,
            Input::Time | Input::Coordinate(_) => Stage::Configuration,
            Input::Speed(_) | Input::Input(_) | Input::Acceleration(_) | Input::Tangent(_) => Stage::Velocity,
        }
    }

    /// The stage of an operation whose operands have known stages.
    pub fn of(operation: Operation, mut stage: impl FnMut(Value) -> Stage) -> Self {
        match operation {
            Operation::Constant(_) => Stage::Constant,
            Operation::Input(input) => Stage::of_input(input),
            _ => operation.operands().map(&mut stage).max().unwrap_or(Stage::Constant),
        }
    }
}
