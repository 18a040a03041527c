//! The numbers of a specialised collision: those of the caller, of another type.

use core::{
    any::TypeId,
    cmp::Ordering,
    marker::PhantomData,
    ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign},
};

use hodograph_arithmetic::elementary::inlined::{double, single};
use nalgebra::{convert, convert_unchecked};
use num_traits::{One, Zero};

use super::known_law::KnownLaw;
use crate::{Law, Scalar, scalar::Real};

/// A number of the type `T` over which the solver becomes part of its caller, under a law that `L` knows.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub(super) struct Inlined<T, L> {
    pub value: T,
    law: PhantomData<L>,
}

impl<T, L> Inlined<T, L> {
    #[inline(always)]
    pub const fn of(value: T) -> Self {
        Self { value, law: PhantomData }
    }
}

/// A function of doubles or singles as a part of the caller, where it has an answer, else that of the number;
/// which of the two number types it is, is known while compiling. No function that takes functions: these
/// need not become parts of it.
macro_rules! inlined {
    ($function:ident of $a:expr) => {{
        let (a, this) = ($a, TypeId::of::<T>());
        if this == TypeId::of::<f64>()
            && let Some(value) = double::$function(convert_unchecked::<T, f64>(a))
        {
            Self::of(convert(value))
        } else if this == TypeId::of::<f32>()
            && let Some(value) = single::$function(convert_unchecked::<T, f32>(a))
        {
            Self::of(convert(value))
        } else {
            Self::of(rarely(a, Real::$function))
        }
    }};
}

/// A function of an argument for which there is no shorter one.
#[cold]
#[inline(never)]
fn rarely<T: Scalar>(a: T, function: impl FnOnce(T) -> T) -> T {
    function(a)
}

impl<T: Scalar, L: KnownLaw> Real for Inlined<T, L> {
    const LAW: Option<Law> = L::LAW;
    const INLINED: bool = true;

    #[inline(always)]
    fn refined() -> bool {
        <T as Real>::refined()
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self::of(T::constant(value))
    }
    #[inline(always)]
    fn primal(self) -> Self {
        Self::of(self.value.primal())
    }
    #[inline(always)]
    fn default_epsilon() -> Self {
        Self::of(<T as Real>::default_epsilon())
    }
    #[inline(always)]
    fn is_finite(&self) -> bool {
        Real::is_finite(&self.value)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self::of(Real::abs(self.value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::of(Real::sqrt(self.value))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        inlined!(exp of self.value)
    }
    #[inline(always)]
    fn exp_m1(self) -> Self {
        inlined!(exp_m1 of self.value)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        inlined!(ln of self.value)
    }
    #[inline(always)]
    fn ln_1p(self) -> Self {
        inlined!(ln_1p of self.value)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self::of(Real::mul_add(self.value, a.value, b.value))
    }
}

macro_rules! operators {
    ($($operator:ident $method:ident, $assignment:ident $assign:ident;)*) => {$(
        impl<T: Scalar, L> $operator for Inlined<T, L> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::of($operator::$method(self.value, other.value))
            }
        }

        impl<T: Scalar, L> $assignment for Inlined<T, L> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                $assignment::$assign(&mut self.value, other.value);
            }
        }
    )*};
}

operators! {
    Add add, AddAssign add_assign;
    Sub sub, SubAssign sub_assign;
    Mul mul, MulAssign mul_assign;
    Div div, DivAssign div_assign;
}

impl<T: Scalar, L> Neg for Inlined<T, L> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::of(-self.value)
    }
}

impl<T: Scalar, L> PartialEq for Inlined<T, L> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

impl<T: Scalar, L> PartialOrd for Inlined<T, L> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        self.value.partial_cmp(&other.value)
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        self.value < other.value
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.value <= other.value
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        self.value > other.value
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        self.value >= other.value
    }
}

impl<T: Scalar, L> Zero for Inlined<T, L> {
    #[inline(always)]
    fn zero() -> Self {
        Self::of(T::zero())
    }
    #[inline(always)]
    fn is_zero(&self) -> bool {
        self.value.is_zero()
    }
}

impl<T: Scalar, L> One for Inlined<T, L> {
    #[inline(always)]
    fn one() -> Self {
        Self::of(T::one())
    }
}
