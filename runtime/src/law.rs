//! The laws (hypotheses) of restitution.

/// The hypothesis of restitution: what the coefficient e means, and so where the collision ends (section 4 of the paper).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[doc(alias = "RestitutionLaw")]
pub enum Law {
    /// Kinematic: v_n2 = -e v_n1 (48). It may gain energy.
    Newton,
    /// Kinetic: I_n2 = (1 + e) I_nC (51).
    Poisson,
    /// Energetic: the normal work is (1 - e^2) of that at the end of compression (54). It never gains energy.
    Stronge,
}
