//! The text of a model: characters of a file, or tokens that a compiler has read.

use std::borrow::Cow;
use std::sync::Arc;

use crate::diagnostics::{Diagnostic, codes};
use crate::parts::{self, Expansion, Files, Imported, NoFiles};
use crate::span::{Location, Span};
use crate::syntax::lexer;
use crate::syntax::token::{Token, TokenKind};

/// A file has at most this many bytes: a model of ten thousand parameters has a tenth of it.
pub const MAX_BYTES: usize = 4 << 20;
/// A model has at most this many tokens.
pub const MAX_TOKENS: usize = 500_000;

/// The text of a model.
#[derive(Clone, Debug)]
pub struct Source {
    name: String,
    content: Content,
    parts: Option<Arc<Parts>>,
}

/// What a model with parts stands for.
#[derive(Clone, Debug)]
struct Parts {
    expansion: Expansion,
    /// the files that it imports
    imported: Vec<Source>,
}

#[derive(Clone, Debug)]
enum Content {
    File(String),
    /// not read: why
    Unreadable(Box<Diagnostic>),
    Inline {
        tokens: Vec<Token>,
        locations: Vec<Option<Location>>,
    },
}

/// Whether a carriage return ends a line, without a line feed after it.
fn ends_lines_with_returns(text: &str) -> bool {
    let mut parts = text.split('\r');
    // what is before the first belongs to none
    parts.next();
    let mut rest = parts.skip_while(|part| part.is_empty() || part.starts_with('\n'));
    rest.any(|part| !part.is_empty() && !part.starts_with('\n'))
}

impl Source {
    /// A text of its own, or what its parts expand to.
    fn new(name: String, content: Content) -> Source {
        Source { name, content, parts: None }.importing(&NoFiles)
    }

    /// The same model with the files that it imports: a model that imports any cannot be read without.
    pub fn importing(mut self, files: &dyn Files) -> Source {
        self.parts = None;
        let may_have_parts = match &self.content {
            Content::File(text) => parts::WORDS.iter().any(|word| text.contains(word)),
            Content::Inline { .. } => true,
            Content::Unreadable(_) => false,
        };
        let expansion = match self.tokens() {
            Ok(tokens) if may_have_parts => parts::expand(&tokens, files, MAX_TOKENS),
            _ => None,
        };
        self.parts = expansion.map(|expansion| {
            // an imported file is a text to quote from
            let source = |file: &Imported| Source {
                name: file.name.clone(),
                content: Content::File(file.text.clone()),
                parts: None,
            };
            let imported = expansion.files.iter().map(source).collect();
            Arc::new(Parts { expansion, imported })
        });
        self
    }

    /// What its parts expand to, if it has any.
    pub fn expansion(&self) -> Option<&Expansion> {
        self.parts.as_ref().map(|parts| &parts.expansion)
    }

    /// Whether it holds parts for other models, and no mechanism.
    pub fn is_library(&self) -> bool {
        self.expansion().is_some_and(|expansion| expansion.is_library)
    }

    /// The names of the files that it imports, directly or through others.
    pub fn imported(&self) -> impl Iterator<Item = &Source> {
        self.parts.iter().flat_map(|parts| &parts.imported)
    }

    /// The text in which a place stands, and where in it: the model itself or a file that it imports.
    pub fn locate(&self, span: Span) -> (&Source, Span) {
        let (file, span) = self.place(span);
        let imported = file.checked_sub(1).and_then(|file| self.imported().nth(file));
        (imported.unwrap_or(self), span)
    }

    /// The same, with the number of the text: 0 is the model itself, others count what it imports from 1. What
    /// is between two words stands behind the first.
    pub fn place(&self, span: Span) -> (usize, Span) {
        let Some(parts) = &self.parts else { return (0, span) };
        let places = &parts.expansion.places;
        let between = span.range().is_empty() && span.start > 0;
        let words = if between { Span { start: span.start - 1, ..span } } else { span };
        let Some(place) = places.find(words) else { return (0, Span::default()) };
        let span = if between { Span { start: place.span.end, ..place.span } } else { place.span };
        (place.file as usize, span)
    }

    /// Where in the model itself a place belongs to: there, or the use or import through which it came.
    pub fn in_itself(&self, span: Span) -> Span {
        let Some(parts) = &self.parts else { return span };
        let places = &parts.expansion.places;
        let Some(place) = places.find(span) else { return Span::default() };
        let mut around = std::iter::once(place).chain(places.sites(place).into_iter().map(|site| site.place));
        around.find(|place| place.file == 0).map_or(Span::default(), |place| place.span)
    }

    /// A model in a file. `name` is what messages call it: its path, as the user knows it.
    pub fn file(name: impl Into<String>, text: impl Into<String>) -> Source {
        let (name, text) = (name.into(), text.into());
        if ends_lines_with_returns(&text) {
            let message =
                "the lines of the file end with carriage returns alone, so that all of it is one line"
                    .to_owned();
            return Source::unreadable(
                name,
                message,
                "save the file with line feeds, as editors and `tr '\\r' '\\n'` do",
            );
        }
        Source::new(name, Content::File(text))
    }

