//! What operations and functions mean in doubles, in numbers of twice the digits, and in numbers that are the same on every machine.
//! Generated code means the same (`hodograph::generated`).

mod double_double;
mod doubles;
mod function;
mod large_angles;
pub mod reproducible;

pub use doubles::{Arithmetic, call, call2, sin_cos};
pub use function::Function;
pub use hodograph_arithmetic::{DoubleDouble, FUSED, mul_add};
