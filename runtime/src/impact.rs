//! The outcome of a collision.

use nalgebra::Vector3;

use crate::{Motion, Phases, Scalar, Sensitivity, scalar::constant, table::table};

/// The phases of a collision in order. A phase without impulse is left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Path {
    /// Slip from beginning to end (section 3.1).
    Sliding,
    /// Slip that stops, then sticking until the end (section 3.2; mu >= mu_c).
    SlidingThenSticking,
    /// Slip that stops and is renewed at once in the direction phi_hat (section 3.3; mu < mu_c).
    SlidingThenRenewal,
    /// No slip at any time: there was none at the start, and mu >= mu_c.
    Sticking,
    /// No slip at the start; slip begins at once in the direction phi_hat (mu < mu_c).
    Renewal,
}

table! { Path
    Sliding "sliding" "the point slides throughout",
    SlidingThenSticking "sliding_then_sticking" "it slides, then sticks",
    SlidingThenRenewal "sliding_then_renewal" "it slides, stops, and slides again",
    Sticking "sticking" "it sticks throughout",
    Renewal "renewal" "it starts without slip, and slides",
}

impl Path {
    /// The names of the phases in order.
    #[inline]
    pub const fn phases(self) -> &'static [&'static str] {
        match self {
            Self::Sliding => &["sliding"],
            Self::SlidingThenSticking => &["sliding", "sticking"],
            Self::SlidingThenRenewal => &["sliding", "renewal"],
            Self::Sticking => &["sticking"],
            Self::Renewal => &["renewal"],
        }
    }

    /// The last phase.
    pub(crate) const fn last(self) -> Motion {
        match self {
            Self::Sliding => Motion::Sliding,
            Self::SlidingThenSticking | Self::Sticking => Motion::Sticking,
            Self::SlidingThenRenewal | Self::Renewal => Motion::Renewal,
        }
    }
}

/// The phases in order: `sliding, then sticking`.
impl core::fmt::Display for Path {
    fn fmt(&self, out: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        for (index, phase) in self.phases().iter().enumerate() {
            out.write_str(if index > 0 { ", then " } else { "" })?;
            out.write_str(phase)?;
        }
        Ok(())
    }
}

/// The outcome of a collision, in the axes n, t, s of the input.
#[must_use]
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Impact<T: nalgebra::Scalar> {
    /// Velocity of approach (n, t, s) as given, in m/s.
    pub approach: Vector3<T>,
    /// Impulse (n, t, s) on the striking point, in N s.
    pub impulse: Vector3<T>,
    /// Velocity of separation (n, t, s), in m/s.
    pub velocity: Vector3<T>,
    /// Work of the contact impulse (23), in J: the change of mechanical energy unless motion is prescribed.
    pub contact_work: T,
    /// Work of the normal impulse alone, the integral of v_n dI_n (35b), in J.
    pub normal_work: T,
    /// The phases of the collision.
    pub path: Path,
    /// How often compression ended: 1, or 2 if the bodies approached again during restitution.
    pub compressions: u32,
    /// All quantities at the instants where compression ended and where slip stopped.
    pub phases: Phases<T>,
    /// Flags for situations in which a small change of the input changes the outcome by much.
    pub sensitivity: Sensitivity,
}

impl<T: Scalar> Impact<T> {
    /// The energy that the collision gained, in J, if it did: the work (23) where it is positive by more than
    /// its rounding, see [`energy_gained`].
    ///
    /// Newton's hypothesis can gain energy. Stronge's cannot. For Poisson's no proof is known, and no
    /// collision that gains.
    #[inline]
    pub fn energy_gained(&self) -> Option<T> {
        energy_gained(&self.impulse, &self.approach, &self.velocity)
    }
}

/// The roundings of the terms of the work that are no gain.
const ROUNDINGS: f64 = 64.0;

/// The energy that a collision gained, in J, if it did, from its impulse (N s), velocity of approach and
/// velocity of separation (m/s), each along n, t, s.
///
/// It is the work I.(v1 + v2) / 2 of the impulse (23), if that is greater than 64 roundings of its terms,
/// (|I_n| (|v_n1| + |v_n2|) + |I_t| (|v_t1| + |v_t2|) + |I_s| (|v_s1| + |v_s2|)) / 2. A collision that loses
/// nothing, as without friction for e = 1, has a work of some such roundings instead of zero.
///
/// Theory: docs/theory.md, sections 9.6 and 18.8.
#[inline]
pub fn energy_gained<T: Scalar>(
    impulse: &Vector3<T>,
    approach: &Vector3<T>,
    separation: &Vector3<T>,
) -> Option<T> {
    let half = constant::<T>(0.5);
    let work = impulse.dot(&(separation + approach)) * half;
    let terms = impulse.abs().dot(&(separation.abs() + approach.abs())) * half;
    (work > constant::<T>(ROUNDINGS) * T::default_epsilon() * terms).then_some(work)
}
