//! Decides what the contacts do in the start state.

use crate::closed_contacts::ClosedContacts;
use crate::motion::Failure;
use crate::phase::{Leaving, Phase};
use crate::transition::Transition;
use crate::{Reason, SimulationError};

/// Bodies overlap where a gap is below minus this at the start, m; contacts below it touch.
const OVERLAP: f64 = 1e-9;

impl Transition<'_> {
    /// Contacts at the start.
    pub(crate) fn begin(&mut self) -> Result<(), SimulationError> {
        let front = self.front.clone();
        let state = self.here_of(&front);
        let mut strikes = None;
        let mut stay = Vec::new();
        let was = self.front.phases.clone();
        for contact in 0..self.front.phases.len() {
            if self.surfaces[contact].is_none() {
                continue;
            }
            let fault = |error| self.failure(Failure::State(error));
            let Some(gap) = self.mechanism.gap(contact, &state).map_err(fault)? else { continue };
            if gap < -OVERLAP {
                return Err(self.error(Some(contact), Reason::Overlap(gap)));
            }
            if gap > OVERLAP {
                continue;
            }
            let support = ClosedContacts::new(self.mechanism, &state, &[contact], false).map_err(fault)?;
            let rate = support.velocity[0];
            let rounding = 1e-9 * support.velocity_size(0, state.speeds);
            if rate < -rounding {
                // One that is a little open yet closes by itself.
                if gap <= 1e-15 {
                    strikes.get_or_insert(contact);
                }
            } else if rate > rounding {
                self.front.phases[contact] = Phase::Open(Leaving::Bounced);
            } else {
                self.front.phases[contact] = Phase::Open(Leaving::NOW);
                stay.push(contact);
            }
        }
        self.decide(&stay, &was)?;
        match strikes {
            Some(contact) => self.strike(contact),
            None => self.look_for_rest(),
        }
    }
}
