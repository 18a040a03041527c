//! The paths of derivation files.

use std::path::{Path, PathBuf};

use hodograph_model::rust_names::snake_case;

/// The derivation of a model file: `models/hopper.mech` has `models/hopper.derivation` beside it.
pub fn beside(model: &Path) -> PathBuf {
    model.with_extension("derivation")
}

/// The derivation of an inline model: `derived/hopper.derivation` beside the `Cargo.toml` in `package`.
pub fn inline(package: &Path, mechanism: &str) -> PathBuf {
    package.join("derived").join(format!("{}.derivation", snake_case(mechanism)))
}
