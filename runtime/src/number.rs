//! The numbers of generated values and derivatives: one number, or several that undergo the same operations.

use core::{any::TypeId, ops::Neg};

use hodograph_arithmetic::elementary::{double, single};
use hodograph_arithmetic::{hyperbolic, trigonometry};
use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, convert, convert_unchecked,
};
use num_traits::{One, Zero};

use crate::scalar::same_everywhere;
use crate::{Scalar, StateError};

/// What the values and derivatives of a generated module are computed in: any [`Scalar`], or several doubles
/// at once (module `lanes`, feature of that name).
///
/// Methods of a mechanism that decide for each state what comes next, such as collisions, ask for a
/// [`Scalar`]. There is nothing to implement by hand.
pub trait Number:
    nalgebra::Scalar
    + Copy
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
{
    #[doc(hidden)]
    fn number(value: f64) -> Self;
    /// self * b + c with one rounding
    #[doc(hidden)]
    fn fused(self, b: Self, c: Self) -> Self;
    #[doc(hidden)]
    fn sqrt(self) -> Self;
    #[doc(hidden)]
    fn abs(self) -> Self;
    #[doc(hidden)]
    fn sin_cos(self) -> (Self, Self);
    /// Whether sines and cosines of several angles are computed together, as doubles.
    #[doc(hidden)]
    fn is_double() -> bool;
    #[doc(hidden)]
    fn to_double(self) -> f64;
    #[doc(hidden)]
    fn tan(self) -> Self;
    #[doc(hidden)]
    fn asin(self) -> Self;
    #[doc(hidden)]
    fn acos(self) -> Self;
    #[doc(hidden)]
    fn atan(self) -> Self;
    #[doc(hidden)]
    fn exp(self) -> Self;
    #[doc(hidden)]
    fn log(self) -> Self;
    #[doc(hidden)]
    fn sinh(self) -> Self;
    #[doc(hidden)]
    fn cosh(self) -> Self;
    #[doc(hidden)]
    fn tanh(self) -> Self;
    #[doc(hidden)]
    fn atan2(self, b: Self) -> Self;
    #[doc(hidden)]
    fn sign(self) -> Self;
    #[doc(hidden)]
    fn min(self, b: Self) -> Self;
    #[doc(hidden)]
    fn max(self, b: Self) -> Self;
    /// Whether a value (one of several) counts as zero beside its scale, or one of the two is NaN.
    #[doc(hidden)]
    fn vanishes_beside(self, scale: Self) -> bool;
    /// Whether a value (one of several) is zero or NaN.
    #[doc(hidden)]
    fn vanishes(self) -> bool;
    /// The error of a value (the first of several) that vanishes beside its scale.
    #[doc(hidden)]
    fn singular(self, scale: Self, what: &'static str) -> StateError;
}

/// A value counts as zero where it is at most this times its scale: 2^-40.
pub(crate) const VANISHING: f64 = 1.0 / (1u64 << 40) as f64;

/// Functions of one number.
macro_rules! functions {
    ($($name:ident => $double:path, $single:path, $method:ident;)*) => {$(
        #[inline(always)]
        fn $name(self) -> Self {
            same_everywhere(self, $double, $single, nalgebra::ComplexField::$method)
        }
    )*};
}

impl<T: Scalar> Number for T {
    #[inline(always)]
    fn number(value: f64) -> Self {
        convert(value)
    }

    #[inline(always)]
    fn fused(self, b: Self, c: Self) -> Self {
        nalgebra::ComplexField::mul_add(self, b, c)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        nalgebra::ComplexField::sqrt(self)
    }

    #[inline(always)]
    fn abs(self) -> Self {
        nalgebra::ComplexField::abs(self)
    }

    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        if Self::is_double() {
            let (sine, cosine) = trigonometry::sin_cos(self.to_double(), beyond);
            (convert(sine), convert(cosine))
        } else if TypeId::of::<T>() == TypeId::of::<f32>() {
            let (sine, cosine) = trigonometry::single::sin_cos(convert_unchecked::<T, f32>(self));
            (convert(sine), convert(cosine))
        } else {
            nalgebra::ComplexField::sin_cos(self)
        }
    }

    #[inline(always)]
    fn is_double() -> bool {
        TypeId::of::<T>() == TypeId::of::<f64>()
    }

    #[inline(always)]
    fn to_double(self) -> f64 {
        self.to_subset_unchecked()
    }

    functions! {
        tan => double::tan, single::tan, tan;
        asin => double::asin, single::asin, asin;
        acos => double::acos, single::acos, acos;
        atan => double::atan, single::atan, atan;
        exp => double::exp, single::exp, exp;
        log => double::ln, single::ln, ln;
        sinh => hyperbolic::sinh, single::sinh, sinh;
        cosh => hyperbolic::cosh, single::cosh, cosh;
        tanh => hyperbolic::tanh, single::tanh, tanh;
    }

    #[inline(always)]
    fn atan2(self, b: Self) -> Self {
        if Self::is_double() {
            convert(double::atan2(self.to_double(), b.to_double()))
        } else if TypeId::of::<T>() == TypeId::of::<f32>() {
            convert(single::atan2(convert_unchecked::<T, f32>(self), convert_unchecked::<T, f32>(b)))
        } else {
            nalgebra::RealField::atan2(self, b)
        }
    }

    #[inline(always)]
    fn sign(self) -> Self {
        if self >= T::zero() { T::one() } else { -T::one() }
    }

    #[inline(always)]
    fn min(self, b: Self) -> Self {
        if self < b { self } else { b }
    }

    #[inline(always)]
    fn max(self, b: Self) -> Self {
        if self > b { self } else { b }
    }

    #[inline(always)]
    fn vanishes_beside(self, scale: Self) -> bool {
        let size = |a: T| nalgebra::ComplexField::abs(a);
        let above = size(self) > convert::<f64, T>(VANISHING) * size(scale);
        !above && !is_infinite(self)
    }

    #[inline(always)]
    fn vanishes(self) -> bool {
        let above = nalgebra::ComplexField::abs(self) > T::zero();
        !above
    }

    fn singular(self, scale: Self, what: &'static str) -> StateError {
        let known = nalgebra::ComplexField::is_finite(&self) && nalgebra::ComplexField::is_finite(&scale);
        if known { StateError::Singular { what } } else { StateError::NotFinite }
    }
}

/// Whether a divisor is infinite. It is then large, not zero, and the quotient is 0; this is asked only where
/// the scale is infinite too.
#[cold]
#[inline(never)]
fn is_infinite<T: Scalar>(value: T) -> bool {
    nalgebra::ComplexField::abs(value) > T::zero() && !nalgebra::ComplexField::is_finite(&value)
}

#[cold]
#[inline(never)]
pub(crate) fn beyond(a: f64) -> (f64, f64) {
    trigonometry::beyond(a)
}
