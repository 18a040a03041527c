//! The errors of generated routines.

use core::fmt;

use crate::{Cause, ComponentKind, ContactError, ImpactError};

/// Why a routine of a mechanism has no result in a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum StateError {
    /// The state is singular: a divisor is zero, or a matrix that must be inverted is singular.
    Singular {
        /// What is singular, in the names of the model.
        what: &'static str,
    },
    /// A number of the state, or of the result, is infinite or NaN.
    NotFinite,
    /// A slice is too long or too short.
    Length {
        /// What the slice holds.
        what: &'static str,
        /// How many numbers it must have.
        expected: usize,
        /// How many it has.
        found: usize,
    },
    /// The mechanism has no component of this kind with this number.
    Missing {
        /// The kind.
        kind: ComponentKind,
        /// The number, counted from 0.
        index: usize,
    },
    /// The model does not define this quantity.
    Undefined {
        /// The quantity.
        what: &'static str,
    },
}

impl StateError {
    /// Its cause, without the numbers.
    pub const fn cause(&self) -> Cause {
        match self {
            Self::Singular { .. } => Cause::SingularState,
            Self::NotFinite => Cause::NotFinite,
            Self::Length { .. } => Cause::WrongLength,
            Self::Missing { .. } => Cause::UnknownName,
            Self::Undefined { .. } => Cause::Undefined,
        }
    }

    /// A stable lower-case name.
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl fmt::Display for StateError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Singular { what } => write!(out, "the state is singular: {what}"),
            Self::NotFinite => {
                write!(
                    out,
                    "a number of the state, or a result, is infinite or not a number: it must be finite; check the state and the parameters for overflow"
                )
            }
            Self::Length { what, expected, found } => {
                write!(out, "the slice for {what} has {found} numbers: it must have {expected}")
            }
            Self::Missing { kind, index } => {
                write!(out, "there is no {} with the number {index} (they are counted from 0)", kind.noun())
            }
            Self::Undefined { what } => write!(out, "the model does not determine the {what}"),
        }
    }
}

impl core::error::Error for StateError {}

/// Why parameters are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ParameterError {
    /// A parameter, or something computed from parameters, is infinite or not a number.
    NotFinite {
        /// The parameter, the body or the shape.
        name: &'static str,
    },
    /// The mass of a body is zero or negative.
    Mass {
        /// The body.
        body: &'static str,
    },
    /// No body has this inertia: a principal moment is negative or greater than the sum of the other two.
    Inertia {
        /// The body.
        body: &'static str,
    },
    /// A quantity that must not be zero is zero.
    Singular {
        /// The quantity, in the names of the model.
        what: &'static str,
    },
    /// A dimension of a shape is zero or negative.
    Size {
        /// The shape.
        shape: &'static str,
        /// The dimension: radius, length or the like.
        dimension: &'static str,
    },
    /// The slice of parameters is too long or too short.
    Length {
        /// How many parameters the mechanism has.
        expected: usize,
        /// How many were given.
        found: usize,
    },
}

impl ParameterError {
    /// Its cause, without the numbers.
    pub const fn cause(&self) -> Cause {
        match self {
            Self::NotFinite { .. } => Cause::NotFinite,
            Self::Mass { .. } => Cause::ImpossibleMass,
            Self::Inertia { .. } => Cause::ImpossibleInertia,
            Self::Singular { .. } => Cause::SingularParameters,
            Self::Size { .. } => Cause::ImpossibleSize,
            Self::Length { .. } => Cause::WrongLength,
        }
    }

    /// A stable lower-case name.
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl fmt::Display for ParameterError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { name } => {
                write!(out, "`{name}` is infinite or not a number: it must be finite")
            }
            Self::Mass { body } => write!(out, "the mass of `{body}` is not positive"),
            Self::Inertia { body } => write!(
                out,
                "no body has the inertia of `{body}`: its moments must not be negative, and none greater than the sum of the others"
            ),
            Self::Singular { what } => write!(out, "the parameters are singular: {what}"),
            Self::Size { shape, dimension } => write!(out, "the {dimension} of `{shape}` is not positive"),
            Self::Length { expected, found } => {
                write!(out, "{found} parameters are given: the mechanism has {expected}")
            }
        }
    }
}

impl core::error::Error for ParameterError {}

impl From<StateError> for ParameterError {
    fn from(error: StateError) -> Self {
        match error {
            StateError::Singular { what } => Self::Singular { what },
            StateError::Length { expected, found, .. } => Self::Length { expected, found },
            StateError::Undefined { what } => Self::Singular { what },
            StateError::NotFinite | StateError::Missing { .. } => {
                Self::NotFinite { name: "a value that depends on parameters alone" }
            }
        }
    }
}

/// Why a collision of a mechanism has no outcome.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CollisionError<T> {
    /// The state is singular or not finite.
    State(StateError),
    /// The collision cannot be solved.
    Impact(ImpactError<T>),
}

impl<T> CollisionError<T> {
    /// Its cause, without the numbers.
    pub const fn cause(&self) -> Cause {
        match self {
            Self::State(error) => error.cause(),
            Self::Impact(error) => error.cause(),
        }
    }

    /// A stable lower-case name.
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl<T: fmt::Debug + fmt::Display> fmt::Display for CollisionError<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(error) => error.fmt(out),
            Self::Impact(error) => error.fmt(out),
        }
    }
}

impl<T: fmt::Debug + fmt::Display + 'static> core::error::Error for CollisionError<T> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::State(error) => Some(error),
            Self::Impact(error) => Some(error),
        }
    }
}

impl<T> From<StateError> for CollisionError<T> {
    fn from(error: StateError) -> Self {
        Self::State(error)
    }
}

impl<T> From<ImpactError<T>> for CollisionError<T> {
    fn from(error: ImpactError<T>) -> Self {
        Self::Impact(error)
    }
}

/// Why a closed contact of a mechanism has no force.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ClosedContactError<T> {
    /// The state is singular or not finite.
    State(StateError),
    /// No finite force agrees with Coulomb's law.
    Contact(ContactError<T>),
}

impl<T> ClosedContactError<T> {
    /// Its cause, without the numbers.
    pub const fn cause(&self) -> Cause {
        match self {
            Self::State(error) => error.cause(),
            Self::Contact(error) => error.cause(),
        }
    }

    /// A stable lower-case name.
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl<T: fmt::Debug + fmt::Display> fmt::Display for ClosedContactError<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::State(error) => error.fmt(out),
            Self::Contact(error) => error.fmt(out),
        }
    }
}

impl<T: fmt::Debug + fmt::Display + 'static> core::error::Error for ClosedContactError<T> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::State(error) => Some(error),
            Self::Contact(error) => Some(error),
        }
    }
}

impl<T> From<StateError> for ClosedContactError<T> {
    fn from(error: StateError) -> Self {
        Self::State(error)
    }
}

impl<T> From<ContactError<T>> for ClosedContactError<T> {
    fn from(error: ContactError<T>) -> Self {
        Self::Contact(error)
    }
}
