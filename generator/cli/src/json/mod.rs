//! The JSON interface: reads lines and states, writes answers and error objects (`docs/json.md` is the
//! specification).

pub mod answer;
pub mod characteristics;
pub mod failure;
pub mod fields;
pub mod lines;
pub mod state;
pub mod value;

pub use failure::{Failure, Kind};
pub use fields::Fields;
pub use value::Json;
