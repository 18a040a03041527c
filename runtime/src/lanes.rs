//! Several doubles at once: a generated module computes values and derivatives of four or eight states by
//! the instructions of one.
//!
//! ```ignore
//! use hodograph::lanes::{F64x4, Lanes};
//!
//! let four = Pendulum::<F64x4>::from_lanes(|_| pendulum); // one machine for all lanes, or one for each
//! let q = Coordinates::<F64x4>::from_lanes(|lane| states[lane].0);
//! let u = Speeds::<F64x4>::from_lanes(|lane| states[lane].1);
//! let rates = four.accelerations(&q, &u)?; // of four states
//! let third = rates.lane(2); // Speeds<f64>
//! ```
//!
//! Each lane has the bits that the same call with `f64` gives. A method fails where one of its lanes fails;
//! which one it is, and what the others answer, calls for single states tell. Collisions, forces of closed
//! contacts and their derivatives decide for each state what comes next: they ask for a [`Scalar`]. Many collisions
//! are solved by [`solve_each`].
//!
//! How many doubles a register holds is known while compiling: two on every x86-64 and AArch64 processor, four with
//! `-C target-cpu=x86-64-v3`, eight with `x86-64-v4`. Where there are fewer than lanes, several registers are used.
//!
//! [`Scalar`]: crate::Scalar

use core::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Sub, SubAssign};

use hodograph_arithmetic::FUSED;
use hodograph_arithmetic::trigonometry::{self, Doubles, LARGEST, near_zero, reduced};
use nalgebra::Vector3;
use num_traits::{One, Zero};
use wide::bytemuck::cast;
use wide::{Select, f64x4, f64x8, u64x4, u64x8};

use crate::number::{VANISHING, beyond};
use crate::{Impact, ImpactError, Number, ReducedMatrix, StateError, Surface};

/// Several doubles that undergo the same operations.
pub trait Lanes: Number {
    /// How many.
    const COUNT: usize;
    /// From the number of each lane.
    fn from_lanes(number: impl FnMut(usize) -> f64) -> Self;
    /// From the numbers of each lane.
    fn gather<const N: usize>(numbers: impl FnMut(usize) -> [f64; N]) -> [Self; N];
    /// The number of a lane; of the last one past it.
    fn lane(self, lane: usize) -> f64;
}

/// A function of doubles, lane by lane.
macro_rules! by_lane {
    ($($name:ident)*) => {$(
        #[inline]
        fn $name(self) -> Self {
            self.map(Number::$name)
        }
    )*};
}

/// What holds for each lane: all bits of a number that it holds for are set.
#[derive(Clone, Copy)]
pub(crate) struct Holds<F>(F);

