//! Messages as compile errors.

use proc_macro2::{Span as RustSpan, TokenStream};
use quote::quote_spanned;

use super::{Diagnostic, Severity};
use crate::source::Source;

/// One `compile_error!` per error. For an inline model each stands at the user's own tokens; for a file each names the place in
/// the file, at the place where the macro was called.
pub fn compile_errors(diagnostics: &[Diagnostic], source: &Source) -> TokenStream {
    diagnostics.iter().filter(|d| d.severity == Severity::Error).map(|d| compile_error(d, source)).collect()
}

fn compile_error(diagnostic: &Diagnostic, source: &Source) -> TokenStream {
    let (start, end, text) = match source.rust_spans(diagnostic.primary.span) {
        Some((start, end)) => (start, end, inline_text(diagnostic)),
        None => (RustSpan::call_site(), RustSpan::call_site(), file_text(diagnostic, source)),
    };
    // the compiler underlines from the first token of the call to its last
    let path = quote_spanned!(start=> ::core::compile_error);
    let call = quote_spanned!(end=> ! { #text });
    quote::quote!(#path #call)
}

fn inline_text(diagnostic: &Diagnostic) -> String {
    let mut text = format!("[{}] {}", diagnostic.code, diagnostic.message);
    if !diagnostic.primary.text.is_empty() {
        text.push_str(&format!("\nhere: {}", diagnostic.primary.text));
    }
    if let Some(help) = &diagnostic.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    text
}

fn file_text(diagnostic: &Diagnostic, source: &Source) -> String {
    let rendered = diagnostic.render(source);
    let body = rendered.split_once('\n').map_or("", |(_, body)| body);
    let line = Diagnostic { help: None, ..diagnostic.clone() }.one_line(source);
    format!("{line}\n{body}")
}
