//! Lowers products, quotients and powers.

use num_rational::Ratio;
use num_traits::{Signed, ToPrimitive, Zero};

use super::super::mechanism::{Scalar, Vector};
use super::super::provenance::Provenance;
use super::super::typed::{Traits, Typed, TypedValue, moderate};
use super::Lowering;
use super::dimensions::in_words;
use crate::diagnostics::{Diagnostic, codes};
use crate::dimension::{Dimension, Exponent};
use crate::number::Number;
use crate::span::Span;
use crate::syntax::tree::{Expr, ExprKind};

/// Constant exponents are at most this large.
const MAX_EXPONENT: i32 = 100;

/// A product whose factors so far have been read.
struct Product {
    traits: Traits,
    /// the dimension of the factors whose dimension is known; `None` where it is out of bounds
    dimension: Option<Dimension>,
    /// a factor takes whatever dimension it needs, and so does the product
    any_dimension: bool,
    provenance: Provenance,
    constant: Option<f64>,
    exact: Option<Number>,
    numerator: Vec<Scalar>,
    denominator: Vec<Scalar>,
    /// the place of the divisors
    divisors: Option<Span>,
    vector: Option<(Vector, Span)>,
    /// constant factors, none of which is 0, have a product that a double cannot hold
    underflows: bool,
    /// a mistake has been reported: the product has no value
    wrong: bool,
}

impl Product {
    fn one() -> Self {
        Self {
            traits: Traits::default(),
            dimension: Some(Dimension::none()),
            any_dimension: false,
            provenance: Provenance::none(),
            constant: Some(1.0),
            exact: Some(Number::integer(1)),
            numerator: Vec::new(),
            denominator: Vec::new(),
            divisors: None,
            vector: None,
            underflows: false,
            wrong: false,
        }
    }

    /// Takes what a factor, or a divisor, says of the whole without its value.
    fn take_facts(&mut self, factor: &Typed, divides: bool) {
        self.traits = self.traits.times(if divides { factor.traits.bent() } else { factor.traits });
        if divides && factor.traits.degree > 0 {
            self.traits.degree = 2;
            self.traits.speed_at = factor.traits.speed_at;
        }
        self.provenance = if divides {
            self.provenance.over(&factor.provenance)
        } else {
            self.provenance.times(&factor.provenance)
        };
        self.constant = match (self.constant, factor.constant) {
            (Some(so_far), Some(next)) => {
                let together = if divides { so_far / next } else { so_far * next };
                self.underflows |= too_small(together) && so_far != 0.0 && next != 0.0;
                Some(together)
            }
            _ => None,
        };
        self.exact = match (self.exact.take(), &factor.exact) {
            (Some(so_far), Some(next)) if divides && !next.0.is_zero() => {
                moderate(Number(so_far.0 / &next.0))
            }
            (Some(so_far), Some(next)) if !divides => moderate(Number(so_far.0 * &next.0)),
            _ => None,
        };
    }

    /// Takes the dimension of a factor or a divisor; false where that of the product is out of bounds.
    fn take_dimension(&mut self, factor: &Typed, divides: bool) -> bool {
        match (self.dimension, factor.dimension) {
            (Some(so_far), Some(next)) => {
                self.dimension = if divides { so_far.over(&next) } else { so_far.times(&next) };
                self.dimension.is_some() || self.any_dimension
            }
            _ => {
                self.any_dimension = true;
                true
            }
        }
    }

    /// Takes the value of a factor or a divisor; a mistake where it has no place in a product.
    fn take_value(&mut self, factor: Typed, divides: bool) -> Result<(), Box<Diagnostic>> {
        let place = factor.span;
        match factor.value {
            TypedValue::Poison => self.wrong = true,
            TypedValue::Scalar(scalar) if divides => {
                self.divisors = Some(self.divisors.map_or(place, |divisors| divisors.to(place)));
                self.denominator.push(scalar);
            }
            TypedValue::Scalar(scalar) => self.numerator.push(scalar),
            TypedValue::Vector(_) if divides => {
                let error = Diagnostic::new(codes::SCALAR_VECTOR, place, "a vector cannot be a divisor");
                return Err(Box::new(error.help("divide by its magnitude `norm(v)`")));
            }
            TypedValue::Vector(vector) => match &self.vector {
                None => self.vector = Some((vector, place)),
                Some((_, first)) => {
                    let error = Diagnostic::new(codes::SCALAR_VECTOR, place, "a vector times a vector")
                        .related(*first, "the other vector")
                        .help("write `dot(v, w)` or `cross(v, w)`");
                    return Err(Box::new(error));
                }
            },
        }
        Ok(())
    }

