//! A text as tokens and comments, each with the line breaks before it.

use crate::syntax::token::{Token, TokenKind};

/// What an item is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// a token that is no documentation
    Token(TokenKind),
    /// documentation that ends with its line
    DocLine,
    /// documentation between `/*` and `*/`
    DocBlock,
    /// a comment that ends with its line
    CommentLine,
    /// a comment between `/*` and `*/`
    CommentBlock,
}

/// A token or a comment.
#[derive(Clone, Debug)]
pub struct Item<'a> {
    /// what it is
    pub kind: Kind,
    /// as it was written, without blanks at its end
    pub text: &'a str,
    /// number of line breaks between it and the item before
    pub breaks: usize,
}

impl Item<'_> {
    /// Whether it is a comment or documentation.
    pub fn is_remark(&self) -> bool {
        !matches!(self.kind, Kind::Token(_))
    }

    /// Whether its line ends with it.
    pub fn ends_line(&self) -> bool {
        matches!(self.kind, Kind::DocLine | Kind::CommentLine)
    }

    /// Whether it is this kind of token.
    pub fn is(&self, kind: TokenKind) -> bool {
        self.kind == Kind::Token(kind)
    }
}

/// The items of a text, whose tokens these are.
pub fn items<'a>(text: &'a str, tokens: &[Token]) -> Vec<Item<'a>> {
    let mut items = Vec::with_capacity(tokens.len());
    let mut at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut breaks = 0;
    for token in tokens {
        let place = token.span.range();
        // what is read of a sign of mathematical print stands where the sign stands
        if place.start < at {
            continue;
        }
        remarks(&text[at..place.start], &mut breaks, &mut items);
        let written = text[place.clone()].trim_end();
        let kind = match token.kind {
            TokenKind::OuterDoc | TokenKind::InnerDoc if written.starts_with("/*") => Kind::DocBlock,
            TokenKind::OuterDoc | TokenKind::InnerDoc => Kind::DocLine,
            kind => Kind::Token(kind),
        };
        items.push(Item { kind, text: written, breaks });
        (at, breaks) = (place.end, 0);
    }
    remarks(&text[at..], &mut breaks, &mut items);
    items
}

/// The comments between two tokens.
fn remarks<'a>(gap: &'a str, breaks: &mut usize, items: &mut Vec<Item<'a>>) {
    let mut rest = gap;
    while let Some(start) = rest.find('/') {
        *breaks += rest[..start].matches('\n').count();
        rest = &rest[start..];
        let (kind, length) = if rest.starts_with("/*") {
            (Kind::CommentBlock, block(rest))
        } else {
            (Kind::CommentLine, rest.find('\n').unwrap_or(rest.len()))
        };
        items.push(Item { kind, text: rest[..length].trim_end(), breaks: *breaks });
        *breaks = 0;
        rest = &rest[length..];
    }
    *breaks += rest.matches('\n').count();
}

/// Length of a comment between `/*` and `*/`, which nest.
fn block(text: &str) -> usize {
    let bytes = text.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// The comments of a text, without what a change of layout may change in them.
pub fn comments<'i>(items: &'i [Item<'_>]) -> impl Iterator<Item = Vec<&'i str>> {
    let remarks = items.iter().filter(|item| matches!(item.kind, Kind::CommentLine | Kind::CommentBlock));
    remarks.map(|item| item.text.lines().map(str::trim_end).collect())
}
