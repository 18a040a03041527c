//! Operations on one number of every state of a block.

use hodograph_arithmetic::trigonometry::{is_within, near_zero, reduced, turned};

use crate::arithmetic::sin_cos;

/// How many states a block has.
pub const LANES: usize = 32;
/// How many of them are computed before any result is stored: a result may then take the place of an operand.
pub const WIDTH: usize = 8;

/// One number of every state of a block.
pub type Slot = [[f64; WIDTH]; LANES / WIDTH];

/// Where an operand is.
pub trait Operand: Copy {
    /// Its numbers for the states of a part of the block.
    fn part(self, slots: &[Slot], uniforms: &[f64], part: usize) -> [f64; WIDTH];
}

/// In the slot of this number.
#[derive(Clone, Copy)]
pub struct InSlot(pub u32);

/// The same for all states: the uniform of this number.
#[derive(Clone, Copy)]
pub struct Uniform(pub u32);

impl Operand for InSlot {
    #[inline(always)]
    fn part(self, slots: &[Slot], _: &[f64], part: usize) -> [f64; WIDTH] {
        slots[self.0 as usize][part]
    }
}

impl Operand for Uniform {
    #[inline(always)]
    fn part(self, _: &[Slot], uniforms: &[f64], _: usize) -> [f64; WIDTH] {
        [uniforms[self.0 as usize]; WIDTH]
    }
}

/// The numbers that steps work on.
pub struct Numbers<'a> {
    /// one number of every state
    pub slots: &'a mut [Slot],
    /// one number for all states
    pub uniforms: &'a [f64],
}

impl Numbers<'_> {
    /// A function of one operand.
    #[inline(always)]
    pub fn one<A: Operand>(&mut self, to: u32, a: A, f: impl Fn(f64) -> f64) {
        for part in 0..LANES / WIDTH {
            let a = a.part(self.slots, self.uniforms, part);
            let result = std::array::from_fn(|lane| f(a[lane]));
            self.slots[to as usize][part] = result;
        }
    }

    /// A function of two operands.
    #[inline(always)]
    pub fn two<A: Operand, B: Operand>(&mut self, to: u32, a: A, b: B, f: impl Fn(f64, f64) -> f64) {
        for part in 0..LANES / WIDTH {
            let a = a.part(self.slots, self.uniforms, part);
            let b = b.part(self.slots, self.uniforms, part);
            let result = std::array::from_fn(|lane| f(a[lane], b[lane]));
            self.slots[to as usize][part] = result;
        }
    }

    /// A function of three operands.
    #[inline(always)]
    pub fn three<A: Operand, B: Operand, C: Operand>(
        &mut self,
        to: u32,
        (a, b, c): (A, B, C),
        f: impl Fn(f64, f64, f64) -> f64,
    ) {
        for part in 0..LANES / WIDTH {
            let a = a.part(self.slots, self.uniforms, part);
            let b = b.part(self.slots, self.uniforms, part);
            let c = c.part(self.slots, self.uniforms, part);
            let result = std::array::from_fn(|lane| f(a[lane], b[lane], c[lane]));
            self.slots[to as usize][part] = result;
        }
    }

    /// Sine and cosine.
    pub fn sine_cosine(&mut self, sine: u32, cosine: u32, a: u32) {
        let (sines, cosines) = sines_cosines(&self.slots[a as usize]);
        self.slots[sine as usize] = sines;
        self.slots[cosine as usize] = cosines;
    }
}

/// Sines and cosines of a block: for each state what [`sin_cos`] gives, to the last bit.
#[inline(never)]
fn sines_cosines(angles: &Slot) -> (Slot, Slot) {
    let (mut sines, mut cosines) = (*angles, *angles);
    let (s, c) = (sines.as_flattened_mut(), cosines.as_flattened_mut());
    let angles = angles.as_flattened();
    let within = angles.iter().fold(true, |within, &angle| within & is_within(angle));
    for ((s, c), &angle) in s.iter_mut().zip(c).zip(angles) {
        (*s, *c) = if within {
            let (r, low, turns) = reduced(angle);
            turned(near_zero(r, low), turns)
        } else {
            sin_cos(angle)
        };
    }
    (sines, cosines)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bits_of_sines_and_cosines_are_those_one_by_one() {
        let spread = (0..40_000).map(|k| (f64::from(k) * 0.618_033_988_749_895).fract() * 400.0 - 200.0);
        let right = (-500..500).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_4);
        let edges = [0.0, -0.0, 5e-324, -1e-300, 524_288.0, -524_287.5, 0.3, 1.0];
        let beyond = [1e9, f64::NAN, f64::INFINITY, 0.5, -1e300, 2.0, -0.0, 524_289.0];
        let all: Vec<f64> = spread.chain(right).chain(edges).chain(beyond).collect();
        for angles in all.chunks_exact(LANES) {
            let mut block = [[0.0; WIDTH]; LANES / WIDTH];
            block.as_flattened_mut().copy_from_slice(angles);
            let (sines, cosines) = sines_cosines(&block);
            for (lane, &angle) in angles.iter().enumerate() {
                let (sine, cosine) = sin_cos(angle);
                let found = (sines.as_flattened()[lane], cosines.as_flattened()[lane]);
                assert!(found.0.to_bits() == sine.to_bits() || sine.is_nan() && found.0.is_nan(), "{angle}");
                assert!(
                    found.1.to_bits() == cosine.to_bits() || cosine.is_nan() && found.1.is_nan(),
                    "{angle}"
                );
            }
        }
    }
}
