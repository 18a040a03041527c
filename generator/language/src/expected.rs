//! The dimension that the rest of the model requires of an expression.
//!
//! The number 0 has every dimension. It replaces the expression, which may also be missing; the checker then
//! reports the required dimension of the whole and the dimensions of its other parts.

use hodograph_model::check;
use hodograph_model::dimension::{Dimension, Exponent};
use hodograph_model::model::symbols::Symbols;
use hodograph_model::span::Span;
use hodograph_model::syntax::repair;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::{Expr, ExprKind};
use hodograph_model::syntax::units;
use hodograph_model::syntax::visit::{Root, roots};

use crate::Document;
use crate::context;

/// The requirements on an expression.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Expected {
    /// its dimension, if known
    pub dimension: Option<Dimension>,
    /// whether it is a vector, if known
    pub is_vector: Option<bool>,
}

impl Document {
    /// The requirements on the name at a place.
    pub(crate) fn expected_at(&self, place: Span) -> Option<Expected> {
        let tokens = self.tokens();
        let at = tokens.iter().position(|token| token.span == place)?;
        let mut tokens = tokens.to_vec();
        tokens[at] = zero(place);
        demanded(&tokens, place)
    }

    /// The requirements on the text after the first `count` tokens, in place of a word that has been begun
    /// there.
    pub(crate) fn expected_behind(&self, count: usize, word: Option<Span>, offset: u32) -> Option<Expected> {
        let tokens = self.tokens();
        let place = word.unwrap_or(Span { start: offset, end: offset });
        let rest = &tokens[(count + usize::from(word.is_some())).min(tokens.len())..];
        let mut with_hole = tokens[..count].to_vec();
        with_hole.push(zero(place));
        // the next line is another statement, unless an operator joins it
        let joins = |next: &Token| matches!(next.kind, TokenKind::Sign(_) | TokenKind::Close(_));
        if rest.first().is_none_or(|next| !joins(next)) {
            let kind = TokenKind::Sign(context::separator(&tokens[..count]));
            with_hole.push(Token {
                kind,
                text: String::new(),
                span: Span { start: place.end, end: place.end },
            });
        }
        with_hole.extend_from_slice(rest);
        demanded(&with_hole, place)
    }
}

fn zero(span: Span) -> Token {
    Token { kind: TokenKind::Number, text: "0".to_owned(), span }
}

/// The requirements on the number at a place.
fn demanded(tokens: &[Token], place: Span) -> Option<Expected> {
    let (tree, symbols) = check::names(&repair::balanced(tokens));
    let holds = |expr: &Expr| expr.span.start <= place.start && place.end <= expr.span.end;
    roots(&tree).into_iter().find(|root| holds(root.value)).and_then(|Root { value, beside, unit }| {
        let stated = unit.and_then(|unit| units::read(unit).ok()).map(|unit| unit.dimension);
        let other = beside.and_then(|other| symbols.value(other.span));
        let given = Expected {
            dimension: stated.or(other.and_then(|value| value.dimension)),
            is_vector: other.map(|value| value.is_vector).or(stated.map(|_| false)),
        };
        within(value, given, place, &symbols)
    })
}

