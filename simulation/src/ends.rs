//! Contacts of faces and edges that end: where they begin and end without an impact (docs/theory.md, section 17.18).
//!
//! Such a contact has a validity, which says how far its place is from the ends. While it is closed the validity is
//! watched like a gap; where it falls below zero, the contact ends. One that is open may come to its face from the
//! side, along a surface that it slides on: then it begins as it is, without an impact. For this its gap is watched
//! at a small height first, and its validity below that height.

use hodograph::{State, StateError};
use nalgebra::Vector3;

use crate::closed_contacts::ClosedContacts;
use crate::motion::Failure;
use crate::phase::{Leaving, Phase};
use crate::transition::Transition;
use crate::{EventKind, SimulationError};

/// A contact is near where its gap is below this part of the length of the problem.
const NEAR: f64 = 5e-11;
/// A normal velocity below this part of its terms is none.
const STILL: f64 = 1e-10;

impl Transition<'_> {
    /// Whether the faces or edges that touch at a contact end.
    pub(crate) fn ends(&self, contact: usize) -> bool {
        self.pair(contact).is_some_and(|pair| pair.ends)
    }

    /// The height below which a contact is near, m.
    pub(crate) fn low(&self) -> f64 {
        NEAR * self.front.scales.length
    }

    /// How far a contact is from where it ends, m.
    pub(crate) fn validity(&self, contact: usize, state: &State<'_>) -> Result<f64, StateError> {
        if !self.ends(contact) {
            return Ok(f64::INFINITY);
        }
        Ok(self.mechanism.validity(contact, state)?.unwrap_or(f64::INFINITY))
    }

    /// Whether gap and normal of a contact belong together in a state.
    pub(crate) fn is_valid(&self, contact: usize, state: &State<'_>) -> Result<bool, SimulationError> {
        let validity = self.validity(contact, state);
        validity.map(|validity| validity >= 0.0).map_err(|error| self.failure(Failure::State(error)))
    }

    /// The height at which the gap of an open contact is watched, m.
    pub(crate) fn watched_from(&self, contact: usize) -> f64 {
        match self.front.phases[contact] {
            Phase::Open(Leaving::Apart) if self.ends(contact) => self.low(),
            _ => 0.0,
        }
    }

    /// Whether a contact that is near is beside its face, so that it may come from the side.
    pub(crate) fn is_beside(&self, contact: usize) -> bool {
        self.front.phases[contact] == Phase::Open(Leaving::Near)
            && self.validity(contact, &self.here()).is_ok_and(|validity| validity < 0.5 * self.low())
    }

    /// A contact has come to its face from the side: it begins if it keeps its height.
    pub(crate) fn enter(&mut self, contact: usize) -> Result<(), SimulationError> {
        let gap = self.mechanism.gap(contact, &self.here()).map_err(|e| self.failure(Failure::State(e)))?;
        if gap.is_some_and(|gap| gap <= self.low()) && self.keeps_height(contact)? {
            return self.stay(contact);
        }
        Ok(())
    }

    /// Whether a contact has no normal velocity but rounding.
    pub(crate) fn keeps_height(&self, contact: usize) -> Result<bool, SimulationError> {
        let here = self.here();
        let support = ClosedContacts::new(self.mechanism, &here, &[contact], false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let size = support.velocity_size(0, here.speeds).max(support.velocity_size(0, &self.front.scale));
        Ok(support.velocity[0].abs() <= STILL * size)
    }

    /// A closed contact has come to the end of its face: it ends, and the others carry on.
    pub(crate) fn leave(&mut self, contact: usize) -> Result<(), SimulationError> {
        self.front.phases[contact] = Phase::Open(Leaving::Near);
        self.front.forces[contact] = Vector3::zeros();
        let torques: Vec<usize> = self.mechanism.torques_of(&[contact]).collect();
        for torque in torques {
            self.front.phases[torque] = Phase::Open(Leaving::Apart);
            self.front.forces[torque] = Vector3::zeros();
        }
        self.front.resting = false;
        let selection = hodograph::Selection::Unique;
        self.push(Some(contact), EventKind::LiftOff { selection });
        let was = self.front.phases.clone();
        let closed: Vec<usize> = (0..was.len()).filter(|&other| was[other].is_closed()).collect();
        self.decide(&closed, &was)
    }
}
