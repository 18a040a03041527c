//! The solver against independent computations, laws of mechanics and hostile input.
//!
//! One program holds all of them: `cargo test -p hodograph --test all slip::`
//! runs those of `tests/slip.rs`.

mod appendix;
mod budget;
mod common;
mod contact;
mod derivative;
mod energy;
#[path = "../../tests/tests/common/expectations.rs"]
mod expectations;
mod extremes;
mod hodograph;
mod hostile;
mod hostile_run;
mod methods;
mod paper;
mod properties;
mod reference_cases;
mod remarks;
mod scalars;
mod second_road;
mod several;
mod slip;
mod specialised;
mod structure;
mod theory;
#[cfg(feature = "lanes")]
mod together;
mod types;
mod without_collision;
