//! Finds all zeros of a polynomial of degree four in [-1, 1].

use crate::scalar::{Real, constant};

/// Room for four zeros and for three extrema at which the polynomial may touch zero.
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

/// The zeros in [-1, 1] of a polynomial with these coefficients, constant first, and the places where it
/// touches zero up to rounding.
///
/// Between two zeros of its derivative a polynomial is monotone, so that a bracket finds what is there: from
/// the third derivative down to the polynomial itself. At most 10 brackets.
pub(super) fn zeros<T: Real>(p: &[T; 5]) -> Zeros<T> {
    let mut size = T::zero();
    for coefficient in p {
        size += coefficient.abs().primal();
    }
    let mut found = Zeros::none();
    // The constant exceeds the sum of the other coefficients: no zero; or all coefficients are zero.
    let constant_part = p.first().map_or(T::zero(), |first| first.abs().primal());
    if size <= T::zero() || constant_part > (size - constant_part) * constant(1.0625) {
        return found;
    }
    let first = derivative(p);
    let second = derivative(&first);
    let third = derivative(&second);
    let fourth = derivative(&third);
    let chain =
        [(&third, &fourth, false), (&second, &third, false), (&first, &second, false), (p, &first, true)];
    for (q, slope, last) in chain {
        let mut next = Zeros::none();
        let mut low = -T::one();
        for high in found.iter().chain(core::iter::once(T::one())) {
            if let Some(zero) = between(q, slope, low, high) {
                next.push(if last { polished(p, &first, zero) } else { zero });
            }
            low = high;
        }
        if last {
            let noise = constant::<T>(16.0) * T::default_epsilon() * size;
            for place in found.iter().chain([-T::one(), T::one()]) {
                if value(p, place).abs() <= noise {
                    next.push(place);
                }
            }
        }
        found = next;
    }
    found
}

/// The polynomial at x.
#[inline]
fn value<T: Real>([a, b, c, d, e]: &[T; 5], x: T) -> T {
    (((*e * x + *d) * x + *c) * x + *b) * x + *a
}

/// The coefficients of the derivative.
#[inline]
fn derivative<T: Real>([_, b, c, d, e]: &[T; 5]) -> [T; 5] {
    let two = constant::<T>(2.0);
    [*b, two * *c, constant::<T>(3.0) * *d, constant::<T>(4.0) * *e, T::zero()]
}

/// The zero of a polynomial between two places between which it is monotone, by Newton's method, with
/// bisection where that leaves the bracket or converges too slowly.
fn between<T: Real>(q: &[T; 5], slope: &[T; 5], low: T, high: T) -> Option<T> {
    let (zero, half) = (T::zero(), constant::<T>(0.5));
    let (mut low, mut high) = (low.primal(), high.primal());
    let rises = value(q, low) < zero;
    if (value(q, high) < zero) == rises {
        return None;
    }
    // Steps of Newton's method do not become smaller than rounding.
    let enough = T::default_epsilon() * constant(4.0);
    let mut place = (low + high) * half;
    let mut last = high - low;
    // Every step is at most half as long as the one before, or halves the bracket.
    for _ in 0..128 {
        let here = value(q, place).primal();
        if (here < zero) == rises {
            low = place;
        } else {
            high = place;
        }
        if high - low <= enough {
            break;
        }
        let step = here / value(slope, place).primal();
        let next = place - step;
        if next > low && next < high && step.abs() <= last * half {
            last = step.abs();
            place = next;
            if last <= enough {
                break;
            }
        } else {
            last = (high - low) * half;
            place = low + last;
        }
    }
    Some(place)
}

/// Two more steps of Newton's method, after which the zero has the derivatives that follow from those of the
/// coefficients.
fn polished<T: Real>(p: &[T; 5], slope: &[T; 5], mut place: T) -> T {
    for _ in 0..2 {
        let step = value(p, place) / value(slope, place);
        // A larger step means that two zeros are about to merge; it is not taken.
        if step.abs() <= constant(1e-6) {
            place -= step;
        }
    }
    place
}
