//! Random numbers that are the same on every machine.

use hodograph::{Law, Surface};

/// A linear congruential generator (Knuth's constants), the upper 53 bits of which are used.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Between -1 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A place in a list of so many.
    pub fn pick(&mut self, count: usize) -> usize {
        ((0.5 * (self.next() + 1.0) * count as f64) as usize).min(count - 1)
    }

    /// Evenly between two numbers.
    pub fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * 0.5 * (self.next() + 1.0)
    }

    /// Between two positive numbers, evenly in the logarithm.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(0.5 * (self.next() + 1.0))
    }

    /// A power of ten with an exponent up to this size.
    pub fn power(&mut self, most: f64) -> f64 {
        10.0_f64.powf(most * self.next())
    }

    /// Between -1 and 1 with ten bits, so that sums of products of such numbers are exact.
    pub fn short(&mut self) -> f64 {
        (self.next() * 1024.0).round() / 1024.0
    }

    /// Friction between 0.02 and 6, restitution often 0 or 1, any law.
    pub fn surface(&mut self) -> Surface<f64> {
        let e = [0.0, 1.0, 0.55 + 0.45 * self.next()][(self.0 >> 40) as usize % 3];
        let law = Law::ALL[(self.0 >> 43) as usize % Law::ALL.len()];
        Surface { mu: self.between(0.02, 6.0), e, law }
    }
}
