//! Sines and cosines of several angles at once, in loops without branches that compilers turn into vector instructions.

use core::{any::TypeId, array::from_fn, hint::black_box};

use hodograph_arithmetic::trigonometry::{is_within, near_zero, reduced, turned};
use nalgebra::convert;

use super::arithmetic::sin_cos;
use crate::Scalar;

/// Whether the target has instructions that compute several doubles at once.
const VECTORS: bool = cfg!(any(
    target_feature = "sse2",
    target_feature = "neon",
    target_feature = "simd128",
    target_feature = "v"
));

/// Sines and cosines of up to eight angles, each the same bits as [`sin_cos`] gives.
#[inline(always)]
pub fn sines_cosines<T: Scalar, const N: usize>(angles: [T; N]) -> ([T; N], [T; N]) {
    // Known at compile time; the conversions of a double to a double vanish.
    if !VECTORS || TypeId::of::<T>() != TypeId::of::<f64>() {
        return one_by_one(angles);
    }
    let angles = angles.map(|angle| angle.to_subset_unchecked());
    let (sines, cosines) = match N {
        0 | 1 => one_by_one(angles),
        2 => filled::<N, 2>(angles),
        3 | 4 => filled::<N, 4>(angles),
        5..=8 => filled::<N, 8>(angles),
        _ => one_by_one(angles),
    };
    (sines.map(convert), cosines.map(convert))
}

/// `N` angles in `LANES` lanes (at least `N`); the last angle fills the lanes that are left over.
#[inline(always)]
fn filled<const N: usize, const LANES: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    let (sines, cosines) = of_doubles::<LANES>(from_fn(|lane| angles[lane.min(N - 1)]));
    (from_fn(|lane| sines[lane.min(LANES - 1)]), from_fn(|lane| cosines[lane.min(LANES - 1)]))
}

/// A function of its own: inside a long function, compilers do not vectorise all of the loops.
#[inline(never)]
fn of_doubles<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    if !angles.iter().fold(true, |within, &angle| within & is_within(angle)) {
        return beyond(angles);
    }
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    if N > UNROLLED {
        for lane in 0..N {
            let (r, low, turns) = reduced(angles[lane]);
            (sines[lane], cosines[lane]) = turned(near_zero(r, low), turns);
        }
        return (sines, cosines);
    }
    let (mut r, mut low, mut turns) = ([0.0; N], [0.0; N], [0; N]);
    for lane in 0..N {
        (r[lane], low[lane], turns[lane]) = reduced(angles[lane]);
    }
    let low = black_box(low);
    for lane in 0..N {
        (sines[lane], cosines[lane]) = near_zero(r[lane], low[lane]);
    }
    if N > 2 {
        (sines, cosines) = (black_box(sines), black_box(cosines));
    }
    for lane in 0..N {
        (sines[lane], cosines[lane]) = turned((sines[lane], cosines[lane]), turns[lane]);
    }
    (sines, cosines)
}

/// Compilers unroll loops of this many turns before they look for vector instructions, and then find these only up to a dozen operations before a store.
/// Intermediate results are therefore stored, which costs less than missing vector instructions would.
const UNROLLED: usize = 4;

#[cold]
#[inline(never)]
fn beyond<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    one_by_one(angles)
}

#[inline(always)]
fn one_by_one<T: Scalar, const N: usize>(angles: [T; N]) -> ([T; N], [T; N]) {
    let pairs = angles.map(sin_cos);
    (pairs.map(|(sine, _)| sine), pairs.map(|(_, cosine)| cosine))
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::vec::Vec;

    use super::*;

    fn one(angle: f64) -> (u64, u64) {
        let (s, c) = sin_cos(angle);
        (s.to_bits(), c.to_bits())
    }

    fn together<const N: usize>(angles: [f64; N]) -> [(u64, u64); N] {
        let (s, c) = sines_cosines(angles);
        from_fn(|lane| (s[lane].to_bits(), c[lane].to_bits()))
    }

    #[test]
    fn the_same_bits_as_one_by_one() {
        let near = (-400..400).map(|k| f64::from(k) * core::f64::consts::FRAC_PI_4);
        let spread = (0..100_000).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract() * 200.0 - 100.0);
        let all: Vec<f64> =
            near.chain(spread).chain([0.0, -0.0, 1e-300, -5e-324, 524_288.0, -524_287.5]).collect();
        for angles in all.chunks_exact(8) {
            let eight: [f64; 8] = angles.try_into().unwrap();
            assert_eq!(together(eight), eight.map(one), "{eight:?}");
            assert_eq!(together([eight[3]]), [one(eight[3])]);
            let [a, b, c, d, e, ..] = eight;
            assert_eq!(together([b, e]), [b, e].map(one), "{b} {e}");
            assert_eq!(together([c, a, d]), [c, a, d].map(one), "{c} {a} {d}");
            assert_eq!(together([d, b, e, a]), [d, b, e, a].map(one), "{d} {b} {e} {a}");
            assert_eq!(together([a, c, b, e, d]), [a, c, b, e, d].map(one), "{eight:?}");
        }
    }

    #[test]
    fn angles_beyond_the_reduction_and_other_numbers_go_one_by_one() {
        let (s, c) = sines_cosines([1e9, f64::INFINITY]);
        assert_eq!((s[0], c[0]), sin_cos(1e9));
        assert!(s[1].is_nan() && c[1].is_nan());
        let (s, c) = sines_cosines([0.3f32, 2.0]);
        assert_eq!((s[1], c[1]), sin_cos(2.0f32));
    }
}
