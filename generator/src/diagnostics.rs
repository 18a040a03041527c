//! Mistakes in a model: where, what, and what to do about it.

pub mod codes;
pub mod explanations;
mod render;

use std::ops::Range;

pub use codes::Code;
pub use render::render;

/// A place in the source: bytes of a file, or tokens of an inline model (see `syntax`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// first byte (file) or first token (inline)
    pub start: u32,
    /// one past the last
    pub end: u32,
}

impl Span {
    /// The place as a range.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// The smallest place that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// Does it stop the model from being used?
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// yes
    Error,
    /// no, but it is probably not meant
    Warning,
}

/// A place and what is to be said there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    /// where
    pub span: Span,
    /// what, in a few words; may be empty
    pub text: String,
}

/// One mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// its kind, stable from version to version and explained in `docs/errors.md`
    pub code: Code,
    /// error or warning
    pub severity: Severity,
    /// what is wrong, in one line
    pub message: String,
    /// where
    pub primary: Label,
    /// other places that explain it
    pub related: Vec<Label>,
    /// what to do
    pub help: Option<String>,
}

impl Diagnostic {
    /// A mistake of this kind at this place; an error or a warning as its code says.
    pub fn new(code: Code, span: Span, message: impl Into<String>) -> Self {
        Diagnostic {
            code,
            severity: code.severity(),
            message: message.into(),
            primary: Label { span, text: String::new() },
            related: Vec::new(),
            help: None,
        }
    }

    /// Does it leave the meaning of the model open?
    pub fn hides_meaning(&self) -> bool {
        self.severity == Severity::Error && !self.code.is_of_form()
    }

    /// Says a few words at the place itself.
    pub fn label(mut self, text: impl Into<String>) -> Self {
        self.primary.text = text.into();
        self
    }

    /// Points to another place.
    pub fn related(mut self, span: Span, text: impl Into<String>) -> Self {
        self.related.push(Label { span, text: text.into() });
        self
    }

    /// Says what to do.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }
}

impl Diagnostic {
    /// One line: `models/x.mech:14:23: error[E020]: unknown name `zz`; did you mean `z`?`
    pub fn one_line(&self, source: &crate::source::Source) -> String {
        let place = match source.location(self.primary.span) {
            Some(at) => format!("{}:{}:{}", source.name(), at.line, at.column),
            None => source.name().to_owned(),
        };
        let severity = match self.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
        };
        let help = self.help.as_ref().map_or(String::new(), |help| format!("; {help}"));
        format!("{place}: {severity}[{}]: {}{help}", self.code, self.message)
    }
}
