//! The operations and functions of programs in three number types: doubles, numbers of twice the digits, and
//! numbers that are the same on every machine. Generated code computes the same bits
//! (`hodograph::generated`).

mod double_double;
mod doubles;
mod function;
mod large_angles;
pub mod reproducible;

pub use doubles::{Arithmetic, call, call2, sin_cos};
pub use function::Function;
pub use hodograph_arithmetic::{DoubleDouble, FUSED, mul_add};
