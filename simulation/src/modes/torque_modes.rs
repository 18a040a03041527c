//! Torques at changes of modes: their phases follow those of their contacts, and their events have names of
//! their own.
//!
//! Theory: docs/theory.md, section 17.17.

use hodograph::Selection;
use nalgebra::Vector2;

use crate::closed::mode_selection::Decision;
use crate::closed::phase::{Closed, Leaving, Phase};
use crate::closed::torques::{Torque, Turning};
use crate::modes::mode_changes::FIRST;
use crate::state::transition::Transition;
use crate::{ErrorKind, EventKind, SimulationError};

impl Transition<'_> {
    /// Applies the mode of a torque, after that of its contact, and records the change as an event.
    pub(crate) fn apply_to_torque(
        &mut self,
        number: usize,
        torque: &Torque,
        was: Phase,
        decision: Decision,
        selection: Selection,
    ) -> Result<(), SimulationError> {
        let phase = match decision {
            _ if !self.front.phases[torque.contact].is_closed() => Phase::Open(Leaving::Apart),
            Decision::Stick => Phase::Stick,
            Decision::Slide(direction, _) => Phase::Slide(direction),
            // If the normal force is a rounding error, its phase does not change.
            Decision::Separate => self.front.phases[number],
        };
        self.front.phases[number] = phase;
        let begins = matches!(decision, Decision::Slide(_, true));
        if begins {
            self.front.next = self.front.next.min(FIRST * self.front.scales.time);
        }
        if self.bounces(torque.contact) {
            return Ok(());
        }
        match (was, phase) {
            (Phase::Slide(_), Phase::Stick) => self.push(Some(number), ends(torque.turning, selection)),
            (Phase::Stick | Phase::Slide(_), Phase::Slide(d)) if begins => {
                self.front.resting = false;
                let along = self.along_axes_of_n(torque.contact, d)?;
                self.push(Some(number), turns(torque.turning, d, along, selection));
            }
            _ => {}
        }
        Ok(())
    }

    /// Handles a jam of a sliding contact or of a torque, whose force would grow without bound.
    pub(crate) fn jams(&mut self, contact: usize) -> Result<(), SimulationError> {
        let own = self.mechanism.contact(contact);
        let touching = (0..self.front.phases.len()).filter(|&i| self.front.phases[i].is_closed());
        if self.mechanism.torques_of(&touching.collect::<Vec<_>>()).next().is_none() {
            return self.impact_without_collision(own);
        }
        let message = "it jams, and would suffer an impact without collision, while torques of rolling or spinning \
            friction act: such impacts are not covered. Give these contacts no `rolling` and no `spinning`";
        Err(self.error(Some(own), ErrorKind::NoForces(message.to_owned())))
    }

    /// The mode of a closed contact or of its torque in a word.
    pub(crate) fn mode_in_words(&self, closed: &Closed) -> &'static str {
        let turning = self.mechanism.torque(closed.contact).map(|torque| torque.turning);
        match (turning, closed.slides.is_some()) {
            (None, true) => "slides",
            (None, false) => "sticks",
            (Some(Turning::Rolling), true) => "rolls",
            (Some(Turning::Rolling), false) => "does not roll",
            (Some(Turning::Spinning), true) => "spins",
            (Some(Turning::Spinning), false) => "does not spin",
        }
    }
}

/// The event of rotation that begins in a direction.
fn turns(turning: Turning, direction: Vector2<f64>, along: [f64; 3], selection: Selection) -> EventKind {
    match turning {
        Turning::Rolling => EventKind::Roll { direction: [direction.x, direction.y], along, selection },
        Turning::Spinning => EventKind::Spin { positive: direction.x > 0.0, selection },
    }
}

/// The event of rotation that ends.
fn ends(turning: Turning, selection: Selection) -> EventKind {
    match turning {
        Turning::Rolling => EventKind::RollEnds { selection },
        Turning::Spinning => EventKind::SpinEnds { selection },
    }
}
