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
        if <T as Real>::refined() { convert(convert_unchecked::<T, f64>(self)) } else { self }
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

/// What the formulas of the solver ask of a number: any [`Real`], or the numbers of several collisions that undergo the
/// same operations (`lanes`). Comparisons give a [`Mask`], by which each lane chooses its own case.
pub(crate) trait Arithmetic:
    nalgebra::Scalar
    + Copy
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
    type Mask: Mask;
    /// Whether this holds several numbers.
    const SEVERAL: bool;

    /// One bit for each number, that of the first the lowest.
    #[cfg(feature = "lanes")]
    fn bits(holds: Self::Mask) -> u32;
    fn refined() -> bool;
    fn constant(value: f64) -> Self;
    fn primal(self) -> Self;
    fn default_epsilon() -> Self;
    fn abs(self) -> Self;
    fn sqrt(self) -> Self;
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// self < other
    fn below(self, other: Self) -> Self::Mask;
    /// Whether it is a finite number.
    fn has_end(self) -> Self::Mask;
    /// self <= other
    fn at_most(self, other: Self) -> Self::Mask;
    /// One number computes the case that holds. Of several, all compute both.
    fn choose(holds: Self::Mask, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self;
    fn choose_all<const N: usize>(
        holds: Self::Mask,
        yes: impl FnOnce() -> [Self; N],
        no: impl FnOnce() -> [Self; N],
    ) -> [Self; N];
    /// The numbers of an iteration after one more step: of one number, which would not go on if it had ended, these are the
    /// new ones; of several, those that have ended before keep the old ones.
    fn iterated<const N: usize>(
        goes_on: Self::Mask,
        new: impl FnOnce() -> [Self; N],
        old: [Self; N],
    ) -> [Self; N];
}

/// The numbers of several collisions, which are loaded and stored together.
#[cfg(feature = "lanes")]
pub(crate) trait Together: Arithmetic {
    /// How many.
    const COUNT: usize;
    /// From the number of each.
    fn each(number: impl FnMut(usize) -> f64) -> Self;
    /// The number of one of them.
    fn of(self, place: usize) -> f64;
    /// From numbers of each that stand in memory: they are loaded by fours.
    fn load<'n, const N: usize>(numbers: impl Fn(usize) -> &'n [f64; N]) -> [Self; N];
    /// Gives the numbers of each.
    fn store<const N: usize>(numbers: &[Self; N], to: impl FnMut(usize, [f64; N]));
}

