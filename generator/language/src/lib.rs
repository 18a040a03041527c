//! The services of an editor for a model, as functions of its text, without files, threads and protocol. The
//! language server and a page in a browser use the same functions, and each presents the results in its own
//! way.
//!
//! ```
//! use hodograph_language::Document;
//!
//! let model = "mechanism A;\nparameters { m: kg = 2 }\nspeeds { u: m/s }\n";
//! let document = Document::new(model);
//! let help = document.hover(model.find("m: kg").unwrap() as u32).unwrap();
//! assert!(help.text.contains("a parameter"));
//! assert_eq!(document.findings()[0].code, "E014");
//! ```
//!
//! Places are byte offsets of the text; [`text`] converts them to lines and to the units of an editor.

pub mod colours;
pub mod completion;
mod context;
pub mod document;
mod entries;
mod expected;
pub mod findings;
pub mod fixes;
mod fixes_with_parts;
pub mod hints;
pub mod hover;
pub mod layout;
pub mod navigate;
mod new_name;
pub mod outline;
pub mod rename_with_parts;
mod statements;
pub mod text;

pub use document::{Document, Place};
pub use hodograph_model::span::Span;