macro_rules! lanes {
    ($(#[$doc:meta])* $name:ident $of:ident $bits:ident $count:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name($of);

        impl $name {
            /// The numbers of the lanes.
            #[inline(always)]
            #[must_use]
            pub fn to_array(self) -> [f64; $count] {
                self.0.to_array()
            }

            #[inline(always)]
            fn map(self, f: impl Fn(f64) -> f64) -> Self {
                Self::from(self.to_array().map(f))
            }

            #[inline(always)]
            fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
                let (a, b) = (self.to_array(), other.to_array());
                Self::from(core::array::from_fn(|lane| f(a[lane], b[lane])))
            }

            /// Angles of which one is too large, infinite or no number.
            #[cold]
            #[inline(never)]
            fn one_by_one(self) -> (Self, Self) {
                let both = self.to_array().map(|angle| trigonometry::sin_cos(angle, beyond));
                (Self::from(both.map(|(sine, _)| sine)), Self::from(both.map(|(_, cosine)| cosine)))
            }

            #[cold]
            #[inline(never)]
            fn one_vanishes_beside(self, scale: Self) -> bool {
                self.to_array().iter().zip(scale.to_array()).any(|(value, scale)| value.vanishes_beside(scale))
            }
        }

        impl From<[f64; $count]> for $name {
            #[inline(always)]
            fn from(numbers: [f64; $count]) -> Self {
                Self($of::new(numbers))
            }
        }

        impl From<f64> for $name {
            #[inline(always)]
            fn from(number: f64) -> Self {
                Self($of::splat(number))
            }
        }

        impl Lanes for $name {
            const COUNT: usize = $count;
            #[inline(always)]
            fn from_lanes(number: impl FnMut(usize) -> f64) -> Self {
                Self::from(core::array::from_fn::<f64, $count, _>(number))
            }
            #[inline(always)]
            fn gather<const N: usize>(numbers: impl FnMut(usize) -> [f64; N]) -> [Self; N] {
                let lanes: [[f64; N]; $count] = core::array::from_fn(numbers);
                let mut all = [Self::zero(); N];
                let (fours, rest) = all.as_chunks_mut::<4>();
                for (place, four) in fours.iter_mut().enumerate() {
                    let of_lane = |lane: usize| lanes[lane].as_chunks::<4>().0[place];
                    *four = Self::transposed(of_lane);
                }
                let first = N - rest.len();
                for (place, one) in rest.iter_mut().enumerate() {
                    *one = Self::from(lanes.each_ref().map(|lane| lane[first + place]));
                }
                all
            }
            #[inline(always)]
            fn lane(self, lane: usize) -> f64 {
                self.to_array()[lane.min($count - 1)]
            }
        }

        impl crate::scalar::Arithmetic for $name {
            type Mask = Holds<$of>;
            const SEVERAL: bool = true;

            #[inline(always)]
            fn bits(holds: Self::Mask) -> u32 {
                holds.0.to_bitmask()
            }
            #[inline(always)]
            fn refined() -> bool {
                false
            }
            #[inline(always)]
            fn constant(value: f64) -> Self {
                Self::from(value)
            }
            #[inline(always)]
            fn primal(self) -> Self {
                self
            }
            #[inline(always)]
            fn default_epsilon() -> Self {
                Self::from(f64::EPSILON)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                Self(self.0.mul_add(a.0, b.0))
            }
            #[inline(always)]
            fn has_end(self) -> Self::Mask {
                Holds(self.0.abs().simd_lt($of::splat(f64::INFINITY)))
            }
            #[inline(always)]
            fn below(self, other: Self) -> Self::Mask {
                Holds(self.0.simd_lt(other.0))
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> Self::Mask {
                Holds(self.0.simd_le(other.0))
            }
            #[inline(always)]
            fn choose(holds: Self::Mask, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self {
                Self(Select::select(holds.0, yes().0, no().0))
            }
            #[inline(always)]
            fn choose_all<const N: usize>(
                holds: Self::Mask,
                yes: impl FnOnce() -> [Self; N],
                no: impl FnOnce() -> [Self; N],
            ) -> [Self; N] {
                let (yes, no) = (yes(), no());
                core::array::from_fn(|place| Self::choose(holds, || yes[place], || no[place]))
            }
            #[inline(always)]
            fn iterated<const N: usize>(
                goes_on: Self::Mask,
                new: impl FnOnce() -> [Self; N],
                old: [Self; N],
            ) -> [Self; N] {
                Self::choose_all(goes_on, new, || old)
            }
        }

        impl crate::scalar::Mask for Holds<$of> {
            #[inline(always)]
            fn all() -> Self {
                Self($of::splat(0.0).simd_eq($of::splat(0.0)))
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.0.any()
            }
            #[inline(always)]
            fn and(self, other: impl FnOnce() -> Self) -> Self {
                Self(self.0 & other().0)
            }
            #[inline(always)]
            fn or(self, other: impl FnOnce() -> Self) -> Self {
                Self(self.0 | other().0)
            }
            #[inline(always)]
            fn not(self) -> Self {
                Self(self.0 ^ <Self as crate::scalar::Mask>::all().0)
            }
            #[inline(always)]
            fn select(self, yes: impl FnOnce() -> Self, no: impl FnOnce() -> Self) -> Self {
                Self(Select::select(self.0, yes().0, no().0))
            }
        }

        impl crate::scalar::Together for $name {
            const COUNT: usize = $count;

            #[inline(always)]
            fn each(number: impl FnMut(usize) -> f64) -> Self {
                Lanes::from_lanes(number)
            }
            #[inline(always)]
            fn of(self, place: usize) -> f64 {
                self.lane(place)
            }
            #[inline(always)]
            fn load<'n, const N: usize>(numbers: impl Fn(usize) -> &'n [f64; N]) -> [Self; N] {
                let lanes: [&[f64; N]; $count] = core::array::from_fn(numbers);
                let mut all = [Self::zero(); N];
                let (fours, rest) = all.as_chunks_mut::<4>();
                for (place, four) in fours.iter_mut().enumerate() {
                    *four = Self::transposed(|lane| lanes[lane].as_chunks::<4>().0[place]);
                }
                let first = N - rest.len();
                for (place, one) in rest.iter_mut().enumerate() {
                    *one = Self::from(lanes.map(|lane| lane[first + place]));
                }
                all
            }
            #[inline(always)]
            fn store<const N: usize>(numbers: &[Self; N], mut to: impl FnMut(usize, [f64; N])) {
                let mut lanes = [[0.0; N]; $count];
                let (fours, rest) = numbers.as_chunks::<4>();
                for (place, four) in fours.iter().enumerate() {
                    Self::rows(four, |lane, row| lanes[lane].as_chunks_mut::<4>().0[place] = row);
                }
                let first = N - rest.len();
                for (place, one) in rest.iter().enumerate() {
                    for (lane, number) in lanes.iter_mut().zip(one.to_array()) {
                        lane[first + place] = number;
                    }
                }
                for (lane, row) in lanes.into_iter().enumerate() {
                    to(lane, row);
                }
            }
        }

        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(self.0 ^ $of::splat(-0.0))
            }
        }

        lanes!(operator $name Add add AddAssign add_assign +);
        lanes!(operator $name Sub sub SubAssign sub_assign -);
        lanes!(operator $name Mul mul MulAssign mul_assign *);
        lanes!(operator $name Div div DivAssign div_assign /);

        impl Zero for $name {
            #[inline(always)]
            fn zero() -> Self {
                Self::from(0.0)
            }
            #[inline(always)]
            fn is_zero(&self) -> bool {
                *self == Self::zero()
            }
        }

        impl One for $name {
            #[inline(always)]
            fn one() -> Self {
                Self::from(1.0)
            }
        }

        impl Doubles for $name {
            #[inline(always)]
            fn all(value: f64) -> Self {
                Self::from(value)
            }
            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                if FUSED { self.fused(b, c) } else { self * b + c }
            }
        }

        impl Number for $name {
            #[inline(always)]
            fn number(value: f64) -> Self {
                Self::from(value)
            }

            /// The library's `mul_add` rounds once where [`FUSED`] holds, and is asked nowhere else.
            #[inline(always)]
            fn fused(self, b: Self, c: Self) -> Self {
                Self(self.0.mul_add(b.0, c.0))
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }

            #[inline(always)]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }

            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                if !self.0.abs().simd_le($of::splat(LARGEST)).all() {
                    return self.one_by_one();
                }
                let (r, low, shifted) = reduced(self);
                let (sine, cosine) = near_zero(r, low);
                // `trigonometry::turned`, for all lanes
                let (turns, sine, cosine): ($bits, $bits, $bits) = (cast(shifted.0), cast(sine.0), cast(cosine.0));
                let (one, two) = ($bits::splat(1), $bits::splat(2));
                let exchanged = (sine ^ cosine) & ($bits::splat(0) - (turns & one));
                let sign = |turns: $bits| (turns & two) << 62_u32;
                let sine: $of = cast(sine ^ exchanged ^ sign(turns));
                let cosine: $of = cast(cosine ^ exchanged ^ sign(turns + one));
                (Self(sine + $of::splat(0.0)), Self(cosine))
            }

            #[inline(always)]
            fn is_double() -> bool {
                false
            }

            /// Not asked: lanes are no single double.
            #[inline(always)]
            fn to_double(self) -> f64 {
                self.lane(0)
            }

            by_lane! { tan asin acos atan exp log sinh cosh tanh }

            #[inline]
            fn atan2(self, b: Self) -> Self {
                self.zip(b, Number::atan2)
            }

            #[inline(always)]
            fn sign(self) -> Self {
                let (one, less) = ($of::splat(1.0), $of::splat(-1.0));
                Self(self.0.simd_ge($of::splat(0.0)).bitselect(one, less))
            }

            #[inline(always)]
            fn min(self, b: Self) -> Self {
                Self(self.0.simd_lt(b.0).bitselect(self.0, b.0))
            }

            #[inline(always)]
            fn max(self, b: Self) -> Self {
                Self(self.0.simd_gt(b.0).bitselect(self.0, b.0))
            }

            #[inline(always)]
            fn vanishes_beside(self, scale: Self) -> bool {
                let above = self.0.abs().simd_gt($of::splat(VANISHING) * scale.0.abs());
                !above.all() && self.one_vanishes_beside(scale)
            }

            #[inline(always)]
            fn vanishes(self) -> bool {
                !self.0.abs().simd_gt($of::splat(0.0)).all()
            }

            fn singular(self, scale: Self, what: &'static str) -> StateError {
                let failed = self.to_array().into_iter().zip(scale.to_array());
                let first = failed.into_iter().find(|(value, scale)| value.vanishes_beside(*scale));
                first.map_or(StateError::NotFinite, |(value, scale)| value.singular(scale, what))
            }
        }
    };
    (operator $name:ident $trait:ident $method:ident $assigning:ident $assign:ident $operator:tt) => {
        impl $trait for $name {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0 $operator other.0)
            }
        }
        impl $assigning for $name {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    };
}

