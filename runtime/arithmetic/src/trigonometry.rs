//! Sine and cosine of a double together, to less than one unit in the last place, in forty operations without
//! a branch, the same bits on every machine.
//!
//! The angle is reduced by a multiple of pi/2, which is stored in three parts. Sine and cosine of the
//! remainder are polynomials (Chebyshev interpolation on [0, pi/4], error below 2^-55); the quadrant
//! exchanges them and sets their signs. For angles beyond 2^19 the caller supplies a function.

pub mod single;

use core::ops::{Add, Mul, Neg, Sub};

use crate::fused::{FUSED, mul_add};

/// Angles up to here are reduced here, rad.
pub const LARGEST: f64 = 524288.0;
/// 1.5 * 2^52: adding it rounds to an integer, whose last bits are then those of the sum.
const ROUNDER: f64 = 6755399441055744.0;
/// pi/2 in three parts, for products that are not rounded: the second has 33 bits, so that what the
/// difference loses is a double.
const HALF_PI: [f64; 3] = [core::f64::consts::FRAC_PI_2, 6.12323399538461e-17, 3.5215598651832e-27];
/// pi/2 in three parts, of which the first two have 33 bits: their products with a multiple are exact.
const HALF_PI_SHORT: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// Sines of right angles; the cosine of one is the sine of the next.
const QUARTERS: [f64; 5] = [0.0, 1.0, 0.0, -1.0, 0.0];

/// (sin r / r - 1) / r^2 in powers of r^2.
const SINE: [f64; 6] = [
    -0.16666666666666666,
    0.008333333333330946,
    -0.0001984126983675497,
    2.755731610068303e-06,
    -2.5051131455427946e-08,
    1.591810123027412e-10,
];
/// (cos r - 1 + r^2 / 2) / r^4 in powers of r^2.
const COSINE: [f64; 6] = [
    0.041666666666666664,
    -0.0013888888888887395,
    2.4801587298763433e-05,
    -2.7557317270560326e-07,
    2.0876146024689747e-09,
    -1.1382614868556325e-11,
];

/// Sine and cosine; `beyond` computes them for angles that are too large, infinite or NaN.
#[inline(always)]
pub fn sin_cos(x: f64, beyond: impl FnOnce(f64) -> (f64, f64)) -> (f64, f64) {
    if !is_within(x) {
        return beyond(x);
    }
    let (r, low, shifted) = reduced(x);
    let (sine, cosine) = near_zero(r, low);
    let quadrant = shifted.to_bits() as usize & 3;
    // In each product below one factor is 0, 1 or -1: no rounding.
    let (s, c) = (QUARTERS[quadrant], QUARTERS[quadrant + 1]);
    (mul_add(sine, c, cosine * s), mul_add(cosine, c, -(sine * s)))
}

/// Angles that are too large, infinite or not a number: with as many digits of pi as they need.
pub fn beyond(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// A double, or several that undergo the same operations.
pub trait Doubles:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// This number, as often as there are numbers.
    fn all(value: f64) -> Self;
    /// self * b + c, with one rounding where [`FUSED`] says so.
    fn mul_add(self, b: Self, c: Self) -> Self;
}

impl Doubles for f64 {
    #[inline(always)]
    fn all(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        mul_add(self, b, c)
    }
}

/// Whether the angle is small enough to be reduced here.
#[inline(always)]
pub fn is_within(x: f64) -> bool {
    x.abs() <= LARGEST
}

/// The difference of an angle and the nearest multiple of pi/2, the rounding error of the difference, and a
/// number whose last two bits are those of the multiple.
#[inline(always)]
pub fn reduced<D: Doubles>(x: D) -> (D, D, D) {
    let shifted = x.mul_add(D::all(core::f64::consts::FRAC_2_PI), D::all(ROUNDER));
    let turns = shifted - D::all(ROUNDER);
    let (r, low) = if FUSED {
        let [one, two, three] = HALF_PI.map(D::all);
        let first = (-turns).mul_add(one, x);
        let r = (-turns).mul_add(two, first);
        (r, (-turns).mul_add(three, (-turns).mul_add(two, first - r)))
    } else {
        let [one, two, three] = HALF_PI_SHORT.map(D::all);
        let (second, third) = (turns * two, turns * three);
        let first = x - turns * one;
        let less = first - second;
        let r = less - third;
        (r, (less - r - third) + (first - less - second))
    };
    (r, low, shifted)
}

/// Sine and cosine of `r + low`, from -pi/4 to pi/4.
#[inline(always)]
pub fn near_zero<D: Doubles>(r: D, low: D) -> (D, D) {
    let z = r * r;
    let sine = r + (r * z).mul_add(polynomial(SINE, z), low);
    let cosine = D::all(1.0) + z.mul_add(z.mul_add(polynomial(COSINE, z), D::all(-0.5)), -(r * low));
    (sine, cosine)
}

/// Exchanges sine and cosine and changes their signs according to the quadrant, without a table: what
/// [`sin_cos`] makes of them, for loops over many angles.
#[inline(always)]
pub fn turned((sine, cosine): (f64, f64), turns: u64) -> (f64, f64) {
    let odd = (turns & 1).wrapping_neg();
    let exchanged = (sine.to_bits() ^ cosine.to_bits()) & odd;
    let sign = |turns: u64| (turns & 2) << 62;
    let sine = f64::from_bits(sine.to_bits() ^ exchanged ^ sign(turns));
    let cosine = f64::from_bits(cosine.to_bits() ^ exchanged ^ sign(turns.wrapping_add(1)));
    // one zero: the positive one
    (sine + 0.0, cosine)
}

#[inline(always)]
fn polynomial<D: Doubles>(coefficients: [f64; 6], z: D) -> D {
    let [a, b, c, d, e, f] = coefficients.map(D::all);
    f.mul_add(z, e).mul_add(z, d).mul_add(z, c).mul_add(z, b).mul_add(z, a)
}
