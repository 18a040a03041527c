//! Renders diagnostics as text in the style of rustc.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

use crate::diagnostics::{Diagnostic, Label, Severity, codes};
use crate::source::Source;
use crate::span::Span;

/// At most this number of messages is shown with their lines; the rest is counted.
const MAX_SHOWN: usize = 100;
/// Longer lines are not shown.
const MAX_LINE: usize = 2000;
/// Places further apart than this are not shown together.
const MAX_DISTANCE: usize = 20_000;

/// All messages, each with its place, its line and a caret; without colours. Ends with a newline unless
/// empty.
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
    /// The message with its place, its line and a caret; without colours. An inline model has no text to
    /// show.
    pub fn render(&self, source: &Source) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level.primary_title(clean(&self.message)).id(self.code.0);
        let help = self.help.as_deref().map(|help| Level::HELP.message(clean(help)));
        let renderer = Renderer::plain();
        let (file, span) = source.locate(self.primary.span);
        let primary = file.text().map(|text| within(text, span));
        let (Some(text), Some(primary)) = (file.text(), primary.filter(|place| self.has_line(file, place)))
        else {
            let place = Level::NOTE.message(format!("in {}", self.place(source)));
            let others =
                self.related.iter().filter(|label| file.name() != source.locate(label.span).0.name());
            let notes = others.map(|label| Level::NOTE.message(self.note(label, source)));
            return renderer.render(&[title.element(place).elements(notes).elements(help)]);
        };
        // what is far away is named by its line, what is in another file is shown by itself
        let (here, elsewhere): (Vec<&Label>, Vec<&Label>) =
            self.related.iter().partition(|label| std::ptr::eq(source.locate(label.span).0, file));
        let place_of = |label: &Label| within(text, source.locate(label.span).1);
        let (near, far): (Vec<&Label>, Vec<&Label>) = here.into_iter().partition(|label| {
            let place = place_of(label);
            place.start.abs_diff(primary.start) < MAX_DISTANCE && self.has_line(file, &place)
        });
        let labels: Vec<(Range<usize>, &str, bool)> =
            std::iter::once((primary, self.primary.text.as_str(), true))
                .chain(near.iter().map(|label| (place_of(label), label.text.as_str(), false)))
                .collect();
        let snippet = snippet(file.name(), text, &labels);
        let (others, unseen): (Vec<&Label>, Vec<&Label>) =
            elsewhere.into_iter().partition(|label| source.locate(label.span).0.text().is_some());
        let others = others.into_iter().map(|label| {
            let (file, span) = source.locate(label.span);
            let text = file.text().unwrap_or_default();
            self::snippet(file.name(), text, &[(within(text, span), label.text.as_str(), false)])
        });
        let notes = far.iter().chain(&unseen).map(|label| Level::NOTE.message(self.note(label, source)));
        renderer.render(&[title.element(snippet).elements(others).elements(notes).elements(help)])
    }

    /// A place that is not shown, by its line.
    fn note(&self, label: &Label, source: &Source) -> String {
        let line = source.location(label.span).map_or(0, |at| at.line);
        clean(&format!("{} (line {line})", label.text))
    }

    /// One line: `models/x.mech:14:23: error[E020]: unknown name `zz`; did you mean `z`?`
    pub fn one_line(&self, source: &Source) -> String {
        let name = source.locate(self.primary.span).0.name();
        let place = match source.location(self.primary.span) {
            Some(at) => format!("{name}:{}:{}", at.line, at.column),
            None => name.to_owned(),
        };
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let help = self.help.as_ref().map_or(String::new(), |help| format!("; {help}"));
        format!("{place}: {severity}[{}]: {}{help}", self.code, self.message)
    }

    /// The message as the text of a compile error. For a file: one line with the place, then the line and a
    /// caret. For an inline model, whose tokens the compiler underlines: what is wrong and what to do.
    pub fn compiler_text(&self, source: &Source) -> String {
        let (file, _) = source.locate(self.primary.span);
        if file.text().is_none() && !file.is_inline() {
            return self.one_line(source);
        }
        if file.text().is_some() {
            let line = Diagnostic { help: None, ..self.clone() }.one_line(source);
            let rendered = self.render(source);
            // the first line is said already, and so is the place under it
            let body: Vec<&str> =
                rendered.lines().skip(1).skip_while(|line| line.trim_start().starts_with("-->")).collect();
            return format!("{line}\n{}", body.join("\n"));
        }
        let mut text = format!("[{}] {}", self.code, self.message);
        if !self.primary.text.is_empty() {
            text.push_str(&format!("\n{}", self.primary.text));
        }
        // the compiler underlines one place: the others are named
        for label in &self.related {
            let at = source
                .location(label.span)
                .map_or(String::new(), |at| format!(", line {}, column {}", at.line, at.column));
            let words = format!("`{}`", source.words(label.span));
            let words = if label.text.contains(&words) { String::new() } else { format!(": {words}") };
            text.push_str(&format!("\nnote: {}{words}{at}", label.text));
        }
        if let Some(help) = &self.help {
            text.push_str(&format!("\nhelp: {help}"));
        }
        text
    }

    /// Whether it is said of a text that is too large to be read, which has no place.
    fn is_of_the_whole(&self) -> bool {
        self.code == codes::TOO_LARGE && self.primary.span == Span::default()
    }

    /// The file, and the line and column if there are any.
    fn place(&self, source: &Source) -> String {
        let (file, _) = source.locate(self.primary.span);
        match source.location(self.primary.span).filter(|_| !self.is_of_the_whole()) {
            Some(at) if file.text().is_some_and(|text| !text.is_empty()) => {
                format!("{}:{}:{}", file.name(), at.line, at.column)
            }
            _ => file.name().to_owned(),
        }
    }

    /// Whether the line of a place can be shown.
    fn has_line(&self, source: &Source, place: &Range<usize>) -> bool {
        let Some(text) = source.text().filter(|text| !text.is_empty() && !self.is_of_the_whole()) else {
            return false;
        };
        line_of(text, place).len() <= MAX_LINE
    }
}

/// The lines of a text with these places.
fn snippet<'t>(
    name: &'t str,
    text: &'t str,
    labels: &[(Range<usize>, &str, bool)],
) -> Snippet<'t, annotate_snippets::Annotation<'t>> {
    let (window, first_line) = window(text, labels.iter().map(|(range, ..)| range));
    let annotations = labels.iter().map(|(range, words, primary)| {
        let kind = if *primary { AnnotationKind::Primary } else { AnnotationKind::Context };
        let annotation = kind.span(range.start - window.start..range.end - window.start);
        if words.is_empty() { annotation } else { annotation.label(clean(words)) }
    });
    Snippet::source(&text[window.clone()])
        .path(name)
        .line_start(first_line)
        .fold(true)
        .annotations(annotations)
}

/// The line of a place.
fn line_of(text: &str, place: &Range<usize>) -> Range<usize> {
    let start = text[..place.start].rfind('\n').map_or(0, |n| n + 1);
    let end = text[place.end..].find('\n').map_or(text.len(), |n| place.end + n);
    start..end
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
