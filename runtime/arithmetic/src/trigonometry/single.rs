//! Sine and cosine of a single together, to 1.001 units in the last place, in single precision and integers
//! alone: a processor whose unit knows singles only computes no doubles. No operation is fused and nothing is
//! asked of the system, so that the bits are the same on every machine.
//!
//! Angles up to 128 rad are reduced by multiples of pi/2 in three parts, larger ones by integers with as many
//! digits of 2/pi as the largest single needs. Sine and cosine of the rest are polynomials of least relative
//! error on [0, pi/4]: 2^-26.8 and 2^-32.7.

/// Angles up to here are reduced in singles, rad: the multiples of pi/2 have at most seven bits.
const LARGEST: f32 = 128.0;
/// 1.5 * 2^23: adding it rounds to an integer, whose last bits are then those of the sum.
const ROUNDER: f32 = 12582912.0;
/// pi/2 in three parts to 2^-63; the first two have 17 bits, so that their products with a multiple are
/// exact.
const HALF_PI: [f32; 3] = [1.5708008, -4.4544577e-6, 2.563344e-12];

/// (sin r / r - 1) / r^2 in powers of r^2.
const SINE: [f32; 3] = [-0.16666655, 0.008332158, -0.00019514958];
/// (cos r - 1 + r^2 / 2) / r^4 in powers of r^2.
const COSINE: [f32; 3] = [0.041666646, -0.0013887313, 2.4432786e-5];

/// 2/pi in words of 32 bits: the first are the whole part, the others stand behind the point.
const TWO_OVER_PI: [u32; 8] =
    [0, 0xa2f9836e, 0x4e441529, 0xfc2757d1, 0xf534ddc0, 0xdb629599, 0x3c439041, 0xfe5163ab];
/// pi/2 * 2^31
const HALF_PI_FIXED: u64 = 0xc90fdaa2;

/// Sine and cosine; not a number for what is not finite.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    if x.abs() <= LARGEST {
        let shifted = x * core::f32::consts::FRAC_2_PI + ROUNDER;
        let turns = shifted - ROUNDER;
        let (second, third) = (turns * HALF_PI[1], turns * HALF_PI[2]);
        let first = x - turns * HALF_PI[0];
        let less = first - second;
        let r = less - third;
        let low = (less - r - third) + (first - less - second);
        turned(near_zero(r, low), shifted.to_bits())
    } else {
        beyond(x)
    }
}

/// Sine and cosine of `r + low`, from -pi/4 to pi/4.
#[inline(always)]
fn near_zero(r: f32, low: f32) -> (f32, f32) {
    let z = r * r;
    let polynomial = |[a, b, c]: [f32; 3]| (c * z + b) * z + a;
    let sine = r + (r * z * polynomial(SINE) + low);
    // what the first difference loses is added again
    let half = z * 0.5;
    let near = 1.0 - half;
    let cosine = near + ((1.0 - near - half) + (z * z * polynomial(COSINE) - r * low));
    (sine, cosine)
}

/// After so many right angles, of which the last two bits count.
#[inline(always)]
fn turned((sine, cosine): (f32, f32), turns: u32) -> (f32, f32) {
    let (s, c) = if turns & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    let s = if turns & 2 == 0 { s } else { -s };
    let c = if turns.wrapping_add(1) & 2 == 0 { c } else { -c };
    // one zero: the positive one
    (s + 0.0, c)
}

/// Angles beyond 128 rad.
#[cold]
#[inline(never)]
fn beyond(x: f32) -> (f32, f32) {
    if !x.is_finite() {
        return (f32::NAN, f32::NAN);
    }
    let (r, low, turns) = reduced(x);
    turned(near_zero(r, low), turns)
}

