//! Sines and cosines of several angles at once, in loops without branches that compilers turn into vector
//! instructions.

use core::{array::from_fn, hint::black_box};

use hodograph_arithmetic::trigonometry::{is_within, near_zero, reduced, turned};

use super::arithmetic::sin_cos;
use crate::Number;

/// Whether the target has instructions that compute several doubles at once.
const VECTORS: bool = cfg!(any(
    target_feature = "sse2",
    target_feature = "neon",
    target_feature = "simd128",
    target_feature = "v"
));

/// Sines and cosines of up to eight angles, each the same bits as [`sin_cos`] gives.
#[inline(always)]
pub fn sines_cosines<T: Number, const N: usize>(angles: [T; N]) -> ([T; N], [T; N]) {
    several::<T, N, false>(angles)
}

/// [`sines_cosines`] as a part of the caller.
#[inline(always)]
pub fn sines_cosines_inlined<T: Number, const N: usize>(angles: [T; N]) -> ([T; N], [T; N]) {
    several::<T, N, true>(angles)
}

/// Sines and cosines, with `HERE` as a part of the caller.
#[inline(always)]
fn several<T: Number, const N: usize, const HERE: bool>(angles: [T; N]) -> ([T; N], [T; N]) {
    // Known at compile time; the conversions of a double to a double vanish.
    if !VECTORS || !T::is_double() {
        return one_by_one(angles);
    }
    let angles = angles.map(|angle| angle.to_double());
    let angle = |lane: usize| angles[lane.min(N - 1)];
    let (sines, cosines) = match N {
        0 | 1 => one_by_one(angles),
        2 if HERE => first(of_doubles([angle(0), angle(1)], far::<T, 2>)),
        3 | 4 if HERE => first(of_doubles(from_fn(angle), far::<T, 4>)),
        5..=8 if HERE => first(of_doubles(from_fn(angle), far::<T, 8>)),
        2 => first(of_two(angle(0), angle(1))),
        3 | 4 => first(of_four(angle(0), angle(1), angle(2), angle(3))),
        5..=8 => {
            first(of_eight(angle(0), angle(1), angle(2), angle(3), angle(4), angle(5), angle(6), angle(7)))
        }
        _ => one_by_one(angles),
    };
    (sines.map(T::number), cosines.map(T::number))
}

/// The first `N` of `LANES` sines and cosines.
#[inline(always)]
fn first<const N: usize, const LANES: usize>(
    (sines, cosines): ([f64; LANES], [f64; LANES]),
) -> ([f64; N], [f64; N]) {
    (from_fn(|lane| sines[lane.min(LANES - 1)]), from_fn(|lane| cosines[lane.min(LANES - 1)]))
}

// The angles are arguments of their own, which come in registers. In an array the caller would store one
// after the other, and a processor cannot load a vector from several stores before all of them, and
// everything in front of them, are done.

#[inline(never)]
fn of_two(a: f64, b: f64) -> ([f64; 2], [f64; 2]) {
    of_doubles([a, b], beyond)
}

#[inline(never)]
fn of_four(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    of_doubles([a, b, c, d], beyond)
}

#[inline(never)]
#[allow(clippy::too_many_arguments, reason = "as many as there are registers")]
fn of_eight(a: f64, b: f64, c: f64, d: f64, e: f64, f: f64, g: f64, h: f64) -> ([f64; 8], [f64; 8]) {
    of_doubles([a, b, c, d, e, f, g, h], beyond)
}

/// Part of functions of their own: inside a long function, compilers do not vectorise all of the loops.
#[inline(always)]
fn of_doubles<const N: usize>(
    angles: [f64; N],
    beyond: impl FnOnce([f64; N]) -> ([f64; N], [f64; N]),
) -> ([f64; N], [f64; N]) {
    // Of two angles the sum is looked at: one comparison.
    let within = match angles[..] {
        [a, b] => is_within(a.abs() + b.abs()),
        _ => angles.iter().fold(true, |within, &angle| within & is_within(angle)),
    };
    if !within {
        // A copy: what is only in registers otherwise need not be stored.
        return beyond(black_box(angles));
    }
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    if N > UNROLLED {
        for lane in 0..N {
            let (r, low, shifted) = reduced(angles[lane]);
            (sines[lane], cosines[lane]) = turned(near_zero(r, low), shifted.to_bits());
        }
        return (sines, cosines);
    }
    let (mut r, mut low, mut shifted) = ([0.0; N], [0.0; N], [0.0; N]);
    for lane in 0..N {
        (r[lane], low[lane], shifted[lane]) = reduced(angles[lane]);
    }
    let low = black_box(low);
    for lane in 0..N {
        (sines[lane], cosines[lane]) = near_zero(r[lane], low[lane]);
    }
    if N > 2 {
        (sines, cosines) = (black_box(sines), black_box(cosines));
    }
    for lane in 0..N {
        (sines[lane], cosines[lane]) = turned((sines[lane], cosines[lane]), shifted[lane].to_bits());
    }
    (sines, cosines)
}

/// Compilers unroll loops of this many turns before they look for vector instructions, and then find these
/// only up to a dozen operations before a store. Intermediate results are therefore stored, which costs less
/// than missing vector instructions would.
const UNROLLED: usize = 4;

#[cold]
#[inline(never)]
fn beyond<const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    one_by_one(angles)
}

/// [`beyond`], compiled with the routine that calls it.
#[cold]
#[inline(never)]
#[expect(clippy::extra_unused_type_parameters, reason = "functions without are compiled with this package")]
fn far<T: Number, const N: usize>(angles: [f64; N]) -> ([f64; N], [f64; N]) {
    one_by_one(angles)
}

#[inline(always)]
fn one_by_one<T: Number, const N: usize>(angles: [T; N]) -> ([T; N], [T; N]) {
    let (mut sines, mut cosines) = (angles, angles);
    for (sine, cosine) in sines.iter_mut().zip(&mut cosines) {
        (*sine, *cosine) = sin_cos(*sine);
    }
    (sines, cosines)
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
