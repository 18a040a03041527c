//! Operations on one number of every state of a block.

use hodograph_arithmetic::trigonometry::{is_within, near_zero, reduced, turned};

use super::steps::{Factor, Sign, Step, Term};
use hodograph_model::arithmetic::{mul_add, sin_cos};

/// Number of states in a block. It is so large that finding out what a step does costs little beside its arithmetic, and so
/// small that sums of products stay in registers, and the slots of large mechanisms in the core's own cache: sums of 48 states
/// take twelve of sixteen registers of four doubles, or six of 32 of eight. (Quadruped, 461 slots, 177 kB: 32 and 64 states
/// in a block take 1.01 and 1.03 of the time with four doubles in a register, 1.05 and 0.98 with eight.)
pub const LANES: usize = 48;
/// Number of states that are computed before any result is stored, so that a result may overwrite an operand.
pub const WIDTH: usize = 8;

/// One value for every state of a block. A vector register is loaded from one line of the cache.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Slot(pub [[f64; WIDTH]; LANES / WIDTH]);

impl Slot {
    /// The same number for every state.
    pub const fn of(number: f64) -> Self {
        Self([[number; WIDTH]; LANES / WIDTH])
    }
}

/// The place of an operand.
pub trait Operand: Copy {
    /// The operand of this index.
    fn at(index: u32) -> Self;
    /// Its values for the states of one part of the block.
    fn part(self, slots: &[Slot], uniforms: &[f64], part: usize) -> [f64; WIDTH];
}

/// An operand in the slot with this index.
#[derive(Clone, Copy)]
pub struct InSlot(pub u32);

/// An operand that is the same for all states: the uniform with this index.
#[derive(Clone, Copy)]
pub struct Uniform(pub u32);

impl Operand for InSlot {
    #[inline(always)]
    fn at(index: u32) -> Self {
        Self(index)
    }
    #[inline(always)]
    fn part(self, slots: &[Slot], _: &[f64], part: usize) -> [f64; WIDTH] {
        slots[self.0 as usize].0[part]
    }
}

impl Operand for Uniform {
    #[inline(always)]
    fn at(index: u32) -> Self {
        Self(index)
    }
    #[inline(always)]
    fn part(self, _: &[Slot], uniforms: &[f64], _: usize) -> [f64; WIDTH] {
        [uniforms[self.0 as usize]; WIDTH]
    }
}

/// The storage of the steps.
pub struct Numbers<'a> {
    /// one value for every state
    pub slots: &'a mut [Slot],
    /// one value for all states
    pub uniforms: &'a [f64],
}

