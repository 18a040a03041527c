//! Lowers expressions: sums, products, powers and names.

use num_bigint::BigInt;
use num_rational::{BigRational, Ratio};
use num_traits::{Signed, ToPrimitive, Zero};

use super::super::mechanism::{CoordinateId, DefinitionId, Scalar, Vector};
use super::super::names::Symbol;
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed, TypedValue, moderate};
use super::Lowering;
use super::dimensions::{in_words, model_of, quantity};
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::{Dimension, Exponent};
use crate::number::Number;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind, Name};

/// Constant exponents are at most this large.
const MAX_EXPONENT: i32 = 100;
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
                    Diagnostic::new(codes::BAD_EXPRESSION, expr.span, "a list in brackets is no vector")
                        .help("name the frame of its components: `N.vec(a, b, c)`");
                self.report(error);
                Typed::poison(expr.span)
            }
            ExprKind::Rate(inner) => self.rate(inner, expr.span),
        };
        self.in_range(typed)
    }

    /// A constant must be a number that a double can hold.
    fn in_range(&mut self, typed: Typed) -> Typed {
        match typed.constant {
            Some(value) if !value.is_finite() => {
                let error = if value.is_nan() {
                    Diagnostic::new(codes::NUMBER_RANGE, typed.span, "this constant is no number")
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
            Symbol::Frame(_) | Symbol::Point(_) | Symbol::Body(_) | Symbol::Contact(_) => {
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

    fn sum(&mut self, terms: &[(bool, Expr)], span: Span) -> Typed {
        let typed: Vec<Typed> = terms
            .iter()
            .map(|(negative, term)| {
                let term = self.expression(term);
                if *negative { negated(term) } else { term }
            })
            .collect();
        self.add(typed, span)
    }

    /// The sum of typed terms.
    pub(super) fn add(&mut self, terms: Vec<Typed>, span: Span) -> Typed {
        let traits = terms.iter().fold(Traits::default(), |sum, term| sum.plus(term.traits));
        let constant = terms.iter().try_fold(0.0, |sum, term| Some(sum + term.constant?));
        let exact = terms
            .iter()
            .try_fold(BigRational::zero(), |sum, term| Some(sum + &term.exact.as_ref()?.0))
            .and_then(|sum| moderate(Number(sum)));
        let poisoned = terms.iter().any(Typed::is_poison);
        // what most of them are
        let kinds = |vector: bool| {
            terms.iter().filter(move |t| !t.is_poison() && !t.is_zero() && t.is_vector() == vector)
        };
        let mut model =
            [true, false].map(|vector| (vector, kinds(vector).count(), kinds(vector).next().map(|t| t.span)));
        model.sort_by_key(|(_, count, place)| (std::cmp::Reverse(*count), *place));
        let vector = model[0].2.map(|place| (model[0].0, place));
        let mut summands: Vec<&Typed> = Vec::new();
        let (mut scalars, mut vectors) = (Vec::new(), Vec::new());
        let (mut wrong, mut fit) = (poisoned, true);
        for term in &terms {
            let is_vector = match &term.value {
                TypedValue::Poison => continue,
                // 0 joins scalars and vectors alike
                TypedValue::Scalar(scalar) if term.is_zero() => {
                    scalars.push(scalar.clone());
                    continue;
                }
                TypedValue::Scalar(scalar) => {
                    scalars.push(scalar.clone());
                    false
                }
                TypedValue::Vector(v) => {
                    vectors.push(v.clone());
                    true
                }
            };
            match vector {
                Some((first, place)) if first != is_vector => {
                    let kind = |v: bool| if v { "a vector" } else { "a scalar" };
                    let message = format!("{} is added to {}", kind(is_vector), kind(first));
                    let error = Diagnostic::new(codes::SCALAR_VECTOR, term.span, message)
                        .label(format!("this is {}", kind(is_vector)))
                        .related(place, format!("this is {}", kind(first)))
                        .help("multiply the scalar by an axis such as `N.x`, or take a component with `dot`");
                    self.report(error);
                    (wrong, fit) = (true, false);
                    continue;
                }
                _ => {}
            }
            summands.push(term);
        }
        let model = model_of(summands.iter().copied());
        for term in summands {
            // one mistake at a time: a sum of scalars and vectors has no dimension
            if let Some(model) = model.filter(|_| fit) {
                wrong |= !self
                    .same(model, term, |a, b| format!("{} cannot be added to {}", quantity(b), quantity(a)));
            }
        }
        let dimension = model.and_then(|model| model.dimension);
        let provenance = model.map_or(Provenance::none(), |model| model.provenance.clone());
        if wrong {
            return Typed { traits, ..Typed::poison(span) };
        }
        let value = match vector {
            Some((true, _)) if vectors.len() == 1 => TypedValue::Vector(vectors.remove(0)),
            Some((true, _)) => TypedValue::Vector(Vector::Add(vectors)),
            _ => TypedValue::Scalar(Scalar::Add(scalars)),
        };
        let is_scalar = matches!(value, TypedValue::Scalar(_));
        Typed {
            value,
            dimension,
            provenance,
            traits,
            constant: constant.filter(|_| is_scalar),
            exact: exact.filter(|_| is_scalar),
            span,
        }
    }

    fn product(&mut self, factors: &[(bool, Expr)], span: Span) -> Typed {
        let mut traits = Traits::default();
        let mut dimension = Some(Dimension::none());
        let mut provenance = Provenance::none();
        let mut any_dimension = false;
        let (mut constant, mut exact) = (Some(1.0), Some(BigRational::from_integer(BigInt::from(1))));
        let (mut numerator, mut denominator) = (Vec::new(), Vec::new());
        let mut vector: Option<(Vector, Span)> = None;
        let mut wrong = false;
        let mut divisor_span: Option<Span> = None;
        for (divides, factor) in factors {
            // what is differentiated makes no sense
            if *divides
                && wrong
                && matches!(&factor.kind, ExprKind::Name(text) if text == "dt" && self.names.get(text).is_none())
            {
                continue;
            }
            let typed = self.expression(factor);
            let factor_traits = if *divides { typed.traits.bent() } else { typed.traits };
            let nonlinear_divisor = *divides && typed.traits.degree > 0;
            traits = traits.times(factor_traits);
            if nonlinear_divisor {
                traits.degree = 2;
                traits.speed_at = typed.traits.speed_at;
            }
            if typed.is_zero() && *divides {
                let error =
                    Diagnostic::new(codes::ZERO_DIVISOR, typed.span, "division by zero").label("this is 0");
                self.report(error);
                wrong = true;
            }
            let combined = match (dimension, typed.dimension) {
                (Some(so_far), Some(next)) if *divides => so_far.over(&next),
                (Some(so_far), Some(next)) => so_far.times(&next),
                _ => {
                    any_dimension = true;
                    dimension
                }
            };
            if combined.is_none() && !any_dimension {
                self.error(codes::EXPONENT, span, "the dimension of this product is out of bounds");
                wrong = true;
            }
            dimension = combined;
            provenance = if *divides {
                provenance.over(&typed.provenance)
            } else {
                provenance.times(&typed.provenance)
            };
            constant = constant.and_then(|c| typed.constant.map(|v| if *divides { c / v } else { c * v }));
            exact = match (exact, &typed.exact) {
                (Some(e), Some(v)) if *divides && !v.is_zero() => moderate(Number(e / &v.0)).map(|n| n.0),
                (Some(e), Some(v)) if !*divides => moderate(Number(e * &v.0)).map(|n| n.0),
                _ => None,
            };
            match typed.value {
                TypedValue::Poison => wrong = true,
                TypedValue::Scalar(scalar) if *divides => {
                    divisor_span = Some(divisor_span.map_or(typed.span, |s| s.to(typed.span)));
                    denominator.push(scalar);
                }
                TypedValue::Scalar(scalar) => numerator.push(scalar),
                TypedValue::Vector(_) if *divides => {
                    let error =
                        Diagnostic::new(codes::SCALAR_VECTOR, typed.span, "a vector cannot be a divisor")
                            .help("divide by its magnitude `norm(v)`");
                    self.report(error);
                    wrong = true;
                }
                TypedValue::Vector(v) => match &vector {
                    None => vector = Some((v, typed.span)),
                    Some((_, first)) => {
                        let error =
                            Diagnostic::new(codes::SCALAR_VECTOR, typed.span, "a vector times a vector")
                                .related(*first, "the other vector")
                                .help("write `dot(v, w)` or `cross(v, w)`");
                        self.report(error);
                        wrong = true;
                    }
                },
            }
        }
        if wrong {
            return Typed { traits, ..Typed::poison(span) };
        }
        let product = |mut list: Vec<Scalar>| match list.len() {
            0 => Scalar::Number(Number::integer(1)),
            1 => list.remove(0),
            _ => Scalar::Mul(list),
        };
        let plain = numerator.is_empty() && denominator.is_empty();
        let numerator = product(numerator);
        let scalar = match divisor_span {
            None => numerator,
            Some(place) => Scalar::Div(Box::new(numerator), Box::new(product(denominator)), place),
        };
        let dimension = dimension.filter(|_| !any_dimension);
        match vector {
            Some((vector, _)) if plain => Typed::vector(vector, dimension, traits, span).from(provenance),
            Some((vector, _)) => {
                Typed::vector(Vector::Scale(Box::new(scalar), Box::new(vector)), dimension, traits, span)
                    .from(provenance)
            }
            None => {
                let exact = exact.map(Number);
                Typed {
                    value: TypedValue::Scalar(scalar),
                    dimension,
                    provenance,
                    traits,
                    constant,
                    exact,
                    span,
                }
            }
        }
    }

    /// `base ^ exponent`
    pub(super) fn power(&mut self, base: Typed, exponent: Typed, span: Span) -> Typed {
        let (Some(b), Some(e)) =
            (self.need_scalar(&base, "the base of a power"), self.need_scalar(&exponent, "an exponent"))
        else {
            return Typed::poison(span);
        };
        self.demand(&exponent, Dimension::none(), "an exponent");
        let constant = match (base.constant, exponent.constant) {
            (Some(b), Some(e)) => Some(b.powf(e)),
            _ => None,
        };
        let small = exponent.exact.as_ref().and_then(small_ratio);
        if let Some(value) = exponent.constant
            && (value.abs() > f64::from(MAX_EXPONENT) || (exponent.exact.is_some() && small.is_none()))
        {
            let message = format!("exponents are fractions between -{MAX_EXPONENT} and {MAX_EXPONENT}");
            self.report(
                Diagnostic::new(codes::EXPONENT, exponent.span, message).label("this is out of bounds"),
            );
            return Typed::poison(span);
        }
        if base.is_zero() && exponent.constant.is_some_and(|e| e < 0.0) {
            let error = Diagnostic::new(codes::ZERO_DIVISOR, span, "a negative power of zero");
            self.report(error.related(base.span, "this is 0"));
            return Typed::poison(span);
        }
        let provenance = small.map_or(Provenance::none(), |exponent| base.provenance.power(exponent));
        let dimension = match (base.dimension, small) {
            (None, _) if base.is_zero() => Some(Dimension::none()),
            (None, _) => None,
            (Some(d), Some(_)) if d.is_none() => Some(d),
            (Some(d), None) if d.is_none() => {
                self.agreement(base.provenance.clone());
                Some(d)
            }
            (Some(d), Some(e)) => match d.power(e) {
                Some(d) => Some(d),
                None => {
                    self.error(codes::EXPONENT, span, "the dimension of this power is out of bounds");
                    return Typed::poison(span);
                }
            },
            (Some(d), None) => {
                let message = format!(
                    "the base has the dimension {d}, so the exponent must be a number such as 2 or 1/2"
                );
                let error = Diagnostic::new(codes::EXPONENT, exponent.span, message)
                    .related(base.span, format!("this is {}", in_words(d)))
                    .help("divide the base by a quantity of its own dimension");
                let says = "with an exponent that is no number, this must be without dimension";
                self.contradiction(
                    error,
                    base.provenance.clone(),
                    Dimension::none().over(&d),
                    says.to_owned(),
                );
                return Typed::poison(span);
            }
        };
        let exact = match (&base.exact, small) {
            (Some(b), Some(e)) if e.is_integer() && !(b.is_zero() && *e.numer() < 0) => {
                let bits = (b.0.numer().bits() + b.0.denom().bits()) * u64::from(e.numer().unsigned_abs());
                if bits <= 1024 { moderate(Number(b.0.pow(*e.numer()))) } else { None }
            }
            _ => None,
        };
        let one = small == Some(Exponent::from_integer(1));
        let traits = if one { base.traits } else { base.traits.bent().plus(exponent.traits.bent()) };
        let value = TypedValue::Scalar(Scalar::Pow(Box::new(b), Box::new(e)));
        Typed { value, dimension, provenance, traits, constant, exact, span }
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

    /// Is the expression a bare coordinate?
    pub(super) fn as_coordinate(&mut self, expr: &Expr) -> Option<CoordinateId> {
        let ExprKind::Name(text) = &expr.kind else { return None };
        let symbol = self.names.get(text)?;
        self.used.insert(symbol);
        match symbol {
            Symbol::Coordinate(i) => Some(CoordinateId(i)),
            _ => None,
        }
    }
}

/// The opposite.
pub(super) fn negated(typed: Typed) -> Typed {
    let value = match typed.value {
        TypedValue::Scalar(scalar) => TypedValue::Scalar(Scalar::Neg(Box::new(scalar))),
        TypedValue::Vector(vector) => TypedValue::Vector(Vector::Neg(Box::new(vector))),
        TypedValue::Poison => TypedValue::Poison,
    };
    Typed { value, constant: typed.constant.map(|c| -c), exact: typed.exact.map(|n| Number(-n.0)), ..typed }
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

/// The fraction as one of small whole numbers.
fn small_ratio(number: &Number) -> Option<Exponent> {
    let numer = number.0.numer().to_i32().filter(|n| n.abs() <= MAX_EXPONENT * 100)?;
    let denom = number.0.denom().to_i32().filter(|d| *d <= 100)?;
    let ratio = Ratio::new(numer, denom);
    (ratio.abs() <= Ratio::from_integer(MAX_EXPONENT)).then_some(ratio)
}
