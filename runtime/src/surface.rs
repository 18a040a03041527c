//! The pair of surfaces in contact: friction and restitution.

use crate::Law;

/// The pair of surfaces in contact: one coefficient of friction, one of restitution, and what the latter means.
///
/// The fields are plain numbers; [`crate::solve`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Surface<T> {
    /// Coulomb's coefficient of friction, not negative.
    pub mu: T,
    /// Coefficient of restitution, in [0, 1].
    pub e: T,
    /// The hypothesis `e` belongs to.
    pub law: Law,
}