/// The requirements on the number at a place inside an expression with these requirements.
fn within(expr: &Expr, given: Expected, place: Span, symbols: &Symbols) -> Option<Expected> {
    let mut given = given;
    for wanted in symbols.wanted.iter().filter(|wanted| wanted.place == expr.span) {
        given.dimension = wanted.dimension.or(given.dimension);
        given.is_vector = wanted.is_vector.or(given.is_vector);
    }
    if expr.span == place && matches!(expr.kind, ExprKind::Number(_)) {
        return Some(given);
    }
    let holds = |part: &Expr| part.span.start <= place.start && place.end <= part.span.end;
    let value = |part: &Expr| symbols.value(part.span);
    let plain = Expected { dimension: Some(Dimension::none()), is_vector: Some(false) };
    match &expr.kind {
        ExprKind::Neg(inner) => within(inner, given, place, symbols),
        ExprKind::Sum(terms) => {
            let (_, part) = terms.iter().find(|(_, part)| holds(part))?;
            let others = || terms.iter().map(|(_, term)| term).filter(|term| !holds(term)).filter_map(value);
            let dimension = others().find_map(|value| value.dimension);
            let kind = others().find(|value| value.dimension.is_some()).map(|value| value.is_vector);
            let given =
                Expected { dimension: given.dimension.or(dimension), is_vector: given.is_vector.or(kind) };
            within(part, given, place, symbols)
        }
        ExprKind::Product(factors) => {
            let (divides, part) = factors.iter().find(|(_, part)| holds(part))?;
            let mut dimension = given.dimension;
            let mut vector = false;
            for (divides, factor) in factors.iter().filter(|(_, factor)| !holds(factor)) {
                let known = value(factor);
                vector |= known.is_some_and(|value| value.is_vector);
                dimension =
                    dimension.zip(known.and_then(|value| value.dimension)).and_then(|(whole, part)| {
                        if *divides { whole.times(&part) } else { whole.over(&part) }
                    });
            }
            if *divides {
                dimension = dimension.and_then(|whole| Dimension::none().over(&whole));
            }
            let scalar = *divides || vector || given.is_vector == Some(false);
            let is_vector = if scalar { Some(false) } else { given.is_vector };
            within(part, Expected { dimension, is_vector }, place, symbols)
        }
        ExprKind::Power(base, exponent) if holds(exponent) => within(exponent, plain, place, symbols),
        ExprKind::Power(base, exponent) => {
            let power = match &exponent.kind {
                ExprKind::Number(text) => text.parse::<i32>().ok().filter(|n| *n != 0),
                _ => None,
            };
            let root = power.and_then(|n| given.dimension?.power(Exponent::new(1, n)));
            within(base, Expected { dimension: root, is_vector: Some(false) }, place, symbols)
        }
        ExprKind::Rate(inner) => {
            let second = Dimension::of(0, 0, 1);
            let dimension = given.dimension.and_then(|dimension| dimension.times(&second));
            within(inner, Expected { dimension, is_vector: Some(false) }, place, symbols)
        }
        ExprKind::Call(function, arguments) => {
            let part = arguments.iter().find(|part| holds(part))?;
            let other = arguments.iter().find(|other| !holds(other)).and_then(value);
            let vector = |dimension| Expected { dimension, is_vector: Some(true) };
            let scalar = |dimension| Expected { dimension, is_vector: Some(false) };
            let given = match function.text.as_str() {
                "dot" | "cross" => {
                    let other = other.and_then(|other| other.dimension);
                    vector(given.dimension.zip(other).and_then(|(whole, other)| whole.over(&other)))
                }
                "norm" => vector(given.dimension),
                "unit" => vector(None),
                "abs" => scalar(given.dimension),
                "sqrt" => scalar(given.dimension.and_then(|root| root.power(Exponent::from_integer(2)))),
                "atan2" | "min" | "max" => scalar(other.and_then(|other| other.dimension)),
                "sign" | "pow" => scalar(None),
                _ => plain,
            };
            within(part, given, place, symbols)
        }
        ExprKind::Method(_, method, arguments) => {
            let part = arguments.iter().find(|part| holds(part))?;
            let given = match method.text.as_str() {
                "vec" => Expected { dimension: given.dimension, is_vector: Some(false) },
                "spin" => Expected { dimension: Some(Dimension::of(0, 0, -1)), is_vector: Some(true) },
                _ => plain,
            };
            within(part, given, place, symbols)
        }
        ExprKind::List(items) => {
            let part = items.iter().find(|part| holds(part))?;
            within(part, Expected::default(), place, symbols)
        }
        _ => None,
    }
}
