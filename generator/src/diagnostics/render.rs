//! Messages as text, in the manner of rustc.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use super::{Diagnostic, Severity, Span};
use crate::source::Source;

/// So many messages are shown with their lines; the rest is counted.
const MAX_SHOWN: usize = 100;

/// All messages, each with its place, its line and a caret; without colours. Ends with a newline unless empty.
pub fn render(diagnostics: &[Diagnostic], source: &Source) -> String {
    let mut out = String::new();
    for diagnostic in diagnostics.iter().take(MAX_SHOWN) {
        out.push_str(&diagnostic.render(source));
        out.push_str("\n\n");
    }
    if diagnostics.len() > MAX_SHOWN {
        out.push_str(&format!("and {} more\n\n", diagnostics.len() - MAX_SHOWN));
    }
    let counts = [Severity::Error, Severity::Warning]
        .map(|severity| diagnostics.iter().filter(|d| d.severity == severity).count());
    let plural = |n: usize, word: &str| format!("{n} {word}{}", if n == 1 { "" } else { "s" });
    match counts {
        [0, 0] => {}
        [errors, 0] => out.push_str(&format!("{}: {}\n", source.name(), plural(errors, "error"))),
        [0, warnings] => out.push_str(&format!("{}: {}\n", source.name(), plural(warnings, "warning"))),
        [errors, warnings] => {
            out.push_str(&format!(
                "{}: {}, {}\n",
                source.name(),
                plural(errors, "error"),
                plural(warnings, "warning")
            ));
        }
    }
    out
}

impl Diagnostic {
    /// The message with its place, its line and a caret; without colours. An inline model has no text to show.
    pub fn render(&self, source: &Source) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(clean(&self.message)).id(self.code.0);
        let help = self.help.as_deref().map(|help| Level::HELP.message(clean(help)));
        let renderer = Renderer::plain();
        let Some(text) = source.text().filter(|text| !text.is_empty()) else {
            let place = Level::NOTE.message(format!("in {}", source.name()));
            let group = title.element(place).elements(help);
            return renderer.render(&[group]);
        };
        let labels: Vec<(Range<usize>, &str, bool)> = std::iter::once((&self.primary, true))
            .chain(self.related.iter().map(|label| (label, false)))
            .map(|(label, primary)| (within(text, label.span), label.text.as_str(), primary))
            .collect();
        let (window, first_line) = window(text, labels.iter().map(|(range, ..)| range));
        let annotations = labels.iter().map(|(range, words, primary)| {
            let kind = if *primary { AnnotationKind::Primary } else { AnnotationKind::Context };
            let annotation = kind.span(range.start - window.start..range.end - window.start);
            if words.is_empty() { annotation } else { annotation.label(clean(words)) }
        });
        let snippet = Snippet::source(&text[window.clone()])
            .path(source.name())
            .line_start(first_line)
            .fold(true)
            .annotations(annotations);
        renderer.render(&[title.element(snippet).elements(help)])
    }
}

/// A place as a range of characters of the text.
fn within(text: &str, span: Span) -> Range<usize> {
    let mut start = (span.start as usize).min(text.len());
    while !text.is_char_boundary(start) {
        start -= 1;
    }
    let mut end = (span.end as usize).clamp(start, text.len());
    while !text.is_char_boundary(end) {
        end += 1;
    }
    // a caret needs a place on one line; only the first line of a longer place is underlined
    let line_end = text[start..end].find(['\n', '\r']).map_or(end, |n| start + n);
    start..line_end.max(start)
}

/// The lines that hold all places, and the number of the first.
fn window<'r>(text: &str, places: impl Iterator<Item = &'r Range<usize>>) -> (Range<usize>, usize) {
    let (start, end) = places.fold((text.len(), 0), |(s, e), r| (s.min(r.start), e.max(r.end)));
    let start = text[..start].rfind('\n').map_or(0, |n| n + 1);
    let end = text[end..].find('\n').map_or(text.len(), |n| end + n);
    (start..end, text[..start].matches('\n').count() + 1)
}

/// Messages quote the user's text: nothing in it may disturb the layout.
fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
