//! Describes the word at a place.

use hodograph_model::dimension::Dimension;
use hodograph_model::model::mechanism::{Mechanism, Place, PointId, Variable};
use hodograph_model::model::names::Symbol;
use hodograph_model::model::symbols::{Declared, Value};
use hodograph_model::span::Span;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;
use hodograph_model::syntax::units;
use hodograph_model::words::{self, Word};

use crate::Document;

/// The description of a word.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hover {
    /// the word
    pub span: Span,
    /// the text as Markdown
    pub text: String,
}

impl Document {
    /// The description of the word at a place.
    pub fn hover(&self, offset: u32) -> Option<Hover> {
        let joins = |token: &&Token| matches!(token.kind, TokenKind::Sign('+' | '-' | '*' | '/' | '^'));
        let next = self.tokens().partition_point(|token| token.span.start < offset);
        let sign = self.tokens().get(next).filter(|token| token.span.start == offset).filter(joins);
        if let Some(hover) = sign.and_then(|sign| self.hover_of_operation(sign.span)) {
            return Some(hover);
        }
        if let Some((declared, span)) = self.symbols().at(offset) {
            return Some(Hover { span, text: self.describe(declared) });
        }
        let (i, token) = self.token_at(offset)?;
        if token.kind != TokenKind::Name {
            return None;
        }
        let text = if self.is_unit(token.span) {
            let unit = units::of_symbol(&token.text)?;
            let size = if unit.is_si() { String::new() } else { format!(" = {} SI", number(unit.factor())) };
            format!("unit `{}`{size}: {}", token.text, in_words(Some(unit.dimension)))
        } else {
            let word = self.word_at(i)?;
            format!("```hodograph\n{}\n```\n{}", word.form, word.meaning)
        };
        Some(Hover { span: token.span, text })
    }

    /// What the operation at a sign gives, and of what: why the unit of a whole is as it is.
    fn hover_of_operation(&self, sign: Span) -> Option<Hover> {
        let values = &self.symbols().values;
        let holds = |outer: Span, inner: Span| outer.start <= inner.start && inner.end <= outer.end;
        let whole = values.iter().filter(|value| holds(value.place, sign));
        let whole = whole.min_by_key(|value| value.place.range().len())?;
        let told = |value: &Value| {
            let what = if value.is_vector { "a vector, " } else { "" };
            format!("`{}`: {what}{}", self.text.at(value.place), in_words(value.dimension))
        };
        let mut lines = vec![told(whole)];
        let within =
            values.iter().filter(|value| value.place != whole.place && holds(whole.place, value.place));
        let mut end = 0;
        // the greater come before those within
        for value in within {
            if value.place.start >= end {
                end = value.place.end;
                lines.push(format!("- {}", told(value)));
            }
        }
        lines.dedup();
        Some(Hover { span: whole.place, text: lines.join("\n") })
    }

