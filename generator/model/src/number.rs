//! Exact rational numbers: decimals of a model stay exact until code is emitted.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// An exact rational number.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Number(pub BigRational);

impl Number {
    /// The integer `n`.
    pub fn integer(n: i64) -> Self {
        Number(BigRational::from_integer(BigInt::from(n)))
    }

    /// The quotient `n / d`; `d` must not be zero.
    pub fn ratio(n: i64, d: i64) -> Self {
        Number(BigRational::new(BigInt::from(n), BigInt::from(d)))
    }

    /// Whether it is 0.
    pub fn is_zero(&self) -> bool {
        self.0.is_zero()
    }

    /// Whether it is 1.
    pub fn is_one(&self) -> bool {
        self.0.is_one()
    }

    /// Whether it is below 0.
    pub fn is_negative(&self) -> bool {
        self.0.is_negative()
    }

    /// The integer it is, if it is one that fits.
    pub fn to_integer(&self) -> Option<i64> {
        if self.0.is_integer() { self.0.to_integer().to_i64() } else { None }
    }

    /// The nearest double (infinite where it is out of range).
    pub fn to_f64(&self) -> f64 {
        // Both are doubles: the nearest to their quotient is the quotient of doubles.
        let exact = |n: &BigInt| n.to_i64().filter(|n| n.unsigned_abs() <= 1 << 53);
        match (exact(self.0.numer()), exact(self.0.denom())) {
            (Some(n), Some(d)) => n as f64 / d as f64,
            _ => self.0.to_f64().unwrap_or(f64::NAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_numbers_become_the_doubles_that_long_division_finds() {
        let mut seed = 1_u64;
        let mut random = |bits: u32| {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> (64 - bits)) as i64
        };
        for bits in [3, 20, 53, 54] {
            for _ in 0..2000 {
                let number = Number::ratio(random(bits) - (1 << (bits - 1)), random(bits) + 1);
                assert_eq!(number.to_f64().to_bits(), number.0.to_f64().unwrap().to_bits(), "{number:?}");
            }
        }
    }
}
