//! Handles an event within a step: goes to the state there, and changes the modes.

use crate::event_functions::Watched;
use crate::event_location::Crossing;
use crate::mode_changes::Ending;
use crate::motion::{Evaluation, Failure};
use crate::phase::{Closed, Leaving, Phase};
use crate::slip_end::{ENDING, time_of_slip};
use crate::stepper::Step;
use crate::transition::Transition;
use crate::{EventKind, Reason, SimulationError};

/// The greatest number of events without progress in time.
const CROWD: usize = 2000;

impl Transition<'_> {
    /// Goes to an event and handles it.
    pub(crate) fn handle_event(
        &mut self,
        closed: &[Closed],
        whole: Step,
        watched: Watched,
        crossing: Crossing,
    ) -> Result<(), SimulationError> {
        let mut step = self.at_event(closed, &whole, watched, &crossing)?;
        self.front.next = whole.next.min((10.0 * step.h).max(1e-7));
        let start = self.front.t;
        self.commit(&mut step)?;
        self.crowded(start)?;
        match watched {
            Watched::Gap(contact) => {
                let (_, rate) = self.gap_at(&step, contact)?;
                if rate >= 0.0 {
                    // It only touches.
                    self.front.phases[contact] = Phase::Open(Leaving::NOW);
                    return Ok(());
                }
                self.strike(contact)
            }
            Watched::Normal(place) => self.modes_ended(closed[place].contact, Ending::NormalForce),
            Watched::Cone(place) => self.modes_ended(closed[place].contact, Ending::Friction),
            Watched::Jam => self.jammed(closed),
            Watched::User(index, _) => {
                self.push(None, EventKind::Zero(index));
                // Past the zero, so that it is not found again.
                let small = 1e-12 * self.front.t.abs().max(1e-3);
                if let Some(mut past) = self.part(closed, small) {
                    self.commit(&mut past)?;
                }
                Ok(())
            }
        }
    }

    /// A sliding contact jams: its force grows without bound.
    fn jammed(&mut self, closed: &[Closed]) -> Result<(), SimulationError> {
        let here = self.motion(closed).evaluate(self.front.t, &self.front.y);
        let place = match &here {
            Ok(here) => here.forces.as_ref().and_then(|forces| forces.jams).unwrap_or(0),
            Err(Failure::Contact(contact, _)) => {
                closed.iter().position(|closed| closed.contact == *contact).unwrap_or(0)
            }
            Err(_) => 0,
        };
        self.impact_without_collision(closed[place].contact)
    }

    /// Slip of a contact ends after a short time.
    pub(crate) fn end_slip(
        &mut self,
        closed: &[Closed],
        here: &Evaluation,
        place: usize,
        time: f64,
    ) -> Result<(), SimulationError> {
        let start = self.front.t;
        let mut end = self.front.y.clone();
        end.iter_mut().zip(&here.rates).for_each(|(value, rate)| *value += time * rate);
        let mut step = Step::still(self.front.t, time, &end);
        let mut stopped = Vec::new();
        for (i, contact) in closed.iter().enumerate() {
            // Contacts of one body may stop together.
            let together =
                contact.slides.is_some() && time_of_slip(here, i).is_some_and(|left| left < 3.0 * ENDING);
            if i == place || together {
                self.front.phases[contact.contact] = Phase::Stick;
                stopped.push(contact.contact);
            }
        }
        self.commit(&mut step)?;
        self.crowded(start)?;
        self.slip_ended(&stopped)
    }

    /// Counts events that follow each other without progress.
    pub(crate) fn crowded(&mut self, before: f64) -> Result<(), SimulationError> {
        let close = 1e-12 * self.front.t.abs().max(1.0);
        if self.front.t - before > close {
            self.front.crowd = 0;
        }
        self.front.crowd += 1;
        if self.front.crowd > CROWD {
            return Err(self.error(None, Reason::EventsWithoutEnd(CROWD)));
        }
        Ok(())
    }
}
