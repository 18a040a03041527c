//! Reads the text of a mechanism, gives it its meaning and checks it, without files, without the algebra engine
//! and without a compiler: an editor or a page in a browser links this crate alone.
//!
//! ```text
//! source text -> syntax   tokens and an untyped tree, with the place of everything
//!             -> parts    parts, repetitions and imported files as tokens of a model without them
//!             -> model    names resolved, dimensions checked, all mistakes collected
//!             -> check    the model as a whole, counted and in numbers (numeric)
//! ```
//!
//! A mistake is a [`diagnostics::Diagnostic`]; `rendering` shows it with its line, `explanations` explains its
//! code. `page` is what all written pages have in common.

pub mod arbitrary;
pub mod arithmetic;
pub mod check;
pub mod diagnostics;
pub mod dimension;
pub mod explanations;
pub mod format;
pub mod graph;
pub mod model;
pub mod number;
pub mod numeric;
pub mod page;
pub mod parts;
pub mod rendering;
pub mod rust_names;
pub mod source;
pub mod span;
pub mod suggest;
pub mod syntax;
pub mod unicode;
pub mod vocabulary;
pub mod words;
