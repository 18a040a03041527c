//! Straight-line programs: sequences of operations, each with the stage at which it can be computed.
//!
//! ```text
//! graph (sums, products, functions)  ->  passes, one of which lowers it to binary operations  ->  program
//! ```

mod build;
mod conformance;
pub mod cost;
mod derivation;
mod inputs;
pub mod jacobian;
pub mod ldl;
mod live_values;
mod lower;
mod merge;
pub mod operation;
mod output;
pub mod passes;
pub mod quantity;
mod semantics;
mod slice;
pub mod slopes;
pub mod solve;
mod straight_line;

pub use conformance::fits;
pub use derivation::Derived;
pub use hodograph_model::graph::{self, differentiate};
pub use inputs::Inputs;
pub use output::{Guard, Output, VANISHING};
pub use quantity::{ContactQuantity, PointQuantity, Quantity, Structure};
pub use semantics::operate;
pub use slice::Slice;
pub use straight_line::Program;
