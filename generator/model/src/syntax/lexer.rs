//! Converts the text of a file to tokens, by those lexical rules of Rust that models need. It never fails:
//! text that is not a token becomes a bad token.

use super::token::{Bad, Token, TokenKind, is_decimal};
use crate::span::Span;
use crate::unicode;

/// The tokens of a text, at most `most` and a few. Positions are bytes.
pub fn tokens(text: &str, most: usize) -> Vec<Token> {
    let mut lexer = Lexer { text, at: 0, tokens: Vec::new() };
    if text.starts_with('\u{feff}') {
        lexer.at = '\u{feff}'.len_utf8();
    }
    while lexer.at < text.len() && lexer.tokens.len() <= most {
        lexer.step();
    }
    lexer.tokens
}

/// Whether a name may begin with this.
pub fn begins_name(c: char) -> bool {
    c == '_' || unicode_ident::is_xid_start(c)
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
    tokens: Vec<Token>,
}

impl<'a> Lexer<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// Length of the longest beginning of the rest, from `skip` on, that consists of such characters.
    fn run(&self, skip: usize, fits: impl Fn(char) -> bool) -> usize {
        self.rest()[skip..].find(|c| !fits(c)).map_or(self.rest().len(), |n| skip + n)
    }

    fn push(&mut self, kind: TokenKind, length: usize, text: String) {
        let span = Span { start: self.at as u32, end: (self.at + length) as u32 };
        self.tokens.push(Token { kind, text, span });
        self.at += length;
    }

    fn step(&mut self) {
        let rest = self.rest();
        let Some(first) = rest.chars().next() else { return };
        match first {
            c if c.is_whitespace() => self.at += self.run(0, char::is_whitespace),
            '/' if rest.starts_with("//") => self.line_comment(),
            '/' if rest.starts_with("/*") => self.block_comment(),
            c if begins_name(c) => self.name(),
            c if c.is_ascii_digit() => self.number(),
            '"' => self.quoted(),
            '(' | '[' | '{' => self.push(TokenKind::Open(first), 1, String::new()),
            ')' | ']' | '}' => self.push(TokenKind::Close(first), 1, String::new()),
            '+' | '-' | '*' | '/' | '^' | '=' | '.' | ',' | ';' | ':' | '<' | '>' | '!' | '%' | '&' | '|'
            | '?' | '@' | '#' | '$' | '~' | '\'' => self.push(TokenKind::Sign(first), 1, String::new()),
            // digits of other scripts, and fractions: one mistake, read as some number
            c if c.is_numeric() && c != '²' && c != '³' => {
                let (start, length) = (self.at, self.run(0, |c| c.is_numeric() || c == '.'));
                self.push(TokenKind::Bad(Bad::Digits), length, rest[..length].to_owned());
                let span = Span { start: start as u32, end: self.at as u32 };
                self.tokens.push(Token { kind: TokenKind::Number, text: "1".to_owned(), span });
            }
            _ => {
                let start = self.at;
                self.push(TokenKind::Bad(Bad::Character), first.len_utf8(), first.to_string());
                self.meant(first, start);
            }
        }
    }

    /// A sign of mathematical print is refused, and then read as what it stands for: it is one mistake.
    fn meant(&mut self, sign: char, start: usize) {
        let kinds: &[(TokenKind, &str)] = match sign {
            '−' | '–' => &[(TokenKind::Sign('-'), "")],
            '×' | '·' | '⋅' => &[(TokenKind::Sign('*'), "")],
            '²' => &[(TokenKind::Sign('^'), ""), (TokenKind::Number, "2")],
            '³' => &[(TokenKind::Sign('^'), ""), (TokenKind::Number, "3")],
            '，' | '、' | '‚' => &[(TokenKind::Sign(','), "")],
            '；' | '\u{37e}' => &[(TokenKind::Sign(';'), "")],
            '：' | '∶' => &[(TokenKind::Sign(':'), "")],
            '＝' => &[(TokenKind::Sign('='), "")],
            _ => &[],
        };
        let span = Span { start: start as u32, end: self.at as u32 };
        for (kind, text) in kinds {
            self.tokens.push(Token { kind: *kind, text: (*text).to_owned(), span });
        }
    }

    fn line_comment(&mut self) {
        let length = self.rest().find('\n').unwrap_or(self.rest().len());
        let line = self.rest()[..length].trim_end_matches('\r');
        if let Some(words) = line.strip_prefix("//!") {
            self.push(TokenKind::InnerDoc, length, words.to_owned());
        } else if let Some(words) = line.strip_prefix("///").filter(|words| !words.starts_with('/')) {
            self.push(TokenKind::OuterDoc, length, words.to_owned());
        } else {
            self.at += length;
        }
    }

    /// Block comments nest, as in Rust; `/** */` and `/*! */` document.
    fn block_comment(&mut self) {
        let rest = self.rest();
        let (mut depth, mut end) = (0_usize, None);
        let bytes = rest.as_bytes();
        let mut i = 0;
        while i + 1 < bytes.len() {
            match &bytes[i..i + 2] {
                b"/*" => (depth, i) = (depth + 1, i + 2),
                b"*/" => {
                    (depth, i) = (depth - 1, i + 2);
                    if depth == 0 {
                        end = Some(i);
                        break;
                    }
                }
                _ => i += 1,
            }
        }
        let Some(end) = end else {
            let span = Span { start: self.at as u32, end: self.at as u32 + 2 };
            let kind = TokenKind::Bad(Bad::OpenComment);
            self.tokens.push(Token { kind, text: "/*".to_owned(), span });
            self.at = self.text.len();
            return;
        };
        let comment = &rest[..end];
        let documents = end > 4 && !comment.starts_with("/***");
        if documents && let Some(inner) = comment.strip_prefix("/*!") {
            self.push(TokenKind::InnerDoc, end, inner[..inner.len() - 2].replace("\r\n", "\n"));
        } else if documents && let Some(inner) = comment.strip_prefix("/**") {
            self.push(TokenKind::OuterDoc, end, inner[..inner.len() - 2].replace("\r\n", "\n"));
        } else {
            self.at += end;
        }
    }

    fn name(&mut self) {
        // Unicode lets the dot of a product continue a name
        let length = self.run(0, |c| c != '·' && (c == '_' || unicode_ident::is_xid_continue(c)));
        let name = &self.rest()[..length];
        if name == "r" && self.rest()[length..].starts_with('#') {
            let length = self.run(length + 1, |c| c == '_' || unicode_ident::is_xid_continue(c));
            self.push(TokenKind::Bad(Bad::RawName), length, self.rest()[..length].to_owned());
        } else {
            self.push(TokenKind::Name, length, unicode::normal(name).into_owned());
        }
    }

    fn number(&mut self) {
        let rest = self.rest();
        // Rust's numbers may hold `_`: they are one token here too, and refused
        let digit = |c: char| c.is_ascii_digit() || c == '_';
        let mut length = self.run(0, digit);
        // `1.5` and `1.` are numbers; `1.x` is a number, a point and a name, as in Rust
        if rest[length..].starts_with('.') && !rest[length + 1..].starts_with(|c| c == '.' || begins_name(c))
        {
            length = self.run(length + 1, digit);
        }
        let exponent = &rest[length..];
        if let Some(digits) = exponent.strip_prefix(['e', 'E']) {
            let sign = usize::from(digits.starts_with(['+', '-']));
            if digits[sign..].starts_with(|c: char| c.is_ascii_digit()) {
                length = self.run(length + 1 + sign, digit);
            }
        }
        let end = self.run(length, |c| c != '·' && (c == '_' || unicode_ident::is_xid_continue(c)));
        let text = rest[..end].to_owned();
        let kind = classify_number(&text);
        self.push(kind, end, text);
    }

    fn quoted(&mut self) {
        let rest = self.rest();
        let mut escaped = false;
        let end = rest[1..].find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends || c == '\n'
        });
        let length = end.map_or(rest.len(), |n| n + 1 + usize::from(rest[n + 1..].starts_with('"')));
        self.push(TokenKind::Bad(Bad::Quoted), length, rest[..length].to_owned());
    }
}

/// What the text of a numeric literal is.
pub fn classify_number(text: &str) -> TokenKind {
    if is_decimal(text) {
        return TokenKind::Number;
    }
    let digits = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let tail = &text[digits..];
    let based = text.starts_with("0x") || text.starts_with("0b") || text.starts_with("0o");
    if tail.contains('_') || based || tail.starts_with(['e', 'E']) || tail.is_empty() {
        TokenKind::Bad(Bad::Number)
    } else {
        TokenKind::Bad(Bad::NumberThenName)
    }
}
