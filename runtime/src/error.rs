//! The errors of the impact solver.

use core::fmt;

use crate::{Cause, Law};

/// The reason why a collision could not be solved, with the number at fault.
///
/// `Display` says what is wrong and what to do; [`ImpactError::kind`] is a stable name for programs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ImpactError<T> {
    /// An input is infinite or not a number, or the outcome is beyond the range of the number type: too
    /// large, or a normal impulse too small.
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
        /// The principal minor found negative: an entry, or a 2 x 2 or 3 x 3 determinant divided by the
        /// product of its diagonal.
        minor: T,
    },
    /// m_nn is zero: no impulse along the normal can move the contact.
    NoNormalMobility {
        /// The m_nn given, in 1/kg.
        nn: T,
    },
    /// An impact without collision was asked for (v_n1 = 0) where slip brings none: f (31) is not negative,
    /// or there is no slip.
    NoImpact {
        /// f in the direction of slip, or m_nn without slip, in 1/kg.
        rate: T,
    },
    /// The outcome found violates a law of impact by more than rounding explains: numbers of this precision
    /// do not determine the outcome.
    ///
    /// It takes a contact that is nearly wedged (mu close to mu_c of a singular matrix), or a singular
    /// contact with friction above the inverse of the rounding unit.
    Inaccurate {
        /// The law that is violated.
        violated: Violation,
        /// By how much, relative to the speeds or works of the impact.
        residual: T,
    },
    /// The bodies wedge: the law never ends the collision, because the normal velocity stops changing, while
    /// the contact sticks or slides.
    Wedged {
        /// The normal velocity at which it stops changing, in m/s.
        normal_velocity: T,
        /// The law that has no outcome.
        law: Law,
    },
    /// The collision needs more quadratures than the [budget](crate::Budgeted) allows.
    BudgetExceeded {
        /// The quadratures made: the budget.
        quadratures: u32,
        /// The normal velocity up to which the collision was followed, in m/s.
        normal_velocity: T,
    },
}

/// A text, or a number, by which no hypothesis of restitution goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct UnknownLaw<'a> {
    /// What was given.
    pub name: &'a str,
}

impl UnknownLaw<'_> {
    /// Its cause.
    pub const fn cause(&self) -> Cause {
        Cause::UnknownLaw
    }

    /// A stable lower-case name.
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl fmt::Display for UnknownLaw<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "there is no law `{}`: give one of ", self.name)?;
        for (place, name) in Law::NAMES.iter().enumerate() {
            out.write_str(if place > 0 { ", " } else { "" })?;
            out.write_str(name)?;
        }
        Ok(())
    }
}

impl core::error::Error for UnknownLaw<'_> {}

impl Law {
    /// The law of this name, as [`Law::named`], or an error that says which there are.
    ///
    /// ```
    /// use hodograph::Law;
    /// assert_eq!(Law::read("poisson"), Ok(Law::Poisson));
    /// let error = Law::read("hooke").unwrap_err();
    /// assert_eq!(error.to_string(), "there is no law `hooke`: give one of newton, poisson, stronge");
    /// ```
    ///
    /// # Errors
    ///
    /// [`UnknownLaw`].
    pub fn read(name: &str) -> Result<Self, UnknownLaw<'_>> {
        Self::named(name).ok_or(UnknownLaw { name })
    }
}

/// The laws that every outcome is checked against.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Violation {
    /// v_2 = v_1 + M I (20)-(22).
    Momentum,
    /// Coulomb's law: the tangential impulse is at most mu I_n.
    Friction,
    /// The bodies push each other and separate: I_n >= 0, v_n2 >= 0.
    Separation,
    /// Friction does not add energy.
    Energy,
    /// The law of restitution: the target of v_n2, I_n2 or the normal work.
    Restitution,
}

impl fmt::Display for Violation {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.write_str(match self {
            Self::Momentum => "the balance of momentum",
            Self::Friction => "Coulomb's law of friction",
            Self::Separation => "separation",
            Self::Energy => "dissipation by friction",
            Self::Restitution => "the law of restitution",
        })
    }
}

impl<T> ImpactError<T> {
    /// Its cause, without the numbers.
    #[inline]
    pub const fn cause(&self) -> Cause {
        match self {
            Self::NotFinite { .. } => Cause::NotFinite,
            Self::NegativeFriction { .. } => Cause::NegativeFriction,
            Self::RestitutionOutOfRange { .. } => Cause::RestitutionOutOfRange,
            Self::NotApproaching { .. } => Cause::NotApproaching,
            Self::NotPositiveSemidefinite { .. } => Cause::NotPositiveSemidefinite,
            Self::NoNormalMobility { .. } => Cause::NoNormalMobility,
            Self::NoImpact { .. } => Cause::NoImpact,
            Self::Inaccurate { .. } => Cause::Inaccurate,
            Self::Wedged { .. } => Cause::Wedged,
            Self::BudgetExceeded { .. } => Cause::BudgetExceeded,
        }
    }

    /// A stable lower-case name, the same that `hodograph solve` writes.
    #[inline]
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl<T: fmt::Debug + fmt::Display> fmt::Display for ImpactError<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { value } => write!(
                out,
                "an input or the outcome is not finite or beyond the range of the numbers ({value:?}): check the state and the parameters for \
                 overflow or division by zero"
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
            Self::NoImpact { rate } => write!(
                out,
                "nothing happens at normal velocity 0, because a normal impulse would part the bodies at the rate {rate}: an impact without \
                 collision needs f < 0"
            ),
            Self::Inaccurate { violated, residual } => write!(
                out,
                "rounding forbids an answer: the one found misses {violated} by {residual} of its scale; change mu, which is close to mu_c of \
                 a nearly wedged contact or very large, or use a wider number type"
            ),
            Self::Wedged { normal_velocity, law } => write!(
                out,
                "the contact wedges at normal velocity {normal_velocity}: no impulse ends the collision under {law:?}'s hypothesis; \
                 lower the friction{}",
                // Poisson's ends a collision that jams with v_n = 0, but not one that is still approaching.
                if *law == Law::Poisson {
                    ""
                } else {
                    " or, if the bodies merely jam, use Poisson's hypothesis"
                }
            ),
            Self::BudgetExceeded { quadratures, normal_velocity } => write!(
                out,
                "the collision was followed up to normal velocity {normal_velocity} when its budget of {quadratures} quadratures was spent: allow more, or \
                 use what the program keeps for a missed answer"
            ),
        }
    }
}

impl<T: fmt::Debug + fmt::Display> core::error::Error for ImpactError<T> {}
