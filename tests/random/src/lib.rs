//! Random numbers for tests, the same on every machine and in every run.

use std::f64::consts::TAU;

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A sequence of random numbers (SplitMix64).
#[derive(Clone, Debug)]
pub struct Random(SplitMix64);

impl Random {
    /// The sequence that belongs to a seed.
    pub fn new(seed: u64) -> Self {
        Random(SplitMix64::from_seed(seed.to_le_bytes()))
    }

    /// The sequence that belongs to a name, as that of a model.
    pub fn named(name: &str) -> Self {
        Random::new(name.bytes().fold(7, |seed, byte| seed.wrapping_mul(31) + u64::from(byte)))
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// From 0 to 1, the latter excluded: a multiple of 2^-53.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From -1 to 1, the latter excluded.
    pub fn number(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }

    /// Evenly between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Between two positive numbers, evenly in the logarithm.
    pub fn logarithmic(&mut self, low: f64, high: f64) -> f64 {
        low * libm::pow(high / low, self.unit())
    }

    /// A natural number below `count`: a place in a list of so many. 0 if the list is empty.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() % count.max(1) as u64) as usize
    }

    /// From the normal distribution of mean 0 and variance 1.
    pub fn normal(&mut self) -> f64 {
        (-2.0 * libm::log(1.0 - self.unit())).sqrt() * libm::cos(TAU * self.unit())
    }

    /// A quaternion of length one, evenly over the rotations.
    pub fn rotation(&mut self) -> [f64; 4] {
        loop {
            let four = [0; 4].map(|_| self.number());
            let norm = four.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.1 && norm < 1.0 {
                return four.map(|x| x / norm);
            }
        }
    }
}

/// Which random starts a test tries: the first so many, or what `HODOGRAPH_STARTS` says, a number or a range
/// as `96..97`.
pub fn starts(usual: u64) -> std::ops::Range<u64> {
    let text = std::env::var("HODOGRAPH_STARTS").unwrap_or_default();
    match text.split_once("..") {
        Some((from, to)) => from.parse().unwrap_or(0)..to.parse().unwrap_or(usual),
        None => 0..text.parse().unwrap_or(usual),
    }
}

#[cfg(test)]
mod tests {
    use super::Random;

    #[test]
    fn numbers_are_the_published_ones() {
        // the first outputs of SplitMix64 from seed 1234567, as Vigna's code prints them
        let mut random = Random::new(1_234_567);
        assert_eq!(random.bits(), 6_457_827_717_110_365_317);
        assert_eq!(random.bits(), 3_203_168_211_198_807_973);
    }

    #[test]
    fn numbers_fill_their_ranges_evenly() {
        let mut random = Random::new(1);
        let count = 100_000;
        let mean = |mut number: Box<dyn FnMut() -> f64>| {
            (0..count).map(|_| number()).sum::<f64>() / f64::from(count)
        };
        let mut again = random.clone();
        let first = mean(Box::new(move || again.number()));
        assert!(first.abs() < 0.01, "{first}");
        let mut again = random.clone();
        let square = mean(Box::new(move || again.normal().powi(2)));
        assert!((square - 1.0).abs() < 0.02, "{square}");
        let mut again = random.clone();
        let logarithm = mean(Box::new(move || again.logarithmic(1e-3, 1e3).log10()));
        assert!(logarithm.abs() < 0.03, "{logarithm}");
        let mut counts = [0_u32; 7];
        (0..count).for_each(|_| counts[random.below(7)] += 1);
        assert!(counts.iter().all(|n| n.abs_diff(count / 7) < 500), "{counts:?}");
    }
}
