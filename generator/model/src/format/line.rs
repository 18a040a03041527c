//! Blanks between tokens, and where a line that is too long is broken.

use super::items::{Item, Kind};
use crate::syntax::token::TokenKind;

/// Words after which a sign belongs to what follows.
const LEADING_WORDS: [&str; 2] = ["about", "velocity"];

/// A piece of a line that is never broken.
#[derive(Debug)]
struct Piece {
    text: String,
    /// brackets around the place before it, twice, if the line may be broken there; and one within a sum, which is
    /// broken later than the list of which it is an entry
    breakable: Option<usize>,
}

/// Tokens as one line.
pub fn joined(items: &[Item<'_>]) -> String {
    pieces(items).into_iter().map(|piece| piece.text).collect()
}

/// Tokens as lines of at most so many characters, if they can be broken so. The first begins at column
/// `first`, the others at column `others`.
pub fn lines(items: &[Item<'_>], first: usize, others: usize, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    fill(&pieces(items), &mut line, &mut lines, &|line_number| {
        width.saturating_sub(if line_number == 0 { first } else { others })
    });
    lines.push(line);
    lines.iter().map(|line| line.trim().to_owned()).collect()
}

/// Puts pieces on lines: breaks where the fewest brackets are open, and elsewhere only what is still too
/// long.
fn fill(pieces: &[Piece], line: &mut String, lines: &mut Vec<String>, room: &impl Fn(usize) -> usize) {
    let length = |text: &str| text.trim().chars().count();
    let whole: String = pieces.iter().map(|piece| piece.text.as_str()).collect();
    let depth = pieces.iter().skip(1).filter_map(|piece| piece.breakable).min();
    let fits = length(&format!("{line}{whole}")) <= room(lines.len());
    let Some(depth) = depth.filter(|_| !fits) else {
        line.push_str(&whole);
        return;
    };
    let mut start = 0;
    while start < pieces.len() {
        let next = pieces[start + 1..].iter().position(|piece| piece.breakable == Some(depth));
        let end = next.map_or(pieces.len(), |n| start + 1 + n);
        let part = &pieces[start..end];
        let text: String = part.iter().map(|piece| piece.text.as_str()).collect();
        let too_long = length(&format!("{line}{text}")) > room(lines.len());
        if too_long && start > 0 {
            lines.push(std::mem::take(line));
        }
        fill(part, line, lines, room);
        start = end;
    }
}

/// The pieces of a line, each with the blank before it.
fn pieces(items: &[Item<'_>]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut depth = 0_usize;
    let mut before: Option<Before<'_>> = None;
    for item in items {
        let Kind::Token(kind) = item.kind else { continue };
        if let TokenKind::Close(_) = kind {
            depth = depth.saturating_sub(1);
        }
        let leads =
            matches!(kind, TokenKind::Sign('+' | '-')) && before.as_ref().is_none_or(Before::awaits_value);
        let blank = before.as_ref().is_some_and(|before| blank_between(before, kind, leads));
        // a sum is broken before its signs, a list behind its commas
        let behind_comma = before.as_ref().is_some_and(|before| before.kind == TokenKind::Sign(','));
        let in_sum = matches!(kind, TokenKind::Sign('+' | '-')) && !leads;
        let breakable = (behind_comma || in_sum).then_some(2 * depth + usize::from(!behind_comma));
        let text = if blank { format!(" {}", item.text) } else { item.text.to_owned() };
        pieces.push(Piece { text, breakable });
        if let TokenKind::Open(_) = kind {
            depth += 1;
        }
        before = Some(Before { kind, text: item.text, leads });
    }
    pieces
}

/// The token before.
struct Before<'a> {
    kind: TokenKind,
    text: &'a str,
    /// whether it is a sign that belongs to what follows
    leads: bool,
}

impl Before<'_> {
    /// Whether a value follows, so that a sign here belongs to it.
    fn awaits_value(&self) -> bool {
        match self.kind {
            TokenKind::Sign(sign) => sign != '.',
            TokenKind::Open(_) => true,
            TokenKind::Name => LEADING_WORDS.contains(&self.text),
            _ => false,
        }
    }
}

fn blank_between(before: &Before<'_>, kind: TokenKind, leads: bool) -> bool {
    use TokenKind::*;
    match (before.kind, kind) {
        (Open('{'), Close('}')) => false,
        (Open('{'), _) | (_, Close('}')) | (_, Open('{')) => true,
        (Open(_), _) | (_, Close(_)) => false,
        (_, Sign(',' | ';' | ':' | '.' | '*' | '/' | '^')) => false,
        (Sign(',' | ';' | ':' | '='), _) | (_, Sign('=')) => true,
        (Sign('.' | '*' | '/' | '^'), _) => false,
        (Sign('+' | '-'), _) => !before.leads,
        (Name, Sign('+' | '-')) => true,
        (_, Sign('+' | '-')) => !leads,
        (Name | Close(']'), Open('(' | '[')) => false,
        (Name | Number | Close(_) | Bad(_), Name | Number | Open(_) | Bad(_)) => true,
        _ => false,
    }
}
