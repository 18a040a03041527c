//! Diagnostics: mistakes in a model, each with place, cause and cure.

pub mod codes;

pub use codes::Code;

use crate::span::Span;

/// Whether a mistake prevents the use of the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// it does
    Error,
    /// it does not, but what the model says is probably not meant
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

/// A change of the text that may cure a mistake.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// where
    pub place: Place,
    /// what to write there
    pub text: String,
}

/// Where a fix writes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// in place of what stands here
    Replace(Span),
    /// at the end of the braces or brackets that follow what stands here, as one more field
    IntoBraces(Span),
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
    /// changes that may cure it, each by itself, the likeliest first
    pub fixes: Vec<Fix>,
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
            fixes: Vec::new(),
        }
    }

    /// Whether it leaves the meaning of the model open.
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

    /// Asks whether another word is meant, which can be put in place of what is wrong.
    pub fn did_you_mean(self, word: &str) -> Self {
        let place = Place::Replace(self.primary.span);
        self.help(format!("did you mean `{word}`?")).fix(place, word)
    }

    /// Offers a change that may cure it.
    pub fn fix(mut self, place: Place, text: impl Into<String>) -> Self {
        self.fixes.push(Fix { place, text: text.into() });
        self
    }

    /// Says what to do.
    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }
}
