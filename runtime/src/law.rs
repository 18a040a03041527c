//! The laws (hypotheses) of restitution.

use core::fmt;
use core::str::FromStr;

use crate::table::table;

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

table! { Law
    Newton "newton" "ratio of normal velocities",
    Poisson "poisson" "ratio of normal impulses",
    Stronge "stronge" "ratio of works of the normal force",
}

impl Law {
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

/// The name, as [`Law::from_str`] reads it.
impl fmt::Display for Law {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.name())
    }
}

/// ```
/// use hodograph::Law;
/// assert_eq!("stronge".parse(), Ok(Law::Stronge));
/// assert_eq!(Law::Poisson.to_string().parse(), Ok(Law::Poisson));
/// let refused = "hertz".parse::<Law>().unwrap_err();
/// assert_eq!(refused.to_string(), "this is none of newton, poisson, stronge");
/// ```
impl FromStr for Law {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        Self::named(name).ok_or(UnknownName { names: Self::NAMES })
    }
}

/// A text that is none of the names that it may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct UnknownName {
    /// The names.
    pub names: &'static [&'static str],
}

impl fmt::Display for UnknownName {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str("this is none of ")?;
        for (index, name) in self.names.iter().enumerate() {
            out.write_str(if index > 0 { ", " } else { "" })?;
            out.write_str(name)?;
        }
        Ok(())
    }
}

impl core::error::Error for UnknownName {}
