//! The language, its mistakes and what becomes of a model, from text to tokens.
//!
//! One program holds all of them: `cargo test -p hodograph-generator --test all language::`
//! runs those of `tests/language.rs`.

mod cascades;
mod clearances;
mod degenerate_poses;
mod diagnostics;
mod errors_page;
mod expansion;
#[path = "../../tests/tests/common/expectations.rs"]
mod expectations;
mod imports;
mod iterated_contacts;
mod kept_configurations;
mod language;
mod language_page;
mod literals;
mod masses_of_shapes;
mod mistakes;
mod mistakes_of_a_cart;
mod mistakes_of_other_kinds;
mod overconstrained;
mod parts;
mod polytopes;
mod robust;
mod second_road;
mod shapes;
mod sizes;
mod slips;
mod stages;
