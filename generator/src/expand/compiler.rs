//! File, line and column of the tokens of a macro's input, from the compiler that runs the macro; unknown
//! outside of a compiler.

extern crate proc_macro;

use std::path::PathBuf;

use proc_macro2::Span;

use hodograph_model::span::Location;

/// The compiler's own span, while there is a compiler.
fn known(span: Span) -> Option<proc_macro::Span> {
    proc_macro::is_available().then(|| span.unwrap())
}

/// The source file of a token.
pub fn file(span: Span) -> Option<PathBuf> {
    known(span)?.local_file()
}

/// Its line and column.
pub fn location(span: Span) -> Option<Location> {
    let span = known(span)?;
    Some(Location { line: span.line(), column: span.column() })
}