    /// The word of the language at a token.
    pub(crate) fn word_at(&self, i: usize) -> Option<&'static Word> {
        let tokens = self.tokens();
        let text = tokens[i].text.as_str();
        let next = |kind| tokens.get(i + 1).is_some_and(|token| token.kind == kind);
        let after = |sign| i > 0 && tokens[i - 1].is_sign(sign);
        if after('.') {
            return words::look(words::MEMBERS, text);
        }
        if next(TokenKind::Open('(')) {
            let functions = words::look(words::FUNCTIONS, text);
            return functions.or_else(|| words::look(words::START_FUNCTIONS, text));
        }
        if next(TokenKind::Open('{')) && Section::of_word(text).is_some() {
            return words::look(words::SECTIONS, text);
        }
        if next(TokenKind::Sign(':'))
            && let Some(field) = words::look(words::FIELDS, text)
        {
            return Some(field);
        }
        if after(':')
            && let Some(law) = words::look(words::LAWS, text)
        {
            return Some(law);
        }
        words::look(words::LOAD_FORMS, text).or_else(|| words::look(words::WORDS, text))
    }

    fn describe(&self, declared: &Declared) -> String {
        let mut lines = Vec::new();
        let statement = self.statement_of(declared);
        let head = if statement.is_empty() { declared.name.clone() } else { statement };
        lines.push(format!("```hodograph\n{head}\n```"));
        let kind = declared.symbol.kind();
        lines.push(if has_dimension(declared.symbol) {
            let vector = if declared.is_vector { ", a vector" } else { "" };
            format!("{kind}{vector}: {}", in_words(declared.dimension))
        } else {
            kind.to_owned()
        });
        if let Some(mechanism) = &self.analysis.mechanism {
            lines.extend(value(mechanism, declared.symbol));
            let chain = self.chain(mechanism, declared.symbol);
            if !chain.is_empty() {
                lines.push(format!("```hodograph\n{}\n```", chain.join("\n")));
            }
        }
        if !declared.docs.is_empty() {
            lines.push(declared.docs.clone());
        }
        lines.join("\n\n")
    }

    /// The text of the declaration, on one line, if it is short.
    fn statement_of(&self, declared: &Declared) -> String {
        let Some(place) = declared.place else {
            return words::look(words::GIVEN, &declared.name)
                .map_or(String::new(), |word| format!("{} // {}", word.form, word.meaning));
        };
        self.statement_at(place)
    }

    /// The statement that contains the name at a place.
    pub(crate) fn statement_at(&self, place: Span) -> String {
        let tokens = self.tokens();
        let Some(at) = tokens.iter().position(|token| token.span == place) else { return String::new() };
        let before = tokens[..at].iter().rposition(|token| {
            matches!(token.kind, TokenKind::Sign(',' | ';') | TokenKind::Open('{') | TokenKind::OuterDoc)
        });
        let (start, mut depth, mut end) = (before.map_or(at, |i| i + 1), 0_usize, at);
        for (i, token) in tokens.iter().enumerate().skip(at) {
            match token.kind {
                TokenKind::Open(_) => depth += 1,
                TokenKind::Close(_) if depth == 0 => break,
                TokenKind::Close(_) => depth -= 1,
                TokenKind::Sign(',' | ';') if depth == 0 => break,
                _ => {}
            }
            end = i;
        }
        let text = self.text.at(tokens[start].span.to(tokens[end].span));
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The declarations from a frame or point to N or O.
    fn chain(&self, m: &Mechanism, symbol: Symbol) -> Vec<String> {
        let mut chain = Vec::new();
        let mut next = match symbol {
            Symbol::Frame(i) => m.frames.get(i).and_then(|frame| frame.parent).map(|f| Symbol::Frame(f.0)),
            Symbol::Point(i) => origin(m, i).map(|p| Symbol::Point(p.0)),
            Symbol::Body(i) => m.bodies.get(i).and_then(|body| body.frame).map(|f| Symbol::Frame(f.0)),
            _ => None,
        };
        while let Some(symbol) = next.filter(|_| chain.len() < 40) {
            let (statement, after) = match symbol {
                Symbol::Frame(i) => (m.frames.get(i).map(|f| f.span), m.frames.get(i).and_then(|f| f.parent)),
                _ => (None, None),
            };
            let (statement, after) = match symbol {
                Symbol::Point(i) => {
                    (m.points.get(i).map(|p| p.span), origin(m, i).map(|p| Symbol::Point(p.0)))
                }
                _ => (statement, after.map(|f| Symbol::Frame(f.0))),
            };
            let given = matches!(symbol, Symbol::Frame(0) | Symbol::Point(0));
            if let Some(place) = statement.filter(|_| !given) {
                chain.push(self.statement_at(place));
            }
            next = after.filter(|_| !given);
        }
        chain
    }
}

/// The point relative to which another is defined.
fn origin(m: &Mechanism, point: usize) -> Option<PointId> {
    match &m.points.get(point)?.place {
        Place::Offset { from, .. } | Place::Material { from, .. } => Some(*from),
        _ => None,
    }
}

fn has_dimension(symbol: Symbol) -> bool {
    use Symbol::{Coordinate, Definition, Input, Parameter, Pi, Speed, Time};
    matches!(symbol, Parameter(_) | Input(_) | Coordinate(_) | Speed(_) | Definition(_) | Time | Pi)
}

/// A dimension in words.
pub(crate) fn in_words(dimension: Option<Dimension>) -> String {
    match dimension {
        None => "its dimension is not known".to_owned(),
        Some(none) if none.is_none() => "a plain number or an angle".to_owned(),
        Some(dimension) => format!("in {dimension}"),
    }
}

/// The value in the declared unit and in SI units.
fn value(m: &Mechanism, symbol: Symbol) -> Option<String> {
    let (list, i) = match symbol {
        Symbol::Parameter(i) => (&m.parameters, i),
        Symbol::Input(i) => (&m.inputs, i),
        Symbol::Coordinate(i) => (&m.coordinates, i),
        Symbol::Speed(i) => (&m.speeds, i),
        _ => return None,
    };
    let quantity: &Variable = list.get(i)?;
    let value = quantity.value?;
    let what = match symbol {
        Symbol::Parameter(_) | Symbol::Input(_) => "value",
        _ => "initial value",
    };
    let unit = if quantity.unit == "1" { String::new() } else { format!(" {}", quantity.unit) };
    let si = match quantity.factor == 1.0 {
        true => String::new(),
        false => format!(" = {} in SI units", number(value * quantity.factor)),
    };
    Some(format!("{what} {}{unit}{si}", number(value)))
}

/// A number rounded for display.
fn number(value: f64) -> String {
    let short = format!("{value:.5e}").parse::<f64>().unwrap_or(value);
    let size = short.abs();
    if short == 0.0 || (1e-4..1e6).contains(&size) { format!("{short}") } else { format!("{short:e}") }
}
