//! The arithmetic operations of generated code, for any scalar. For doubles they give the same bits as
//! `hodograph_generator::arithmetic`.

use core::any::TypeId;

use hodograph_arithmetic::elementary::{double, single};
use hodograph_arithmetic::{FUSED, hyperbolic, trigonometry};
use nalgebra::{convert, convert_unchecked};

use crate::Scalar;

/// A literal of the program in the scalar type.
#[inline(always)]
pub fn number<T: Scalar>(number: f64) -> T {
    convert(number)
}

/// a * b + c, with one rounding where the feature `fused` is on and the target has the instruction (and never
/// by a library call).
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

/// The square root of x^2 + y^2, without overflow or underflow of the squares. Not by the system's library: it may
/// differ from machine to machine, and a program that calls it needs a recent one.
pub fn hypot(x: f64, y: f64) -> f64 {
    double::hypot(x, y)
}

/// 1 / a
#[inline(always)]
pub fn recip<T: Scalar>(a: T) -> T {
    T::one() / a
}

/// Sine and cosine. Those of doubles and singles are our own: faster than the system's, and the same
/// everywhere.
#[inline(always)]
pub fn sin_cos<T: Scalar>(a: T) -> (T, T) {
    // Known at compile time; the conversions of a number to itself vanish.
    if TypeId::of::<T>() == TypeId::of::<f64>() {
        let (sine, cosine) = trigonometry::sin_cos(a.to_subset_unchecked(), beyond);
        (convert(sine), convert(cosine))
    } else if TypeId::of::<T>() == TypeId::of::<f32>() {
        let (sine, cosine) = trigonometry::single::sin_cos(convert_unchecked::<T, f32>(a));
        (convert(sine), convert(cosine))
    } else {
        a.sin_cos()
    }
}

#[cold]
#[inline(never)]
fn beyond(a: f64) -> (f64, f64) {
    trigonometry::beyond(a)
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
    /// Square root: right to the last place everywhere.
    sqrt => sqrt,
    /// Magnitude.
    abs => abs,
}

/// Functions of one number: those of doubles (first module) and singles (second) are the same on every
/// machine, those of other numbers their own.
macro_rules! same_everywhere {
    ($($(#[$doc:meta])* $name:ident => $double:ident::$function:ident, $single:ident::$single_function:ident, $method:ident),* $(,)?) => {$(
        $(#[$doc])*
        #[inline]
        pub fn $name<T: Scalar>(a: T) -> T {
            // known at compile time, as for sine and cosine
            if TypeId::of::<T>() == TypeId::of::<f64>() {
                convert($double::$function(a.to_subset_unchecked()))
            } else if TypeId::of::<T>() == TypeId::of::<f32>() {
                convert($single::$single_function(convert_unchecked::<T, f32>(a)))
            } else {
                a.$method()
            }
        }
    )*};
}

same_everywhere! {
    /// Tangent.
    tan => double::tan, single::tan, tan,
    /// Arc sine.
    asin => double::asin, single::asin, asin,
    /// Arc cosine.
    acos => double::acos, single::acos, acos,
    /// Arc tangent.
    atan => double::atan, single::atan, atan,
    /// Exponential.
    exp => double::exp, single::exp, exp,
    /// Natural logarithm.
    log => double::ln, single::ln, ln,
    /// Hyperbolic sine.
    sinh => hyperbolic::sinh, single::sinh, sinh,
    /// Hyperbolic cosine.
    cosh => hyperbolic::cosh, single::cosh, cosh,
    /// Hyperbolic tangent.
    tanh => hyperbolic::tanh, single::tanh, tanh,
}

/// Angle of (b, a).
#[inline(always)]
pub fn atan2<T: Scalar>(a: T, b: T) -> T {
    if TypeId::of::<T>() == TypeId::of::<f64>() {
        convert(double::atan2(a.to_subset_unchecked(), b.to_subset_unchecked()))
    } else if TypeId::of::<T>() == TypeId::of::<f32>() {
        convert(single::atan2(convert_unchecked::<T, f32>(a), convert_unchecked::<T, f32>(b)))
    } else {
        a.atan2(b)
    }
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

/// A power with an exponent that is not negative, by squaring.
#[inline]
pub fn power<T: Scalar>(a: T, exponent: i32) -> T {
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
