//! Braces and statements of a text, found from its tokens alone: for incomplete texts, and for sections whose
//! entries have no names.

use hodograph_model::span::Span;
use hodograph_model::syntax::token::{Token, TokenKind};

/// The closing brace of the one at this index; the last token if there is none.
pub fn partner(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0_usize;
    for (i, token) in tokens.iter().enumerate().skip(open) {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return i;
        }
    }
    tokens.len().saturating_sub(1)
}

/// The statements between two indices: each ends at a separator on the level of the braces. Documentation and
/// separators are left out.
pub fn statements(tokens: &[Token], from: usize, to: usize) -> Vec<std::ops::Range<usize>> {
    let (mut out, mut depth, mut start) = (Vec::new(), 0_usize, from);
    for (i, token) in tokens.iter().enumerate().take(to).skip(from) {
        match token.kind {
            TokenKind::Open(_) => depth += 1,
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            TokenKind::Sign(',' | ';') if depth == 0 => {
                out.push(start..i);
                start = i + 1;
            }
            _ => {}
        }
    }
    out.push(start..to.min(tokens.len()));
    let is_doc = |i: &usize| matches!(tokens[*i].kind, TokenKind::OuterDoc | TokenKind::InnerDoc);
    let trimmed = out.into_iter().map(|range| {
        let docs = range.clone().take_while(is_doc).count();
        range.start + docs..range.end
    });
    trimmed.filter(|range| !range.is_empty()).collect()
}

/// The place of a range of tokens.
pub fn span(tokens: &[Token], range: std::ops::Range<usize>) -> Span {
    let (Some(first), Some(last)) = (tokens.get(range.start), tokens.get(range.end - 1)) else {
        return Span::default();
    };
    first.span.to(last.span)
}
