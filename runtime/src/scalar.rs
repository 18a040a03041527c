//! The number type.

use core::{
    any::TypeId,
    fmt::Debug,
    ops::{AddAssign, DivAssign, MulAssign, Neg, SubAssign},
};

use hodograph_arithmetic::elementary::{double, single};
use nalgebra::{
    ClosedAddAssign, ClosedDivAssign, ClosedMulAssign, ClosedSubAssign, RealField, Vector2, convert,
    convert_unchecked,
};
use num_traits::{One, Zero};

use crate::Law;

/// A real scalar the solver works in: `f64`, `f32`, or a dual number that carries derivatives.
///
/// Implemented for every `Copy` type with nalgebra's [`RealField`]; there is nothing to implement by hand.
pub trait Scalar: RealField + Copy {}

impl<T: RealField + Copy> Scalar for T {}

/// The little that the solver itself asks of a number: all of [`Scalar`], and the crate's own dual numbers,
/// which cannot have nalgebra's [`RealField`] because one of its parents has unsafe methods.
pub(crate) trait Real:
    Copy
    + PartialOrd
    + Debug
    + Send
    + Sync
    + 'static
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + ClosedDivAssign
    + AddAssign
    + SubAssign
    + MulAssign
    + DivAssign
{
    /// The law of restitution of all collisions of this number type, where there is but one.
    const LAW: Option<Law> = None;
    /// Whether the solver becomes a part of the routine that calls it. Else its longer functions are shared by
    /// all contacts.
    const INLINED: bool = false;

    /// Whether the numbers may carry derivatives: then iterations go on until these have settled too.
    fn refined() -> bool;

    fn constant(value: f64) -> Self;
    /// The value without its derivatives.
    fn primal(self) -> Self;
    fn default_epsilon() -> Self;
    fn is_finite(&self) -> bool;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn exp(self) -> Self;
    fn exp_m1(self) -> Self;
    fn ln(self) -> Self;
    fn ln_1p(self) -> Self;
    fn mul_add(self, a: Self, b: Self) -> Self;
}

impl<T: RealField + Copy> Real for T {
    /// Known while compiling.
    #[inline(always)]
    fn refined() -> bool {
        let this = TypeId::of::<T>();
        this != TypeId::of::<f64>() && this != TypeId::of::<f32>()
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        convert(value)
    }
    #[inline(always)]
    fn primal(self) -> Self {
        if T::refined() { convert(convert_unchecked::<T, f64>(self)) } else { self }
    }
    #[inline(always)]
    fn default_epsilon() -> Self {
        T::default_epsilon()
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        nalgebra::ComplexField::is_finite(self)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        nalgebra::ComplexField::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        nalgebra::ComplexField::sqrt(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        same_everywhere(self, double::exp, single::exp, nalgebra::ComplexField::exp)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        same_everywhere(self, double::exp_m1, single::exp_m1, nalgebra::ComplexField::exp_m1)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        same_everywhere(self, double::ln, single::ln, nalgebra::ComplexField::ln)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        same_everywhere(self, double::ln_1p, single::ln_1p, nalgebra::ComplexField::ln_1p)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        nalgebra::ComplexField::mul_add(self, a, b)
    }
}

/// A function of doubles or singles that does not depend on the system, or that of other numbers: which, is
/// known while compiling.
#[inline(always)]
pub(crate) fn same_everywhere<T: Scalar>(
    a: T,
    double: fn(f64) -> f64,
    single: fn(f32) -> f32,
    other: fn(T) -> T,
) -> T {
    let this = TypeId::of::<T>();
    if this == TypeId::of::<f64>() {
        convert(double(convert_unchecked::<T, f64>(a)))
    } else if this == TypeId::of::<f32>() {
        convert(single(convert_unchecked::<T, f32>(a)))
    } else {
        other(a)
    }
}

/// A constant of the method in the scalar type.
#[inline(always)]
pub(crate) fn constant<T: Real>(value: f64) -> T {
    T::constant(value)
}

/// `a * b + c`, fused only with the feature of that name and where the target has the instruction: else every
/// target computes the same bits.
#[inline(always)]
pub(crate) fn fma<T: Real>(a: T, b: T, c: T) -> T {
    if cfg!(all(feature = "fused", target_feature = "fma")) { a.mul_add(b, c) } else { a * b + c }
}

/// `a * b + c * d`, of which one product is rounded.
#[inline(always)]
pub(crate) fn dot<T: Real>(a: T, b: T, c: T, d: T) -> T {
    fma(a, b, c * d)
}

/// The larger of two numbers, by comparison alone (no order is defined beyond `PartialOrd`).
#[inline(always)]
pub(crate) fn larger<T: Real>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

/// The smaller of two numbers, likewise.
#[inline(always)]
pub(crate) fn smaller<T: Real>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

/// The length of a vector in the contact plane.
#[inline(always)]
pub(crate) fn length<T: Real>(v: &Vector2<T>) -> T {
    dot(v.x, v.x, v.y, v.y).sqrt()
}