lanes! {
    /// Four doubles.
    F64x4 f64x4 u64x4 4
}
lanes! {
    /// Eight doubles.
    F64x8 f64x8 u64x8 8
}

impl F64x4 {
    /// Four numbers of each lane.
    #[inline(always)]
    fn transposed(of_lane: impl Fn(usize) -> [f64; 4]) -> [Self; 4] {
        f64x4::transpose(core::array::from_fn(|lane| f64x4::new(of_lane(lane)))).map(Self)
    }

    /// The four numbers of each lane.
    #[inline(always)]
    fn rows(four: &[Self; 4], mut row: impl FnMut(usize, [f64; 4])) {
        for (lane, numbers) in f64x4::transpose(four.map(|one| one.0)).into_iter().enumerate() {
            row(lane, numbers.to_array());
        }
    }
}

impl F64x8 {
    /// Four numbers of each lane.
    #[inline(always)]
    fn transposed(of_lane: impl Fn(usize) -> [f64; 4]) -> [Self; 4] {
        let (low, high) = (F64x4::transposed(&of_lane), F64x4::transposed(|lane| of_lane(lane + 4)));
        core::array::from_fn(|place| Self(cast([low[place].0, high[place].0])))
    }

    /// The four numbers of each lane.
    #[inline(always)]
    fn rows(four: &[Self; 4], mut row: impl FnMut(usize, [f64; 4])) {
        let halves: [[f64x4; 2]; 4] = four.map(|one| cast(one.0));
        F64x4::rows(&halves.map(|[low, _]| F64x4(low)), &mut row);
        F64x4::rows(&halves.map(|[_, high]| F64x4(high)), |lane, numbers| row(lane + 4, numbers));
    }
}

