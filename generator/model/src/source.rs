//! The text of a model: characters of a file, or tokens that a compiler has read.

use std::borrow::Cow;

use crate::diagnostics::{Diagnostic, codes};
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
        Source { name, content: Content::File(text) }
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

    /// A model among the tokens of a Rust source, each with its line and column where they are known. `name` is
    /// what messages call it.
    pub fn inline(name: impl Into<String>, tokens: Vec<Token>, locations: Vec<Option<Location>>) -> Source {
        Source { name: name.into(), content: Content::Inline { tokens, locations } }
    }

    /// A model that could not be read. `check` reports why and what to do.
    pub fn unreadable(name: String, message: String, help: &str) -> Source {
        let error = Diagnostic::new(codes::UNREADABLE, Span::default(), message).help(help);
        Source { name, content: Content::Unreadable(Box::new(error)) }
    }

    /// A model in a file that is larger than [`MAX_BYTES`]; `check` reports it.
    pub fn too_large(name: String) -> Source {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let error = Diagnostic::new(codes::TOO_LARGE, Span::default(), message).help("is it a model?");
        Source { name, content: Content::Unreadable(Box::new(error)) }
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it stands in a Rust source.
    pub fn is_inline(&self) -> bool {
        matches!(self.content, Content::Inline { .. })
    }

    /// The text of a file.
    pub fn text(&self) -> Option<&str> {
        match &self.content {
            Content::File(text) => Some(text),
            _ => None,
        }
    }

    /// Its tokens.
    pub fn tokens(&self) -> Result<Cow<'_, [Token]>, Box<Diagnostic>> {
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
        if let Content::Inline { locations, .. } = &self.content {
            return *locations.get(span.start as usize).or(locations.last())?;
        }
        let text = self.text()?;
        let start = (span.start as usize).min(text.len());
        let before = text.get(..start)?;
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        Some(Location { line, column })
    }
}
