//! Contacts of bounded faces and edges: where they begin and end without an impact (docs/theory.md, section
//! 17.18).
//!
//! Such a contact has a validity: the distance of the contact point from the boundary. While the contact is
//! closed, its validity is monitored like a gap; where it falls below zero, the contact ends. An open contact
//! may come to its face from the side, along a surface on which it slides; then it begins without an impact.
//! To detect this, its gap is first monitored at a small height, and below that height its validity.
//!
//! Where a contact hands over to its neighbour both may be the same: one place and one normal. Only one of them is closed
//! then, which goes on to its own end.

use hodograph::{Distance, State, StateError};
use nalgebra::Vector3;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::phase::{Leaving, Phase};
use crate::integration::motion::Failure;
use crate::state::transition::Transition;
use crate::{EventKind, SimulationError};

/// A contact is near its face if its gap is below this part of the length of the problem.
const NEAR: f64 = 5e-11;
/// Normal partial velocities that differ by less than this part are the same.
const SAME: f64 = 2e-8;
/// A normal velocity below this part of its terms counts as zero.
const STILL: f64 = 1e-9;

impl Transition<'_> {
    /// Whether the faces or edges of a contact are bounded.
    pub(crate) fn ends(&self, contact: usize) -> bool {
        self.pair(contact).is_some_and(|pair| pair.ends)
    }

    /// The height below which a contact is near its face, m.
    pub(crate) fn low(&self) -> f64 {
        NEAR * self.front.scales.length
    }

    /// The distance of the contact point from the boundary, m.
    pub(crate) fn validity(&self, contact: usize, state: &State<'_>) -> Result<f64, StateError> {
        if !self.ends(contact) {
            return Ok(f64::INFINITY);
        }
        Ok(self.mechanism.validity(contact, state)?.unwrap_or(f64::INFINITY))
    }

    /// Whether gap and normal of a contact are valid in a state.
    pub(crate) fn is_valid(&self, contact: usize, state: &State<'_>) -> Result<bool, SimulationError> {
        let validity = self.validity(contact, state);
        validity.map(|validity| validity >= 0.0).map_err(|error| self.failure(Failure::State(error)))
    }

    /// The height at which the gap of an open contact is monitored, m.
    pub(crate) fn watched_from(&self, contact: usize) -> f64 {
        match self.front.phases[contact] {
            Phase::Open(Leaving::Apart) if self.ends(contact) => self.low(),
            _ => 0.0,
        }
    }

    /// Those of these contacts that are near their faces and lie beside them, so that they may come from the side.
    pub(crate) fn beside(&self, near: &[usize]) -> Vec<usize> {
        let near: Vec<usize> = near.iter().copied().filter(|&contact| self.ends(contact)).collect();
        let mut distances = vec![Distance::default(); near.len()];
        if near.is_empty() || self.mechanism.gaps(&near, &self.here(), &mut distances).is_err() {
            return Vec::new();
        }
        let low = 0.5 * self.low();
        let lies_beside = |distance: &Distance| distance.validity.is_some_and(|validity| validity < low);
        near.into_iter().zip(&distances).filter(|(_, found)| lies_beside(found)).map(|(one, _)| one).collect()
    }

    /// Handles a contact that has come to its face from the side: it begins if its normal velocity is zero.
    pub(crate) fn enter(&mut self, contact: usize) -> Result<(), SimulationError> {
        let gap = self.mechanism.gap(contact, &self.here()).map_err(|e| self.failure(Failure::State(e)))?;
        if gap.is_some_and(|gap| gap <= self.low())
            && self.keeps_height(contact)?
            && !self.is_held(contact)?
        {
            let was = self.front.phases.clone();
            let closed = |other: usize| other == contact || was[other].is_closed();
            let mut candidates: Vec<usize> = (0..was.len()).filter(|&other| closed(other)).collect();
            candidates.extend(self.arrived(contact)?);
            candidates.sort_unstable();
            return self.decide(&candidates, &was);
        }
        Ok(())
    }

    /// The open contacts, but for this one, that have come to their faces from the side just as it has: they are within
    /// them, without a gap and a normal velocity. What comes together begins together, for each alone might not
    /// carry what they carry together.
    fn arrived(&self, but: usize) -> Result<Vec<usize>, SimulationError> {
        let here = self.here();
        let mut arrived = Vec::new();
        let may_arrive = |&contact: &usize| {
            let phase = &self.front.phases[contact];
            contact != but
                && matches!(phase, Phase::Open(Leaving::Near | Leaving::Apart))
                && self.ends(contact)
                && self.surfaces[contact].is_some()
        };
        let open = (0..self.front.phases.len()).filter(may_arrive);
        let failed = |error| self.failure(Failure::State(error));
        for (contact, distance) in self.distances_nearby(open, &here).map_err(failed)? {
            if distance.validity.is_some_and(|validity| validity >= 0.5 * self.low())
                && distance.gap.is_some_and(|gap| gap <= self.low())
                && self.keeps_height(contact)?
                && !self.is_held(contact)?
                && self.coinciding(&[contact], &arrived)?.is_empty()
            {
                arrived.push(contact);
            }
        }
        Ok(arrived)
    }

    /// Whether a closed contact holds the place of this one, with the same normal.
    pub(crate) fn is_held(&self, contact: usize) -> Result<bool, SimulationError> {
        Ok(!self.held(&[contact])?.is_empty())
    }

    /// Those of these contacts whose place a closed contact holds, with the same normal.
    pub(crate) fn held(&self, contacts: &[usize]) -> Result<Vec<usize>, SimulationError> {
        let closed: Vec<usize> =
            (0..self.front.phases.len()).filter(|&other| self.front.phases[other].is_closed()).collect();
        self.coinciding(contacts, &closed)
    }

    /// Those of these contacts whose faces or edges are bounded and that have place and normal of another such contact
    /// among `others`: its normal partial velocities.
    fn coinciding(&self, contacts: &[usize], others: &[usize]) -> Result<Vec<usize>, SimulationError> {
        let bounded = |of: &[usize]| -> Vec<usize> {
            of.iter().copied().filter(|&contact| self.ends(contact)).collect()
        };
        let (contacts, others) = (bounded(contacts), bounded(others));
        if contacts.is_empty() || others.is_empty() {
            return Ok(Vec::new());
        }
        let mut all = [&contacts[..], &others].concat();
        all.sort_unstable();
        all.dedup();
        let support = ClosedContacts::new(self.mechanism, &self.here(), &all, false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let normal = |contact: usize| support.partials.column(3 * all.binary_search(&contact).unwrap_or(0));
        let is_at = |contact: usize, other: usize| {
            let own = normal(contact);
            other != contact && (normal(other) - own).amax() <= SAME * own.amax()
        };
        let coincides = |&contact: &usize| others.iter().any(|&other| is_at(contact, other));
        Ok(contacts.into_iter().filter(coincides).collect())
    }

    /// Whether the normal velocity of a contact is zero up to rounding.
    pub(crate) fn keeps_height(&self, contact: usize) -> Result<bool, SimulationError> {
        let here = self.here();
        let support = ClosedContacts::new(self.mechanism, &here, &[contact], false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let size = support.velocity_size(0, here.speeds).max(support.velocity_size(0, &self.front.scale));
        Ok(support.velocity[0].abs() <= STILL * size)
    }

    /// A closed contact that is at the boundary of its face, if there is one.
    pub(crate) fn at_its_end(&self) -> Result<Option<usize>, SimulationError> {
        for contact in self.closed().iter().map(|closed| closed.contact).filter(|&contact| self.ends(contact))
        {
            let validity = self.validity(contact, &self.here());
            if validity.map_err(|error| self.failure(Failure::State(error)))? <= self.low() {
                return Ok(Some(contact));
            }
        }
        Ok(None)
    }

    /// Handles a closed contact at the boundary of its face: it ends, and the others take over.
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
        let mut closed: Vec<usize> = (0..was.len()).filter(|&other| was[other].is_closed()).collect();
        closed.extend(self.arrived(contact)?);
        closed.sort_unstable();
        self.decide(&closed, &was)
    }
}
