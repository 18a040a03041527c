//! The problem of k contacts, its solutions, and the reasons why there may be none.

use std::fmt;

use hodograph::several::Certificate;
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

/// A problem of k contacts whose forces are unknown. The unit of lambda times that of W is that of beta.
#[derive(Clone, Copy, Debug)]
pub struct Problem<'a> {
    /// W, 3 k x 3 k, (n, t, s) of each contact; positive semidefinite, perhaps singular, and symmetric but for
    /// rounding.
    pub w: &'a DMatrix<f64>,
    /// The accelerations without forces of the contacts.
    pub beta: &'a DVector<f64>,
    /// The coefficient of friction of each contact.
    pub mu: &'a [f64],
    /// The direction of slip (t, s) of each contact, of length one; `None` without slip.
    pub slip: &'a [Option<Vector2<f64>>],
    /// Bounds of the rounding errors of the components of beta: accelerations below them count as zero.
    pub noise: Option<&'a DVector<f64>>,
}

impl Problem<'_> {
    /// The number of contacts.
    pub fn contacts(&self) -> usize {
        self.mu.len()
    }

    /// Checks lengths and numbers.
    pub(super) fn check(&self) -> Result<(), Unsolved> {
        let (k, n) = (self.mu.len(), 3 * self.mu.len());
        let lengths = self.w.shape() == (n, n)
            && self.beta.len() == n
            && self.slip.len() == k
            && self.noise.is_none_or(|noise| noise.len() == n);
        if !lengths {
            return Err(Unsolved::Lengths);
        }
        for i in 0..k {
            let finite = self.w.columns(3 * i, 3).iter().all(|entry| entry.is_finite())
                && self.beta.rows(3 * i, 3).iter().all(|entry| entry.is_finite())
                && self
                    .noise
                    .is_none_or(|noise| noise.rows(3 * i, 3).iter().all(|e| e.is_finite() && *e >= 0.0))
                && self.mu[i].is_finite()
                && self.slip[i].is_none_or(|d| d.x.is_finite() && d.y.is_finite());
            let positive = self.mu[i] >= 0.0 && (3 * i..3 * i + 3).all(|row| self.w[(row, row)] >= 0.0);
            if !(finite && positive) {
                return Err(Unsolved::Input { contact: i });
            }
        }
        Ok(())
    }

    /// Whether some contact shares the normal force of another one (docs/theory.md, section 17.17) and has no
    /// effect besides.
    pub(super) fn shares_normal_forces(&self) -> bool {
        let k = self.contacts();
        let shares = |i: usize, j: usize| self.w[(3 * i, 3 * j)] != 0.0 && self.w[(3 * j, 3 * i)] == 0.0;
        (0..k).any(|i| (0..i).any(|j| shares(i, j)))
    }

    /// The rounding error of a component of beta.
    pub(super) fn noise(&self, row: usize) -> f64 {
        self.noise.map_or(0.0, |noise| noise[row])
    }

    /// A component of beta; zero if it is below its rounding error.
    pub(super) fn pull(&self, row: usize) -> f64 {
        if self.beta[row].abs() <= self.noise(row) { 0.0 } else { self.beta[row] }
    }

    /// The scale s_i, about tr(W_ii)^(-1/2): lambda = s x and a = v / s obey the same laws.
    pub(super) fn scale(&self, i: usize) -> f64 {
        let trace: f64 = (3 * i..3 * i + 3).map(|row| self.w[(row, row)]).sum();
        if trace <= 0.0 {
            return 1.0;
        }
        let scale = 1.0 / trace.sqrt();
        // A power of two causes no rounding errors.
        let power = f64::from_bits(scale.to_bits() & (0x7ff << 52));
        if power > 0.0 { power } else { scale }
    }
}

/// The mode of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mode {
    /// It separates: no force.
    Separate,
    /// It sticks: no slip, and no beginning of slip.
    Stick,
    /// It slips, or begins to slip, along a direction (t, s) of length one.
    Slide(Vector2<f64>),
}

impl Mode {
    /// The name of the mode: lower case, and stable between versions.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Separate => "separate",
            Self::Stick => "stick",
            Self::Slide(_) => "slide",
        }
    }

    /// Whether two modes have the same name.
    pub fn is_like(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// How many solutions a problem has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solutions {
    /// The solution is the only one.
    Unique,
    /// There are solutions in other modes.
    Several,
    /// Unknown: not examined, or too many contacts.
    Unknown,
}

impl Solutions {
    /// The name: lower case, and stable between versions.
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Unique => "unique",
            Self::Several => "several",
            Self::Unknown => "unknown",
        }
    }
}

/// Forces that obey the laws.
#[derive(Clone, Debug)]
pub struct Solution {
    /// lambda, n, t, s of each contact
    pub force: DVector<f64>,
    /// W lambda + beta
    pub acceleration: DVector<f64>,
    /// The mode of each contact.
    pub modes: Vec<Mode>,
    /// The greatest violation of each law, relative to its terms.
    pub certificate: Certificate<f64>,
    /// Whether there are solutions in other modes.
    pub solutions: Solutions,
}

/// Why no forces are found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unsolved {
    /// The sizes of the matrix, the vectors and the lists do not fit one number of contacts.
    Lengths,
    /// A number is not finite, or mu or a diagonal entry of W is negative.
    Input {
        /// The invalid contact.
        contact: usize,
    },
    /// The existence of forces is not known: friction of this sliding contact accelerates the bodies towards
    /// each other more than its normal force separates them (jam).
    Jam {
        /// The contact that jams.
        contact: usize,
        /// f of this contact alone, W_nn - mu W_nT d, or while the others keep their modes.
        f: f64,
    },
    /// No forces with an acceptable certificate were found.
    NotFound {
        /// The least violation that was reached.
        violation: f64,
    },
}

impl fmt::Display for Unsolved {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lengths => write!(out, "matrix and vectors do not belong to one number of contacts"),
            Self::Input { contact } => {
                write!(
                    out,
                    "contact {contact}: a number is not finite, or mu or the diagonal of W is negative"
                )
            }
            Self::Jam { contact, f } => {
                write!(out, "contact {contact} jams (f = {f:e}): no finite forces exist")
            }
            Self::NotFound { violation } => {
                write!(out, "no forces found that obey the laws (least violation {violation:e})")
            }
        }
    }
}

impl std::error::Error for Unsolved {}

/// The force or acceleration of contact `i`.
pub(super) fn three(values: &DVector<f64>, i: usize) -> Vector3<f64> {
    Vector3::new(values[3 * i], values[3 * i + 1], values[3 * i + 2])
}
