//! Writes the text of a model in one style, without a change of its meaning.
//!
//! ```text
//! items    tokens and comments, each with the line breaks before it
//! entries  what stands between separators: what precedes it, its tokens, what follows on its line
//! line     blanks between tokens, and where a line that is too long is broken
//! layout   sections and entries as lines
//! ```
//!
//! Tokens are neither added nor removed, and no comment is lost: only blanks and line breaks change. So the
//! hash of the equations stays, and derivations stay fresh.

mod entries;
mod items;
mod layout;
mod line;

use std::borrow::Cow;

use crate::diagnostics::{Diagnostic, Severity};
use crate::source::{MAX_TOKENS, Source};
use crate::syntax::lexer;
use crate::syntax::token::{Token, TokenKind};
use crate::syntax::{self};

/// Lines are at most this long, in characters, if they can be broken.
pub const WIDTH: usize = 100;
/// Blanks by which what stands in braces is moved in.
const INDENT: usize = 4;

/// Why a text is left as it is.
#[derive(Clone, Debug)]
pub enum Unformatted {
    /// it cannot be parsed: its mistakes
    Mistakes(Vec<Diagnostic>),
    /// it is no file: the tokens of a macro have no layout
    Inline,
    /// the layout would have changed the meaning, which is a mistake of the formatter
    Changed,
}

/// The text of a model in the one style.
///
/// # Errors
///
/// [`Unformatted`]
pub fn format(source: &Source) -> Result<String, Unformatted> {
    let read = source.tokens().map_err(|error| Unformatted::Mistakes(vec![*error]))?;
    let text = source.text().ok_or(Unformatted::Inline)?;
    let (tokens, mut mistakes) = match source.expansion() {
        // its parts stay as they are
        Some(expansion) => {
            (Cow::Owned(lexer::tokens(text, MAX_TOKENS)), expansion.explained(expansion.syntax.clone()))
        }
        None => {
            let mistakes = syntax::parse(&read).1;
            (read, mistakes)
        }
    };
    mistakes.retain(|mistake| mistake.severity == Severity::Error);
    if !mistakes.is_empty() {
        return Err(Unformatted::Mistakes(mistakes));
    }
    let before = items::items(text, &tokens);
    let formatted = layout::model(&before);
    let again = lexer::tokens(&formatted, MAX_TOKENS);
    let after = items::items(&formatted, &again);
    let same = same_tokens(&tokens, &again) && items::comments(&before).eq(items::comments(&after));
    if same { Ok(formatted) } else { Err(Unformatted::Changed) }
}

/// The text of a model without parts: what a model with parts stands for, and any other as it is.
pub fn plain(source: &Source) -> String {
    if source.expansion().is_none() {
        return source.text().unwrap_or_default().to_owned();
    }
    let mut text = String::new();
    for token in source.tokens().unwrap_or_default().iter() {
        match token.kind {
            TokenKind::Sign(c) | TokenKind::Open(c) | TokenKind::Close(c) => text.push(c),
            TokenKind::InnerDoc => token.text.lines().for_each(|line| text.push_str(&format!("//!{line}\n"))),
            TokenKind::OuterDoc => {
                token.text.lines().for_each(|line| text.push_str(&format!("\n///{line}\n")))
            }
            TokenKind::Name | TokenKind::Number | TokenKind::Bad(_) => text.push_str(&token.text),
        }
        let ends = token.is_sign(';') || token.is_sign(',') || matches!(token.kind, TokenKind::Open('{'));
        text.push(if ends { '\n' } else { ' ' });
    }
    let laid_out = format(&Source::file(source.name(), text.as_str()));
    laid_out.unwrap_or(text)
}

fn same_tokens(before: &[Token], after: &[Token]) -> bool {
    let words = |token: &Token| token.text.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>();
    let same = |(a, b): (&Token, &Token)| a.kind == b.kind && words(a) == words(b);
    before.len() == after.len() && before.iter().zip(after).all(same)
}

#[cfg(test)]
mod tests;
