//! Constants that are 0 but for rounding: `sin(pi)`, `tan(pi/4) - 1`. Nothing can be divided by them.

use super::super::mechanism::{DefinitionId, Scalar};
use super::super::typed::{Typed, TypedValue};
use super::Lowering;
use crate::arithmetic::{call, call2};

/// Parts of an expression that are looked at, at most.
const MOST_PARTS: usize = 300;
/// A constant is 0 if it is no more than so many times what rounding can make of it.
const ROUNDED: f64 = 4.0;

/// A constant, and by how much it may be wrong.
#[derive(Clone, Copy)]
struct Rounded {
    value: f64,
    error: f64,
}

impl Rounded {
    fn exact(value: f64) -> Self {
        Rounded { value, error: 0.0 }
    }

    /// With the rounding of the operation that made it.
    fn of(value: f64, error: f64) -> Self {
        Rounded { value, error: error + f64::EPSILON * value.abs() }
    }

    fn is_zero(self) -> bool {
        self.value.abs() <= ROUNDED * self.error || self.value == 0.0
    }

    fn times(self, other: Self) -> Self {
        Rounded::of(self.value * other.value, self.value.abs() * other.error + other.value.abs() * self.error)
    }

    /// A function of it: what it makes of values that are as wrong tells how wrong that is.
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let value = function(self.value);
        let off = |by: f64| (function(self.value + by) - value).abs();
        Rounded::of(value, off(self.error).max(off(-self.error)))
    }
}

impl Lowering<'_> {
    /// Whether it is 0 in all states, or would be without rounding.
    pub(super) fn vanishes(&self, typed: &Typed) -> bool {
        let mut left = MOST_PARTS;
        match &typed.value {
            _ if typed.is_zero() => true,
            TypedValue::Scalar(scalar) if typed.exact.is_none() => self.is_nothing(scalar, &mut left),
            _ => false,
        }
    }

    /// Whether a factor of it is a constant that is 0.
    fn is_nothing(&self, scalar: &Scalar, left: &mut usize) -> bool {
        let Some(others) = left.checked_sub(1) else { return false };
        *left = others;
        match scalar {
            Scalar::Number(_) | Scalar::Pi => false,
            Scalar::Neg(inner) | Scalar::Div(inner, ..) => self.is_nothing(inner, left),
            Scalar::Mul(factors) => factors.iter().any(|factor| self.is_nothing(factor, left)),
            Scalar::Definition(id) => self.defined(*id).is_some_and(|inner| self.is_nothing(inner, left)),
            _ => self.rounded(scalar, left).is_some_and(Rounded::is_zero),
        }
    }

    fn defined(&self, id: DefinitionId) -> Option<&Scalar> {
        match &self.definitions.get(id.0)?.typed.as_ref()?.value {
            TypedValue::Scalar(scalar) => Some(scalar),
            _ => None,
        }
    }

    /// The value of an expression of numbers alone.
    fn rounded(&self, scalar: &Scalar, left: &mut usize) -> Option<Rounded> {
        *left = left.checked_sub(1)?;
        Some(match scalar {
            Scalar::Number(number) => Rounded::of(number.to_f64(), 0.0),
            Scalar::Pi => Rounded::of(std::f64::consts::PI, 0.0),
            Scalar::Definition(id) => self.rounded(self.defined(*id)?, left)?,
            Scalar::Neg(inner) => {
                let inner = self.rounded(inner, left)?;
                Rounded { value: -inner.value, ..inner }
            }
            Scalar::Add(terms) => {
                let mut sum = Rounded::exact(0.0);
                for term in terms {
                    let term = self.rounded(term, left)?;
                    sum = Rounded::of(sum.value + term.value, sum.error + term.error);
                }
                sum
            }
            Scalar::Mul(factors) => {
                let mut product = Rounded::exact(1.0);
                for factor in factors {
                    product = product.times(self.rounded(factor, left)?);
                }
                product
            }
            Scalar::Div(a, b, _) => {
                let (a, b) = (self.rounded(a, left)?, self.rounded(b, left)?);
                if b.is_zero() {
                    return None;
                }
                a.times(b.map(|b| 1.0 / b))
            }
            Scalar::Pow(base, exponent) => {
                let (base, exponent) = (self.rounded(base, left)?, self.rounded(exponent, left)?);
                base.map(|base| base.powf(exponent.value))
            }
            Scalar::Call(function, arguments) => match arguments[..] {
                [ref a] => self.rounded(a, left)?.map(|a| call(*function, a)),
                [ref a, ref b] => {
                    let (a, b) = (self.rounded(a, left)?, self.rounded(b, left)?);
                    let value = a.map(|a| call2(*function, a, b.value));
                    let other = b.map(|b| call2(*function, a.value, b));
                    Rounded { error: value.error + other.error, ..value }
                }
                _ => return None,
            },
            _ => return None,
        })
    }
}
