//! Residues modulo a prime, with exact arithmetic.

use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::ToPrimitive;

use crate::number::Number;

/// The greatest prime below 2^64 that is 4 q + 1 with a prime q: it has a root of -1, and powers of a residue
/// repeat after q of them or after at most four.
pub const FIRST_PRIME: u64 = 0xffff_ffff_ffff_f40d;
/// The next smaller one.
pub const SECOND_PRIME: u64 = 0xffff_ffff_ffff_ddd5;

/// A residue modulo the prime P.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Residue<const P: u64>(u64);

impl<const P: u64> Residue<P> {
    /// 0
    pub const ZERO: Self = Residue(0);
    /// 1
    pub const ONE: Self = Residue(1);

    /// An integer.
    pub fn integer(n: i64) -> Self {
        Residue(i128::from(n).rem_euclid(i128::from(P)) as u64)
    }

    /// A rational number; `None` if the prime divides the denominator.
    pub fn rational(number: &Number) -> Option<Self> {
        let of = |n: &BigInt| {
            let prime = BigInt::from(P);
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
        Residue(1 + bits % (P - 1))
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
            n if P - n <= largest => Some(-((P - n) as i64)),
            _ => None,
        }
    }

    /// Its power. A negative power of 0 counts as 0.
    pub fn power(self, exponent: i128) -> Self {
        let mut left = exponent.rem_euclid(i128::from(P - 1)) as u64;
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
        (self != Residue::ZERO).then(|| self.power(i128::from(P) - 2))
    }

    /// A root of -1: the power (P - 1) / 4 of the least residue that is no square.
    pub fn imaginary() -> Self {
        let is_square = |n: &Self| n.power(i128::from((P - 1) / 2)) == Residue::ONE;
        let found = (2..).map(Residue).find(|n| !is_square(n));
        found.unwrap_or(Residue::ONE).power(i128::from((P - 1) / 4))
    }
}

impl<const P: u64> Add for Residue<P> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Residue(((u128::from(self.0) + u128::from(other.0)) % u128::from(P)) as u64)
    }
}

impl<const P: u64> Sub for Residue<P> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<const P: u64> Neg for Residue<P> {
    type Output = Self;

    fn neg(self) -> Self {
        Residue(if self.0 == 0 { 0 } else { P - self.0 })
    }
}

impl<const P: u64> Mul for Residue<P> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Residue((u128::from(self.0) * u128::from(other.0) % u128::from(P)) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a number is prime: Miller and Rabin's test, which decides below 2^64 with these bases.
    fn is_prime(n: u64) -> bool {
        let times = |a: u64, b: u64| (u128::from(a) * u128::from(b) % u128::from(n)) as u64;
        let power = |mut a: u64, mut exponent: u64| {
            let mut power = 1;
            while exponent > 0 {
                power = if exponent & 1 == 1 { times(power, a) } else { power };
                (a, exponent) = (times(a, a), exponent >> 1);
            }
            power
        };
        let twos = (n - 1).trailing_zeros();
        [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37].iter().all(|&base| {
            let mut at = power(base, (n - 1) >> twos);
            let passes = |at: u64| at == n - 1;
            at == 1
                || (0..twos).any(|_| {
                    let found = passes(at);
                    at = times(at, at);
                    found
                })
        })
    }

    #[test]
    fn the_primes_are_primes_of_the_form_that_is_claimed() {
        for prime in [FIRST_PRIME, SECOND_PRIME] {
            assert!(is_prime(prime) && prime % 4 == 1 && is_prime((prime - 1) / 4), "{prime}");
        }
        assert!(!is_prime(FIRST_PRIME - 2) && !is_prime(561));
    }

    fn is_a_field<const P: u64>() {
        for seed in 0..200 {
            let [a, b, c] = [0, 1, 2].map(|which| Residue::<P>::arbitrary(&[seed, which]));
            assert_eq!((a + b) * c, a * c + b * c);
            assert_eq!(a - b + b, a);
            assert_eq!(a * a.reciprocal().unwrap(), Residue::ONE);
            assert_eq!(a.power(-3) * a.power(5), a * a);
        }
        let zero = Residue::<P>::ZERO;
        assert_eq!(zero.reciprocal(), None);
        assert_eq!(zero.power(0), Residue::ONE);
        assert_eq!(zero.power(i128::from(P - 1)), zero);
        let i = Residue::<P>::imaginary();
        assert_eq!(i * i, Residue::integer(-1));
    }

    #[test]
    fn both_are_fields_with_a_root_of_minus_one() {
        is_a_field::<FIRST_PRIME>();
        is_a_field::<SECOND_PRIME>();
    }

    #[test]
    fn numbers_keep_their_meaning() {
        type First = Residue<FIRST_PRIME>;
        let third = First::rational(&Number::ratio(-1, 3)).unwrap();
        assert_eq!(third * Residue::integer(3), Residue::integer(-1));
        assert_eq!(First::double(-0.375).unwrap() * Residue::integer(8), Residue::integer(-3));
        assert_ne!(First::double(0.1).unwrap() * Residue::integer(10), Residue::ONE, "a double is no tenth");
        assert!(First::double(f64::INFINITY).is_none() && First::double(5e-324).is_some());
        assert_eq!([-12, 12].map(|n| First::integer(n).small(12)), [Some(-12), Some(12)]);
        assert_eq!(First::integer(13).small(12), None);
    }
}
