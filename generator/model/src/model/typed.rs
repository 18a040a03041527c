//! An expression with its type: scalar or vector, dimension, and dependence on speeds, coordinates, time and
//! inputs.

use num_rational::BigRational;

use super::mechanism::{Scalar, Vector};
use super::provenance::Provenance;
use crate::dimension::Dimension;
use crate::number::Number;
use crate::span::Span;

/// The expression itself.
#[derive(Clone, Debug)]
pub enum TypedValue {
    /// a scalar
    Scalar(Scalar),
    /// a vector
    Vector(Vector),
    /// a mistake that is already reported; causes no further message
    Poison,
}

/// On what an expression depends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traits {
    /// degree in rates of coordinates and speeds together; 2 stands for anything that is not linear
    pub degree: u8,
    /// where the first of them stands
    pub speed_at: Option<Span>,
    /// on coordinates
    pub moves: bool,
    /// on time
    pub time: bool,
    /// on an input, and where it stands
    pub input: Option<Span>,
}

impl Traits {
    /// Of something that is linear in the speeds, such as a speed.
    pub fn speed(at: Span) -> Self {
        Traits { degree: 1, speed_at: Some(at), ..Traits::default() }
    }

    /// Of a sum.
    pub fn plus(self, other: Traits) -> Traits {
        Traits {
            degree: self.degree.max(other.degree),
            // of two places the one that matters more
            speed_at: if other.degree > self.degree {
                other.speed_at
            } else {
                self.speed_at.or(other.speed_at)
            },
            moves: self.moves || other.moves,
            time: self.time || other.time,
            input: self.input.or(other.input),
        }
    }

    /// Of a product.
    pub fn times(self, other: Traits) -> Traits {
        let both = self.degree > 0 && other.degree > 0;
        let speed_at = if both { other.speed_at } else { self.speed_at.or(other.speed_at) };
        Traits { degree: (self.degree + other.degree).min(2), speed_at, ..self.plus(other) }
    }

    /// Of a function that is not linear.
    pub fn bent(self) -> Traits {
        Traits { degree: if self.degree == 0 { 0 } else { 2 }, ..self }
    }

    /// The same things mattered, but seen from another place: that is where a message must point.
    pub fn seen_from(self, at: Span) -> Traits {
        Traits { speed_at: self.speed_at.map(|_| at), input: self.input.map(|_| at), ..self }
    }

    /// With nothing more to be said about speeds and inputs.
    pub fn given(self) -> Traits {
        Traits { degree: 0, speed_at: None, input: None, ..self }
    }

    /// The time derivative of something free of speeds.
    pub fn derivative(self, at: Span) -> Traits {
        if self.moves { Traits { degree: 1, speed_at: Some(at), ..self } } else { self }
    }
}

/// A typed expression.
#[derive(Clone, Debug)]
pub struct Typed {
    /// the expression
    pub value: TypedValue,
    /// its dimension; `None` fits everything: the number 0, or a mistake that is reported already
    pub dimension: Option<Dimension>,
    /// the declarations from which the dimension comes
    pub provenance: Provenance,
    /// on what it depends
    pub traits: Traits,
    /// its value, if it is a constant scalar
    pub constant: Option<f64>,
    /// its exact value, if it is a rational constant of moderate size
    pub exact: Option<Number>,
    /// where it stands
    pub span: Span,
}

impl Typed {
    /// An expression that is already reported: it causes no further message.
    pub fn poison(span: Span) -> Self {
        let traits = Traits::default();
        Typed {
            value: TypedValue::Poison,
            dimension: None,
            provenance: Provenance::none(),
            traits,
            constant: None,
            exact: None,
            span,
        }
    }

    /// A scalar that is not constant.
    pub fn scalar(value: Scalar, dimension: Option<Dimension>, traits: Traits, span: Span) -> Self {
        Typed { value: TypedValue::Scalar(value), dimension, traits, ..Typed::poison(span) }
    }

    /// A vector.
    pub fn vector(value: Vector, dimension: Option<Dimension>, traits: Traits, span: Span) -> Self {
        Typed { value: TypedValue::Vector(value), dimension, traits, ..Typed::poison(span) }
    }

    /// A rational number.
    pub fn number(value: BigRational, span: Span) -> Self {
        let number = Number(value);
        let zero = number.is_zero();
        Typed {
            constant: Some(number.to_f64()),
            value: TypedValue::Scalar(Scalar::Number(number.clone())),
            dimension: if zero { None } else { Some(Dimension::none()) },
            exact: moderate(number),
            ..Typed::poison(span)
        }
    }

    /// The same, with a dimension that comes from these declarations.
    pub fn from(self, provenance: Provenance) -> Self {
        Typed { provenance, ..self }
    }

    /// Whether it is a mistake that is reported already.
    pub fn is_poison(&self) -> bool {
        matches!(self.value, TypedValue::Poison)
    }

    /// Whether it is the constant 0.
    pub fn is_zero(&self) -> bool {
        self.constant == Some(0.0)
    }
}

/// Exact arithmetic goes on with numbers of moderate size only.
pub fn moderate(number: Number) -> Option<Number> {
    let small = number.0.numer().bits() <= 512 && number.0.denom().bits() <= 512;
    small.then_some(number)
}