/// What a finite angle from 1 rad on is beside the nearest multiple of pi/2, in two parts, and the multiple,
/// of which the last two bits count.
///
/// The angle is m 2^e with an integer m of 24 bits. Of 2/pi times 2^e, bits worth 4 and more turn full
/// circles: the 96 bits from that worth 2 down are multiplied with m, and of the product 2 bits before the
/// point and 62 behind it are kept. What is left out is less than 2^-61 right angles; the single nearest to a
/// multiple of them is 2^-29.8 away.
fn reduced(x: f32) -> (f32, f32, u32) {
    let bits = x.to_bits();
    let m = u64::from(bits & 0x7f_ffff | 0x80_0000);
    // the bit of the table that is worth 2: e + 30, where e is the exponent of the last bit of m
    let first = (bits >> 23 & 0xff).saturating_sub(120);
    let (word, shift) = (first as usize / 32, first % 32);
    let pair =
        |k: usize| u64::from(TWO_OVER_PI[(word + k) & 7]) << 32 | u64::from(TWO_OVER_PI[(word + k + 1) & 7]);
    let (above, below) = (pair(0), pair(2));
    let upper = above << shift | (below >> 1) >> (63 - shift);
    let lower = (below << shift) >> 32;
    let product = m.wrapping_mul(upper).wrapping_add((m * lower) >> 32);
    let turns = (product.wrapping_add(1 << 61) >> 62) as u32;
    let rest = product.wrapping_sub(u64::from(turns) << 62) as i64;

    // the rest without leading zeros, times pi/2, in two parts of 24 bits
    let size = rest.unsigned_abs() | 1;
    let zeros = size.leading_zeros();
    let angle = ((size << zeros) >> 32) * HALF_PI_FIXED;
    let scaled =
        |part: u64, exponent: u32| part as u32 as f32 * f32::from_bits((127 - exponent - zeros) << 23);
    let (high, low) = (scaled(angle >> 40, 21), scaled(angle >> 16 & 0xff_ffff, 45));
    let (high, low) = if (rest < 0) == (x < 0.0) { (high, low) } else { (-high, -low) };
    (high, low, if x < 0.0 { turns.wrapping_neg() } else { turns })
}

#[cfg(test)]
mod tests {
    use super::{reduced, sin_cos};

    /// Distance in units of the last place that a single near the expected number has.
    fn ulps(found: f32, expected: f64) -> f64 {
        let near = (expected as f32).abs().max(f32::MIN_POSITIVE);
        let unit = f64::from(f32::from_bits(near.to_bits() & 0x7f80_0000)) * f64::from(f32::EPSILON);
        (f64::from(found) - expected).abs() / unit
    }

    /// The largest distance over these angles, from sines of doubles: these lose nothing that a single shows.
    fn worst(angles: impl Iterator<Item = f32>) -> f64 {
        let both = |x: f32| {
            let ((s, c), (sine, cosine)) = (sin_cos(x), f64::from(x).sin_cos());
            ulps(s, sine).max(ulps(c, cosine))
        };
        angles.map(both).fold(0.0, f64::max)
    }

    /// Every so many of all finite singles of either sign; `HODOGRAPH_ANGLES=1` tries all of them, in some
    /// minutes in release: the worst is 1.0002.
    #[test]
    fn a_unit_in_the_last_place() {
        let step = std::env::var("HODOGRAPH_ANGLES").ok().and_then(|text| text.parse().ok()).unwrap_or(16411);
        let finite = (0..f32::INFINITY.to_bits()).step_by(step).map(f32::from_bits);
        let error = worst(finite.flat_map(|x| [x, -x]));
        assert!(error < 1.001, "{error}");
    }

    /// Multiples of pi/4 and their neighbours, where most is cancelled and where quadrants meet.
    #[test]
    fn near_right_angles() {
        let multiples = (0..200_000).map(|k| (f64::from(k) * core::f64::consts::FRAC_PI_4) as f32);
        let large = (0..120).map(|k| (2f64.powi(k) * core::f64::consts::FRAC_PI_4) as f32);
        let error = worst(multiples.chain(large).flat_map(|x| [x.next_down(), x, x.next_up()]));
        assert!(error < 1.001, "{error}");
    }

    /// The two reductions agree where both are good, and the integers take the singles that are nearest to a
    /// multiple of pi/2 (found by continued fractions of 2^e 2/pi; sines and cosines computed with 80
    /// digits).
    #[test]
    fn large_angles() {
        for k in 0..40_000u32 {
            let x = 1.0 + k as f32 * 0.003_174_3;
            let (r, low, turns) = reduced(x);
            let exact = f64::from(x).rem_euclid(core::f64::consts::TAU);
            let expected =
                exact - (exact / core::f64::consts::FRAC_PI_2).round() * core::f64::consts::FRAC_PI_2;
            let found = f64::from(r) + f64::from(low);
            if expected.abs() < 0.78 {
                assert!((found - expected).abs() < 1e-8, "{x}: {found} {expected}");
                assert_eq!(turns & 3, (exact / core::f64::consts::FRAC_PI_2).round() as u32 & 3, "{x}");
            }
        }
        for (x, sine, cosine) in include!("nearest.rs") {
            let (s, c) = sin_cos(x);
            assert!(ulps(s, sine) < 1.0 && ulps(c, cosine) < 1.0, "{x:e}: {s:e} {sine:e}, {c:e} {cosine:e}");
        }
    }

    #[test]
    fn the_ends() {
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!(sin_cos(-0.0).0.is_sign_positive());
        assert_eq!(sin_cos(1e-45), (1e-45, 1.0));
        for x in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
            let (s, c) = sin_cos(x);
            assert!(s.is_nan() && c.is_nan());
        }
    }
}
