//! The arithmetic operations of constructors, in numbers of twice the digits, under the same names as those
//! of `arithmetic`.
//!
//! Theory: docs/theory.md, section 16.4.

use super::arithmetic as usual;
use core::ops::{Add, Div, Mul, Neg, Sub};

use hodograph_arithmetic::{Component, DoubleDouble};
use nalgebra::{ComplexField, convert};

use crate::Scalar;

/// A number of twice the digits.
pub type Paired<T> = DoubleDouble<Usual<T>>;

/// A scalar in a type of this crate, so that a trait of another crate can be implemented for it.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
#[repr(transparent)]
pub struct Usual<T>(T);

macro_rules! operators {
    ($($operator:ident::$method:ident),*) => {$(
        impl<T: Scalar> $operator for Usual<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Usual($operator::$method(self.0, other.0))
            }
        }
    )*};
}

operators!(Add::add, Sub::sub, Mul::mul, Div::div);

impl<T: Scalar> Neg for Usual<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Usual(-self.0)
    }
}

impl<T: Scalar> Component for Usual<T> {
    #[inline(always)]
    fn zero() -> Self {
        Usual(T::zero())
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        ComplexField::is_finite(&self.0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Usual(ComplexField::sqrt(self.0))
    }
    /// 2^12 + 1 for singles, 2^27 + 1 for doubles: known while compiling.
    #[inline(always)]
    fn splitter() -> Self {
        let single = T::default_epsilon() > convert(1e-10);
        Usual(convert(if single { 4097.0 } else { 134217729.0 }))
    }
}

/// A literal of the program or a parameter, exactly.
#[inline]
pub fn exactly<T: Scalar>(number: T) -> Paired<T> {
    Paired::new(Usual(number))
}

/// The nearest scalar, for use in routines.
#[inline]
pub fn rounded<T: Scalar>(a: Paired<T>) -> T {
    a.rounded().0
}

/// a * b + c
pub fn mul_add<T: Scalar>(a: Paired<T>, b: Paired<T>, c: Paired<T>) -> Paired<T> {
    a * b + c
}

/// a * b - c
pub fn mul_sub<T: Scalar>(a: Paired<T>, b: Paired<T>, c: Paired<T>) -> Paired<T> {
    a * b - c
}

/// c - a * b
pub fn neg_mul_add<T: Scalar>(a: Paired<T>, b: Paired<T>, c: Paired<T>) -> Paired<T> {
    c - a * b
}

/// 1 / a
pub fn recip<T: Scalar>(a: Paired<T>) -> Paired<T> {
    exactly(T::one()) / a
}

/// Sine and cosine.
pub fn sin_cos<T: Scalar>(a: Paired<T>) -> (Paired<T>, Paired<T>) {
    let (sine, cosine) = usual::sin_cos(rounded(a));
    let (sine, cosine) = (Usual(sine), Usual(cosine));
    (a.function(sine, cosine), a.function(cosine, -sine))
}

/// Sine.
pub fn sin<T: Scalar>(a: Paired<T>) -> Paired<T> {
    sin_cos(a).0
}

/// Cosine.
pub fn cos<T: Scalar>(a: Paired<T>) -> Paired<T> {
    sin_cos(a).1
}

/// Square root.
pub fn sqrt<T: Scalar>(a: Paired<T>) -> Paired<T> {
    a.sqrt()
}

/// Magnitude.
pub fn abs<T: Scalar>(a: Paired<T>) -> Paired<T> {
    if rounded(a) < T::zero() { -a } else { a }
}

/// The lesser.
pub fn min<T: Scalar>(a: Paired<T>, b: Paired<T>) -> Paired<T> {
    if a.is_less(b) { a } else { b }
}

/// The greater.
pub fn max<T: Scalar>(a: Paired<T>, b: Paired<T>) -> Paired<T> {
    if b.is_less(a) { a } else { b }
}

macro_rules! of_the_nearest {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),*)),* $(,)?) => {$(
        $(#[$doc])*
        pub fn $name<T: Scalar>($($argument: Paired<T>),*) -> Paired<T> {
            exactly(usual::$name($(rounded($argument)),*))
        }
    )*};
}

