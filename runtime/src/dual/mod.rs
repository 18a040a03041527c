//! Dual numbers: a value with its derivatives with respect to `N` inputs. The solver runs on them to
//! differentiate an outcome (forward mode).
//!
//! Theory: docs/theory.md, section 13.1.

mod operators;

use crate::{Scalar, scalar::Real};

/// A value and its partial derivatives. Comparisons use the value only, so that a calculation takes the same
/// branches as without derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<T, const N: usize> {
    pub value: T,
    pub partials: [T; N],
}

impl<T: Scalar, const N: usize> Dual<T, N> {
    /// A constant: all derivatives are zero.
    #[inline]
    pub fn fixed(value: T) -> Self {
        Self { value, partials: [T::zero(); N] }
    }

    /// The input with this index: its own derivative is one.
    #[inline]
    pub fn input(value: T, index: usize) -> Self {
        let mut dual = Self::fixed(value);
        if let Some(partial) = dual.partials.get_mut(index) {
            *partial = T::one();
        }
        dual
    }

    /// A function of this number, from its value and its derivative here.
    #[inline]
    fn chain(self, value: T, derivative: T) -> Self {
        Self { value, partials: self.partials.map(|p| p * derivative) }
    }
}

impl<T: Scalar, const N: usize> Real for Dual<T, N> {
    #[inline(always)]
    fn refined() -> bool {
        true
    }

    #[inline]
    fn constant(value: f64) -> Self {
        Self::fixed(nalgebra::convert(value))
    }
    #[inline]
    fn primal(self) -> Self {
        Self::fixed(self.value)
    }
    #[inline]
    fn default_epsilon() -> Self {
        Self::fixed(T::default_epsilon())
    }
    #[inline]
    fn is_finite(&self) -> bool {
        self.value.is_finite()
    }
    #[inline]
    fn abs(self) -> Self {
        if self.value < T::zero() { -self } else { self }
    }
    /// At zero, where the root has no derivative, the derivatives are set to zero.
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let derivative = if root > T::zero() { T::one() / (root + root) } else { T::zero() };
        self.chain(root, derivative)
    }
    #[inline]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    #[inline]
    fn exp_m1(self) -> Self {
        let value = self.value.exp_m1();
        self.chain(value, value + T::one())
    }
    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), T::one() / self.value)
    }
    #[inline]
    fn ln_1p(self) -> Self {
        self.chain(self.value.ln_1p(), T::one() / (self.value + T::one()))
    }
    #[inline]
    fn mul_add(self, a: Self, b: Self) -> Self {
        self * a + b
    }
}
