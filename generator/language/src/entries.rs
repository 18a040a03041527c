//! Entries of a text by its tokens alone: where one more goes, and all of one that is there.

use hodograph_model::span::Span;
use hodograph_model::syntax::token::{Token, TokenKind};

use crate::statements::partner;
use crate::text::{Edit, Text};

/// A text with its tokens.
#[derive(Clone, Copy)]
pub struct Written<'a> {
    /// the text
    pub text: &'a Text,
    /// its tokens
    pub tokens: &'a [Token],
}

impl Written<'_> {
    /// One more entry in the braces or brackets that follow a place.
    pub fn entry_in_braces(&self, after: u32, text: &str) -> Option<Edit> {
        let tokens = self.tokens;
        let from = tokens.partition_point(|token| token.span.start < after);
        let open = (from..tokens.len().min(from + 12))
            .find(|i| matches!(tokens[*i].kind, TokenKind::Open('{' | '(')))?;
        let close = partner(tokens, open);
        let last = tokens[close - 1].clone();
        let separate = !matches!(last.kind, TokenKind::Open('{') | TokenKind::Sign(',' | ';'));
        // behind a comment the entry would be part of it
        let at = Span { start: last.span.end, end: last.span.end };
        let several =
            self.text.line_of(tokens[open].span.start) < self.text.line_of(tokens[close].span.start);
        let lead = match (separate, several) {
            (true, false) => ", ".to_owned(),
            (false, false) => " ".to_owned(),
            (separate, true) => {
                let line = self.text.line(self.text.line_of(tokens[close].span.start));
                let indent: String = self.text.at(line).chars().take_while(|c| *c == ' ').collect();
                format!("{}\n{indent}    ", if separate { "," } else { "" })
            }
        };
        let tail = match last.kind {
            TokenKind::Open(_) if !several => " ",
            _ if several => ",",
            _ => "",
        };
        Some(Edit { span: at, text: format!("{lead}{text}{tail}") })
    }

    /// All of a declaration, with the separator behind it and the documentation before it.
    pub fn declaration(&self, name: Span) -> Option<Span> {
        let tokens = self.tokens;
        let at = tokens.iter().position(|token| token.span == name)?;
        let is_before =
            |i: &usize| matches!(tokens[*i].kind, TokenKind::OuterDoc) || tokens[*i].is_word("fixed");
        let first = (0..at).rev().take_while(is_before).last().unwrap_or(at);
        let mut depth = 0_usize;
        let mut last = at;
        for (i, token) in tokens.iter().enumerate().skip(at) {
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) if depth == 0 => break,
                TokenKind::Close(_) => depth -= 1,
                _ => {}
            }
            last = i;
            if depth == 0 && matches!(token.kind, TokenKind::Sign(',' | ';')) {
                break;
            }
        }
        let mut span = tokens[first].span.to(tokens[last].span);
        let after = self.text.at(Span { start: span.end, end: self.text.as_str().len() as u32 });
        let line = self.text.line(self.text.line_of(span.start));
        let alone = self.text.at(Span { start: line.start, end: span.start }).trim().is_empty();
        let blanks = after.len() - after.trim_start_matches([' ', '\t']).len();
        let rest = &after[blanks..];
        if alone && (rest.starts_with('\n') || rest.starts_with("\r\n")) {
            let feed = if rest.starts_with('\n') { 1 } else { 2 };
            span = Span { start: line.start, end: span.end + (blanks + feed) as u32 };
        } else {
            span.end += blanks as u32;
        }
        Some(span)
    }
}
