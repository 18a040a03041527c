//! Arithmetic and comparison of dual numbers.

use core::{
    array::from_fn,
    cmp::Ordering,
    ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign},
};

use num_traits::{One, Zero};

use super::Dual;
use crate::Scalar;

/// Both arrays entry by entry.
#[inline(always)]
fn both<T: Copy, const N: usize>(a: &[T; N], b: &[T; N], f: impl Fn(T, T) -> T) -> [T; N] {
    let mut out = *a;
    for (x, y) in out.iter_mut().zip(b) {
        *x = f(*x, *y);
    }
    out
}

impl<T: PartialEq, const N: usize> PartialEq for Dual<T, N> {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: PartialOrd, const N: usize> PartialOrd for Dual<T, N> {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
}

impl<T: Scalar, const N: usize> Add for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            partials: both(&self.partials, &other.partials, |a, b| a + b),
        }
    }
}

impl<T: Scalar, const N: usize> Sub for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            partials: both(&self.partials, &other.partials, |a, b| a - b),
        }
    }
}

impl<T: Scalar, const N: usize> Mul for Dual<T, N> {
    type Output = Self;
    #[inline]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "the product rule adds")]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self.value, other.value);
        Self { value: x * y, partials: both(&self.partials, &other.partials, |a, b| a * y + b * x) }
    }
}

impl<T: Scalar, const N: usize> Div for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let inverse = T::one() / other.value;
        Self { value, partials: both(&self.partials, &other.partials, |a, b| (a - b * value) * inverse) }
    }
}

impl<T: Scalar, const N: usize> Neg for Dual<T, N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, partials: self.partials.map(|p| -p) }
    }
}

impl<T: Scalar, const N: usize> AddAssign for Dual<T, N> {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar, const N: usize> SubAssign for Dual<T, N> {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Scalar, const N: usize> MulAssign for Dual<T, N> {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Scalar, const N: usize> DivAssign for Dual<T, N> {
    #[inline]
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl<T: Scalar, const N: usize> Zero for Dual<T, N> {
    #[inline]
    fn zero() -> Self {
        Self { value: T::zero(), partials: from_fn(|_| T::zero()) }
    }
    #[inline]
    fn is_zero(&self) -> bool {
        self.value == T::zero()
    }
}

impl<T: Scalar, const N: usize> One for Dual<T, N> {
    #[inline]
    fn one() -> Self {
        Self { value: T::one(), partials: from_fn(|_| T::zero()) }
    }
}
