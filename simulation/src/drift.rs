//! Corrects the drift of the integration after each step: lengths of quaternions, closed loops, gaps and
//! velocities of closed contacts.

use hodograph::{ComponentKind, Contacts, State, StateError};
use nalgebra::{DMatrix, DVector};

use crate::closed_contacts::{ClosedContacts, least_squares};
use crate::torques::WithTorques;

/// Steps of Newton's method at most.
const STEPS: usize = 4;

/// Brings quaternions to length one and takes a few of Newton's steps towards closed loops, from dependent coordinates that
/// are nearly right. Answers the last change of a coordinate, relative to the greatest coordinate or 1.
///
/// # Errors
///
/// The mechanism cannot be evaluated there.
pub fn close_loops(
    mechanism: &dyn Contacts<f64>,
    time: f64,
    coordinates: &mut [f64],
    speeds: &[f64],
    inputs: &[f64],
) -> Result<f64, StateError> {
    mechanism.normalise(coordinates)?;
    let count = mechanism.count(ComponentKind::DependentCoordinate);
    if count == 0 {
        return Ok(0.0);
    }
    let places: Vec<usize> = (0..count).filter_map(|index| mechanism.dependent_coordinate(index)).collect();
    let (mut residual, mut jacobian) = (vec![0.0; count], vec![0.0; count * count]);
    let mut last = 0.0;
    for _ in 0..STEPS {
        let state = State { time, coordinates: &*coordinates, speeds, inputs };
        mechanism.configuration(&state, &mut residual, &mut jacobian)?;
        let matrix = DMatrix::from_row_slice(count, count, &jacobian);
        let change = least_squares(&matrix, &-DVector::from_column_slice(&residual));
        for (&place, change) in places.iter().zip(change.iter()) {
            coordinates[place] += change;
        }
        let size = coordinates.iter().fold(0.0_f64, |size, q| size.max(q.abs()));
        last = change.amax() / size.max(1.0);
        if change.amax() <= 64.0 * f64::EPSILON * size {
            break;
        }
    }
    Ok(last)
}

/// A gap that was not closed: the contact, and the gap that is left, m.
pub(crate) struct Left {
    pub contact: usize,
    pub gap: f64,
}

/// A gap counts as closed where the correction leaves no more than this part of the coordinates' size.
const CLOSED: f64 = 1e-10;

/// The coordinates moved so that the gaps of these contacts vanish, by the least motion in the sense of the
/// mass matrix; the first gap that it does not close, if there is one, and what it knows of the contacts. `least`
/// is a length that is small in the problem: 1e-13 of it is rounding.
pub(crate) fn close_gaps(
    mechanism: WithTorques<'_>,
    time: f64,
    coordinates: &mut [f64],
    speeds: &[f64],
    inputs: &[f64],
    contacts: &[usize],
    least: f64,
) -> Result<(Option<Left>, Option<ClosedContacts>), StateError> {
    let n = coordinates.len();
    let size = coordinates.iter().fold(least, |size, q| size.max(q.abs()));
    let mut before = f64::INFINITY;
    let mut known = None;
    for _ in 0..STEPS {
        let state = State { time, coordinates: &*coordinates, speeds, inputs };
        let mut open = Vec::new();
        let mut gaps = Vec::new();
        for &contact in contacts {
            // beyond its end a gap is not what the normal closes
            let ended = mechanism.validity(contact, &state)?.is_some_and(|validity| validity < 0.0);
            if let Some(gap) = mechanism.gap(contact, &state)?.filter(|_| !ended) {
                open.push(contact);
                gaps.push(gap);
            }
        }
        let largest = gaps.iter().fold(0.0_f64, |largest, gap| largest.max(gap.abs()));
        if largest <= 1e-13 * least {
            return Ok((None, known));
        }
        if largest > CLOSED * size && largest > 0.5 * before {
            // Newton's method closes a gap whose rate is the normal velocity quadratically.
            let worst = gaps.iter().position(|gap| gap.abs() == largest).unwrap_or(0);
            return Ok((Some(Left { contact: open[worst], gap: gaps[worst] }), known));
        }
        before = largest;
        // the change is small: directions of the first step serve the others
        let support: &ClosedContacts = match &mut known {
            Some(known) => known,
            none => none.insert(ClosedContacts::new(mechanism, &state, &open, false)?),
        };
        let rows: Vec<usize> = (0..open.len()).map(|i| 3 * i).collect();
        let mut wanted = DVector::zeros(3 * open.len());
        for (i, gap) in gaps.iter().enumerate() {
            wanted[3 * i] = *gap;
        }
        let change = support.without(&rows, &wanted);
        // q' is affine in u.
        let (mut here, mut there) = (vec![0.0; n], vec![0.0; n]);
        mechanism.coordinate_rates(&state, &mut here)?;
        let moved: Vec<f64> = speeds.iter().zip(change.iter()).map(|(u, change)| u + change).collect();
        mechanism.coordinate_rates(&State { speeds: &moved, ..state }, &mut there)?;
        for (coordinate, (here, there)) in coordinates.iter_mut().zip(here.iter().zip(&there)) {
            *coordinate += there - here;
        }
        close_loops(mechanism.mechanism, time, coordinates, speeds, inputs)?;
        if largest <= 1e-12 * least {
            break;
        }
    }
    Ok((None, known))
}

/// The speeds changed so that closed contacts do not part, and those that stick do not slip, by the least
/// change of kinetic energy, with what is `known` of the contacts close by.
pub(crate) fn hold_velocities(
    mechanism: WithTorques<'_>,
    time: f64,
    coordinates: &[f64],
    speeds: &mut [f64],
    inputs: &[f64],
    (closed, known): (&[(usize, bool)], Option<ClosedContacts>),
) -> Result<(), StateError> {
    if closed.is_empty() {
        return Ok(());
    }
    let contacts: Vec<usize> = closed.iter().map(|(contact, _)| *contact).collect();
    let rows: Vec<usize> = closed
        .iter()
        .enumerate()
        .flat_map(|(i, (_, sticks))| (0..if *sticks { 3 } else { 1 }).map(move |axis| 3 * i + axis))
        .collect();
    let state = State { time, coordinates, speeds: &*speeds, inputs };
    // The velocities are those of this place; the directions of a place close by correct them as well.
    let (support, mut velocity) = match known.filter(|known| known.contacts == contacts) {
        Some(known) => {
            let mut velocity = DVector::zeros(3 * contacts.len());
            for (i, &contact) in contacts.iter().enumerate() {
                velocity.rows_mut(3 * i, 3).copy_from(&mechanism.contact_velocity(contact, &state)?);
            }
            (known, velocity)
        }
        None => {
            let support = ClosedContacts::new(mechanism, &state, &contacts, false)?;
            let velocity = support.velocity.clone();
            (support, velocity)
        }
    };
    // Velocities are affine in the speeds: the second time corrects rounding.
    for _ in 0..2 {
        let change = support.without(&rows, &velocity);
        speeds.iter_mut().zip(change.iter()).for_each(|(speed, change)| *speed += change);
        velocity += support.partials.tr_mul(&change);
    }
    Ok(())
}
