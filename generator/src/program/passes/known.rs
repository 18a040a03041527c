//! Numbers of twice the digits with an error bound, for evaluation at arbitrary inputs: they tell whether a value is identically zero.

use crate::arithmetic::reproducible::Reproducible;
use crate::arithmetic::{Arithmetic, Function};
use crate::program::graph::Input;

/// Number of places at which nodes are evaluated.
pub const PLACES: usize = 4;
/// Rounding of an operation, relatively: less than this.
const ROUNDING: f64 = 1e-30;
/// What cancels to less than this part of its terms is looked at.
const CANCELLED: f64 = 1e-20;
/// A number may differ by this multiple of its error bound.
const SLACK: f64 = 16.0;

/// A number, a bound of its error, and the size of what it was added up from.
#[derive(Clone, Copy)]
pub struct Known {
    /// the number
    pub number: Reproducible,
    /// its error is at most this
    pub error: f64,
    /// the largest of its terms
    pub size: f64,
}

impl Known {
    /// A number as it is.
    pub fn exact(number: Reproducible) -> Self {
        Known::with(number, 0.0)
    }

    fn with(number: Reproducible, error: f64) -> Self {
        let size = number.rounded().abs();
        Known { number, error: error + ROUNDING * size, size }
    }

    /// A sum.
    pub fn sum(terms: impl Iterator<Item = Known>) -> Self {
        let zero = Known { number: Reproducible::exactly(0.0), error: 0.0, size: 0.0 };
        terms.fold(zero, |sum, term| {
            let size = sum.size.max(term.number.rounded().abs());
            let number = sum.number + term.number;
            Known { number, error: sum.error + term.error + ROUNDING * size, size }
        })
    }

    /// The opposite.
    pub fn opposite(self) -> Self {
        Known { number: -self.number, ..self }
    }

    /// A product.
    pub fn times(self, other: Self) -> Self {
        let error = self.error * other.number.rounded().abs() + other.error * self.number.rounded().abs();
        Known::with(self.number * other.number, error)
    }

    /// 1 / a
    pub fn reciprocal(self) -> Self {
        let number = Reproducible::exactly(1.0) / self.number;
        Known::with(number, self.error * number.rounded().powi(2))
    }

    /// Whether it is this number, as far as can be told, and for no other reason than that its terms cancel.
    pub fn is(self, number: f64) -> bool {
        let difference = (self.number - Reproducible::exactly(number)).rounded().abs();
        difference <= SLACK * self.error && self.error <= CANCELLED * self.size
    }
}

/// A function without branches; `None` of others.
pub fn analytic(function: Function, a: Known) -> Option<Known> {
    use Function::*;
    let number = match function {
        Sin | Cos | Tan | Exp | Sinh | Cosh | Tanh => a.number.call(function),
        _ => return None,
    };
    let value = number.rounded().abs();
    // at least the slope
    let slope = match function {
        Tan => 1.0 + value * value,
        Exp => value,
        Sinh | Cosh => 1.0 + value,
        _ => 1.0,
    };
    Some(Known::with(number, slope * a.error + ROUNDING))
}

/// The seed of a number from outside.
pub fn seed_of(input: Input) -> u64 {
    let (kind, index) = match input {
        Input::Time => (0, 0),
        Input::Parameter(index) => (1, index),
        Input::Coordinate(index) => (2, index),
        Input::Speed(index) => (3, index),
        Input::Input(index) => (4, index),
        Input::Acceleration(index) => (5, index),
        Input::Tangent(index) => (6, index),
    };
    kind << 32 | u64::from(index)
}

/// A number from 0.3 to 2 with any sign: always the same for a seed and a place.
pub fn arbitrary(seed: u64, place: usize) -> Known {
    let mut bits =
        (seed.wrapping_mul(PLACES as u64).wrapping_add(place as u64)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    for _ in 0..3 {
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    }
    let unit = (bits >> 11) as f64 / (1u64 << 53) as f64;
    let size = 0.3 + 1.7 * unit;
    Known::exact(Reproducible::exactly(if bits & 1 == 0 { size } else { -size }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn functions_carry_at_least_the_error_of_their_argument() {
        use Function::*;
        let delta = 1e-6;
        for function in [Sin, Cos, Tan, Exp, Sinh, Cosh, Tanh] {
            for x in [-1.4, -0.5, 0.1, 0.9, 1.3] {
                let of = |x: f64| Reproducible::exactly(x).call(function).rounded();
                let uncertain = Known { number: Reproducible::exactly(x), error: delta, size: x.abs() };
                let Some(known) = analytic(function, uncertain) else { panic!("{function:?}") };
                for moved in [x - delta, x + delta] {
                    let change = (of(moved) - of(x)).abs();
                    assert!(
                        change <= known.error * (1.0 + 1e-4),
                        "{function:?} {x}: {change} {}",
                        known.error
                    );
                }
            }
        }
        assert!(analytic(Abs, Known::exact(Reproducible::exactly(1.0))).is_none());
    }

    #[test]
    fn what_is_not_known_well_is_no_number() {
        let of = |number: f64, error: f64| Known { number: Reproducible::exactly(number), error, size: 1.0 };
        assert!(of(0.0, 1e-30).is(0.0) && of(1e-30, 1e-30).is(0.0) && of(2.0, 1e-30).is(2.0));
        assert!(!of(1e-27, 1e-30).is(0.0), "beyond its error");
        assert!(!of(0.0, 1e-10).is(0.0) && !of(1e-10, 1e-10).is(0.0), "too uncertain");
    }
}
