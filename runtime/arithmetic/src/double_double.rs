//! Numbers of twice the digits, as unevaluated sums of two numbers (Dekker 1971). Constructors compute in
//! them what depends on parameters only, and round the result once.
//!
//! The relative error of products and quotients is a few units in the last of all places; that of sums is as
//! many units relative to their terms. Rounding errors are computed by arithmetic operations and not by
//! manipulating bits, so that numbers that carry derivatives can be components.

use core::ops::{Add, Div, Mul, Neg, Sub};

/// The operations that a component needs.
pub trait Component:
    Copy
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// 0
    fn zero() -> Self;
    /// Whether it is neither infinite nor NaN.
    fn is_finite(&self) -> bool;
    /// Square root.
    fn sqrt(self) -> Self;
    /// 2^k + 1 for numbers of 2k or 2k - 1 binary digits: it splits a number into two halves whose products
    /// are exact.
    fn splitter() -> Self;
}

#[cfg(feature = "std")]
impl Component for f64 {
    fn zero() -> Self {
        0.0
    }
    fn is_finite(&self) -> bool {
        f64::is_finite(*self)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn splitter() -> Self {
        134217729.0
    }
}

/// `high + low`, where `low` is at most half a unit in the last place of `high`, and zero where `high` is not
/// finite.
#[derive(Clone, Copy, Debug)]
pub struct DoubleDouble<T> {
    high: T,
    low: T,
}

/// The rounding error of `high = a + b` (Knuth 1969).
fn lost<T: Component>(a: T, b: T, high: T) -> T {
    let of_b = high - a;
    let of_a = high - of_b;
    (a - of_a) + (b - of_b)
}

/// A number as the sum of two of half the digits (Veltkamp 1968).
fn split<T: Component>(a: T) -> (T, T) {
    let shifted = a * T::splitter();
    let high = shifted - (shifted - a);
    (high, a - high)
}

/// What rounding took from `product = a * b` (Dekker 1971), without fused operations, which some targets have
/// in software only. Not finite where a factor is so large that it cannot be split.
#[inline(never)]
fn lost_of_product<T: Component>(a: T, b: T, product: T) -> T {
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
}

impl<T: Component> DoubleDouble<T> {
    /// An exact number.
    pub fn new(high: T) -> Self {
        DoubleDouble { high, low: T::zero() }
    }

    /// `high + low`, where `low` is small.
    fn of(high: T, low: T) -> Self {
        if !low.is_finite() {
            return DoubleDouble::new(high);
        }
        let sum = high + low;
        DoubleDouble { high: sum, low: low - (sum - high) }
    }

    /// The nearest number of the component type.
    pub fn rounded(self) -> T {
        self.high
    }

    /// A function of this number, from its value and slope at [`DoubleDouble::rounded`].
    pub fn function(self, value: T, slope: T) -> Self {
        DoubleDouble::of(value, slope * self.low)
    }

    /// Whether it is less than another.
    pub fn is_less(self, other: Self) -> bool {
        self.high < other.high || (self.high == other.high && self.low < other.low)
    }

    /// Its square root.
    pub fn sqrt(self) -> Self {
        let near = self.high.sqrt();
        let square = near * near;
        let rest = (self.high - square - lost_of_product(near, near, square)) + self.low;
        // At zero the slope is infinite: the correction is not finite and is left out.
        DoubleDouble::of(near, rest / (near + near))
    }
}

impl<T: Component> Add for DoubleDouble<T> {
    type Output = Self;
    // Not inlined: constructors are long, and run once.
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let high = self.high + other.high;
        DoubleDouble::of(high, lost(self.high, other.high, high) + (self.low + other.low))
    }
}

impl<T: Component> Neg for DoubleDouble<T> {
    type Output = Self;
    fn neg(self) -> Self {
        DoubleDouble { high: -self.high, low: -self.low }
    }
}

impl<T: Component> Sub for DoubleDouble<T> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<T: Component> Mul for DoubleDouble<T> {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let high = self.high * other.high;
        let lost = lost_of_product(self.high, other.high, high);
        DoubleDouble::of(high, lost + (self.high * other.low + self.low * other.high))
    }
}

impl<T: Component> Div for DoubleDouble<T> {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let near = self.high / other.high;
        let product = near * other.high;
        let rest = (self.high - product - lost_of_product(near, other.high, product))
            + (self.low - near * other.low);
        DoubleDouble::of(near, rest / other.high)
    }
}
