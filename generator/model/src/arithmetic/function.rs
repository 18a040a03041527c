//! The functions of the model language.

/// A function of scalars.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sqrt,
    Exp,
    Log,
    Sinh,
    Cosh,
    Tanh,
    Abs,
    /// 1 if the argument is not negative, else -1
    Sign,
    Min,
    Max,
    /// the argument, of which derivatives take no notice: what an iteration starts from
    Frozen,
}
