//! The laws (hypotheses) of restitution.

/// The hypothesis of restitution: what the coefficient e means, and so where the collision ends (section 4 of
/// the paper).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[doc(alias = "RestitutionLaw")]
#[non_exhaustive]
pub enum Law {
    /// Kinematic: v_n2 = -e v_n1 (48). It may gain energy.
    Newton,
    /// Kinetic: I_n2 = (1 + e) I_nC (51).
    Poisson,
    /// Energetic: the normal work is (1 - e^2) of that at the end of compression (54). It never gains energy.
    Stronge,
}

impl Law {
    /// Every law, in the order of the variants.
    pub const ALL: &'static [Self] = &[Self::Newton, Self::Poisson, Self::Stronge];

    /// The name in lower case, as in JSON and on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        // Whoever is sent here by the compiler for a new law: it also belongs into `ALL`, just above.
        match self {
            Self::Newton => "newton",
            Self::Poisson => "poisson",
            Self::Stronge => "stronge",
        }
    }

    /// The law of this name.
    ///
    /// ```
    /// use hodograph::Law;
    /// assert!(Law::ALL.iter().all(|&law| Law::named(law.name()) == Some(law)));
    /// ```
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|law| law.name() == name)
    }
}
