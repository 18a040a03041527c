//! The reduced mass matrix of a contact.

use nalgebra::{Matrix3, Vector3};

use crate::Scalar;

/// The symmetric 3 x 3 matrix of the reduced equations of motion (20)-(22), along n, t, s, in 1/kg.
///
/// It maps a contact impulse (n, t, s) to the change of the relative velocity at the contact (n, t, s). It is
/// positive semidefinite; singular ones are ordinary (a planar system, a joint or a rolling contact at the
/// body struck). t and s may be any orthonormal pair in the contact plane: nothing needs t to lie along the
/// slip.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ReducedMatrix<T> {
    /// m_nn > 0.
    pub nn: T,
    /// m_nt.
    pub nt: T,
    /// m_ns.
    pub ns: T,
    /// m_tt >= 0.
    pub tt: T,
    /// m_ts.
    pub ts: T,
    /// m_ss >= 0.
    pub ss: T,
}

impl<T> ReducedMatrix<T> {
    /// From the entries in the order nn, nt, ns, tt, ts, ss.
    #[inline]
    pub const fn new(nn: T, nt: T, ns: T, tt: T, ts: T, ss: T) -> Self {
        Self { nn, nt, ns, tt, ts, ss }
    }
}

impl<T: Scalar> ReducedMatrix<T> {
    /// The change of relative velocity (n, t, s) that an impulse (n, t, s) causes: (20)-(22).
    #[inline]
    pub fn apply(&self, impulse: &Vector3<T>) -> Vector3<T> {
        let (n, t, s) = (impulse.x, impulse.y, impulse.z);
        Vector3::new(
            self.nn * n + self.nt * t + self.ns * s,
            self.nt * n + self.tt * t + self.ts * s,
            self.ns * n + self.ts * t + self.ss * s,
        )
    }

    /// The same contact in tangential axes turned by an angle about n: new t = cos t + sin s, new s = cos s -
    /// sin t.
    ///
    /// `cos` and `sin` are those of the angle; their squares must add up to one.
    #[inline]
    pub fn turned(&self, cos: T, sin: T) -> Self {
        let tt = self.tt * cos * cos + (self.ts + self.ts) * cos * sin + self.ss * sin * sin;
        Self {
            nn: self.nn,
            nt: self.nt * cos + self.ns * sin,
            ns: self.ns * cos - self.nt * sin,
            tt,
            ts: self.ts * (cos * cos - sin * sin) + (self.ss - self.tt) * cos * sin,
            ss: self.tt + self.ss - tt,
        }
    }
}

/// Takes the lower triangle; the other entries are not read.
impl<T: Scalar> From<Matrix3<T>> for ReducedMatrix<T> {
    #[inline]
    fn from(m: Matrix3<T>) -> Self {
        Self::new(m.m11, m.m21, m.m31, m.m22, m.m32, m.m33)
    }
}

impl<T: Scalar> From<ReducedMatrix<T>> for Matrix3<T> {
    #[inline]
    fn from(m: ReducedMatrix<T>) -> Self {
        Matrix3::new(m.nn, m.nt, m.ns, m.nt, m.tt, m.ts, m.ns, m.ts, m.ss)
    }
}

/// The entries in the order nn, nt, ns, tt, ts, ss.
impl<T> From<[T; 6]> for ReducedMatrix<T> {
    #[inline]
    fn from([nn, nt, ns, tt, ts, ss]: [T; 6]) -> Self {
        Self::new(nn, nt, ns, tt, ts, ss)
    }
}

/// The entries in the order nn, nt, ns, tt, ts, ss.
impl<T> From<ReducedMatrix<T>> for [T; 6] {
    #[inline]
    fn from(m: ReducedMatrix<T>) -> Self {
        [m.nn, m.nt, m.ns, m.tt, m.ts, m.ss]
    }
}
