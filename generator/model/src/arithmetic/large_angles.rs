//! Reduces large angles by multiples of pi/2, with enough digits of pi for every double.

use std::sync::OnceLock;

use num_bigint::BigInt;
use num_traits::{FromPrimitive, Signed, ToPrimitive};

/// Bits behind the point of what is reduced: a double has 1074 at most.
const FRACTION: u32 = 1100;
/// More bits of pi, for the multiples of it in the largest double are 2^1024.
const MORE: u32 = 1200;
/// Bits behind the point of what is left.
const LEFT: u32 = 160;

/// pi/2 in units of 2^-(FRACTION + MORE), by Machin's formula.
fn half_pi() -> &'static BigInt {
    static HALF_PI: OnceLock<BigInt> = OnceLock::new();
    HALF_PI.get_or_init(|| {
        // 64 bits more, for the rounding of each term
        let one = BigInt::from(1) << (FRACTION + MORE + 64);
        let arc_tangent = |inverse: u32| {
            let (mut power, mut sum) = (&one / inverse, BigInt::from(0));
            let mut divisor = 1_u32;
            while power.is_positive() {
                let term = &power / divisor;
                sum = if divisor % 4 == 1 { sum + term } else { sum - term };
                power /= inverse * inverse;
                divisor += 2;
            }
            sum
        };
        (arc_tangent(5) * 8 - arc_tangent(239) * 2) >> 64
    })
}

/// A finite double in units of 2^-FRACTION: exactly.
fn exactly(number: f64) -> BigInt {
    let bits = number.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as u32;
    let mantissa = (bits & ((1 << 52) - 1)) | if exponent > 0 { 1 << 52 } else { 0 };
    // the last bit of the mantissa is worth 2^(exponent - 1075)
    let size = BigInt::from(mantissa) << (exponent.max(1) + FRACTION - 1075);
    if number < 0.0 { -size } else { size }
}

/// The number of right angles nearest to `high + low`, of which the last two bits count, and what is left, in
/// two parts.
pub fn reduced(high: f64, low: f64) -> (u8, [f64; 2]) {
    let angle: BigInt = (exactly(high) + exactly(low)) << MORE;
    let half_pi = half_pi();
    let shifted: BigInt = angle + (half_pi >> 1_u32);
    let (mut turns, mut rest) = (&shifted / half_pi, &shifted % half_pi);
    if rest.is_negative() {
        (turns, rest) = (turns - 1, rest + half_pi);
    }
    let rest: BigInt = (rest - (half_pi >> 1_u32)) >> (FRACTION + MORE - LEFT);
    let unit = 2f64.powi(-(LEFT as i32));
    let near = rest.to_f64().unwrap_or(0.0);
    let less = BigInt::from_f64(near).map_or(0.0, |near| (rest - near).to_f64().unwrap_or(0.0));
    let quarter: BigInt = (turns % 4 + 4) % 4;
    (quarter.to_u8().unwrap_or(0), [near * unit, less * unit])
}

#[cfg(test)]
mod tests {
    use super::reduced;

    /// Digits from a computation with 60 decimals.
    #[test]
    fn what_is_left_of_large_angles() {
        for (angle, quarter, left) in [
            (1e13, 0, -0.2930622841882782),
            (-1e13, 0, 0.2930622841882782),
            (1e22, 3, 0.5506189342358097),
            (1.7976931348623157e308, 2, -0.004961975150787273),
        ] {
            let (turns, [high, low]) = reduced(angle, 0.0);
            assert_eq!(turns, quarter, "{angle}");
            assert_eq!(high, left, "{angle}");
            assert!(low.abs() <= 1e-16 * high.abs());
        }
        // what is nothing beside the angle counts
        let (_, [high, _]) = reduced(1e13, 1e-5);
        assert!((high - -0.2930622841882782 - 1e-5).abs() < 1e-16);
    }
}