of_the_nearest! {
    /// Tangent of the nearest number.
    tan(a),
    /// Arc sine of the nearest number.
    asin(a),
    /// Arc cosine of the nearest number.
    acos(a),
    /// Arc tangent of the nearest number.
    atan(a),
    /// Angle of the nearest (b, a).
    atan2(a, b),
    /// Exponential of the nearest number.
    exp(a),
    /// Natural logarithm of the nearest number.
    log(a),
    /// Hyperbolic sine of the nearest number.
    sinh(a),
    /// Hyperbolic cosine of the nearest number.
    cosh(a),
    /// Hyperbolic tangent of the nearest number.
    tanh(a),
    /// 1 if the nearest number is not negative, else -1.
    sign(a),
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of<T: Scalar>(number: T) -> Paired<T> {
        exactly(number)
    }

    #[test]
    fn what_one_number_cannot_hold_is_kept() {
        let (large, one) = (of(1e17), of(1.0));
        assert_eq!(rounded(large + one - large), 1.0);
        let (above, below) = (of(1.0 + f64::EPSILON), of(1.0 - f64::EPSILON));
        assert_eq!(rounded(mul_sub(above, below, one)), -f64::EPSILON * f64::EPSILON);
        let third = one / of(3.0);
        assert!(rounded(third * of(3.0) - one).abs() < 1e-31);
        let root = sqrt(of(2.0f64));
        assert!(rounded(root * root - of(2.0)).abs() < 1e-31);
        assert!(rounded(neg_mul_add(root, root, of(2.0))).abs() < 1e-31);
        let (large, one) = (of(1e9f32), of(1.0f32));
        assert_eq!(rounded(large + one - large), 1.0);
        assert!(rounded(recip(of(3.0f32)) * of(3.0) - one).abs() < 1e-13);
    }

    #[test]
    fn sines_know_what_their_angle_lost() {
        let angle = of(1.0) + of(1e-17);
        let (sine, cosine) = sin_cos(angle);
        assert!((rounded(sine - of(1f64.sin())) - 1e-17 * 1f64.cos()).abs() < 2e-16);
        assert!(rounded(sine * sine + cosine * cosine - of(1.0)).abs() < 4e-16);
        assert_eq!(rounded(sin(angle)), rounded(sine));
        assert_eq!(rounded(cos(angle)), rounded(cosine));
    }

    #[test]
    fn what_is_not_finite_stays_so() {
        let (zero, one) = (of(0.0), of(1.0));
        assert_eq!(rounded(one / zero), f64::INFINITY);
        assert_eq!(rounded(-one / zero + one), f64::NEG_INFINITY);
        assert!(rounded(zero / zero).is_nan() && rounded(sqrt(-one)).is_nan());
        assert_eq!(rounded(of(1e200) * of(1e200)), f64::INFINITY);
        assert_eq!((rounded(sqrt(zero)), rounded(zero * one)), (0.0, 0.0));
    }

    #[test]
    fn order_and_magnitude_see_both_halves() {
        let (one, more) = (of(1.0), of(1.0) + of(1e-20));
        assert!(one.is_less(more) && !more.is_less(one));
        assert_eq!(rounded(min(more, one) - one), 0.0);
        assert_eq!(rounded(max(one, more) - one), 1e-20);
        assert_eq!(rounded(abs(-more) - one), 1e-20);
        assert_eq!(rounded(sign(-one)), -1.0);
    }

    #[test]
    fn derivatives_go_through() {
        use num_dual::Dual64;
        let x = exactly(Dual64::new(0.7, 1.0));
        let one = exactly(Dual64::from(1.0));
        let value = rounded(sqrt(recip(x * x + one)) - x);
        let expected = (Dual64::new(0.7, 1.0).powi(2) + 1.0).recip().sqrt() - Dual64::new(0.7, 1.0);
        assert!((value.re - expected.re).abs() < 1e-15 && (value.eps - expected.eps).abs() < 1e-15);
    }

    /// Near both ends of the range the second part overflows or underflows; the usual digits must remain.
    #[test]
    fn numbers_of_any_size_keep_the_usual_digits() {
        let sizes =
            [0.0, 5e-324, 3e-310, 1.7e-308, 1e-292, 1e-154, 0.3, 7.0, 1.3e154, 1e200, 1.7e308, f64::MAX];
        let signed = || sizes.into_iter().flat_map(|size| [size, -size]);
        let same = |found: f64, expected: f64| found == expected || found.is_nan() && expected.is_nan();
        for a in signed() {
            for b in signed() {
                let (x, y) = (of(a), of(b));
                let found = [x + y, x - y, x * y, x / y, max(x, y)].map(rounded);
                for (found, expected) in found.into_iter().zip([a + b, a - b, a * b, a / b, a.max(b)]) {
                    assert!(same(found, expected), "{a:e} {b:e}: {found:e} {expected:e}");
                }
                assert!(!(a + b).is_finite() || rounded(x + y - x) == b, "{a:e} {b:e}");
                let (found, expected) = (rounded(mul_sub(x, y, x / y)), a * b - a / b);
                let near = same(found, expected) || (found - expected).abs() <= 1e-15 * expected.abs();
                assert!(near || expected.abs() < 1e-300, "{a:e} {b:e}: {found:e} {expected:e}");
            }
            let (found, expected) = (rounded(sqrt(of(a))), a.sqrt());
            assert!(
                same(found, expected) || (found - expected).abs() <= 3e-16 * expected,
                "{a:e}: {found:e}"
            );
        }
        for a in [1e-45f32, 2e-38, 0.3, 1e19, 3e38] {
            assert_eq!([of(a) * of(a), of(a) / of(a), sqrt(of(a))].map(rounded), [a * a, 1.0, a.sqrt()]);
        }
    }
}
