//! Exact evaluation modulo a prime at arbitrary inputs: it tells which values are identically equal, whatever
//! their form.
//!
//! Two expressions that agree at arbitrary residues of their inputs are equal as rational functions, but for
//! a probability of about their degree over 2^64 at each of the two places (Schwartz and Zippel). No size
//! matters: what is attenuated by a factor of 1e-30 is as visible as anything else.
//!
//! Sines, cosines and exponentials follow their addition theorems ([`functions`]). Functions with branches
//! (roots, magnitudes, arc functions) count as unknowns, which are equal where their arguments are. An
//! unknown hides some identities; it never shows a false one.

mod functions;
mod graph;
mod operations;
mod residue;

pub use residue::Residue;

/// Number of places at which values are evaluated.
pub const PLACES: usize = 2;

/// A value at all places.
pub type Residues = [Residue; PLACES];

/// What every value is at all places: `None` where it is not known, as behind a division by zero.
fn at_all_places(evaluate: impl Fn(u64) -> Vec<Option<Residue>>) -> Vec<Option<Residues>> {
    let [first, second] = [evaluate(0), evaluate(1)];
    first.into_iter().zip(second).map(|(a, b)| Some([a?, b?])).collect()
}

/// The multiple of 1 / `denominator` that a value is at all places, if its numerator is at most `largest`.
pub fn multiple_of(residues: &Residues, denominator: u32, largest: u32) -> Option<i64> {
    let numerators =
        residues.map(|residue| (residue * Residue::integer(i64::from(denominator))).small(largest));
    numerators[0].filter(|_| numerators.iter().all(|other| *other == numerators[0]))
}
