//! Random numbers that are the same on every machine.

/// A generator of 64-bit numbers (splitmix64).
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A place in a list of so many.
    pub fn place(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// A quaternion of length one, nearly uniform over the rotations.
    pub fn rotation(&mut self) -> [f64; 4] {
        loop {
            let four = [0; 4].map(|_| self.between(-1.0, 1.0));
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
