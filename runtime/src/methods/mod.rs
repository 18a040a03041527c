//! The paper's own solutions: numerical integration (55), recursive summation (56), and partial integration
//! or summation (57)-(62).
//!
//! [`crate::solve`] gives the same outcomes to machine precision at a lower cost. These methods serve study
//! and comparison, and as an independent check of every outcome: they share nothing with the exact solver but
//! the check of the input.
//!
//! All work in `f64`, in the units of the input (1/kg, m/s, N s, J), and take the velocity of approach in any
//! tangential axes (phi starts at atan2(v_s, v_t), not at 0). They also treat what the paper leaves out: no
//! slip at the start, singular matrices, and repeated compression (compression ends at each upward zero of
//! v_n; no law ends a collision while v_n < 0).
//!
//! They return the phases of a collision, but set none of the flags of [`crate::Sensitivity`].
//!
//! Each answers a [`Solution`]: the outcome, and the number of steps it took.
//!
//! # What is corrected
//!
//! * (56f): the terms of renewal and sticking are v_n(i-1) + f_hat D(i) and v_n(i-1) + D(i) / c_n; (56h): the
//!   first term begins with I_s(i-1). As printed they multiply by v_n(i-1) and take I_t.
//! * 6.1: the eigenvalues (not eigenvectors) are (h' +- sqrt(h'^2 - 4 h g')) / (2 s), and a step D is stable
//!   if |1 + lambda D| <= 1.
//! * 6.3.3: with Stronge's hypothesis v_n2 of (61) is 0.269934 (mu = 1.1) and 0.184789 (mu = 1.6) for the
//!   paper's own inputs, not 0.203 and 0.267.
//! * (41), (43): mu_c and the terminal rates are formed with the pseudo-inverse of the tangential block, so
//!   that they exist for planar and other singular matrices too (Appendix C prints 0/0).
//!
//! Theory: docs/theory.md, section 15.

mod equations;
mod integrate;
mod irs;
mod law;
mod outcome;
mod runge_kutta;
mod stability;
mod sum;

use core::fmt;

pub use self::{
    integrate::{Integration, Switch, integrate},
    irs::{Partial, irs},
    stability::{Stability, stability},
    sum::{Summation, sum},
};
use crate::{Impact, ImpactError};

/// What a method answers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// The outcome of the collision.
    pub impact: Impact<f64>,
    /// Steps made: of the summation (i of (56)), the last one included, or tried by the integration. What is
    /// evaluated in closed form takes none.
    pub steps: u32,
}

/// Why a method has no result.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum MethodError {
    /// The collision has no outcome or is ill-posed: the same errors as [`crate::solve`].
    Impact(ImpactError<f64>),
    /// The method did not come to an end within its bound of steps (a summation too fine, a tolerance too
    /// small, or a contact that wedges).
    Unfinished {
        /// Steps made.
        steps: u32,
        /// The normal velocity reached, in m/s.
        normal_velocity: f64,
    },
    /// An option of the method is out of range.
    BadOption {
        /// The option.
        name: &'static str,
        /// The value given.
        value: f64,
    },
}

impl MethodError {
    /// A stable lower-case name, as [`ImpactError::kind`].
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Impact(error) => error.kind(),
            Self::Unfinished { .. } => "unfinished",
            Self::BadOption { .. } => "bad_option",
        }
    }
}

impl From<ImpactError<f64>> for MethodError {
    fn from(error: ImpactError<f64>) -> Self {
        Self::Impact(error)
    }
}

impl fmt::Display for MethodError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Impact(error) => error.fmt(out),
            Self::Unfinished { steps, normal_velocity } => write!(
                out,
                "no end of the collision within {steps} steps (normal velocity {normal_velocity}): the contact may wedge; try the exact \
                 solver, a coarser summation or a larger tolerance"
            ),
            Self::BadOption { name, value } => {
                write!(out, "the option `{name}` of the method is {value}: it is out of range")
            }
        }
    }
}

impl core::error::Error for MethodError {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Impact(error) => Some(error),
            Self::Unfinished { .. } | Self::BadOption { .. } => None,
        }
    }
}