impl Numbers<'_> {
    /// Applies a function of one operand.
    #[inline(always)]
    pub fn one<A: Operand>(&mut self, steps: &[Step], f: impl Fn(f64) -> f64) {
        let (slots, uniforms) = (&mut *self.slots, self.uniforms);
        for step in steps {
            let a = A::at(step.a);
            for part in 0..LANES / WIDTH {
                let a = a.part(slots, uniforms, part);
                let result = std::array::from_fn(|lane| f(a[lane]));
                slots[step.to as usize].0[part] = result;
            }
        }
    }

    /// Applies a function of two operands.
    #[inline(always)]
    pub fn two<A: Operand, B: Operand>(&mut self, steps: &[Step], f: impl Fn(f64, f64) -> f64) {
        let (slots, uniforms) = (&mut *self.slots, self.uniforms);
        for step in steps {
            let (a, b) = (A::at(step.a), B::at(step.b));
            for part in 0..LANES / WIDTH {
                let a = a.part(slots, uniforms, part);
                let b = b.part(slots, uniforms, part);
                let result = std::array::from_fn(|lane| f(a[lane], b[lane]));
                slots[step.to as usize].0[part] = result;
            }
        }
    }

    /// Applies a function of three operands.
    #[inline(always)]
    pub fn three<A: Operand, B: Operand, C: Operand>(
        &mut self,
        steps: &[Step],
        f: impl Fn(f64, f64, f64) -> f64,
    ) {
        let (slots, uniforms) = (&mut *self.slots, self.uniforms);
        for step in steps {
            let (a, b, c) = (A::at(step.a), B::at(step.b), C::at(step.c));
            for part in 0..LANES / WIDTH {
                let a = a.part(slots, uniforms, part);
                let b = b.part(slots, uniforms, part);
                let c = c.part(slots, uniforms, part);
                let result = std::array::from_fn(|lane| f(a[lane], b[lane], c[lane]));
                slots[step.to as usize].0[part] = result;
            }
        }
    }

    /// Sums of products, which stay in registers. An addition need not wait for the one before, for there are several
    /// groups of states.
    #[inline(always)]
    pub fn chain(&mut self, steps: &[Step], terms: &[Term<Factor>]) {
        let (slots, same) = (&mut *self.slots, self.uniforms);
        for step in steps {
            let first = Factor(step.c);
            let mut sums = match first.is_same() {
                true => Slot::of(same[first.index()]),
                false => slots[first.index()],
            };
            for term in terms.get(step.a as usize..(step.a + step.b) as usize).unwrap_or(&[]) {
                let [a, b] = term.factors;
                // signs that the compiler knows cost nothing
                match (a.is_same(), b.is_same(), term.sign) {
                    (false, false, Sign::Plus) => two(&mut sums, &slots[a.index()], &slots[b.index()], plus),
                    (false, false, Sign::Minus) => {
                        two(&mut sums, &slots[a.index()], &slots[b.index()], minus)
                    }
                    (false, false, Sign::MinusSum) => {
                        two(&mut sums, &slots[a.index()], &slots[b.index()], minus_sum);
                    }
                    (false, true, Sign::Plus) => one(&mut sums, &slots[a.index()], same[b.index()], plus),
                    (false, true, Sign::Minus) => one(&mut sums, &slots[a.index()], same[b.index()], minus),
                    (false, true, Sign::MinusSum) => {
                        one(&mut sums, &slots[a.index()], same[b.index()], minus_sum);
                    }
                    (true, ..) => {
                        let a = Slot::of(same[a.index()]);
                        match term.sign {
                            Sign::Plus => one(&mut sums, &a, same[b.index()], plus),
                            Sign::Minus => one(&mut sums, &a, same[b.index()], minus),
                            Sign::MinusSum => one(&mut sums, &a, same[b.index()], minus_sum),
                        }
                    }
                }
            }
            slots[step.to as usize] = sums;
        }
    }

    /// Sine and cosine.
    #[inline(always)]
    pub fn sine_cosine(&mut self, steps: &[Step]) {
        for step in steps {
            let mut sines = self.slots[step.a as usize];
            let mut cosines = sines;
            sines_cosines(sines.0.as_flattened_mut(), cosines.0.as_flattened_mut());
            self.slots[step.to as usize] = sines;
            self.slots[step.b as usize] = cosines;
        }
    }
}

#[inline(always)]
fn plus(sum: f64, a: f64, b: f64) -> f64 {
    mul_add(a, b, sum)
}

#[inline(always)]
fn minus(sum: f64, a: f64, b: f64) -> f64 {
    mul_add(-a, b, sum)
}

#[inline(always)]
fn minus_sum(sum: f64, a: f64, b: f64) -> f64 {
    mul_add(a, b, -sum)
}

/// Goes on with sums by the products of two slots.
#[inline(always)]
fn two(sums: &mut Slot, a: &Slot, b: &Slot, next: impl Fn(f64, f64, f64) -> f64) {
    for ((sums, a), b) in sums.0.iter_mut().zip(&a.0).zip(&b.0) {
        *sums = std::array::from_fn(|lane| next(sums[lane], a[lane], b[lane]));
    }
}

/// Goes on with sums by the products of a slot and a number.
#[inline(always)]
fn one(sums: &mut Slot, a: &Slot, b: f64, next: impl Fn(f64, f64, f64) -> f64) {
    for (sums, a) in sums.0.iter_mut().zip(&a.0) {
        *sums = std::array::from_fn(|lane| next(sums[lane], a[lane], b));
    }
}

/// Replaces the angles, which both slices hold, by their sines and cosines, bit for bit those of [`sin_cos`].
#[inline(always)]
fn sines_cosines(sines: &mut [f64], cosines: &mut [f64]) {
    let within = sines.iter().fold(true, |within, &angle| within & is_within(angle));
    for (s, c) in sines.iter_mut().zip(cosines) {
        let angle = *c;
        (*s, *c) = if within {
            let (r, low, shifted) = reduced(angle);
            turned(near_zero(r, low), shifted.to_bits())
        } else {
            sin_cos(angle)
        };
    }
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
        // no remainder of fewer than WIDTH angles
        assert!(all.len().is_multiple_of(WIDTH));
        for angles in all.chunks(LANES) {
            let (mut sines, mut cosines) = (angles.to_vec(), angles.to_vec());
            sines_cosines(&mut sines, &mut cosines);
            for (lane, &angle) in angles.iter().enumerate() {
                let (sine, cosine) = sin_cos(angle);
                let found = (sines[lane], cosines[lane]);
                assert!(found.0.to_bits() == sine.to_bits() || sine.is_nan() && found.0.is_nan(), "{angle}");
                assert!(
                    found.1.to_bits() == cosine.to_bits() || cosine.is_nan() && found.1.is_nan(),
                    "{angle}"
                );
            }
        }
    }
}
