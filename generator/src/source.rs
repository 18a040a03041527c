//! The text of a model, from a file or from the input of a macro.

use std::borrow::Cow;

use proc_macro2::{Span as RustSpan, TokenStream};

use crate::compiler;
use crate::diagnostics::{Diagnostic, codes};
use crate::reading;
use crate::span::{Location, Span};
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::{inline, lexer};

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
        places: Vec<RustSpan>,
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

    /// Reads a model from a file. What goes wrong is reported by `check`.
    pub fn read(path: &std::path::Path) -> Source {
        let name = path.display().to_string();
        Source::read_as(name, path)
    }

    /// As [`Source::read`], with the name that messages give it.
    pub fn read_as(name: impl Into<String>, path: &std::path::Path) -> Source {
        match reading::bytes(path, MAX_BYTES) {
            Ok(bytes) => Source::bytes(name, bytes),
            Err(error) if error.kind() == std::io::ErrorKind::FileTooLarge => Source::too_large(name.into()),
            Err(error) => {
                let message = format!("the file cannot be read: {error}");
                Source::unreadable(name.into(), message, "check the path")
            }
        }
    }

    /// A model in the input of a macro. `name` is what messages call it.
    pub fn inline(name: impl Into<String>, stream: TokenStream) -> Source {
        let (tokens, places) = inline::tokens(stream);
        Source { name: name.into(), content: Content::Inline { tokens, places } }
    }

    fn unreadable(name: String, message: String, help: &str) -> Source {
        let error = Diagnostic::new(codes::UNREADABLE, Span::default(), message).help(help);
        Source { name, content: Content::Unreadable(Box::new(error)) }
    }

    fn too_large(name: String) -> Source {
        let message = format!("the file is larger than {} MiB", MAX_BYTES >> 20);
        let error = Diagnostic::new(codes::TOO_LARGE, Span::default(), message).help("is it a model?");
        Source { name, content: Content::Unreadable(Box::new(error)) }
    }

    /// What messages call it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it is the input of a macro.
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

    /// The user's tokens at a place of an inline model: the first and the last.
    pub fn rust_spans(&self, span: Span) -> Option<(RustSpan, RustSpan)> {
        let Content::Inline { places, .. } = &self.content else { return None };
        let first = places.get(span.start as usize).or(places.last())?;
        let last = (span.end as usize).checked_sub(1).and_then(|i| places.get(i)).unwrap_or(first);
        Some((*first, *last))
    }

    /// Line and column of the beginning of a place; of an inline model as the compiler tells them.
    pub fn location(&self, span: Span) -> Option<Location> {
        if let Some((first, _)) = self.rust_spans(span) {
            return compiler::location(first);
        }
        let text = self.text()?;
        let start = (span.start as usize).min(text.len());
        let before = text.get(..start)?;
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |tail| tail.chars().count()) + 1;
        Some(Location { line, column })
    }
}
