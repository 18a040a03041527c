//! Numbers of twice the digits, as unevaluated sums of two numbers (Dekker 1971). Constructors compute in them what depends on parameters only, and
//! round the result once.
//!
//! The relative error of products and quotients is a few units in the last of all places; that of sums is as many units relative to their terms. Rounding
//! errors are computed by arithmetic operations and not by manipulating bits, so that numbers that carry derivatives can be components.

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
    /// `self * a + b` with one rounding.
    fn mul_add(self, a: Self, b: Self) -> Self;
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
    fn mul_add(self, a: Self, b: Self) -> Self {
        f64::mul_add(self, a, b)
    }
}

/// `high + low`, where `low` is at most half a unit in the last place of `high`, and zero where `high` is not finite.
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
        let rest = (-near).mul_add(near, self.high) + self.low;
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
        // With one rounding on every target, even where that takes many operations: it is done once.
        let lost = self.high.mul_add(other.high, -high);
        DoubleDouble::of(high, lost + (self.high * other.low + self.low * other.high))
    }
}

impl<T: Component> Div for DoubleDouble<T> {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let near = self.high / other.high;
        let rest = (-near).mul_add(other.high, self.high) + (self.low - near * other.low);
        DoubleDouble::of(near, rest / other.high)
    }
}