/// What holds for a number, or for each of several.
pub(crate) trait Mask: Copy {
    fn all() -> Self;
    /// Whether it holds for any of them.
    fn any(self) -> bool;
    /// One number computes the second only where the first holds.
    fn and(self, other: impl FnOnce() -> Self) -> Self;
    fn or(self, other: impl FnOnce() -> Self) -> Self;
    fn not(self) -> Self;
    fn select(self, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self;
}

impl Mask for bool {
    #[inline(always)]
    fn all() -> Self {
        true
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn and(self, other: impl FnOnce() -> Self) -> Self {
        self && other()
    }
    #[inline(always)]
    fn or(self, other: impl FnOnce() -> Self) -> Self {
        self || other()
    }
    #[inline(always)]
    fn not(self) -> Self {
        !self
    }
    #[inline(always)]
    fn select(self, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self {
        if self { yes() } else { no() }
    }
}

impl<T: Real> Arithmetic for T {
    type Mask = bool;
    const SEVERAL: bool = false;

    #[cfg(feature = "lanes")]
    #[inline(always)]
    fn bits(holds: bool) -> u32 {
        u32::from(holds)
    }
    #[inline(always)]
    fn refined() -> bool {
        <T as Real>::refined()
    }
    #[inline(always)]
    fn constant(value: f64) -> Self {
        <T as Real>::constant(value)
    }
    #[inline(always)]
    fn primal(self) -> Self {
        Real::primal(self)
    }
    #[inline(always)]
    fn default_epsilon() -> Self {
        <T as Real>::default_epsilon()
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Real::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Real::sqrt(self)
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Real::mul_add(self, a, b)
    }
    #[inline(always)]
    fn has_end(self) -> bool {
        Real::is_finite(&self)
    }
    #[inline(always)]
    fn below(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn at_most(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn choose(holds: bool, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self {
        if holds { yes() } else { no() }
    }
    #[inline(always)]
    fn choose_all<const N: usize>(
        holds: bool,
        yes: impl FnOnce() -> [Self; N],
        no: impl FnOnce() -> [Self; N],
    ) -> [Self; N] {
        if holds { yes() } else { no() }
    }
    #[inline(always)]
    fn iterated<const N: usize>(_: bool, new: impl FnOnce() -> [Self; N], _: [Self; N]) -> [Self; N] {
        new()
    }
}

/// [`Arithmetic::choose_all`] where cases cost much: of one number the case that holds is computed, of several each case
/// that holds for one of them.
///
/// A macro: cases that are closures may become functions of their own, which a collision would call.
macro_rules! decide {
    ($number:ident: $holds:expr, $yes:expr, $no:expr $(,)?) => {{
        let holds = $holds;
        if <$number as $crate::scalar::Arithmetic>::SEVERAL {
            let yes = if $crate::scalar::Mask::any(holds) { $yes } else { $crate::scalar::nothing() };
            let no = if $crate::scalar::Mask::any($crate::scalar::Mask::not(holds)) {
                $no
            } else {
                $crate::scalar::nothing()
            };
            <$number as $crate::scalar::Arithmetic>::choose_all(holds, || yes, || no)
        } else if $crate::scalar::Mask::any(holds) {
            $yes
        } else {
            $no
        }
    }};
}
pub(crate) use decide;

/// What [`decide`] has where a case holds for none.
#[inline(always)]
pub(crate) fn nothing<T: Arithmetic, const N: usize>() -> [T; N] {
    [T::zero(); N]
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
pub(crate) fn constant<T: Arithmetic>(value: f64) -> T {
    T::constant(value)
}

/// `a * b + c`, fused only with the feature of that name and where the target has the instruction: else every
/// target computes the same bits.
#[inline(always)]
pub(crate) fn fma<T: Arithmetic>(a: T, b: T, c: T) -> T {
    if cfg!(all(feature = "fused", target_feature = "fma")) { a.mul_add(b, c) } else { a * b + c }
}

/// `a * b + c * d`, of which one product is rounded.
#[inline(always)]
pub(crate) fn dot<T: Arithmetic>(a: T, b: T, c: T, d: T) -> T {
    fma(a, b, c * d)
}

/// The larger of two numbers, by comparison alone (no order is defined beyond `PartialOrd`).
#[inline(always)]
pub(crate) fn larger<T: Arithmetic>(a: T, b: T) -> T {
    T::choose(a.below(b), || b, || a)
}

/// The smaller of two numbers, likewise.
#[inline(always)]
pub(crate) fn smaller<T: Arithmetic>(a: T, b: T) -> T {
    T::choose(b.below(a), || b, || a)
}

/// [`Arithmetic::choose`] of vectors in the contact plane.
#[inline(always)]
pub(crate) fn either<T: Arithmetic>(
    holds: T::Mask,
    yes: impl FnOnce() -> Vector2<T>,
    no: impl FnOnce() -> Vector2<T>,
) -> Vector2<T> {
    let [x, y] = T::choose_all(holds, || yes().into(), || no().into());
    Vector2::new(x, y)
}

/// The direction of a vector in the contact plane and its length, also where the squares of its components are
/// too large or too small to be numbers; `None` of zero.
pub(crate) fn direction<T: Scalar>(v: &Vector2<T>) -> Option<(Vector2<T>, T)> {
    let size = larger(v.x.abs(), v.y.abs());
    if size.is_zero() {
        return None;
    }
    let whole = length(v);
    if whole.is_finite() && size * size * T::default_epsilon() > T::zero() {
        return Some((v / whole, whole));
    }
    let scaled = v / size;
    let part = length(&scaled);
    Some((scaled / part, part * size))
}

/// The length of a vector in the contact plane.
#[inline(always)]
pub(crate) fn length<T: Arithmetic>(v: &Vector2<T>) -> T {
    dot(v.x, v.x, v.y, v.y).sqrt()
}