    /// A model in a file, from its bytes. Bytes that are no UTF-8 are reported by `check`.
    pub fn bytes(name: impl Into<String>, bytes: Vec<u8>) -> Source {
        let name = name.into();
        match String::from_utf8(bytes) {
            Ok(text) => Source::file(name, text),
            Err(error) => {
                let valid = error.utf8_error().valid_up_to();
                let line = error.as_bytes()[..valid].iter().filter(|b| **b == b'\n').count() + 1;
                let message =
                    format!("the file is not UTF-8 text: byte {valid}, in line {line}, does not fit");
                Source::unreadable(name, message, "save the file as UTF-8")
            }
        }
    }

    /// A model among the tokens of a Rust source, each with its line and column where they are known. `name`
    /// is what messages call it.
    pub fn inline(name: impl Into<String>, tokens: Vec<Token>, locations: Vec<Option<Location>>) -> Source {
        Source::new(name.into(), Content::Inline { tokens, locations })
    }

    /// A model that could not be read. `check` reports why and what to do.
    pub fn unreadable(name: String, message: String, help: &str) -> Source {
        let error = Diagnostic::new(codes::UNREADABLE, Span::default(), message).help(help);
        Source::new(name, Content::Unreadable(Box::new(error)))
    }

    /// A model in a file that is larger than [`MAX_BYTES`]; `check` reports it.
    pub fn too_large(name: String) -> Source {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let error = Diagnostic::new(codes::TOO_LARGE, Span::default(), message).help("is it a model?");
        Source::new(name, Content::Unreadable(Box::new(error)))
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it stands in a Rust source.
    pub fn is_inline(&self) -> bool {
        matches!(self.content, Content::Inline { .. })
    }

    /// The text of a file, as it was written.
    pub fn text(&self) -> Option<&str> {
        match &self.content {
            Content::File(text) => Some(text),
            _ => None,
        }
    }

    /// Whether the model names the time: then its equations may depend on it by itself.
    pub fn names_time(&self) -> bool {
        self.tokens().is_ok_and(|tokens| tokens.iter().any(|token| token.text == "time"))
    }

    /// The tokens of the model without parts.
    pub fn tokens(&self) -> Result<Cow<'_, [Token]>, Box<Diagnostic>> {
        if let Some(parts) = &self.parts {
            return Ok(Cow::Borrowed(&parts.expansion.tokens));
        }
        let too_large = |message: String| {
            Box::new(Diagnostic::new(codes::TOO_LARGE, Span::default(), message).help("is it a model?"))
        };
        let tokens = match &self.content {
            Content::Unreadable(error) => return Err(error.clone()),
            Content::File(text) if text.len() > MAX_BYTES => {
                return Err(too_large(format!("the file is larger than {} MiB", MAX_BYTES >> 20)));
            }
            Content::File(text) => Cow::Owned(lexer::tokens(text, MAX_TOKENS)),
            Content::Inline { tokens, .. } => Cow::Borrowed(tokens.as_slice()),
        };
        if tokens.len() > MAX_TOKENS {
            return Err(too_large(format!("the model has more than {MAX_TOKENS} words and signs")));
        }
        Ok(tokens)
    }

    /// The words of an inline model at a place, as they were written but for blanks; long ones end in `..`.
    pub fn words(&self, span: Span) -> String {
        let (source, span) = self.locate(span);
        if !source.is_inline() {
            let text = source.text().and_then(|text| text.get(span.range())).unwrap_or_default();
            let short: String =
                text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(40).collect();
            return short;
        }
        let Content::Inline { tokens, .. } = &self.content else { return String::new() };
        let mut words = String::new();
        for token in tokens.get(span.range()).unwrap_or_default() {
            let sign = match token.kind {
                TokenKind::Sign(c) | TokenKind::Open(c) | TokenKind::Close(c) => c.to_string(),
                _ => token.text.clone(),
            };
            let apart = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
            if apart(words.chars().last()) && apart(sign.chars().next()) {
                words.push(' ');
            }
            if words.chars().count() > 40 {
                words.push_str("..");
                break;
            }
            words.push_str(&sign);
        }
        words
    }

    /// Line and column of the beginning of a place; of an inline model as the compiler tells them.
    pub fn location(&self, span: Span) -> Option<Location> {
        let (source, span) = self.locate(span);
        source.location_here(span)
    }

    /// The same of a place in this text itself, as [`Source::locate`] gives it.
    pub fn location_here(&self, span: Span) -> Option<Location> {
        if let Content::Inline { locations, .. } = &self.content {
            return *locations.get(span.start as usize).or(locations.last())?;
        }
        let text = self.text()?;
        let start = (span.start as usize).min(text.len());
        let before = text.get(..start)?;
        let before = before.strip_prefix('\u{feff}').unwrap_or(before);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        Some(Location { line, column })
    }
}
