//! The direction of very small slip, computed from the state instead of by integration.
//!
//! Near the end or the beginning of slip its direction phi obeys s phi' = h(phi), where h is the acceleration
//! perpendicular to the slip. While s is small, the direction settles within the time s / |dh/dphi|, and an
//! explicit integration would need steps of that length. A settled direction follows from the state: h(phi) =
//! s omega, where omega is the rate at which the settled direction turns. The error is of second order in
//! omega s / |dh/dphi|.

use nalgebra::Vector2;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, Lacking};
use crate::closed::mode_selection::begin_along;
use crate::closed::phase::{Closed, mus};
use crate::contact_problem::{Mode, is_slow, slip_together, with_modes};

/// The modes of contacts with the directions that follow from the state; `omega` holds the rates of the
/// settled ones. `None` if there are no such directions; these are then the best that were found.
pub(crate) fn settle_directions(
    support: &ClosedContacts,
    closed: &[Closed],
    holds: &mut [Hold],
    solve: &dyn Fn(&[Hold]) -> Result<Forces, Lacking>,
) -> Option<()> {
    let settled: Vec<(usize, usize)> =
        (0..closed.len()).filter(|&i| closed[i].omega.is_some()).map(|i| (i, i)).collect();
    if settled.is_empty() {
        return Some(());
    }
    let mut directions = directions(holds);
    let across: Vec<f64> =
        settled.iter().map(|&(i, _)| closed[i].omega.unwrap_or(0.0) * support.slip(i).norm()).collect();
    if let Some(together) = slow(support, closed, holds, &settled, &across) {
        holds.copy_from_slice(&together);
        return Some(());
    }
    let found = begin_along(&settled, &mut directions, &across, |directions| solve(&with(directions)).ok());
    holds.copy_from_slice(&with(&directions));
    found
}

/// The modes of contacts that slip together with such small accelerations that their directions cannot be
/// computed from differences; `None` if the accelerations are larger.
fn slow(
    support: &ClosedContacts,
    closed: &[Closed],
    holds: &[Hold],
    settled: &[(usize, usize)],
    across: &[f64],
) -> Option<Vec<Hold>> {
    if settled.len() < 2 {
        return None;
    }
    let mu = mus(closed);
    let slips: Vec<Option<Vector2<f64>>> = holds.iter().map(Hold::direction).collect();
    let modes: Vec<Mode> = slips.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
    let problem = support.problem(&mu, &slips);
    let open: Vec<usize> = settled.iter().map(|&(place, _)| place).collect();
    let force = with_modes(&problem, &modes).ok()?.force;
    if !is_slow(&problem, &modes, &open, &force) {
        return None;
    }
    let begins = open.iter().all(|&place| support.slip(place) == Vector2::zeros());
    let modes = slip_together(&problem, &modes, &open, (!begins).then_some(across), &force)?;
    let hold = |mode: &Mode| match mode {
        Mode::Slide(d) => Hold::Slide(*d),
        _ => Hold::Stick,
    };
    Some(modes.iter().map(hold).collect())
}

fn directions(holds: &[Hold]) -> Vec<Option<Vector2<f64>>> {
    holds
        .iter()
        .map(|hold| match hold {
            Hold::Slide(d) => Some(*d),
            Hold::Stick => None,
        })
        .collect()
}

fn with(directions: &[Option<Vector2<f64>>]) -> Vec<Hold> {
    directions.iter().map(|d| d.map_or(Hold::Stick, Hold::Slide)).collect()
}
