//! Why a collision has no answer.

use core::fmt;

use crate::Law;

/// The reason why a collision could not be solved, with the number at fault.
///
/// `Display` says what is wrong and what to do; [`ImpactError::kind`] is a stable name for programs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ImpactError<T> {
    /// An input is infinite or not a number, or the outcome is too large for the number type.
    NotFinite {
        /// The value found.
        value: T,
    },
    /// The coefficient of friction is negative.
    NegativeFriction {
        /// The coefficient given.
        mu: T,
    },
    /// The coefficient of restitution is outside [0, 1].
    RestitutionOutOfRange {
        /// The coefficient given.
        e: T,
    },
    /// The bodies do not approach each other: v_n1 >= 0.
    NotApproaching {
        /// The normal relative velocity given, in m/s.
        normal_velocity: T,
    },
    /// The reduced matrix is not positive semidefinite, so it belongs to no mechanism.
    NotPositiveSemidefinite {
        /// The principal minor found negative: an entry, or a 2 x 2 or 3 x 3 determinant divided by the product of its diagonal.
        minor: T,
    },
    /// m_nn is zero: no impulse along the normal can move the contact.
    NoNormalMobility {
        /// The m_nn given, in 1/kg.
        nn: T,
    },
    /// The bodies wedge: no outcome satisfies this law, because the normal velocity stops changing, stuck or sliding.
    Wedged {
        /// The normal velocity at which the contact jams, in m/s.
        normal_velocity: T,
        /// The law that has no outcome.
        law: Law,
    },
}

impl<T> ImpactError<T> {
    /// A stable lower-case name, the same that `hodograph solve` writes.
    #[inline]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "not_finite",
            Self::NegativeFriction { .. } => "negative_friction",
            Self::RestitutionOutOfRange { .. } => "restitution_out_of_range",
            Self::NotApproaching { .. } => "not_approaching",
            Self::NotPositiveSemidefinite { .. } => "not_positive_semidefinite",
            Self::NoNormalMobility { .. } => "no_normal_mobility",
            Self::Wedged { .. } => "wedged",
        }
    }
}

impl<T: fmt::Display> fmt::Display for ImpactError<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { value } => write!(
                out,
                "an input or the outcome is not finite ({value}): check the state and the parameters for overflow or division by zero"
            ),
            Self::NegativeFriction { mu } => {
                write!(out, "the coefficient of friction is {mu}: it must not be negative")
            }
            Self::RestitutionOutOfRange { e } => {
                write!(out, "the coefficient of restitution is {e}: it must lie between 0 and 1")
            }
            Self::NotApproaching { normal_velocity } => write!(
                out,
                "the normal velocity is {normal_velocity}: the bodies collide only if it is negative; call this when they approach, \
                 and let the normal point from the body struck towards the striking point"
            ),
            Self::NotPositiveSemidefinite { minor } => write!(
                out,
                "the reduced mass matrix is not positive semidefinite (a principal minor is {minor}): check its entries and their \
                 order nn, nt, ns, tt, ts, ss"
            ),
            Self::NoNormalMobility { nn } => write!(
                out,
                "m_nn is {nn}: no impulse along the normal can move the contact point; check the normal and the constraints"
            ),
            Self::Wedged { normal_velocity, law } => write!(
                out,
                "the contact wedges at normal velocity {normal_velocity}: no impulse ends the collision under {law:?}'s hypothesis; \
                 lower the friction{}",
                match law {
                    // It ends a collision that jams with v_n = 0, but not one that is still approaching.
                    Law::Poisson => "",
                    Law::Newton | Law::Stronge => " or, if the bodies merely jam, use Poisson's hypothesis",
                }
            ),
        }
    }
}

impl<T: fmt::Debug + fmt::Display> core::error::Error for ImpactError<T> {}
