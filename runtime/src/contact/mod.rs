//! Lasting contact: mode, force and acceleration of a contact whose gap is closed and whose normal velocity
//! is zero.
//!
//! Under a contact force lambda (n, t, s) the relative velocity has the rate M lambda + beta, where M is the
//! reduced matrix and beta, the free acceleration of the contact, is the rate without contact force.
//! Coulomb's law allows four modes:
//!
//! | mode | force | holds while |
//! | --- | --- | --- |
//! | separate | none | beta_n > 0 |
//! | slide (slip d s, s > 0) | lambda_n (1, -mu d), lambda_n = -beta_n / f(d) | f > 0, lambda_n >= 0, s > 0 |
//! | stick (no slip) | the one without acceleration | lambda_n >= 0, abs(lambda_tan) <= mu lambda_n |
//! | begin to slip (no slip yet) | as slide, d along the acceleration | lambda_n >= 0, acceleration along d positive |
//!
//! with f = m_nn - mu b.d (31) and b = (m_nt, m_ns). [`contact_mode`] selects the mode at an event. Between
//! events [`contact_force`] keeps the mode, and its margins tell when the mode ends. Where mu |b| < m_nn at
//! least one mode fits, and well below that bound exactly one. Where several fit, `selection` of the
//! result says so; where a sliding contact has no finite force (Painleve's paradox) there is an error.
//!
//! Theory: docs/theory.md, section 17.

mod begin;
mod error;
mod roots;
mod select;
mod stick;
mod tangential;

use core::fmt;
use core::str::FromStr;

use nalgebra::{Vector2, Vector3};

pub use self::error::ContactError;
use crate::table::table;
use crate::{ReducedMatrix, Scalar, UnknownName};

/// What a closed contact does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ContactMode {
    /// The contact opens: no force.
    Separate,
    /// The contact slips, and friction acts against the slip.
    Slide,
    /// The contact does not slip, and friction keeps it from slipping.
    Stick,
    /// The slip is zero but its rate is not: slip begins.
    BeginSlip,
}

table! { ContactMode
    Separate "separate" "the contact opens",
    Slide "slide" "the point slides",
    Stick "stick" "the point sticks",
    BeginSlip "begin_slip" "the point begins to slip",
}

/// The name, as [`ContactMode::from_str`] reads it.
impl fmt::Display for ContactMode {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.name())
    }
}

/// ```
/// use hodograph::ContactMode;
/// for mode in ContactMode::ALL {
///     assert_eq!(mode.to_string().parse(), Ok(*mode));
/// }
/// assert!("roll".parse::<ContactMode>().is_err());
/// ```
impl FromStr for ContactMode {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let named = Self::ALL.iter().copied().find(|mode| mode.name() == name);
        named.ok_or(UnknownName { names: Self::NAMES })
    }
}

/// Whether the mode is the only one that fits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Selection {
    /// No other mode fits, or the mode was given.
    Unique,
    /// Several modes fit; this is the one whose force is nearest to the one before.
    SeveralModes,
    /// There are too many contacts to look for other modes.
    Unknown,
    /// The contact slides with f < 0 and beta_n >= 0: it may lift off or suffer an impact without collision.
    /// Lift-off is taken.
    Indeterminate,
}

/// How far the mode is from its end; the mode holds while all margins that are `Some` are positive.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
#[non_exhaustive]
pub struct Margins<T> {
    /// Normal force, N: at zero the contact lifts off. `None` while separate.
    pub lambda_n: Option<T>,
    /// f (31), 1/kg: at zero a sliding contact jams. `None` unless it slides or begins to.
    pub f: Option<T>,
    /// mu lambda_n - |lambda_tan|, N: at zero a sticking contact begins to slip. `None` unless it sticks.
    pub cone: Option<T>,
    /// Speed of slip, m/s: at zero slip ends. `None` unless it slides.
    pub s: Option<T>,
}

impl<T: Copy> Margins<T> {
    /// The margins with their names `lambda_n` (N), `f` (1/kg), `cone` (N), `s` (m/s); `None` where the mode
    /// does not have one.
    #[inline]
    pub const fn named(&self) -> [(&'static str, Option<T>); 4] {
        [("lambda_n", self.lambda_n), ("f", self.f), ("cone", self.cone), ("s", self.s)]
    }
}

impl<T: Scalar> Margins<T> {
    /// The name of the first margin that is not positive; `None` while the mode holds.
    #[inline]
    pub fn ended(&self) -> Option<&'static str> {
        let over = |margin: &(&'static str, Option<T>)| margin.1.is_some_and(|margin| margin <= T::zero());
        self.named().into_iter().find(over).map(|(name, _)| name)
    }
}

/// Mode, force and acceleration of a closed contact, along n, t, s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
#[non_exhaustive]
pub struct ContactForce<T: nalgebra::Scalar> {
    /// What the contact does.
    pub mode: ContactMode,
    /// Whether another mode would fit too.
    pub selection: Selection,
    /// Force on the striking point, N.
    pub force: Vector3<T>,
    /// Rate of the relative velocity under that force, m/s^2: M force + beta.
    pub acceleration: Vector3<T>,
    /// Direction of slip, or in which slip begins; of length one.
    pub direction: Option<Vector2<T>>,
    /// The quantities whose zeros end the mode.
    pub margins: Margins<T>,
    /// Whether no other force gives this acceleration in this mode. It is false where the contact is wedged:
    /// then the least force is given.
    pub force_is_unique: bool,
}

/// Selects the mode of a closed contact with v_n = 0, coming from no contact force (free flight, or an
/// impact).
///
/// `free_acceleration` is beta (n, t, s), `slip` the tangential velocity (t, s); the contact counts as not
/// slipping where it is exactly zero. Without slip all directions in which it may begin are computed, in some
/// 10 000 instructions; the work is bounded.
///
/// # Errors
/// Each reason is a variant of [`ContactError`].
#[inline]
pub fn contact_mode<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    free_acceleration: &Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
) -> Result<ContactForce<T>, ContactError<T>> {
    contact_mode_after(matrix, free_acceleration, slip, mu, &Vector3::zeros())
}

/// Selects the mode as [`contact_mode`] does; where several fit, the one whose force is nearest to the force
/// before.
///
/// # Errors
/// As [`contact_mode`].
#[inline]
pub fn contact_mode_after<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    free_acceleration: &Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
    force_before: &Vector3<T>,
) -> Result<ContactForce<T>, ContactError<T>> {
    select::select(matrix, free_acceleration, slip, mu, force_before)
}

/// Force and margins of a mode that is kept. A margin that is not positive says that the mode has ended; the
/// force is then the one that would keep it.
///
/// `slip` is read while sliding only. [`ContactMode::BeginSlip`] selects the direction anew.
///
/// # Errors
/// [`ContactError::Jam`] or [`ContactError::ImpactWithoutCollision`] where a sliding contact has no force;
/// [`ContactError::NoMode`] where no force keeps the contact from slipping, or none begins slip;
/// [`ContactError::Input`].
#[inline]
pub fn contact_force<T: Scalar>(
    mode: ContactMode,
    matrix: &ReducedMatrix<T>,
    free_acceleration: &Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
) -> Result<ContactForce<T>, ContactError<T>> {
    select::keep(mode, matrix, free_acceleration, slip, mu)
}
