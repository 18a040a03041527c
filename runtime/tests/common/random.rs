//! Random numbers of collisions.

use hodograph::{Law, Surface};
pub use hodograph_random::Random;

/// What collisions are drawn from beside plain numbers.
pub trait Draw {
    /// A power of ten with an exponent up to this size.
    fn power(&mut self, most: f64) -> f64;
    /// Between -1 and 1 with ten bits, so that sums of products of such numbers are exact.
    fn short(&mut self) -> f64;
    /// Friction between 0.02 and 6, restitution often 0 or 1, any law.
    fn surface(&mut self) -> Surface<f64>;
}

impl Draw for Random {
    fn power(&mut self, most: f64) -> f64 {
        10.0_f64.powf(most * self.number())
    }

    fn short(&mut self) -> f64 {
        (self.number() * 1024.0).round() / 1024.0
    }

    fn surface(&mut self) -> Surface<f64> {
        let e = [0.0, 1.0, self.between(0.1, 1.0)][self.below(3)];
        let law = Law::ALL[self.below(Law::ALL.len())];
        Surface { mu: self.logarithmic(0.02, 6.0), e, law }
    }
}
