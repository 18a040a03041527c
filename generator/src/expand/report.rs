//! Converts mistakes to calls of `compile_error!`.

use super::tokens::Inline;
use hodograph_model::diagnostics::{Diagnostic, Severity};
use hodograph_model::source::Source;
use proc_macro2::{Delimiter, Group, Ident, Literal, Punct, Spacing, Span, TokenStream, TokenTree};

/// A `compile_error!` that underlines from the first to the last token.
pub fn error(first: Span, last: Span, message: &str) -> TokenStream {
    let mut text = Literal::string(message);
    text.set_span(last);
    let mut group = Group::new(Delimiter::Brace, TokenTree::Literal(text).into());
    group.set_span(last);
    let mut bang = Punct::new('!', Spacing::Alone);
    bang.set_span(first);
    [TokenTree::Ident(Ident::new("compile_error", first)), TokenTree::Punct(bang), TokenTree::Group(group)]
        .into_iter()
        .collect()
}

/// The errors of a model file in one message, at the path in the invocation.
pub fn of_file(source: &Source, diagnostics: &[Diagnostic], at: Span) -> TokenStream {
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
    let texts: Vec<String> = errors.map(|diagnostic| diagnostic.compiler_text(source)).collect();
    error(at, at, &texts.join("\n\n"))
}

/// The errors of an inline model, each at the user's own tokens.
pub fn of_inline(model: &Inline, diagnostics: &[Diagnostic]) -> TokenStream {
    let errors = diagnostics.iter().filter(|diagnostic| diagnostic.severity == Severity::Error);
    errors
        .map(|diagnostic| {
            let call = (Span::call_site(), Span::call_site());
            let (first, last) = model.rust_spans(diagnostic.primary.span).unwrap_or(call);
            error(first, last, &diagnostic.compiler_text(&model.source))
        })
        .collect()
}
