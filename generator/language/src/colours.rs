//! The kind of each word, for syntax highlighting.

use hodograph_model::model::names::Symbol;
use hodograph_model::span::Span;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Section;
use hodograph_model::words;

use crate::Document;

/// The kind of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Kind {
    Comment,
    Documentation,
    Keyword,
    Number,
    Unit,
    Field,
    Function,
    Member,
    Law,
    Parameter,
    Input,
    Coordinate,
    Speed,
    Definition,
    Frame,
    Point,
    Body,
    Shape,
    Contact,
    Given,
}

/// A word with its kind; it is on a single line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coloured {
    /// its place
    pub span: Span,
    /// its kind
    pub kind: Kind,
    /// whether the word is declared here
    pub declares: bool,
}

impl Document {
    /// The words in the order of their places.
    pub fn colours(&self) -> Vec<Coloured> {
        let tokens = self.tokens();
        let mut units = self.units();
        units.sort();
        let is_unit = |span: Span| {
            let after = units.partition_point(|unit| unit.start <= span.start);
            after.checked_sub(1).is_some_and(|i| span.end <= units[i].end)
        };
        let symbols = self.symbols();
        let mut uses = symbols.uses.iter().peekable();
        let mut places: Vec<(Span, Symbol)> =
            symbols.declared.iter().filter_map(|declared| Some((declared.place?, declared.symbol))).collect();
        places.sort();
        let mut out = Vec::new();
        let mut at = 0;
        for (i, token) in tokens.iter().enumerate() {
            self.comments(at, token.span.start, &mut out);
            at = at.max(token.span.end);
            while uses.next_if(|used| used.place.start < token.span.start).is_some() {}
            let used = uses.peek().filter(|used| used.place == token.span).map(|used| used.symbol);
            let declared = places.binary_search_by_key(&token.span, |(place, _)| *place);
            let kind = match token.kind {
                TokenKind::OuterDoc | TokenKind::InnerDoc => {
                    self.on_lines(token.span, Kind::Documentation, &mut out);
                    continue;
                }
                TokenKind::Number => Some(Kind::Number),
                TokenKind::Name if is_unit(token.span) => Some(Kind::Unit),
                TokenKind::Name => match (used, declared) {
                    (Some(symbol), _) => Some(of_symbol(symbol)),
                    (None, Ok(declared)) => Some(of_symbol(places[declared].1)),
                    (None, Err(_)) => self.word_kind(i),
                },
                _ => None,
            };
            let declares = used.is_none() && declared.is_ok();
            out.extend(kind.map(|kind| Coloured { span: token.span, kind, declares }));
        }
        self.comments(at, self.text.as_str().len() as u32, &mut out);
        out
    }

    fn word_kind(&self, i: usize) -> Option<Kind> {
        let tokens = self.tokens();
        let text = tokens[i].text.as_str();
        if i > 0 && tokens[i - 1].is_sign('.') {
            return Some(Kind::Member);
        }
        let next = tokens.get(i + 1).map(|token| token.kind);
        if Section::of_word(text).is_some() && next == Some(TokenKind::Open('{')) {
            return Some(Kind::Keyword);
        }
        self.word_at(i)?;
        Some(match next {
            Some(TokenKind::Open('(')) => Kind::Function,
            Some(TokenKind::Sign(':')) if words::look(words::LOAD_FORMS, text).is_none() => Kind::Field,
            _ if words::look(words::LAWS, text).is_some() => Kind::Law,
            _ => Kind::Keyword,
        })
    }

    /// The comments between two tokens.
    fn comments(&self, from: u32, to: u32, out: &mut Vec<Coloured>) {
        let mut at = from;
        while at < to {
            let rest = self.text.at(Span { start: at, end: to });
            let Some(start) = rest.find(['/', '*']) else { return };
            let start = at + start as u32;
            let comment = self.text.at(Span { start, end: to });
            let length = match comment.strip_prefix("//") {
                Some(_) => comment.find('\n').unwrap_or(comment.len()),
                None => block(comment),
            };
            let end = start + length as u32;
            self.on_lines(Span { start, end }, Kind::Comment, out);
            at = end.max(at + 1);
        }
    }

    /// A comment, divided into one piece per line.
    fn on_lines(&self, span: Span, kind: Kind, out: &mut Vec<Coloured>) {
        for line in self.text.line_of(span.start)..=self.text.line_of(span.end.max(span.start)) {
            let line = self.text.line(line);
            let piece = Span { start: line.start.max(span.start), end: line.end.min(span.end) };
            if piece.start < piece.end {
                out.push(Coloured { span: piece, kind, declares: false });
            }
        }
    }
}

/// The length of a block comment, including nested ones.
fn block(text: &str) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while let Some(i) = text[at..].find(['/', '*']).map(|i| at + i) {
        let pair = text.get(i..i + 2);
        match pair {
            Some("/*") => (depth, at) = (depth + 1, i + 2),
            Some("*/") if depth <= 1 => return i + 2,
            Some("*/") => (depth, at) = (depth - 1, i + 2),
            _ => at = i + 1,
        }
    }
    text.len()
}

fn of_symbol(symbol: Symbol) -> Kind {
    match symbol {
        Symbol::Parameter(_) => Kind::Parameter,
        Symbol::Input(_) => Kind::Input,
        Symbol::Coordinate(_) => Kind::Coordinate,
        Symbol::Speed(_) => Kind::Speed,
        Symbol::Definition(_) | Symbol::Broken => Kind::Definition,
        Symbol::Frame(0) | Symbol::Point(0) | Symbol::Time | Symbol::Pi => Kind::Given,
        Symbol::Frame(_) => Kind::Frame,
        Symbol::Point(_) => Kind::Point,
        Symbol::Body(_) => Kind::Body,
        Symbol::Shape(_) => Kind::Shape,
        Symbol::Contact(_) => Kind::Contact,
    }
}
