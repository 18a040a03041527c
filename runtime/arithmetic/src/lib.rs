//! The arithmetic that the interpreter (`hodograph-generator`) and generated code (`hodograph`) share, so
//! that both compute the same bits:
//!
//! * [`mul_add`]: a * b + c, with one rounding where the feature `fused` is on and the target has the
//!   instruction,
//! * [`trigonometry`]: sine and cosine of a double and of a single, the same on every machine,
//! * [`elementary`]: the other elementary functions, likewise,
//! * [`hyperbolic`]: hyperbolic functions of a double, likewise,
//! * [`DoubleDouble`]: numbers of twice the digits,
//! * [`POSSIBLE_INERTIA`]: a tolerance, with which both judge inertias alike.
//!
//! This package is not part of Hodograph's public interface: any version may change it.

#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(feature = "std", test))]
extern crate std;

mod double_double;
pub mod elementary;
mod fused;
pub mod hyperbolic;
pub mod trigonometry;

pub use double_double::{Component, DoubleDouble};
pub use fused::{FUSED, mul_add};

/// Inertias may miss what is possible by this much, relative to their size: stated numbers are rounded.
pub const POSSIBLE_INERTIA: f64 = 1e-9;
