//! Assembles the saltation matrix of a collision of a generated module from the derivatives of its contact.
//!
//! Theory: docs/theory.md, section 13.4.

use nalgebra::{SMatrix, SVector, Vector3, Vector6};

use crate::{CollisionError, ImpactDerivative, ImpactError, Saltation, Scalar, saltation};

/// The rates of the state: of the independent coordinates, whose places among all coordinates are given, then
/// of the `P` speeds.
#[inline]
pub fn state<T: Scalar, const K: usize, const C: usize, const P: usize, const N: usize>(
    rates: &[T; K],
    independent: &[usize; C],
    accelerations: &[T; P],
) -> SVector<T, N> {
    let coordinates = independent.iter().map(|&index| rates.get(index).copied().unwrap_or(T::zero()));
    SVector::from_iterator(
        coordinates.chain(accelerations.iter().copied()).chain(core::iter::repeat(T::zero())).take(N),
    )
}

/// The derivative of the jump of the state: the block of the speeds and the identity for coordinates, without
/// the derivatives of speeds by coordinates.
#[inline]
pub fn reset<T: Scalar, const P: usize, const N: usize>(speeds: &SMatrix<T, P, P>) -> SMatrix<T, N, N> {
    let first = N.saturating_sub(P);
    SMatrix::from_fn(|row, column| {
        let speed = row.checked_sub(first).and_then(|row| Some((row, column.checked_sub(first)?)));
        match speed.and_then(|place| speeds.get(place)) {
            Some(&entry) => entry,
            None if row == column => T::one(),
            None => T::zero(),
        }
    })
}

/// Adds the derivatives of the speeds after the collision with respect to one coordinate, and returns that of
/// the gap. `change` holds the derivatives of velocity, reduced matrix, response and gap with respect to that
/// coordinate, in this order.
#[inline]
pub fn by_coordinate<T: Scalar, const P: usize, const N: usize>(
    reset: &mut SMatrix<T, N, N>,
    column: usize,
    outcome: &ImpactDerivative<T>,
    response: &SMatrix<T, P, 3>,
    change: &[T],
) -> T {
    let at = |index: usize| change.get(index).copied().unwrap_or(T::zero());
    let velocity = Vector3::from_fn(|i, _| at(i));
    let matrix = Vector6::from_fn(|i, _| at(3 + i));
    let of_response = SMatrix::<T, P, 3>::from_fn(|i, j| at(9 + 3 * i + j));
    let impulse = outcome.impulse_by_approach() * velocity + outcome.impulse_by_matrix() * matrix;
    let speeds = response * impulse + of_response * outcome.impact.impulse;
    let first = N.saturating_sub(P);
    for (row, speed) in speeds.iter().enumerate() {
        if let Some(entry) = reset.get_mut((first + row, column)) {
            *entry = *speed;
        }
    }
    at(9 + 3 * P)
}

/// The derivatives of velocity, reduced matrix, response and gap of a contact with respect to all
/// coordinates.
pub type ByCoordinates<'a, T, const P: usize, const C: usize> =
    (&'a SMatrix<T, 3, C>, &'a SMatrix<T, 6, C>, &'a [SMatrix<T, P, 3>; C], &'a SVector<T, C>);

/// The same as [`by_coordinate`], of one coordinate out of the derivatives with respect to all.
#[inline]
pub fn by_coordinates<T: Scalar, const P: usize, const C: usize, const N: usize>(
    reset: &mut SMatrix<T, N, N>,
    column: usize,
    outcome: &ImpactDerivative<T>,
    response: &SMatrix<T, P, 3>,
    (velocity, matrix, of_response, gap): ByCoordinates<'_, T, P, C>,
) -> T {
    let velocity = Vector3::from_fn(|i, _| velocity.get((i, column)).copied().unwrap_or(T::zero()));
    let matrix = Vector6::from_fn(|i, _| matrix.get((i, column)).copied().unwrap_or(T::zero()));
    let of_response = of_response.get(column).copied().unwrap_or(SMatrix::zeros());
    let impulse = outcome.impulse_by_approach() * velocity + outcome.impulse_by_matrix() * matrix;
    let speeds = response * impulse + of_response * outcome.impact.impulse;
    let first = N.saturating_sub(P);
    for (row, speed) in speeds.iter().enumerate() {
        if let Some(entry) = reset.get_mut((first + row, column)) {
            *entry = *speed;
        }
    }
    gap.get(column).copied().unwrap_or(T::zero())
}

/// The saltation matrix; an error where the gap opens.
///
/// # Errors
///
/// The contact does not approach: the gap of the model is not the distance along the normal.
#[inline]
pub fn salted<T: Scalar, const N: usize>(
    reset: &SMatrix<T, N, N>,
    before: &SVector<T, N>,
    after: &SVector<T, N>,
    gap: &SVector<T, N>,
    outcome: &ImpactDerivative<T>,
) -> Result<Saltation<T, N>, CollisionError<T>> {
    match saltation(reset, before, after, gap) {
        Some(matrix) => Ok(Saltation { matrix, non_smoothness: outcome.non_smoothness }),
        None => Err(ImpactError::NotApproaching { normal_velocity: gap.dot(before) }.into()),
    }
}
