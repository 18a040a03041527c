//! Checks what a place in the model requires of an expression: to be a scalar or a vector, free of speeds,
//! linear in them, or to have a known rate.

use super::super::mechanism::{Scalar, Vector};
use super::super::typed::{Typed, TypedValue};
use super::Lowering;
use crate::diagnostics::{Diagnostic, codes};

impl Lowering<'_> {
    /// Demands a scalar.
    pub fn need_scalar(&mut self, typed: &Typed, what: &str) -> Option<Scalar> {
        self.places.wants(typed.span, None, Some(false), what);
        match &typed.value {
            TypedValue::Scalar(scalar) => Some(scalar.clone()),
            TypedValue::Poison => None,
            TypedValue::Vector(_) => {
                let message = format!("{what} must be a scalar, but this is a vector");
                let error = Diagnostic::new(codes::SCALAR_VECTOR, typed.span, message)
                    .help("take a component with `dot(v, A.x)` or the magnitude with `norm(v)`");
                self.report(error);
                None
            }
        }
    }

    /// Demands a vector; the number 0 is one.
    pub fn need_vector(&mut self, typed: &Typed, what: &str) -> Option<Vector> {
        self.places.wants(typed.span, None, Some(true), what);
        match &typed.value {
            TypedValue::Vector(vector) => Some(vector.clone()),
            TypedValue::Poison => None,
            TypedValue::Scalar(_) if typed.is_zero() => Some(Vector::Zero),
            TypedValue::Scalar(_) => {
                let message = format!("{what} must be a vector, but this is a scalar");
                let error = Diagnostic::new(codes::SCALAR_VECTOR, typed.span, message)
                    .help("multiply it by an axis, for instance `s*N.x`, or write `A.vec(a, b, c)`");
                self.report(error);
                None
            }
        }
    }

    /// Demands that no speed enters.
    pub fn need_free_of_speeds(&mut self, typed: &Typed, what: &str) {
        if typed.traits.degree > 0 {
            let message = format!("{what} must not depend on speeds");
            let mut error = Diagnostic::new(codes::SPEED_DEPENDENT, typed.span, message);
            match typed.traits.speed_at {
                Some(place) if place != typed.span => {
                    error = error.related(place, "this is or contains a speed")
                }
                _ => error = error.label("this is or contains a speed"),
            }
            self.report(error);
        }
    }

    /// Demands that its rate is known.
    pub fn need_rate(&mut self, typed: &Typed, what: &str) {
        if let Some(place) = typed.traits.input {
            let message = format!("{what} must not depend on an input, whose rate is not known");
            let error = Diagnostic::new(codes::INPUT_MOVES, typed.span, message)
                .help("prescribe motion by `time` and parameters, or by a coordinate with its speed");
            self.report(if place == typed.span {
                error.label("this is or contains an input")
            } else {
                error.related(place, "this is or contains an input")
            });
        }
    }

    /// Demands that speeds enter linearly at most.
    pub fn need_linear(&mut self, typed: &Typed, what: &str) {
        if typed.traits.degree > 1 {
            let message = format!("{what} must be linear in the speeds");
            let mut error = Diagnostic::new(codes::NOT_LINEAR, typed.span, message);
            match typed.traits.speed_at {
                Some(place) if place != typed.span => {
                    error = error.related(place, "this does not enter linearly")
                }
                _ => error = error.label("this does not enter linearly"),
            }
            error = error.help("each term may contain one speed at most, times a factor without speeds");
            self.report(error);
        }
    }
}
