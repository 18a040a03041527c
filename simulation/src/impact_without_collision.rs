//! Impacts without collision: a sliding contact that no finite force can hold (Painleve's paradox).

use hodograph::{CollisionError, CollisionOutcome, ComponentKind, ContactState, ImpactError, State, Surface};
use nalgebra::Vector2;

use crate::forces::JAM;
use crate::impacts::MOST;
use crate::motion::Failure;
use crate::phase::Phase;
use crate::transition::Transition;
use crate::{CollisionRecord, ErrorKind, EventKind, SimulationError};

impl Transition<'_> {
    /// A sliding contact that no finite force holds suffers an impact with zero speed of approach. Then contacts
    /// that it presses together strike, and the modes of all that touch are decided anew.
    pub(crate) fn impact_without_collision(&mut self, contact: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        self.front.crowd += 1;
        if self.front.crowd > MOST {
            return Err(self.error(Some(contact), self.without_end(MOST)));
        }
        let touching = self.touching(Some(contact))?;
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let before = self.front.y[n..n + p].to_vec();
        let (outcome, after) = match self.without_collision(contact, &before) {
            // Alone it would not jam.
            Err(
                error @ SimulationError {
                    kind: ErrorKind::Collision(CollisionError::Impact(ImpactError::NoImpact { .. })),
                    ..
                },
            ) => {
                return self.jam_together(&before, &was, error);
            }
            found => found?,
        };
        self.front.resting = false;
        self.front.y[n..n + p].copy_from_slice(&after);
        self.front.energy.impacts += outcome.energy_change;
        let struck = CollisionRecord { outcome, speeds_before: before, last_bounce: false, spread: None };
        self.push(Some(contact), EventKind::ImpactWithoutCollision(Box::new(struck)));
        match self.approaching(&touching, &after, Some(1.0))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, &was),
        }
    }

    /// The closed contacts jam together: an impact of all of them.
    fn jam_together(
        &mut self,
        before: &[f64],
        was: &[Phase],
        alone: SimulationError,
    ) -> Result<(), SimulationError> {
        let closed: Vec<usize> = (0..was.len()).filter(|&contact| was[contact].is_closed()).collect();
        let Some(hit) = self.impact_of_a_jam(&closed, before)? else { return Err(alone) };
        self.front.resting = false;
        let after = hit.after.clone();
        self.take_impact(hit, None);
        let touching = self.touching(None)?;
        match self.approaching(&touching, &after, Some(1.0))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, was),
        }
    }

    /// The outcome along n, t, s with t along the slip, and the speeds after.
    fn without_collision(
        &self,
        contact: usize,
        speeds: &[f64],
    ) -> Result<(CollisionOutcome<f64>, Vec<f64>), SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let here = self.mechanism.contact_state(contact, &state).map_err(fault)?;
        let speed = here.velocity.y.hypot(here.velocity.z);
        // Friction is that of the slip that jams, not that of impacts.
        let surface =
            Surface { mu: self.friction(contact, speed)?.slips, ..self.surface_in_impact(contact, 0.0)? };
        let surface = jammed(&here, surface);
        let mut after = speeds.to_vec();
        let outcome = self
            .mechanism
            .impact_without_collision(contact, &state, &surface, &mut after)
            .map_err(|error| self.error(Some(contact), ErrorKind::Collision(error)))?;
        Ok((outcome, after))
    }
}

/// The surface of an impact without collision: where f = m_nn - mu m_nt, t along the slip, is not yet zero,
/// but so small that the contact jams, with the friction that makes it as small and negative. It is larger by
/// less than `2 JAM` times m_nn / m_nt.
fn jammed(here: &ContactState<f64>, surface: Surface<f64>) -> Surface<f64> {
    let (reduced, slip) = (&here.reduced, here.velocity.yz());
    let along_slip = Vector2::new(reduced.nt, reduced.ns).dot(&slip) / slip.norm();
    let f = reduced.nn - surface.mu * along_slip;
    let least = JAM * reduced.nn;
    // the event is found where f = least, up to the rounding of its search
    if f >= 0.0 && f <= 1.5 * least {
        Surface { mu: (reduced.nn + least) / along_slip, ..surface }
    } else {
        surface
    }
}
