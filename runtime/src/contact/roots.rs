//! All zeros of a quartic in [-1, 1].

use crate::scalar::{Real, constant};

/// At most so many: four zeros, and the three extrema where the polynomial may touch zero.
pub(super) const MOST: usize = 8;

/// Zeros in order, some of them perhaps twice.
pub(super) struct Zeros<T> {
    places: [T; MOST],
    count: usize,
}

impl<T: Real> Zeros<T> {
    fn none() -> Self {
        Self { places: [T::zero(); MOST], count: 0 }
    }

    fn push(&mut self, place: T) {
        if let Some(slot) = self.places.get_mut(self.count) {
            *slot = place;
            self.count += 1;
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = T> + '_ {
        self.places.iter().copied().take(self.count)
    }
}

/// The zeros in [-1, 1] of a polynomial with these coefficients, constant first, and the places where it touches zero up to rounding.
///
/// Between two zeros of its derivative a polynomial is monotone, so that bisection finds what is there: from the fourth derivative
/// down to the polynomial itself. At most 16 bisections.
pub(super) fn zeros<T: Real>(p: &[T; 5]) -> Zeros<T> {
    let mut size = T::zero();
    for coefficient in p {
        size += coefficient.abs().primal();
    }
    let mut found = Zeros::none();
    if size <= T::zero() {
        return found;
    }
    for order in (0..4_usize).rev() {
        let mut next = Zeros::none();
        let mut low = -T::one();
        for high in found.iter().chain(core::iter::once(T::one())) {
            if let Some(zero) = between(p, order, low, high) {
                next.push(zero);
            }
            low = high;
        }
        if order == 0 {
            let noise = constant::<T>(16.0) * T::default_epsilon() * size;
            for place in found.iter().chain([-T::one(), T::one()]) {
                if derivative(p, 0, place).abs() <= noise {
                    next.push(place);
                }
            }
        }
        found = next;
    }
    found
}

/// A derivative of the polynomial at x.
fn derivative<T: Real>(p: &[T; 5], order: usize, x: T) -> T {
    let mut total = T::zero();
    for (power, coefficient) in p.iter().enumerate().skip(order).rev() {
        let factor = (power - order + 1..=power).map(|k| k as f64).product::<f64>();
        total = total * x + *coefficient * constant(factor);
    }
    total
}

/// The zero of a derivative between two places, between which it is monotone.
fn between<T: Real>(p: &[T; 5], order: usize, low: T, high: T) -> Option<T> {
    let zero = T::zero();
    let (mut low, mut high) = (low.primal(), high.primal());
    let rises = derivative(p, order, low) < zero;
    if (derivative(p, order, high) < zero) == rises {
        return None;
    }
    for _ in 0..64 {
        let middle = (low + high) * constant(0.5);
        if (derivative(p, order, middle) < zero) == rises {
            low = middle;
        } else {
            high = middle;
        }
        if high - low <= T::default_epsilon() * constant(0.25) {
            break;
        }
    }
    // Two steps of Newton's method carry derivatives of the coefficients to the zero.
    let mut place = (low + high) * constant(0.5);
    if order == 0 {
        for _ in 0..2 {
            let slope = derivative(p, 1, place);
            let step = derivative(p, 0, place) / slope;
            // Else two zeros are about to merge.
            if step.abs() <= constant(1e-6) {
                place -= step;
            }
        }
    }
    Some(place)
}
