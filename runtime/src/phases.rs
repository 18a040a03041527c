//! Snapshots of a collision: all quantities at one normal impulse, and the snapshots at which phases begin or
//! end.

use nalgebra::Vector3;

use crate::Scalar;

/// What the contact does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Motion {
    /// It slips (34).
    Sliding,
    /// It does not slip (45).
    Sticking,
    /// It slips in the direction phi_hat, after slip had stopped or from the start (46).
    Renewal,
}

/// All quantities at one instant of a collision, in the axes n, t, s of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Snapshot<T: nalgebra::Scalar> {
    /// Impulse (n, t, s) so far, in N s; the first is I_n.
    pub impulse: Vector3<T>,
    /// Relative velocity (n, t, s), in m/s.
    pub velocity: Vector3<T>,
    /// Work of the impulse so far (23), in J.
    pub contact_work: T,
    /// Work of the normal impulse so far (35b), in J.
    pub normal_work: T,
    /// The motion of the contact; where two phases meet, that of the later one.
    pub motion: Motion,
}

impl<T: Scalar> Snapshot<T> {
    /// The normal impulse I_n, in N s.
    #[inline]
    pub fn normal_impulse(&self) -> T {
        self.impulse.x
    }

    /// The speed of slip s, in m/s.
    #[inline]
    pub fn slip(&self) -> T {
        (self.velocity.y * self.velocity.y + self.velocity.z * self.velocity.z).sqrt()
    }

    /// The direction of slip phi from t towards s, in radians; `None` without slip.
    #[inline]
    pub fn direction(&self) -> Option<T> {
        let none = self.velocity.y == T::zero() && self.velocity.z == T::zero();
        (!none).then(|| self.velocity.z.atan2(self.velocity.y))
    }

    /// Whether the bodies approach each other (v_n < 0): compression.
    #[inline]
    pub fn compresses(&self) -> bool {
        self.velocity.x < T::zero()
    }
}

/// The instants at which a phase begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Phases<T: nalgebra::Scalar> {
    /// The end of the first compression: v_n = 0 (index C in the paper). Its normal impulse is I_nC (49), its
    /// normal work E_nC (52).
    ///
    /// Under Newton's hypothesis the outcome does not depend on it while slip lasts: [`crate::solve`] then
    /// does not locate it and leaves `None`; [`crate::Hodograph`] always locates it.
    pub compression_end: Option<Snapshot<T>>,
    /// The end of the latest compression, the one the law counts from; the same as the first unless the
    /// bodies approached again.
    pub last_compression_end: Option<Snapshot<T>>,
    /// Where slip stopped (index S in the paper); `None` if it never did, or there was none at the start. Its
    /// normal impulse is I_nS, its normal velocity v_nS, its normal work E_nS (sections 6.2 and 6.3).
    pub slip_end: Option<Snapshot<T>>,
}
