//! Lowers an expression by its kind; names, numbers and rates.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

use super::super::mechanism::{CoordinateId, DefinitionId, Scalar, Vector};
use super::super::names::Symbol;
use super::super::symbols::Value;
use super::super::typed::{Traits, Typed, TypedValue};
use super::Lowering;
use super::shapes::PLACES;
use super::sums::negated;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::Dimension;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Name};
use crate::words;

/// Largest number of digits of a number.
const MAX_DIGITS: usize = 60;

impl Lowering<'_> {
    /// Any expression.
    pub(super) fn expression(&mut self, expr: &Expr) -> Typed {
        let typed = match &expr.kind {
            ExprKind::Error => Typed::poison(expr.span),
            ExprKind::Number(text) => self.number(text, expr.span),
            ExprKind::Name(text) => self.name(&Name { text: text.clone(), span: expr.span }),
            ExprKind::Sum(terms) => self.sum(terms, expr.span),
            ExprKind::Product(factors) => self.product(factors, expr.span),
            ExprKind::Power(base, exponent) => {
                let (base, exponent) = (self.expression(base), self.expression(exponent));
                self.power(base, exponent, expr.span)
            }
            ExprKind::Neg(inner) => {
                let inner = self.expression(inner);
                Typed { span: expr.span, ..negated(inner) }
            }
            ExprKind::Call(function, arguments) => self.call(function, arguments, expr.span),
            ExprKind::Method(base, method, arguments) => self.method(base, method, arguments, expr.span),
            ExprKind::Field(base, field) => self.field(base, field, expr.span),
            ExprKind::List(items) => {
                for item in items {
                    self.expression(item);
                }
                let error =
                    Diagnostic::new(codes::BAD_EXPRESSION, expr.span, "a list in brackets is not a vector")
                        .help("name the frame of its components: `N.vec(a, b, c)`");
                self.report(error);
                Typed::poison(expr.span)
            }
            ExprKind::Rate(inner) => self.rate(inner, expr.span),
        };
        let typed = self.in_range(typed);
        if !typed.is_poison() {
            let (dimension, is_vector) = (typed.dimension, typed.is_vector());
            self.places.values.push(Value { place: expr.span, dimension, is_vector });
        }
        typed
    }

    /// A constant must be a number that a double can hold.
    fn in_range(&mut self, typed: Typed) -> Typed {
        match typed.constant {
            Some(value) if !value.is_finite() => {
                let error = if value.is_nan() {
                    Diagnostic::new(codes::NUMBER_RANGE, typed.span, "this constant is not a number")
                        .help("sqrt and log take no negative number; asin and acos take numbers from -1 to 1")
                } else {
                    Diagnostic::new(codes::NUMBER_RANGE, typed.span, "this constant is out of range")
                        .help("its size must lie between 1e-300 and 1e300")
                };
                self.report(error);
                Typed::poison(typed.span)
            }
            _ => typed,
        }
    }

    fn number(&mut self, text: &str, span: Span) -> Typed {
        let value = exact_decimal(text);
        let fits = |v: &BigRational| {
            let size = v.abs().to_f64().unwrap_or(f64::INFINITY);
            v.is_zero() || (1e-300..=1e300).contains(&size)
        };
        match value {
            Some(value) if fits(&value) => Typed::number(value, span),
            _ => {
                let long = text.len() > MAX_DIGITS;
                let message = if long { "this number is too long" } else { "this number is out of range" };
                let help = if long {
                    format!("a number has at most {MAX_DIGITS} characters; a double holds 17 digits")
                } else {
                    "its size must lie between 1e-300 and 1e300".to_owned()
                };
                self.report(Diagnostic::new(codes::NUMBER_RANGE, span, message).help(help));
                Typed::poison(span)
            }
        }
    }

    fn name(&mut self, name: &Name) -> Typed {
        let span = name.span;
        if let Some(place) = words::PLACES.iter().take(self.along_surface).position(|axis| *axis == name.text)
        {
            let value = Scalar::Definition(PLACES[place]);
            return Typed::scalar(value, Some(Dimension::of(1, 0, 0)), Traits::default(), span);
        }
        let constant_only = self.constant_only;
        let scalar = |s: Symbol| {
            use Symbol::*;
            !constant_only
                && matches!(s, Parameter(_) | Input(_) | Coordinate(_) | Speed(_) | Definition(_) | Time)
                || s == Pi
        };
        let Some(symbol) = self.resolve(name, scalar) else { return Typed::poison(span) };
        if constant_only && symbol != Symbol::Pi {
            let message = format!("a value is a constant, but `{}` is {}", name.text, symbol.kind());
            let error = Diagnostic::new(codes::CONSTANT, span, message)
                .help("use numbers, pi and functions here; what follows from other quantities belongs to `definitions`");
            self.report(error);
            return Typed::poison(span);
        }
        match symbol {
            Symbol::Parameter(_) | Symbol::Input(_) | Symbol::Coordinate(_) | Symbol::Speed(_) => {
                self.quantity_in_expression(symbol, span)
            }
            Symbol::Time => {
                let traits = Traits { time: true, ..Traits::default() };
                Typed::scalar(Scalar::Time, Some(Dimension::of(0, 0, 1)), traits, span)
            }
            Symbol::Pi => Typed {
                constant: Some(std::f64::consts::PI),
                ..Typed::scalar(Scalar::Pi, Some(Dimension::none()), Traits::default(), span)
            },
            Symbol::Broken => Typed::poison(span),
            Symbol::Definition(i) => match &self.definitions[i].typed {
                None => Typed::poison(span),
                Some(known) => {
                    let value = match known.value {
                        TypedValue::Scalar(_) => TypedValue::Scalar(Scalar::Definition(DefinitionId(i))),
                        TypedValue::Vector(_) => TypedValue::Vector(Vector::Definition(DefinitionId(i))),
                        TypedValue::Poison => TypedValue::Poison,
                    };
                    Typed { value, span, traits: known.traits.seen_from(span), ..known.clone() }
                }
            },
            Symbol::Frame(_) | Symbol::Point(_) | Symbol::Body(_) | Symbol::Contact(_) | Symbol::Shape(_) => {
                let help = match symbol {
                    Symbol::Frame(_) => format!("its axes are `{0}.x`, `{0}.y` and `{0}.z`", name.text),
                    Symbol::Point(_) => format!("its position from O is `position({})`", name.text),
                    _ => "it has no value".to_owned(),
                };
                let message =
                    format!("a scalar or vector is needed here, but `{}` is {}", name.text, symbol.kind());
                self.report(Diagnostic::new(codes::WRONG_KIND, span, message).help(help));
                Typed::poison(span)
            }
        }
    }

    /// `d(E)/dt`
    fn rate(&mut self, inner: &Expr, span: Span) -> Typed {
        let typed = self.expression(inner);
        if self.constant_only && !typed.is_poison() {
            self.error(codes::CONSTANT, span, "a value is a constant, not a rate");
            return Typed::poison(span);
        }
        let Some(scalar) = self.need_scalar(&typed, "what is differentiated") else {
            return Typed::poison(span);
        };
        if typed.traits.degree > 0 {
            self.need_free_of_speeds(&typed, "what is differentiated");
            if let Some(error) = self.diagnostics.last_mut() {
                error.help =
                    Some("accelerations are results, not terms of a model: inertia needs no load".to_owned());
            }
            return Typed::poison(span);
        }
        self.need_rate(&typed, "what is differentiated");
        let per_second = Dimension::of(0, 0, -1);
        let dimension = typed.dimension.and_then(|d| d.times(&per_second));
        let value = Scalar::Rate(Box::new(scalar));
        Typed::scalar(value, dimension, typed.traits.derivative(span), span).from(typed.provenance)
    }

    /// Whether the expression is a bare coordinate.
    pub(super) fn as_coordinate(&mut self, expr: &Expr) -> Option<CoordinateId> {
        let ExprKind::Name(text) = &expr.kind else { return None };
        let symbol = self.names.get(text)?;
        self.places.uses(symbol, expr.span);
        match symbol {
            Symbol::Coordinate(i) => Some(CoordinateId(i)),
            _ => None,
        }
    }
}

/// The exact value of a decimal, unless it is too long or its exponent too large.
fn exact_decimal(text: &str) -> Option<BigRational> {
    if text.len() > MAX_DIGITS {
        return None;
    }
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let exponent: i32 = exponent.parse().ok().filter(|e: &i32| e.abs() <= 400)?;
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
    let shift = exponent - i32::try_from(fraction.len()).ok()?;
    let ten = BigRational::from_integer(BigInt::from(10));
    Some(BigRational::from_integer(digits) * ten.pow(shift))
}
