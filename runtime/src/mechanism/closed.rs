//! The result of a mechanism's closed contact: mode, force and acceleration.

use nalgebra::Vector3;

use crate::{ContactForce, ReducedMatrix};

/// Mode, force and acceleration of a closed contact, with the numbers that they were computed from. The
/// contact basis is `normal`, `first`, `second`: unit vectors, right-handed, called n, t, s.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
#[non_exhaustive]
pub struct ContactOutcome<T: nalgebra::Scalar = f64> {
    /// normal n along N.x, N.y, N.z, from what is struck towards the striking point
    pub normal: Vector3<T>,
    /// first tangential axis t along N.x, N.y, N.z
    pub first: Vector3<T>,
    /// second tangential axis s along N.x, N.y, N.z
    pub second: Vector3<T>,
    /// velocity of the striking point relative to what it touches, along n, t, s, m/s. The answer takes its
    /// first component as zero.
    pub velocity: Vector3<T>,
    /// reduced mass matrix V M^-1 V^T (20)-(22) along n, t, s, 1/kg
    pub reduced: ReducedMatrix<T>,
    /// beta: rate of that velocity without contact force, along n, t, s, m/s^2
    pub free_acceleration: Vector3<T>,
    /// force on the striking point along N.x, N.y, N.z, N; what is touched receives its opposite
    pub force_on_point: Vector3<T>,
    /// direction of slip, or in which slip begins, along N.x, N.y, N.z; of length one
    pub direction: Option<Vector3<T>>,
    /// mode, force (N), rate of the velocity under that force (m/s^2) and margins, along n, t, s
    pub answer: ContactForce<T>,
}
