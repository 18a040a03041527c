//! The arithmetic operations of generated code, for any scalar. For doubles they give the same bits as `hodograph_generator::arithmetic`.

use core::any::TypeId;

use hodograph_arithmetic::{FUSED, hyperbolic, trigonometry};
use nalgebra::{ComplexField, convert};

use crate::Scalar;

/// A literal of the program in the scalar type.
#[inline(always)]
pub fn number<T: Scalar>(number: f64) -> T {
    convert(number)
}

/// a * b + c, with one rounding where the target has the instruction (and never by a library call).
#[inline(always)]
pub fn mul_add<T: Scalar>(a: T, b: T, c: T) -> T {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// a * b - c, likewise.
#[inline(always)]
pub fn mul_sub<T: Scalar>(a: T, b: T, c: T) -> T {
    if FUSED { a.mul_add(b, -c) } else { a * b - c }
}

/// c - a * b, likewise.
#[inline(always)]
pub fn neg_mul_add<T: Scalar>(a: T, b: T, c: T) -> T {
    if FUSED { (-a).mul_add(b, c) } else { c - a * b }
}

/// 1 / a
#[inline(always)]
pub fn recip<T: Scalar>(a: T) -> T {
    T::one() / a
}

/// Sine and cosine. Those of doubles are our own: faster than the system's, and the same everywhere.
#[inline(always)]
pub fn sin_cos<T: Scalar>(a: T) -> (T, T) {
    // Known at compile time; the conversions of a double to a double vanish.
    if TypeId::of::<T>() == TypeId::of::<f64>() {
        let (sine, cosine) = trigonometry::sin_cos(a.to_subset_unchecked(), beyond);
        (convert(sine), convert(cosine))
    } else {
        a.sin_cos()
    }
}

#[cold]
#[inline(never)]
fn beyond(a: f64) -> (f64, f64) {
    ComplexField::sin_cos(a)
}

/// Sine.
#[inline(always)]
pub fn sin<T: Scalar>(a: T) -> T {
    sin_cos(a).0
}

/// Cosine.
#[inline(always)]
pub fn cos<T: Scalar>(a: T) -> T {
    sin_cos(a).1
}

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident => $method:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name<T: Scalar>(a: T) -> T {
            a.$method()
        }
    )*};
}

functions! {
    /// Tangent.
    tan => tan,
    /// Arc sine.
    asin => asin,
    /// Arc cosine.
    acos => acos,
    /// Arc tangent.
    atan => atan,
    /// Square root.
    sqrt => sqrt,
    /// Exponential.
    exp => exp,
    /// Natural logarithm.
    log => ln,
    /// Magnitude.
    abs => abs,
}

macro_rules! hyperbolic_functions {
    ($($(#[$doc:meta])* $name:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[inline]
        pub fn $name<T: Scalar>(a: T) -> T {
            // known at compile time, as for sine and cosine
            if TypeId::of::<T>() == TypeId::of::<f64>() {
                convert(hyperbolic::$name(a.to_subset_unchecked()))
            } else {
                a.$name()
            }
        }
    )*};
}

hyperbolic_functions! {
    /// Hyperbolic sine; that of doubles is our own, the same everywhere.
    sinh,
    /// Hyperbolic cosine, likewise.
    cosh,
    /// Hyperbolic tangent, likewise.
    tanh,
}

/// Angle of (b, a).
#[inline(always)]
pub fn atan2<T: Scalar>(a: T, b: T) -> T {
    a.atan2(b)
}

/// 1 if a is not negative, else -1.
#[inline(always)]
pub fn sign<T: Scalar>(a: T) -> T {
    if a >= T::zero() { T::one() } else { -T::one() }
}

/// The lesser.
#[inline(always)]
pub fn min<T: Scalar>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater.
#[inline(always)]
pub fn max<T: Scalar>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

/// A power with an exponent that is not negative.
#[inline]
pub fn power<T: Scalar>(a: T, exponent: i32) -> T {
    a.powi(exponent)
}
