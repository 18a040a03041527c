//! The tokens of a model's text, from a file or from the input of a macro.

use crate::span::Span;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// a name or a word of the grammar
    Name,
    /// a decimal number
    Number,
    /// a single sign such as `+` or `;`
    Sign(char),
    /// `(`, `[` or `{`
    Open(char),
    /// `)`, `]` or `}`
    Close(char),
    /// a line of `///` documentation, about what follows
    OuterDoc,
    /// a line of `//!` documentation, about the whole
    InnerDoc,
    /// text that cannot be part of a model
    Bad(Bad),
}

/// Why a text cannot be part of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bad {
    /// a character that means nothing here
    Character,
    /// digits that are not 0 to 9
    Digits,
    /// a string or character literal
    Quoted,
    /// a number that is not plainly decimal
    Number,
    /// a number that runs into a name, such as `3m`
    NumberThenName,
    /// a raw identifier
    RawName,
    /// `/*` without `*/`
    OpenComment,
}

/// A token and its place.
#[derive(Clone, Debug)]
pub struct Token {
    /// what it is
    pub kind: TokenKind,
    /// the text of a name or number, the words of a documentation line, the offending text of a bad token;
    /// else empty
    pub text: String,
    /// where it stands
    pub span: Span,
}

impl Token {
    /// Whether it is this sign.
    pub fn is_sign(&self, sign: char) -> bool {
        self.kind == TokenKind::Sign(sign)
    }

    /// Whether it is this word.
    pub fn is_word(&self, word: &str) -> bool {
        self.kind == TokenKind::Name && self.text == word
    }

    /// Its name in messages.
    pub fn describe(&self) -> String {
        match self.kind {
            TokenKind::Name | TokenKind::Number | TokenKind::Bad(_) => format!("`{}`", self.text),
            TokenKind::Sign(c) | TokenKind::Open(c) | TokenKind::Close(c) => format!("`{c}`"),
            TokenKind::OuterDoc | TokenKind::InnerDoc => "a documentation comment".to_owned(),
        }
    }
}

/// Whether the text is a plain decimal: digits, optionally a point and digits, optionally an exponent.
pub fn is_decimal(text: &str) -> bool {
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let mantissa_fits = match mantissa.split_once('.') {
        Some((whole, fraction)) => digits(whole) && (fraction.is_empty() || digits(fraction)),
        None => digits(mantissa),
    };
    mantissa_fits && exponent.is_none_or(|e| digits(e.strip_prefix(['+', '-']).unwrap_or(e)))
}
