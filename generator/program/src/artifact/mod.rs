//! Derivation files: a program as lines of text, checked in beside the model that it belongs to.
//!
//! ```text
//! hodograph derivation 2
//! generator 0.1.0
//! model 51b0c2..                      hash of the model
//! structures general                  per contact
//! 0 coordinate 2                      operations: index, word, operands
//! 1 sincos 0
//! 2 sine 1
//! 3 number 0.75
//! 4 mul 2 3
//! output mass_matrix 1 1 : 4          quantity, rows, columns, values
//! guard 4 scale 3 : the arm is stretched
//! end 5
//! digest 9f4e01..                     hash of all that stands above, to the byte
//! ```
//!
//! A text that was changed since it was written does not agree with its digest and is refused. Numbers are
//! the shortest decimals that read back exactly. The same program gives the same bytes.

mod decode;
mod encode;
mod hash;
mod load;
pub mod place;

pub use decode::{DecodeError, decode};
pub use encode::encode;
pub use hash::model_hash;
pub use load::{Loaded, load, load_text};

use crate::program::Program;
use hodograph_model::arithmetic::Function;

/// The version of the format. It changes when a program of one version would mean something else in another.
pub const FORMAT: u32 = 2;

/// The beginning of the last line.
const DIGEST: &str = "digest ";

/// Largest size of a derivation, in bytes: a thousand times that of shipped models.
pub const MAX_BYTES: usize = 128 << 20;

/// A decoded derivation.
#[derive(Clone, Debug, PartialEq)]
pub struct Artifact {
    /// version of the generator that wrote it
    pub generator: String,
    /// [`model_hash`] of the model from which it was derived
    pub model: String,
    /// the program
    pub program: Program,
}

/// The words of functions in derivation files.
const FUNCTIONS: [(Function, &str); 18] = [
    (Function::Sin, "sin"),
    (Function::Cos, "cos"),
    (Function::Tan, "tan"),
    (Function::Asin, "asin"),
    (Function::Acos, "acos"),
    (Function::Atan, "atan"),
    (Function::Atan2, "atan2"),
    (Function::Sqrt, "sqrt"),
    (Function::Exp, "exp"),
    (Function::Log, "log"),
    (Function::Sinh, "sinh"),
    (Function::Cosh, "cosh"),
    (Function::Tanh, "tanh"),
    (Function::Abs, "abs"),
    (Function::Sign, "sign"),
    (Function::Min, "min"),
    (Function::Max, "max"),
    (Function::Frozen, "frozen"),
];

/// Whether the function takes two values.
fn is_binary(function: Function) -> bool {
    matches!(function, Function::Atan2 | Function::Min | Function::Max)
}

#[cfg(test)]
mod tests;
#[cfg(test)]
mod vanishing;
