//! The arithmetic operations of generated code, for any number. For doubles they give the same bits as
//! `hodograph_generator::arithmetic`.

use hodograph_arithmetic::FUSED;
use hodograph_arithmetic::elementary::double;

use crate::Number;

/// A literal of the program.
#[inline(always)]
pub fn number<T: Number>(number: f64) -> T {
    T::number(number)
}

/// a * b + c, with one rounding where the feature `fused` is on and the target has the instruction (and never
/// by a library call).
#[inline(always)]
pub fn mul_add<T: Number>(a: T, b: T, c: T) -> T {
    if FUSED { a.fused(b, c) } else { a * b + c }
}

/// a * b - c, likewise.
#[inline(always)]
pub fn mul_sub<T: Number>(a: T, b: T, c: T) -> T {
    if FUSED { a.fused(b, -c) } else { a * b - c }
}

/// c - a * b, likewise.
#[inline(always)]
pub fn neg_mul_add<T: Number>(a: T, b: T, c: T) -> T {
    if FUSED { (-a).fused(b, c) } else { c - a * b }
}

/// The square root of x^2 + y^2, without overflow or underflow of the squares. Not by the system's library: it may
/// differ from machine to machine, and a program that calls it needs a recent one.
pub fn hypot(x: f64, y: f64) -> f64 {
    double::hypot(x, y)
}

/// 1 / a
#[inline(always)]
pub fn recip<T: Number>(a: T) -> T {
    T::one() / a
}

/// Sine and cosine. Those of doubles and singles are our own: faster than the system's, and the same
/// everywhere.
#[inline(always)]
pub fn sin_cos<T: Number>(a: T) -> (T, T) {
    a.sin_cos()
}

/// Sine.
#[inline(always)]
pub fn sin<T: Number>(a: T) -> T {
    sin_cos(a).0
}

/// Cosine.
#[inline(always)]
pub fn cos<T: Number>(a: T) -> T {
    sin_cos(a).1
}

/// The value itself, of which derived code takes no notice where it is differentiated.
#[inline(always)]
pub fn frozen<T: Number>(a: T) -> T {
    a
}

macro_rules! functions {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),+)),* $(,)?) => {$(
        $(#[$doc])*
        #[inline(always)]
        pub fn $name<T: Number>($($argument: T),+) -> T {
            Number::$name($($argument),+)
        }
    )*};
}

functions! {
    /// Square root: right to the last place everywhere.
    sqrt(a),
    /// Magnitude.
    abs(a),
    /// Tangent.
    tan(a),
    /// Arc sine.
    asin(a),
    /// Arc cosine.
    acos(a),
    /// Arc tangent.
    atan(a),
    /// Exponential.
    exp(a),
    /// Natural logarithm.
    log(a),
    /// Hyperbolic sine.
    sinh(a),
    /// Hyperbolic cosine.
    cosh(a),
    /// Hyperbolic tangent.
    tanh(a),
    /// Angle of (b, a).
    atan2(a, b),
    /// 1 if a is not negative, else -1.
    sign(a),
    /// The lesser.
    min(a, b),
    /// The greater.
    max(a, b),
}

/// A power with an exponent that is not negative, by squaring.
#[inline]
pub fn power<T: Number>(a: T, exponent: i32) -> T {
    let (mut left, mut square, mut product) = (exponent.unsigned_abs(), a, T::one());
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        left >>= 1;
        square *= square;
    }
    product
}
