//! The number type.

use nalgebra::{RealField, convert};

/// A real scalar the solver works in: `f64`, `f32`, or a dual number that carries derivatives.
///
/// Implemented for every `Copy` type with nalgebra's [`RealField`]; there is nothing to implement by hand.
pub trait Scalar: RealField + Copy {}

impl<T: RealField + Copy> Scalar for T {}

/// A constant of the method in the scalar type.
#[inline(always)]
pub(crate) fn constant<T: Scalar>(value: f64) -> T {
    convert(value)
}

/// `a * b + c`, fused only where the target has the instruction and the standard library reaches it.
#[inline(always)]
pub(crate) fn fma<T: Scalar>(a: T, b: T, c: T) -> T {
    if cfg!(all(feature = "std", target_feature = "fma")) { a.mul_add(b, c) } else { a * b + c }
}

/// The larger of two numbers, by comparison alone (no order is defined beyond `PartialOrd`).
#[inline(always)]
pub(crate) fn larger<T: Scalar>(a: T, b: T) -> T {
    if b > a { b } else { a }
}
