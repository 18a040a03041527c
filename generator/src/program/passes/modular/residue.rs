//! Residues modulo a prime, with exact arithmetic.

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;

use crate::number::Number;

/// The prime, 2^64 - 2^32 + 1. What it is less 1 has the factors 2^32, 3 and 5, so that there are roots of
/// unity for the usual fractions of pi.
pub const PRIME: u64 = 0xffff_ffff_0000_0001;
/// Its powers are all residues but 0.
const GENERATOR: Residue = Residue(7);

/// A residue modulo [`PRIME`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Residue(u64);

impl Residue {
    /// 0
    pub const ZERO: Residue = Residue(0);
    /// 1
    pub const ONE: Residue = Residue(1);

    /// An integer.
    pub fn integer(n: i64) -> Self {
        Residue(i128::from(n).rem_euclid(i128::from(PRIME)) as u64)
    }

    /// A rational number; `None` if the prime divides the denominator.
    pub fn rational(number: &Number) -> Option<Self> {
        let of = |n: &BigInt| {
            let prime = BigInt::from(PRIME);
            Residue((((n % &prime) + &prime) % &prime).to_u64().unwrap_or(0))
        };
        Some(of(number.0.numer()) * of(number.0.denom()).reciprocal()?)
    }

    /// A double, which is a rational number; `None` if it is not finite.
    pub fn double(number: f64) -> Option<Self> {
        Residue::rational(&Number(BigRational::from_float(number)?))
    }

    /// An arbitrary residue other than 0, always the same for the same numbers.
    pub fn arbitrary(seed: &[u64]) -> Self {
        let mut bits: u64 = 0x9e37_79b9_7f4a_7c15;
        for part in seed {
            bits = (bits ^ part).wrapping_mul(0xff51_afd7_ed55_8ccd).wrapping_add(0x9e37_79b9_7f4a_7c15);
            bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            bits ^= bits >> 31;
        }
        Residue(1 + bits % (PRIME - 1))
    }

    /// The residue as a number from 0.
    pub fn number(self) -> u64 {
        self.0
    }

    /// The integer it is if the magnitude of that is at most `largest`.
    pub fn small(self, largest: u32) -> Option<i64> {
        let largest = u64::from(largest);
        match self.0 {
            n if n <= largest => Some(n as i64),
            n if PRIME - n <= largest => Some(-((PRIME - n) as i64)),
            _ => None,
        }
    }

    /// Its power. A negative power of 0 counts as 0.
    pub fn power(self, exponent: i128) -> Self {
        let mut left = exponent.rem_euclid(i128::from(PRIME - 1)) as u64;
        // the exponent of 0 may not be reduced
        let mut power = if self == Residue::ZERO && exponent != 0 { Residue::ZERO } else { Residue::ONE };
        let mut square = self;
        while left > 0 {
            if left & 1 == 1 {
                power = power * square;
            }
            square = square * square;
            left >>= 1;
        }
        power
    }

    /// 1 / a; `None` of 0.
    pub fn reciprocal(self) -> Option<Self> {
        (self != Residue::ZERO).then(|| self.power(i128::from(PRIME) - 2))
    }

    /// What stands for e^(i pi n / d): a power of a root of unity. `None` if there is no root of this order.
    pub fn root_of_unity(n: i128, d: u64) -> Option<Self> {
        let order = d.checked_mul(2)?;
        (order > 0 && (PRIME - 1).is_multiple_of(order))
            .then(|| GENERATOR.power(i128::from((PRIME - 1) / order)).power(n))
    }
}

impl Add for Residue {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Residue(((u128::from(self.0) + u128::from(other.0)) % u128::from(PRIME)) as u64)
    }
}

impl Sub for Residue {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Residue {
    type Output = Self;

    fn neg(self) -> Self {
        Residue(if self.0 == 0 { 0 } else { PRIME - self.0 })
    }
}

impl Mul for Residue {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Residue((u128::from(self.0) * u128::from(other.0) % u128::from(PRIME)) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_residues_but_zero_are_powers_of_the_generator() {
        let factors = [2, 3, 5, 17, 257, 65537];
        let mut left = PRIME - 1;
        for factor in factors {
            assert_ne!(GENERATOR.power(i128::from((PRIME - 1) / factor)), Residue::ONE, "{factor}");
            while left.is_multiple_of(factor) {
                left /= factor;
            }
        }
        assert_eq!(left, 1, "all prime factors are in the list");
    }

    #[test]
    fn it_is_a_field() {
        for seed in 0..200 {
            let [a, b, c] = [0, 1, 2].map(|which| Residue::arbitrary(&[seed, which]));
            assert_eq!((a + b) * c, a * c + b * c);
            assert_eq!(a - b + b, a);
            assert_eq!(a * a.reciprocal().unwrap(), Residue::ONE);
            assert_eq!(a.power(-3) * a.power(5), a * a);
        }
        assert_eq!(Residue::ZERO.reciprocal(), None);
        assert_eq!(Residue::ZERO.power(0), Residue::ONE);
        assert_eq!(Residue::ZERO.power(i128::from(PRIME - 1)), Residue::ZERO);
    }

    #[test]
    fn numbers_keep_their_meaning() {
        let third = Residue::rational(&Number::ratio(-1, 3)).unwrap();
        assert_eq!(third * Residue::integer(3), Residue::integer(-1));
        assert_eq!(Residue::double(-0.375).unwrap() * Residue::integer(8), Residue::integer(-3));
        assert_ne!(
            Residue::double(0.1).unwrap() * Residue::integer(10),
            Residue::ONE,
            "a double is no tenth"
        );
        assert!(Residue::double(f64::INFINITY).is_none() && Residue::double(5e-324).is_some());
        assert_eq!([Residue::integer(-12), Residue::integer(12)].map(|n| n.small(12)), [Some(-12), Some(12)]);
        assert_eq!(Residue::integer(13).small(12), None);
    }

    #[test]
    fn roots_of_unity_belong_together() {
        let minus = Residue::integer(-1);
        assert_eq!(Residue::root_of_unity(1, 1), Some(minus));
        let [sixth, third] = [6, 3].map(|d| Residue::root_of_unity(1, d).unwrap());
        assert_eq!(sixth * sixth, third);
        assert_eq!(third.power(3), minus);
        assert_eq!(Residue::root_of_unity(1, 7), None);
    }
}
