//! Tokens as a line of text, for messages.

use crate::syntax::token::{Token, TokenKind};

/// The tokens in one line, as they are commonly written.
pub fn shown(tokens: &[Token]) -> String {
    let mut text = String::new();
    for token in tokens {
        let sign = match token.kind {
            TokenKind::Sign(c) | TokenKind::Open(c) | TokenKind::Close(c) => c.to_string(),
            TokenKind::OuterDoc | TokenKind::InnerDoc => continue,
            _ => token.text.clone(),
        };
        let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        if is_word(text.chars().last()) && is_word(sign.chars().next()) {
            text.push(' ');
        }
        text.push_str(&sign);
    }
    text
}
