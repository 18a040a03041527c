//! Random numbers that are the same everywhere.

/// The generator splitmix64.
pub struct Random(u64);

impl Random {
    /// A sequence that this number chooses.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// A number from -1 to 1: a multiple of 2^-23, which a single holds too.
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let bits = ((z ^ (z >> 31)) >> 40) as i32;
        f64::from(bits - (1 << 23)) / f64::from(1 << 23)
    }
}
