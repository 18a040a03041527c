//! Outputs (quantities and their values) and guards (values that must not be zero) of a derivation or of a
//! program.

use super::operation::Value;
use super::quantity::Quantity;

/// A quantity and its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Output<V = Value> {
    /// the quantity
    pub quantity: Quantity,
    /// number of rows
    pub rows: usize,
    /// number of columns
    pub columns: usize,
    /// rows * columns values, by rows
    pub values: Vec<V>,
}

/// A value that must not vanish. Evaluations that use it report an error if it does.
#[derive(Clone, Debug, PartialEq)]
pub struct Guard<V = Value> {
    /// the value
    pub value: V,
    /// the value that it is compared with: it counts as zero if |value| <= [`VANISHING`] |scale|. `None`: it
    /// counts as zero if it is exactly zero or not finite
    pub scale: Option<V>,
    /// the error if it vanishes, for instance `the constraints cannot be solved for u2, u3`
    pub message: String,
}

/// A value counts as zero if it is at most this times its scale: 2^-40.
pub const VANISHING: f64 = 1.0 / (1u64 << 40) as f64;