    /// The value of the whole, which stands at `span`.
    fn finish(self, span: Span) -> Typed {
        let traits = self.traits;
        if self.wrong {
            return Typed { traits, ..Typed::poison(span) };
        }
        let product = |mut list: Vec<Scalar>| match list.len() {
            0 => Scalar::Number(Number::integer(1)),
            1 => list.remove(0),
            _ => Scalar::Mul(list),
        };
        let without_scalars = self.numerator.is_empty() && self.denominator.is_empty();
        let numerator = product(self.numerator);
        let scalar = match self.divisors {
            None => numerator,
            Some(place) => Scalar::Div(Box::new(numerator), Box::new(product(self.denominator)), place),
        };
        let dimension = self.dimension.filter(|_| !self.any_dimension);
        let (provenance, constant, exact) = (self.provenance, self.constant, self.exact);
        match self.vector {
            Some((vector, _)) => {
                let scaled =
                    if without_scalars { vector } else { Vector::Scale(Box::new(scalar), Box::new(vector)) };
                Typed::vector(scaled, dimension, traits, span).from(provenance)
            }
            None => {
                let value = TypedValue::Scalar(scalar);
                Typed { value, dimension, provenance, traits, constant, exact, span }
            }
        }
    }
}

impl Lowering<'_> {
    /// A product of factors and divisors (marked true).
    pub(super) fn product(&mut self, factors: &[(bool, Expr)], span: Span) -> Typed {
        let mut product = Product::one();
        for &(divides, ref factor) in factors {
            // `d(E)/dt` that could not be read: `dt` is no further mistake
            let is_undeclared_dt = matches!(&factor.kind, ExprKind::Name(text) if text == "dt" && self.names.get(text).is_none());
            if divides && product.wrong && is_undeclared_dt {
                continue;
            }
            let typed = self.expression(factor);
            if divides && self.vanishes(&typed) {
                let label = if typed.is_zero() { "this is 0" } else { "this is 0, but for rounding" };
                let error = Diagnostic::new(codes::ZERO_DIVISOR, typed.span, "division by zero").label(label);
                self.report(error);
                product.wrong = true;
            }
            product.take_facts(&typed, divides);
            if !product.take_dimension(&typed, divides) {
                self.error(
                    codes::EXPONENT,
                    span,
                    "the exponents in the dimension of this product are out of range",
                );
                product.wrong = true;
            }
            if let Err(error) = product.take_value(typed, divides) {
                self.report(*error);
                product.wrong = true;
            }
        }
        if product.underflows && !product.wrong {
            return self.out_of_range(span);
        }
        product.finish(span)
    }

    /// The error of a constant other than 0 that a double cannot hold, or not with all its digits.
    fn out_of_range(&mut self, span: Span) -> Typed {
        let error = Diagnostic::new(codes::NUMBER_RANGE, span, "this constant is out of range");
        self.report(error.help("its size must lie between 1e-300 and 1e300"));
        Typed::poison(span)
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
                Diagnostic::new(codes::EXPONENT, exponent.span, message)
                    .label("this is out of range")
                    .help("write the number that the power is, or a product of powers"),
            );
            return Typed::poison(span);
        }
        if constant.is_some_and(too_small) && base.constant != Some(0.0) {
            return self.out_of_range(span);
        }
        if exponent.constant.is_some_and(|e| e < 0.0) && self.vanishes(&base) {
            let error = Diagnostic::new(codes::ZERO_DIVISOR, span, "a negative power of zero");
            let label = if base.is_zero() { "this is 0" } else { "this is 0, but for rounding" };
            self.report(error.related(base.span, label));
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
                    self.error(
                        codes::EXPONENT,
                        span,
                        "the exponents in the dimension of this power are out of range",
                    );
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
        let power = Scalar::Pow(Box::new(b), Box::new(e));
        if constant.is_some() && bits(&power) > MOST_BITS {
            let message = "this constant has too many digits: powers of numbers are computed exactly";
            let error = Diagnostic::new(codes::NUMBER_RANGE, span, message);
            self.report(error.help("write the number that it is, with the digits that matter"));
            return Typed::poison(span);
        }
        let value = TypedValue::Scalar(power);
        Typed { value, dimension, provenance, traits, constant, exact, span }
    }
}

/// Whether a constant that is not 0 is less than what numbers are bounded by.
fn too_small(value: f64) -> bool {
    value.abs() < 1e-300
}

/// The most bits of a number that a power of numbers may have: it is computed exactly.
const MOST_BITS: u64 = 100_000;

/// About how many bits a number has if it is computed exactly; 0 of what is no number.
fn bits(scalar: &Scalar) -> u64 {
    match scalar {
        Scalar::Number(number) => number.0.numer().bits() + number.0.denom().bits(),
        Scalar::Neg(of) => bits(of),
        Scalar::Add(all) | Scalar::Mul(all) => all.iter().map(bits).fold(0, u64::saturating_add),
        Scalar::Div(a, b, _) => bits(a).saturating_add(bits(b)),
        Scalar::Pow(base, exponent) => match &**exponent {
            Scalar::Number(number) => {
                let times = number.0.numer().magnitude().to_u64().unwrap_or(u64::MAX);
                bits(base).saturating_mul(times)
            }
            _ => 0,
        },
        _ => 0,
    }
}

/// The fraction as one of small whole numbers.
fn small_ratio(number: &Number) -> Option<Exponent> {
    let numer = number.0.numer().to_i32().filter(|n| n.abs() <= MAX_EXPONENT * 100)?;
    let denom = number.0.denom().to_i32().filter(|d| *d <= 100)?;
    let ratio = Ratio::new(numer, denom);
    (ratio.abs() <= Ratio::from_integer(MAX_EXPONENT)).then_some(ratio)
}
