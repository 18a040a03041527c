//! Arbitrary numbers, always the same for a seed: states and parameters at which expressions are compared.

/// A sequence of arbitrary numbers (Marsaglia's xorshift64). Derivations depend on it: it stays as it is.
pub struct Arbitrary(u64);

impl Arbitrary {
    /// The sequence after this word, which is not 0.
    pub fn after(word: u64) -> Self {
        Arbitrary(word)
    }

    /// 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// From 0 to 1, the latter excluded.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From -1 to 1, the latter excluded.
    pub fn number(&mut self) -> f64 {
        2.0 * self.unit() - 1.0
    }
}
