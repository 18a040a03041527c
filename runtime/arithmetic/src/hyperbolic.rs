//! Hyperbolic functions of a double, to two units in the last place, the same bits on every machine.
//!
//! All three are computed from e^a - 1, which keeps its digits for small a. a is reduced by a multiple of log
//! 2, which is stored in two parts; for the remainder, at most log(2)/2 in size, a Taylor series of twelve
//! terms has an error below 2^-55. No operation is fused and no function of the system is called, so that the
//! bits do not depend on machine or standard library.

/// 1.5 * 2^52: adding it rounds to an integer, whose last bits are then those of the sum.
const ROUNDER: f64 = 6755399441055744.0;
/// log 2 in two parts; the first has 42 bits, so that its products with a multiple up to 2^11 are exact.
const LOG_2: [f64; 2] = [0.6931471805598903, 5.497923018708371e-14];
/// Beyond, e^-2a is less than half a unit in the last place of 1.
const LARGE: f64 = 22.0;
/// Beyond, e^a / 2 is infinite.
const LARGEST: f64 = 710.5;

/// 1/2!, 1/3!, .. 1/13!: e^r is 1 + r + r^2 (1/2! + r/3! + ..).
const TAYLOR: [f64; 12] = [
    1.0 / 2.0,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40320.0,
    1.0 / 362880.0,
    1.0 / 3628800.0,
    1.0 / 39916800.0,
    1.0 / 479001600.0,
    1.0 / 6227020800.0,
];

/// Hyperbolic sine.
#[inline(never)]
pub fn sinh(x: f64) -> f64 {
    let a = x.abs();
    let size = if a > LARGE {
        half_exponential(a)
    } else {
        let t = exp_m1(a);
        0.5 * (t + t / (t + 1.0))
    };
    size.copysign(x)
}

/// Hyperbolic cosine.
#[inline(never)]
pub fn cosh(x: f64) -> f64 {
    let a = x.abs();
    if a > LARGE {
        return half_exponential(a);
    }
    let t = exp_m1(a);
    let e = t + 1.0;
    if t < 0.5 { 1.0 + t * t / (e + e) } else { 0.5 * e + 0.5 / e }
}

/// Hyperbolic tangent: from -1 to 1 for every argument.
#[inline(never)]
pub fn tanh(x: f64) -> f64 {
    let a = x.abs();
    if a > LARGE {
        return 1f64.copysign(x);
    }
    let t = exp_m1(a + a);
    (t / (t + 2.0)).copysign(x)
}

/// e^a = 2^n (1 + p): p and n, for a from 0 to 710.5.
fn reduced(a: f64) -> (f64, u32) {
    let shifted = a * core::f64::consts::LOG2_E + ROUNDER;
    let times = shifted - ROUNDER;
    let (first, second) = (a - times * LOG_2[0], times * LOG_2[1]);
    let r = first - second;
    let low = (first - r) - second;
    let series = TAYLOR.iter().rev().fold(0.0, |sum, coefficient| coefficient + r * sum);
    let p = r + (r * r * series + low * (1.0 + r));
    (p, shifted.to_bits() as u32 & 0x7ff)
}

/// 2^n, for n up to 1023.
fn power_of_two(n: u32) -> f64 {
    f64::from_bits(u64::from(1023 + n) << 52)
}

/// e^a - 1, for a from 0 to 50.
fn exp_m1(a: f64) -> f64 {
    let (p, n) = reduced(a);
    let scale = power_of_two(n.min(1023));
    (scale - 1.0) + scale * p
}

/// e^a / 2, for a from 22: infinite where it is larger than every double.
fn half_exponential(a: f64) -> f64 {
    if a > LARGEST {
        return f64::INFINITY;
    }
    let (p, n) = reduced(a);
    // in two steps: 2^(n - 1) itself may be infinite
    (power_of_two(n - 2) + power_of_two(n - 2) * p) * 2.0
}

#[cfg(test)]
mod tests {
    use super::{cosh, sinh, tanh};

    /// Distance in units of the last place of the expected number.
    fn ulps(found: f64, expected: f64) -> f64 {
        if found == expected {
            return 0.0;
        }
        let unit = f64::from_bits(expected.abs().to_bits() + 1) - expected.abs();
        (found - expected).abs() / unit
    }

    /// Against the standard library's, which are right to a unit or so.
    #[test]
    fn two_units_in_the_last_place() {
        let mut worst: f64 = 0.0;
        let spread = (1..200_000).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract());
        let sizes = [1e-300, 1e-8, 0.01, 0.7, 3.0, 45.0, 1400.0];
        for x in spread.flat_map(|x| sizes.map(|size| (x - 0.5) * size)) {
            worst =
                worst.max(ulps(sinh(x), x.sinh())).max(ulps(cosh(x), x.cosh())).max(ulps(tanh(x), x.tanh()));
        }
        assert!(worst <= 3.0, "{worst}");
    }

    #[test]
    fn the_ends_of_the_range() {
        for x in [0.0, -0.0, 5e-324, 710.4758600739439, 710.5, 711.0, 1e300, f64::INFINITY] {
            for x in [x, -x] {
                assert!(ulps(sinh(x), x.sinh()) <= 2.0, "sinh {x}: {} {}", sinh(x), x.sinh());
                assert!(ulps(cosh(x), x.cosh()) <= 2.0, "cosh {x}: {} {}", cosh(x), x.cosh());
                assert_eq!(tanh(x), x.tanh(), "{x}");
                assert_eq!(sinh(x).is_sign_negative(), x.is_sign_negative());
            }
        }
        assert!(sinh(f64::NAN).is_nan() && cosh(f64::NAN).is_nan() && tanh(f64::NAN).is_nan());
    }
}
