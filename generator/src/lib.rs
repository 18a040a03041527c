//! From the text of a model to Rust code, in stages, each of which is a crate of its own:
//!
//! ```text
//! hodograph-model    source text -> syntax -> model -> check
//! hodograph-derive   model -> kinematics -> kane               (feature `derive`)
//! hodograph-program  program -> interpret | explain | artifact
//! hodograph-emit     program -> Rust tokens
//! expand             what `mechanism!` becomes: all of this in the compiler
//! ```

pub mod expand;

#[cfg(feature = "derive")]
pub use hodograph_derive::{DerivationError, algebra, derive};
pub use hodograph_emit as emit;
pub use hodograph_model::{
    arithmetic, check, diagnostics, explanations, format, model, numeric, page, parts, rendering, rust_names,
    source, suggest, syntax, words,
};
pub use hodograph_program::{artifact, explain, files, interpret, program};
