//! Finds the points that move at a fixed distance from the origin O, so that a line from O to them represents
//! a link.

use hodograph::{ComponentKind, Contacts, State as Borrowed};
use hodograph_model::numeric::State;
use nalgebra::Vector3;

/// Number of states that are compared with the first.
const OTHERS: usize = 3;
/// A distance is constant if it changes by at most this part of it.
const SAME: f64 = 1e-9;

/// Whether the position of a point relative to O changes with the coordinates, but its distance does not.
pub fn turns_about_origin(mechanism: &dyn Contacts<f64>, point: usize, state: &State) -> bool {
    let place = |coordinates: &[f64]| -> Option<Vector3<f64>> {
        let inputs = vec![0.0; mechanism.count(ComponentKind::Input)];
        let speeds = vec![0.0; mechanism.count(ComponentKind::Speed)];
        let state = Borrowed { time: state.time, coordinates, speeds: &speeds, inputs: &inputs };
        mechanism.position(point, &state).ok()
    };
    let Some(here) = place(&state.coordinates) else { return false };
    let length = here.norm();
    let mut turns = false;
    for other in 1..=OTHERS {
        let step = |(index, value): (usize, &f64)| value + 0.3 * (1.7 * (index + 3 * other) as f64).sin();
        let mut moved: Vec<f64> = state.coordinates.iter().enumerate().map(step).collect();
        if mechanism.normalise(&mut moved).is_err() {
            return false;
        }
        let Some(there) = place(&moved) else { return false };
        let change = (there.norm() - length).abs();
        if change.is_nan() || change > SAME * length {
            return false;
        }
        turns = turns || (there - here).norm() > 1e3 * SAME * length;
    }
    turns && length > 0.0
}
