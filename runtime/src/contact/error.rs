//! The errors of a closed contact: why no finite force exists.

use core::fmt;

use crate::{Cause, ImpactError};

/// The reason why a closed contact has no finite force, with the numbers at fault.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum ContactError<T> {
    /// The contact slides with f < 0 and is pressed together: any force presses it together more. What
    /// follows is an impact without collision (Painleve's paradox).
    ImpactWithoutCollision {
        /// f (31), 1/kg, negative.
        f: T,
        /// beta_n, m/s^2, negative.
        free_acceleration: T,
    },
    /// The contact slides with f = 0 and is pressed together: the force grows beyond all bounds (dynamic
    /// jam). What follows is an impact without collision.
    Jam {
        /// beta_n, m/s^2, negative.
        free_acceleration: T,
    },
    /// No force agrees with the mode, or with any mode. Tangential motion that no impulse can change
    /// (prescribed motion) may leave a contact so.
    NoMode {
        /// beta_n, m/s^2.
        free_acceleration: T,
    },
    /// An input is impossible: not finite, mu < 0, a matrix that is not positive semidefinite, or m_nn = 0.
    Input(ImpactError<T>),
}

impl<T> ContactError<T> {
    /// Its cause, without the numbers.
    #[inline]
    pub const fn cause(&self) -> Cause {
        match self {
            Self::ImpactWithoutCollision { .. } => Cause::ImpactWithoutCollision,
            Self::Jam { .. } => Cause::Jam,
            Self::NoMode { .. } => Cause::NoMode,
            Self::Input(error) => error.cause(),
        }
    }

    /// A stable lower-case name.
    #[inline]
    pub const fn kind(&self) -> &'static str {
        self.cause().name()
    }
}

impl<T: fmt::Debug + fmt::Display> fmt::Display for ContactError<T> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::ImpactWithoutCollision { f, free_acceleration } => write!(
                out,
                "the contact slides with f = {f} and the free acceleration {free_acceleration}: no finite force holds it; solve an \
                 impact without collision"
            ),
            Self::Jam { free_acceleration } => write!(
                out,
                "the contact slides with f = 0 and the free acceleration {free_acceleration}: its force grows beyond all bounds; solve \
                 an impact without collision"
            ),
            Self::NoMode { free_acceleration } => write!(
                out,
                "no contact force agrees with this mode (free normal acceleration {free_acceleration}): select the mode anew, and check \
                 the free acceleration where motion is prescribed"
            ),
            Self::Input(error) => error.fmt(out),
        }
    }
}

impl<T: fmt::Debug + fmt::Display + 'static> core::error::Error for ContactError<T> {
    fn source(&self) -> Option<&(dyn core::error::Error + 'static)> {
        match self {
            Self::Input(error) => Some(error),
            _ => None,
        }
    }
}

impl<T> From<ImpactError<T>> for ContactError<T> {
    fn from(error: ImpactError<T>) -> Self {
        Self::Input(error)
    }
}
