//! Answers, told by their bits.

use hodograph::Scalar;

/// Doubles and singles.
pub trait Number: Scalar {
    /// `f32` or `f64`
    const NAME: &'static str;
    /// The nearest number of this type.
    fn of(value: f64) -> Self;
    /// The bits of the number.
    fn bits(self) -> u64;
}

impl Number for f64 {
    const NAME: &'static str = "f64";
    fn of(value: f64) -> Self {
        value
    }
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

impl Number for f32 {
    const NAME: &'static str = "f32";
    fn of(value: f64) -> Self {
        value as f32
    }
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

/// All bits that went in, mixed into one number (FNV-1a), and what they were of.
pub struct Digest {
    mixed: u64,
    /// Numbers that went in.
    pub numbers: u32,
    /// Answers that were errors.
    pub errors: u32,
}

impl Default for Digest {
    fn default() -> Self {
        Digest { mixed: 0xcbf2_9ce4_8422_2325, numbers: 0, errors: 0 }
    }
}

impl Digest {
    fn put(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.mixed = (self.mixed ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Takes numbers in. All that are not a number count as one: their bits tell how they came about, which
    /// targets may do differently.
    pub fn take<T: Number>(&mut self, numbers: &[T]) {
        for &number in numbers {
            self.numbers += 1;
            self.put(if number.partial_cmp(&number).is_some() { number.bits() } else { u64::MAX });
        }
    }

    /// Takes in that there was no answer.
    pub fn error(&mut self) {
        self.errors += 1;
        self.put(u64::MAX - 1);
    }

    /// The mixture.
    #[must_use]
    pub fn value(&self) -> u64 {
        self.mixed
    }
}
