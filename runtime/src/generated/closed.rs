//! Calls the functions of lasting contact for a contact of a generated module, and decides which slip counts
//! as zero.
//!
//! Theory: docs/theory.md, section 18.12.

use nalgebra::{Vector2, Vector3};

use super::Contact;
use crate::scalar::{Real, constant};
use crate::{
    ClosedContactError, ContactForce, ContactMode, ContactOutcome, Scalar, contact_force, contact_mode,
};

/// The rounding error of a velocity, in rounding units of the sum of the sizes of its terms.
const ROUNDINGS: f64 = 64.0;

/// The largest slip that rounding alone can make where the exact slip is zero: the terms (partial velocities,
/// by rows, times speeds, and prescribed motion) cancel up to their roundings.
#[inline]
pub fn slip_noise<T: Scalar>(partial_velocities: &[T], speeds: &[T], remainder: &Vector3<T>) -> T {
    let mut terms = remainder.iter().fold(T::zero(), |sum, part| sum + Real::abs(*part));
    // Without speeds there are no rows.
    for row in partial_velocities.chunks_exact(speeds.len().max(1)) {
        for (&partial, &speed) in row.iter().zip(speeds) {
            terms += Real::abs(partial * speed);
        }
    }
    terms * constant::<T>(ROUNDINGS) * <T as Real>::default_epsilon()
}

/// Mode and force of a contact whose gap is closed and whose normal velocity counts as zero; slip below
/// `noise` counts as none.
///
/// # Errors
///
/// Those of [`contact_mode`].
#[inline]
pub fn closed_contact<T: Scalar>(
    contact: &Contact<T>,
    free_acceleration: &Vector3<T>,
    noise: T,
    mu: T,
) -> Result<ContactOutcome<T>, ClosedContactError<T>> {
    let mut slip = contact.velocity.yz();
    if (slip.x * slip.x + slip.y * slip.y).sqrt() <= noise {
        slip = Vector2::zeros();
    }
    let answer = contact_mode(&contact.reduced, free_acceleration, &slip, mu)?;
    Ok(outcome(contact, free_acceleration, answer))
}

/// Force of a contact whose mode is kept.
///
/// # Errors
///
/// Those of [`contact_force`].
#[inline]
pub fn kept_contact<T: Scalar>(
    mode: ContactMode,
    contact: &Contact<T>,
    free_acceleration: &Vector3<T>,
    mu: T,
) -> Result<ContactOutcome<T>, ClosedContactError<T>> {
    let slip = contact.velocity.yz();
    let answer = contact_force(mode, &contact.reduced, free_acceleration, &slip, mu)?;
    Ok(outcome(contact, free_acceleration, answer))
}

fn outcome<T: Scalar>(
    contact: &Contact<T>,
    free_acceleration: &Vector3<T>,
    answer: ContactForce<T>,
) -> ContactOutcome<T> {
    let Contact { normal, first, second, velocity, reduced, .. } = *contact;
    ContactOutcome {
        normal,
        first,
        second,
        velocity,
        reduced,
        free_acceleration: *free_acceleration,
        force_on_point: normal * answer.force.x + first * answer.force.y + second * answer.force.z,
        direction: answer.direction.map(|d| first * d.x + second * d.y),
        answer,
    }
}
