//! The sections with their entries, and foldable ranges.

use hodograph_model::model::names::Symbol;
use hodograph_model::span::Span;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Section;

use crate::Document;
use crate::statements::{partner, span, statements};

/// An entry of the outline.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// its name, or its first words
    pub name: String,
    /// a short description; may be empty
    pub detail: String,
    /// the declared symbol; `None` for sections and unnamed entries
    pub symbol: Option<Symbol>,
    /// the place of the whole entry
    pub span: Span,
    /// the place of its name
    pub place: Span,
    /// its entries
    pub items: Vec<Item>,
}

/// A range of lines that can be folded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fold {
    /// first line, from 0
    pub first: u32,
    /// last line
    pub last: u32,
    /// whether the lines are comments
    pub is_comment: bool,
}

/// The greatest length of the name of an entry, in characters.
const MAX_NAME: usize = 60;

impl Document {
    /// The sections with their entries.
    pub fn outline(&self) -> Vec<Item> {
        let tokens = self.tokens();
        let mut out: Vec<Item> = Vec::new();
        let mut i = 0;
        while i < tokens.len() {
            let opens = tokens.get(i + 1).is_some_and(|next| next.kind == TokenKind::Open('{'));
            let is_section = tokens[i].kind == TokenKind::Name && Section::of_word(&tokens[i].text).is_some();
            if !is_section || !opens {
                i += 1;
                continue;
            }
            let last = partner(tokens, i + 1);
            let items = statements(tokens, i + 2, last).into_iter().map(|range| self.entry(range)).collect();
            out.push(Item {
                name: tokens[i].text.clone(),
                detail: String::new(),
                symbol: None,
                span: tokens[i].span.to(tokens[last].span),
                place: tokens[i].span,
                items,
            });
            i = last.max(i) + 1;
        }
        out
    }

    fn entry(&self, range: std::ops::Range<usize>) -> Item {
        let tokens = self.tokens();
        let whole = span(tokens, range.clone());
        let declared = range.clone().take(2).find_map(|i| {
            let (declared, _) = self.symbols().at(tokens[i].span.start)?;
            (declared.place == Some(tokens[i].span)).then_some((declared, tokens[i].span))
        });
        let short = |text: &str| {
            let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
            match line.char_indices().nth(MAX_NAME) {
                Some((end, _)) => format!("{}..", &line[..end]),
                None => line,
            }
        };
        match declared {
            Some((declared, place)) => Item {
                name: declared.name.clone(),
                detail: declared.symbol.kind().to_owned(),
                symbol: Some(declared.symbol),
                span: whole,
                place,
                items: Vec::new(),
            },
            None => Item {
                name: short(self.text.at(whole)),
                detail: String::new(),
                symbol: None,
                span: whole,
                place: tokens[range.start].span,
                items: Vec::new(),
            },
        }
    }

    /// The foldable ranges: braces and comments with several lines.
    pub fn folds(&self) -> Vec<Fold> {
        let mut out = Vec::new();
        let mut open = Vec::new();
        for token in self.tokens() {
            match token.kind {
                TokenKind::Open(_) => open.push(token.span.start),
                TokenKind::Close(_) => {
                    let first = open.pop().map(|start| self.text.line_of(start));
                    // the line of the closing brace stays visible
                    let last = self.text.line_of(token.span.start).saturating_sub(1);
                    out.extend(first.filter(|first| *first < last).map(|first| Fold {
                        first,
                        last,
                        is_comment: false,
                    }));
                }
                _ => {}
            }
        }
        let is_comment = |line: u32| self.text.at(self.text.line(line)).trim_start().starts_with("//");
        let mut line = 0;
        while line < self.text.lines() {
            let count = (line..self.text.lines()).take_while(|line| is_comment(*line)).count() as u32;
            if count > 1 {
                out.push(Fold { first: line, last: line + count - 1, is_comment: true });
            }
            line += count.max(1);
        }
        out.sort_by_key(|fold| (fold.first, fold.last));
        out
    }
}
