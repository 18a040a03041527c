//! Gives every bracket a partner, so that the rest of an unfinished text can be read. What is wrong with its
//! brackets is said by [`parse`](super::parse), which reads no further; this is for editors, which need the
//! names of the rest.

use super::token::{Token, TokenKind};
use super::tree::Section;
use crate::span::Span;

fn partner(open: char) -> char {
    match open {
        '(' => ')',
        '[' => ']',
        _ => '}',
    }
}

/// The tokens with the brackets that are missing and without those that are too many.
pub fn balanced(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::with_capacity(tokens.len() + 4);
    let mut open: Vec<char> = Vec::new();
    let close = |out: &mut Vec<Token>, open: char| {
        let at = out.last().map_or(0, |token| token.span.end);
        let kind = TokenKind::Close(partner(open));
        out.push(Token { kind, text: String::new(), span: Span { start: at, end: at } });
    };
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(bracket) => open.push(bracket),
            // an expression ends with its statement
            TokenKind::Sign(';') => {
                while let Some(bracket) = open.pop_if(|bracket| *bracket != '{') {
                    close(&mut out, bracket);
                }
            }
            TokenKind::Close(bracket) => {
                if bracket == '}' && open.contains(&'{') {
                    while let Some(inner) = open.pop_if(|inner| *inner != '{') {
                        close(&mut out, inner);
                    }
                }
                if open.pop_if(|last| partner(*last) == bracket).is_none() {
                    continue;
                }
            }
            // a section stands in no other one
            TokenKind::Name if !open.is_empty() && opens_section(tokens, i) => {
                while let Some(bracket) = open.pop() {
                    close(&mut out, bracket);
                }
            }
            _ => {}
        }
        out.push(token.clone());
    }
    while let Some(bracket) = open.pop() {
        close(&mut out, bracket);
    }
    out
}

/// Whether a section begins here.
fn opens_section(tokens: &[Token], at: usize) -> bool {
    let brace = tokens.get(at + 1).is_some_and(|next| next.kind == TokenKind::Open('{'));
    brace && Section::of_word(&tokens[at].text).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::syntax::{lexer, parse};

    fn names(text: &str) -> Vec<String> {
        let (tree, mistakes) = parse(&balanced(&lexer::tokens(text, 1000)));
        assert!(mistakes.iter().all(|mistake| mistake.code != crate::diagnostics::codes::UNBALANCED));
        let points = tree.points.into_iter().map(|point| point.name.text);
        points.chain(tree.bodies.into_iter().map(|body| body.name.text)).collect()
    }

    #[test]
    fn what_follows_an_open_bracket_is_read() {
        let text = "mechanism A; points { P = O + (l; Q = O; } bodies { B { mass: m } }";
        assert_eq!(names(text), ["P", "Q", "B"]);
        assert_eq!(names("mechanism A; points { P = O; Q = O; bodies { B { mass: m } }"), ["P", "Q", "B"]);
        assert_eq!(names("mechanism A; points { P = O); Q = O; } } bodies { B { mass: m"), ["P", "Q", "B"]);
        assert_eq!(names("mechanism A; points { P = dot([O; Q = O; }"), ["P", "Q"]);
    }

    #[test]
    fn a_balanced_text_stays() {
        let text = "mechanism A; points { P = O + (l)*N.x; } loads { spring P to O: { stiffness: [k] }; }";
        let tokens = lexer::tokens(text, 1000);
        let kinds = |tokens: &[Token]| tokens.iter().map(|token| token.kind).collect::<Vec<_>>();
        assert_eq!(kinds(&balanced(&tokens)), kinds(&tokens));
    }
}