/// Numbers as many of which a register holds as the target allows, four at least.
#[cfg(target_feature = "avx512f")]
type Widest = F64x8;
#[cfg(not(target_feature = "avx512f"))]
type Widest = F64x4;

/// Solves many collisions, several of them by the instructions of one: [`crate::solve`] for each, with its bits and its
/// errors, in less time.
///
/// `answer` is called once for each collision, with its place in the order of `collisions`; the calls come in any order.
pub fn solve_each(
    collisions: impl IntoIterator<Item = (ReducedMatrix<f64>, Vector3<f64>, Surface<f64>)>,
    answer: impl FnMut(usize, Result<Impact<f64>, ImpactError<f64>>),
) {
    crate::solve::solve_together::<Widest>(collisions, answer);
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;
    use crate::generated;

    /// Numbers of all kinds, with those at which something changes.
    fn numbers() -> Vec<f64> {
        let spread = (0..4000).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract() * 200.0 - 100.0);
        let right = (-40..40).map(|k| f64::from(k) * core::f64::consts::FRAC_PI_4);
        let edges = [0.0, -0.0, 1.0, -1.0, 5e-324, -1e-300, 524_288.0, -524_287.5, 524_289.0, 1e9, 1e300];
        let not = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
        spread.chain(right).chain(edges).chain(not).chain([0.5, 2.0]).collect()
    }

    fn the_same(found: f64, expected: f64) -> bool {
        found.to_bits() == expected.to_bits() || found.is_nan() && expected.is_nan()
    }

    fn every_operation_of<L: Lanes + Doubles>() {
        let all = numbers();
        let count = all.len();
        let at = |first: usize, step: usize| move |lane: usize| (first + lane * step) % count;
        for first in 0..count {
            let [place, other, third] = [at(first, 1), at(first, 7), at(first, 613)];
            let [a, b, c] = [&place, &other, &third].map(|place| L::from_lanes(|lane| all[place(lane)]));
            let one = |name: &str, found: L, expected: &dyn Fn(f64, f64, f64) -> f64| {
                for lane in 0..L::COUNT {
                    let [x, y, z] = [all[place(lane)], all[other(lane)], all[third(lane)]];
                    let (found, expected) = (found.lane(lane), expected(x, y, z));
                    assert!(the_same(found, expected), "{name} of {x:e} {y:e} {z:e}: {found:e} {expected:e}");
                }
            };
            one("sum", a + b, &|x, y, _| x + y);
            one("difference", a - b, &|x, y, _| x - y);
            one("product", a * b, &|x, y, _| x * y);
            one("quotient", a / b, &|x, y, _| x / y);
            one("opposite", -a, &|x, _, _| -x);
            one("mul_add", generated::mul_add(a, b, c), &|x, y, z| generated::mul_add(x, y, z));
            one("mul_sub", generated::mul_sub(a, b, c), &|x, y, z| generated::mul_sub(x, y, z));
            one("neg_mul_add", generated::neg_mul_add(a, b, c), &|x, y, z| generated::neg_mul_add(x, y, z));
            one("sine", generated::sin(a), &|x, _, _| generated::sin(x));
            one("cosine", generated::cos(a), &|x, _, _| generated::cos(x));
            one("tangent", generated::tan(a), &|x, _, _| generated::tan(x));
            one("arc tangent", generated::atan2(a, b), &|x, y, _| generated::atan2(x, y));
            one("root", generated::sqrt(a), &|x, _, _| generated::sqrt(x));
            one("size", generated::abs(a), &|x, _, _| generated::abs(x));
            one("sign", generated::sign(a), &|x, _, _| generated::sign(x));
            one("lesser", generated::min(a, b), &|x, y, _| generated::min(x, y));
            one("greater", generated::max(a, b), &|x, y, _| generated::max(x, y));
            one("power", generated::power(a, 5), &|x, _, _| generated::power(x, 5));
            let any = |vanishes: &dyn Fn(f64, f64) -> bool| {
                (0..L::COUNT).any(|lane| vanishes(all[place(lane)], all[other(lane)]))
            };
            assert_eq!(generated::vanishes(a), any(&|x, _| generated::vanishes(x)));
            assert_eq!(generated::vanishes_beside(a, b), any(&generated::vanishes_beside::<f64>));
            assert_eq!(generated::all_finite([a, b]), !any(&|x, y| !generated::all_finite([x, y])));
        }
    }

    #[test]
    fn four_lanes_have_the_bits_of_doubles() {
        every_operation_of::<F64x4>();
    }

    #[test]
    fn eight_lanes_have_the_bits_of_doubles() {
        every_operation_of::<F64x8>();
    }

    #[test]
    fn lanes_are_gathered_in_order() {
        fn gathered<L: Lanes, const N: usize>() {
            let number = |lane: usize, place: usize| (100 * lane + place) as f64;
            let all: [L; N] = L::gather(|lane| core::array::from_fn(|place| number(lane, place)));
            for (place, lanes) in all.iter().enumerate() {
                assert!((0..L::COUNT).all(|lane| lanes.lane(lane) == number(lane, place)), "{place}");
            }
        }
        gathered::<F64x4, 0>();
        gathered::<F64x4, 3>();
        gathered::<F64x4, 4>();
        gathered::<F64x4, 11>();
        gathered::<F64x8, 1>();
        gathered::<F64x8, 9>();
    }

    /// The error is that of the first lane that vanishes.
    #[test]
    fn the_error_is_that_of_a_lane() {
        let what = "a divisor";
        let scale = F64x4::from(1.0);
        let error = |numbers: [f64; 4]| generated::singular(F64x4::from(numbers), scale, what);
        assert_eq!(error([1.0, 0.0, f64::NAN, 1.0]), StateError::Singular { what });
        assert_eq!(error([1.0, f64::NAN, 0.0, 1.0]), StateError::NotFinite);
    }
}
