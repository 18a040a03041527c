//! Determines the phases of the contacts in the start state.

use hodograph::{State, StateError};

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::phase::{Leaving, Phase};
use crate::integration::motion::Failure;
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// Bodies overlap at the start if a gap is below minus this part of the length of the problem; contacts with
/// smaller gaps touch.
const OVERLAP: f64 = 5e-9;
/// A gap below this part of the length is closed at the start.
const CLOSED: f64 = 5e-15;

impl Transition<'_> {
    /// Contacts at the start.
    pub(crate) fn begin(&mut self) -> Result<(), SimulationError> {
        self.drive()?;
        let front = self.front.clone();
        let state = self.here_of(&front);
        let overlap = OVERLAP * self.front.scales.length;
        let mut strikes = None;
        let mut stay = Vec::new();
        let was = self.front.phases.clone();
        let known = (0..self.front.phases.len()).filter(|&contact| self.surfaces[contact].is_some());
        let fault = |error| self.failure(Failure::State(error));
        for (contact, distance) in self.distances_nearby(known, &state).map_err(fault)? {
            let (low, ends) = (self.low(), self.ends(contact));
            let Some(gap) = distance.gap else { continue };
            if gap < -overlap {
                return Err(self.error(Some(contact), ErrorKind::Overlap(gap)));
            }
            if gap > overlap {
                continue;
            }
            let valid = distance.validity.is_none_or(|validity| validity >= 0.0);
            if ends && gap <= low {
                self.front.phases[contact] = Phase::Open(Leaving::Near);
            }
            if !valid {
                continue;
            }
            let fault = |error| self.failure(Failure::State(error));
            let support = ClosedContacts::new(self.mechanism, &state, &[contact], false).map_err(fault)?;
            let rate = support.velocity[0];
            let rounding = (1e-9 * support.velocity_size(0, state.speeds)).max(self.slowest(&support, 0));
            let rounding = self.unseen(&support, 0, state.speeds, rounding)?;
            if rate < -rounding {
                // A contact with a small open gap closes by itself later.
                if gap <= CLOSED * self.front.scales.length {
                    strikes.get_or_insert(contact);
                }
            } else if rate > rounding {
                self.front.phases[contact] = Phase::Open(Leaving::Bounced);
            } else {
                let parts = self.parts_by_itself(&support, &state, contact).map_err(fault)?;
                self.front.phases[contact] = Phase::Open(Leaving::NOW);
                if !parts {
                    stay.push(contact);
                }
            }
        }
        self.decide(&stay, &was)?;
        match strikes {
            Some(contact) => self.strike(contact),
            None => self.look_for_rest(),
        }
    }

    /// Whether a contact that no force moves along its normal, as at a dead centre, leaves by the motion that it has.
    fn parts_by_itself(
        &self,
        support: &ClosedContacts,
        state: &State<'_>,
        contact: usize,
    ) -> Result<bool, StateError> {
        if support.coupled[(0, 0)] > 0.0 {
            return Ok(false);
        }
        let free = ClosedContacts::new(self.mechanism, state, &[contact], true)?;
        Ok(free.beta[0] > free.least_acceleration(0))
    }
}
