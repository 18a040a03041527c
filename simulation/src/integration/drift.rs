//! Corrects the drift of the integration after each step: norms of quaternions, closed loops, gaps and
//! velocities of closed contacts.

use hodograph::{ComponentKind, Contacts, Distance, State, StateError};
use nalgebra::{DMatrix, DVector};

use crate::closed::closed_contacts::{ClosedContacts, least_squares};
use crate::closed::lengths::Lengths;
use crate::closed::torques::WithTorques;

/// Largest number of Newton steps.
const STEPS: usize = 4;

/// Normalises quaternions and takes a few Newton steps to close loops, starting from dependent coordinates
/// that are nearly right. Returns the last change of a coordinate, relative to the greatest coordinate, both in
/// metres or radians.
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
    let lengths = Lengths::of(mechanism);
    let mut last = 0.0;
    for _ in 0..STEPS {
        let state = State { time, coordinates: &*coordinates, speeds, inputs };
        mechanism.configuration(&state, &mut residual, &mut jacobian)?;
        let matrix = DMatrix::from_row_slice(count, count, &jacobian);
        let change = least_squares(&matrix, &-DVector::from_column_slice(&residual));
        let mut changes = vec![0.0; coordinates.len()];
        for (&place, change) in places.iter().zip(change.iter()) {
            coordinates[place] += change;
            changes[place] = *change;
        }
        let (changed, size) = (lengths.greatest(&changes), lengths.greatest(coordinates));
        last = if changed > 0.0 { changed / size } else { 0.0 };
        if last <= 64.0 * f64::EPSILON {
            break;
        }
    }
    Ok(last)
}

/// A gap that could not be closed: the contact, and the remaining gap, m.
pub(crate) struct Left {
    pub contact: usize,
    pub gap: f64,
}

/// A gap counts as closed if the remaining correction is at most this part of the size of the coordinates.
const CLOSED: f64 = 1e-10;

/// What the correction of gaps leaves.
#[derive(Default)]
pub(crate) struct Corrected {
    /// the first gap that is not closed
    pub left: Option<Left>,
    /// the contacts as they were evaluated
    pub known: Option<ClosedContacts>,
    /// contacts beyond the end of their faces or edges, whose normals are not theirs any more
    pub ended: Vec<usize>,
}

/// Moves the coordinates so that the gaps of these contacts vanish, by the least motion in the metric of the
/// mass matrix. `least` is a small length of the problem: 1e-13 of it counts as rounding.
pub(crate) fn close_gaps(
    mechanism: WithTorques<'_>,
    time: f64,
    coordinates: &mut [f64],
    speeds: &[f64],
    inputs: &[f64],
    contacts: &[usize],
    (lengths, least): (&Lengths, f64),
) -> Result<Corrected, StateError> {
    let n = coordinates.len();
    let size = lengths.greatest(coordinates).max(least);
    let mut before = f64::INFINITY;
    let mut corrected = Corrected::default();
    // torques have no gap
    let own: Vec<usize> =
        contacts.iter().copied().filter(|&contact| mechanism.torque(contact).is_none()).collect();
    let mut distances = vec![Distance::default(); own.len()];
    for _ in 0..STEPS {
        let state = State { time, coordinates: &*coordinates, speeds, inputs };
        let mut open = Vec::new();
        let mut gaps = Vec::new();
        mechanism.gaps(&own, &state, &mut distances)?;
        corrected.ended.clear();
        for (&contact, Distance { gap, validity }) in own.iter().zip(&distances) {
            // beyond the end of a face the gap is not closed along the normal
            if validity.is_some_and(|validity| validity < 0.0) {
                corrected.ended.push(contact);
            } else if let Some(gap) = gap {
                open.push(contact);
                gaps.push(*gap);
            }
        }
        let largest = gaps.iter().fold(0.0_f64, |largest, gap| largest.max(gap.abs()));
        if largest <= 1e-13 * least {
            return Ok(corrected);
        }
        if largest > CLOSED * size && largest > 0.5 * before {
            // Newton's method converges quadratically for a gap whose rate is the normal velocity.
            let worst = gaps.iter().position(|gap| gap.abs() == largest).unwrap_or(0);
            corrected.left = Some(Left { contact: open[worst], gap: gaps[worst] });
            return Ok(corrected);
        }
        before = largest;
        // the change is small, so the directions of the first step can be reused
        let support: &ClosedContacts = match &mut corrected.known {
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
    Ok(corrected)
}

/// Changes the speeds with the least change of kinetic energy so that closed contacts do not separate, and
/// those that stick do not slip; `known` are contacts evaluated nearby.
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
    // The velocities are those of this state; the directions may be those of a nearby state.
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
    // Velocities are affine in the speeds; the second pass corrects rounding.
    for _ in 0..2 {
        let change = support.without(&rows, &velocity);
        speeds.iter_mut().zip(change.iter()).for_each(|(speed, change)| *speed += change);
        velocity += support.partials.tr_mul(&change);
    }
    Ok(())
}
