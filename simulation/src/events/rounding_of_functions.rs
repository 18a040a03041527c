//! Bounds of the rounding errors of the functions whose zeros are events.

use hodograph::{ComponentKind, State};

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::SLACK;
use crate::closed::phase::Closed;
use crate::closed::scales::{OWN, SIZE};
use crate::integration::motion::DIRECTION;
use crate::state::transition::Transition;
use crate::{ErrorKind, EventFunction, SimulationError};

/// The largest allowed rounding error of a closing gap, relative to the length of the problem.
const HIDDEN: f64 = 1e-6;
/// Relative to the smallest normal velocities that matter, this part is negligible.
const FAINT: f64 = 1e-6;

/// At coordinates beyond this many lengths of the problem the rounding error of a gap is estimated from its
/// sensitivity, with this relative change of each coordinate.
const FAR: f64 = 5e4;
const SHARE: f64 = 1e-6;

impl Transition<'_> {
    /// A bound of the rounding error of an event function of the user that has this value at the front: that of its terms,
    /// whose sizes are its changes under relative changes of what it is of.
    pub(crate) fn rounding_of_function(&self, function: &EventFunction, value: f64) -> f64 {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let count = n + self.mechanism.count(ComponentKind::Speed);
        let mut moved = self.front.y[..count].to_vec();
        let change = |there: f64| Some((there - value).abs() / SHARE).filter(|change| change.is_finite());
        let mut sum = value.abs();
        for index in 0..count {
            let kept = moved[index];
            moved[index] = kept * (1.0 + SHARE);
            sum += change(function(self.front.t, &moved[..n], &moved[n..])).unwrap_or(0.0);
            moved[index] = kept;
        }
        sum += change(function(self.front.t * (1.0 + SHARE), &moved[..n], &moved[n..])).unwrap_or(0.0);
        4.0 * f64::EPSILON * sum
    }

    /// A bound of the rounding error of a gap, m.
    pub(crate) fn rounding_of_gap(&self, contact: usize) -> f64 {
        4.0 * f64::EPSILON * self.gap_size(contact, self.size_of_coordinates())
    }

    /// How far loops may be open within a step, m: gaps follow coordinates there that are integrated, and a slider at its dead
    /// centre touches a stop that it just reaches.
    pub(crate) fn left_of_loops(&self) -> f64 {
        let loops = self.mechanism.count(ComponentKind::DependentCoordinate) > 0;
        if loops { self.options.absolute_tolerance } else { 0.0 }
    }

    /// Checks that a closing gap is known: the place of a collision cannot be determined if rounding exceeds
    /// the gap.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::GapRounding`].
    pub(crate) fn gap_is_known(&self, contact: usize) -> Result<(), SimulationError> {
        let rounding = self.rounding_of_gap(contact);
        if rounding <= HIDDEN * self.front.scales.length {
            return Ok(());
        }
        let gap = self.mechanism.gap(contact, &self.here()).ok().flatten().unwrap_or(0.0);
        Err(self.error(Some(contact), ErrorKind::GapRounding { gap, rounding }))
    }

    /// The size of the terms of a gap: the greatest coordinate, or, far from the origin, the sum of the
    /// changes of the gap under relative changes of the coordinates. So the gap of a particle is not
    /// considered inaccurate because the particle is far away along the floor.
    fn gap_size(&self, contact: usize, size: f64) -> f64 {
        if size <= FAR * self.front.scales.length {
            return size;
        }
        let here = self.here();
        let gap =
            |coordinates: &[f64]| self.mechanism.gap(contact, &State { coordinates, ..here }).ok().flatten();
        let Some(value) = gap(here.coordinates) else { return size };
        let mut moved = here.coordinates.to_vec();
        let mut sum = value.abs().max(SIZE * self.front.scales.length);
        for (index, &coordinate) in here.coordinates.iter().enumerate() {
            moved[index] = coordinate * (1.0 + SHARE);
            let Some(there) = gap(&moved) else { return size };
            sum += (there - value).abs() / SHARE;
            moved[index] = coordinate;
        }
        sum.min(size)
    }

    /// A bound of the rounding error of the mean normal velocity of a contact: 4 eps of the terms of its
    /// velocity, but at most the greater of [`FAINT`] of the smallest velocity that matters and 4 eps of the
    /// terms of the normal velocity itself; and what rounding of the time does to a surface that is driven.
    pub(crate) fn rounding_of_rate(&self, contact: usize) -> f64 {
        let [all, normal] = self.rounding_of_velocity(contact);
        all.min(normal.max(FAINT * self.front.scales.slow)) + self.rounding_of_time(contact)
    }

    /// The change of the normal velocity of a contact over 2 eps of the time, for the same coordinates and speeds.
    fn rounding_of_time(&self, contact: usize) -> f64 {
        let here = self.here();
        let velocity = |time| {
            let state = State { time, ..here };
            self.mechanism.contact_velocity(contact, &state).map_or(0.0, |velocity| velocity.x)
        };
        let short = SHARE * self.front.scales.time;
        let change = velocity(here.time + short) - velocity(here.time);
        2.0 * f64::EPSILON * (here.time / short * change).abs()
    }

    /// The approach that projections leave of the normal velocity of a contact that lifts off here, which is
    /// zero: at most [`OWN`] of the terms of its velocity.
    pub(crate) fn left_at_lift_off(&self, contact: usize) -> f64 {
        let approach = self.mechanism.contact_velocity(contact, &self.here()).map_or(0.0, |v| -v.x);
        let terms = self.rounding_of_velocity(contact)[0] / (4.0 * f64::EPSILON);
        if (0.0..=OWN * terms).contains(&approach) { approach } else { 0.0 }
    }

    /// Bounds of the rounding errors of the velocity of a contact and of its normal velocity: 4 eps of their
    /// terms.
    pub(crate) fn rounding_of_velocity(&self, contact: usize) -> [f64; 2] {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let speeds = &self.front.y[n..n + self.mechanism.count(ComponentKind::Speed)];
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        ClosedContacts::new(self.mechanism, &state, &[contact], false).map_or([0.0; 2], |support| {
            let all = support.velocity_size(0, speeds).max(support.velocity.amax());
            let normal = support.normal_size(0, speeds).max(support.velocity[0].abs());
            [all, normal].map(|size| 4.0 * f64::EPSILON * size)
        })
    }

    /// A bound of the rounding error of the directions of slip, rad; zero where it is less than the slack of the
    /// conditions of modes.
    pub(crate) fn rounding_of_directions(&self, closed: &[Closed]) -> f64 {
        let angle = |closed: &Closed| {
            let velocity = self.mechanism.contact_velocity(closed.contact, &self.here());
            let slip = velocity.map_or(0.0, |velocity| velocity.yz().norm());
            if slip > 0.0 { self.rounding_of_velocity(closed.contact)[0] / slip } else { 0.0 }
        };
        let several = closed.len() > 1;
        let slides = closed.iter().filter(|closed| several && closed.slides.is_some());
        let greatest = slides.map(angle).fold(0.0, f64::max);
        // Slower slip has the last direction that it had.
        if (SLACK..4.0 * f64::EPSILON / DIRECTION).contains(&greatest) { greatest } else { 0.0 }
    }
}
