//! Evaluation modulo primes at arbitrary inputs: it tells which values are identically equal, whatever their
//! form.
//!
//! Two rational functions that differ agree at arbitrary residues of their inputs with a probability of about
//! their degree over 2^64 (Schwartz and Zippel), if the prime does not divide their difference. Two places
//! with a prime each leave no room for chance. No size matters: what is attenuated by a factor of 1e-30 is
//! as visible as anything else.
//!
//! Sines, cosines and exponentials follow their addition theorems ([`functions`]). Functions with branches
//! (roots, magnitudes, arc functions) count as unknowns, which are equal where their arguments are. An
//! unknown hides some identities and makes up none.

pub mod functions;
mod nodes;
pub mod residue;

use residue::{FIRST_PRIME, Residue, SECOND_PRIME};

/// A value at both places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Residues(Residue<FIRST_PRIME>, Residue<SECOND_PRIME>);

impl Residues {
    /// 0
    pub const ZERO: Self = Residues(Residue::ZERO, Residue::ZERO);

    /// The sum.
    pub fn plus(self, other: Self) -> Self {
        Residues(self.0 + other.0, self.1 + other.1)
    }

    /// The product.
    pub fn times(self, other: Self) -> Self {
        Residues(self.0 * other.0, self.1 * other.1)
    }

    /// The reciprocal; `None` where the value is 0 at one of the places.
    pub fn reciprocal(self) -> Option<Self> {
        Some(Residues(self.0.reciprocal()?, self.1.reciprocal()?))
    }

    /// Whether the value is 0 at both places.
    pub fn is_zero(self) -> bool {
        self == Residues::ZERO
    }

    /// The opposite.
    pub fn opposite(self) -> Self {
        Residues(-self.0, -self.1)
    }

    /// Whether values add up to nothing.
    pub fn cancel(values: &[Residues]) -> bool {
        let first = values.iter().fold(Residue::ZERO, |sum, value| sum + value.0);
        let second = values.iter().fold(Residue::ZERO, |sum, value| sum + value.1);
        (first, second) == (Residue::ZERO, Residue::ZERO)
    }

    /// The numerator n if the value is n / `denominator` and the magnitude of n at most `largest`.
    pub fn multiple_of(self, denominator: u32, largest: u32) -> Option<i64> {
        let denominator = i64::from(denominator);
        let first = (self.0 * Residue::integer(denominator)).small(largest)?;
        let second = (self.1 * Residue::integer(denominator)).small(largest)?;
        (first == second).then_some(first)
    }
}

/// What can be evaluated modulo a prime.
pub trait Evaluate {
    /// Every value at a place: `None` where it is not known, as behind a division by zero.
    fn at<const P: u64>(&self, place: u64) -> Vec<Option<Residue<P>>>;

    /// Every value at both places.
    fn at_both(&self) -> Vec<Option<Residues>> {
        let (first, second) = (self.at(0), self.at(1));
        first.into_iter().zip(second).map(|(a, b)| Some(Residues(a?, b?))).collect()
    }
}
