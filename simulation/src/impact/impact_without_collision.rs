//! Impacts without collision: a sliding contact that no finite force can hold (Painleve's paradox).

use hodograph::generated::hypot;
use hodograph::{
    CollisionError, CollisionOutcome, ComponentKind, ContactState, ImpactError, ReducedMatrix, State, Surface,
};
use nalgebra::{DVector, Vector2};

use crate::closed::closed_contacts::{ClosedContacts, least_squares};
use crate::closed::forces::JAM;
use crate::closed::phase::Phase;
use crate::impact::impact_at_once::Jam;
use crate::impact::impacts::MOST;
use crate::impact::single_impact::Hit;
use crate::integration::motion::Failure;
use crate::state::transition::Transition;
use crate::{CollisionRecord, ErrorKind, EventKind, SimulationError};

impl Transition<'_> {
    /// A sliding contact that no finite force can hold suffers an impact with zero speed of approach.
    /// Contacts that it presses together are struck next, and the modes of all closed contacts are decided
    /// again.
    pub(crate) fn impact_without_collision(&mut self, contact: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        self.front.crowd += 1;
        if self.front.crowd > MOST {
            return Err(self.error(Some(contact), self.without_end(MOST)));
        }
        let touching = self.touching(Some(contact))?;
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let mut before = self.front.y[n..n + p].to_vec();
        if let Some(turned) = self.turned_into_jam(contact, &before)? {
            self.front.energy.impacts += self.energy_change(&before, &turned)?;
            before = turned;
        }
        let (outcome, after) = match self.low_without_collision(contact, &before) {
            // It would not jam alone.
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
        self.drive()?;
        self.front.energy.impacts += outcome.energy_change;
        let speeds_before = before.clone();
        let struck = CollisionRecord { outcome, speeds_before, last_bounce: false, spread: None };
        self.push(Some(contact), EventKind::ImpactWithoutCollision(Box::new(struck)));
        let fastest = self.greatest_velocity(&touching, &before)?;
        match self.approaching(&touching, &after, Some(fastest))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, &was),
        }
    }

    /// The speeds with the slip of the only closed contact turned so that it jams. While slip turns towards a
    /// jam, f decreases like the square root of the remaining time, so that the last turn takes less time
    /// than any step. `None` if it has jammed already, or is not about to.
    fn turned_into_jam(&self, contact: usize, speeds: &[f64]) -> Result<Option<Vec<f64>>, SimulationError> {
        let closed = self.front.phases.iter().filter(|phase| phase.is_closed()).count();
        if closed != 1 || !matches!(self.front.phases[contact], Phase::Slide(_)) {
            return Ok(None);
        }
        let state = State { speeds, ..self.here() };
        let alone = ClosedContacts::new(self.mechanism, &state, &[contact], false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let slip = alone.slip(0);
        let mu = self.friction(contact, slip.norm())?.slips;
        let Some(turned) = slip_that_jams(&alone.reduced(0), slip, mu) else { return Ok(None) };
        let change = Vector2::new(turned.x - slip.x, turned.y - slip.y);
        let impulse = least_squares(&alone.coupled, &DVector::from_vec(vec![0.0, change.x, change.y]));
        let change = &alone.response * impulse;
        Ok(Some(speeds.iter().zip(change.iter()).map(|(speed, change)| speed + change).collect()))
    }

    /// The only closed contact, if its slip turns into a jam within a negligible time.
    pub(crate) fn turns_into_jam(&self) -> Result<Option<usize>, SimulationError> {
        let Some(contact) = self.front.phases.iter().position(Phase::is_closed) else { return Ok(None) };
        Ok(self.turned_into_jam(contact, self.here().speeds)?.map(|_| contact))
    }

    /// The closed contacts jam together: an impact of all of them.
    fn jam_together(
        &mut self,
        before: &[f64],
        was: &[Phase],
        alone: SimulationError,
    ) -> Result<(), SimulationError> {
        let closed: Vec<usize> = (0..was.len()).filter(|&contact| was[contact].is_closed()).collect();
        match self.impact_of_a_jam(&closed, before)? {
            Jam::Impact(hit) => self.strike_jam(hit, was),
            // There are finite forces in other modes.
            Jam::Modes(choice) => {
                self.apply(&closed, was, &choice)?;
                self.crowded(self.front.t)
            }
            Jam::Unsolved => self.go_past_a_jam(&closed, was, alone),
        }
    }

    /// Contacts that have no finite forces in any modes, though none of them can be named that jams, jam together; the error
    /// `none` if they have no impact either.
    pub(crate) fn jam_of_all(
        &mut self,
        contacts: &[usize],
        none: SimulationError,
    ) -> Result<(), SimulationError> {
        if self.mechanism.torques_of(contacts).next().is_some() {
            return Err(none);
        }
        self.front.crowd += 1;
        if self.front.crowd > MOST {
            return Err(self.error(None, self.without_end(MOST)));
        }
        match self.impact_of_a_jam(contacts, self.here().speeds)? {
            Jam::Impact(hit) => self.strike_jam(hit, &self.front.phases.clone()),
            Jam::Modes(_) | Jam::Unsolved => Err(none),
        }
    }

    /// Takes the impact of contacts that jam together, and what it makes approach.
    fn strike_jam(&mut self, hit: Hit, was: &[Phase]) -> Result<(), SimulationError> {
        self.front.resting = false;
        let (before, after) = (hit.before.clone(), hit.after.clone());
        self.take_impact(hit, None)?;
        let touching = self.touching(None)?;
        let fastest = self.greatest_velocity(&touching, &before)?;
        match self.approaching(&touching, &after, Some(fastest))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, was),
        }
    }

    /// The outcome of [`Self::without_collision`]; without restitution if the contact is pressed down and
    /// would rise by less than the tolerance: the rule of chatter (docs/theory.md, section 17.7).
    fn low_without_collision(
        &self,
        contact: usize,
        speeds: &[f64],
    ) -> Result<(CollisionOutcome<f64>, Vec<f64>), SimulationError> {
        let (outcome, after) = self.without_collision(contact, speeds, false)?;
        let rebound = outcome.impact.velocity.x;
        if rebound > 0.0 && self.is_low(contact, &after, rebound)? {
            return self.without_collision(contact, speeds, true);
        }
        Ok((outcome, after))
    }

    /// The outcome along n, t, s with t along the slip, and the speeds after it; `faded` means without
    /// restitution.
    fn without_collision(
        &self,
        contact: usize,
        speeds: &[f64],
        faded: bool,
    ) -> Result<(CollisionOutcome<f64>, Vec<f64>), SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let here = self.mechanism.contact_state(contact, &state).map_err(fault)?;
        let speed = hypot(here.velocity.y, here.velocity.z);
        // Friction is that of the jamming slip, not that of impacts.
        let surface =
            Surface { mu: self.friction(contact, speed)?.slips, ..self.surface_in_impact(contact, 0.0)? };
        let surface = jammed(&here, if faded { Surface { e: 0.0, ..surface } } else { surface });
        let mut after = speeds.to_vec();
        let outcome = self
            .mechanism
            .impact_without_collision(contact, &state, &surface, &mut after)
            .map_err(|error| self.error(Some(contact), ErrorKind::Collision(error)))?;
        Ok((outcome, after))
    }
}

/// Slip turned so that f = m_nn - mu b.d is as small and negative as [`jammed`] makes it; `None` if that is
/// not a small turn, or impossible.
fn slip_that_jams(reduced: &ReducedMatrix<f64>, slip: Vector2<f64>, mu: f64) -> Option<Vector2<f64>> {
    let b = Vector2::new(reduced.nt, reduced.ns);
    let (least, speed) = (JAM * reduced.nn, slip.norm());
    let f = reduced.nn - mu * b.dot(&slip) / speed;
    if !(f > 1.5 * least && f <= TURNS * reduced.nn) {
        return None;
    }
    let cos = (reduced.nn + least) / (mu * b.norm());
    if cos >= 1.0 {
        return None;
    }
    // On the same side of b as the slip.
    let towards = b / b.norm();
    let across = Vector2::new(-towards.y, towards.x);
    let side = if across.dot(&slip) < 0.0 { -1.0 } else { 1.0 };
    Some(speed * (towards * cos + across * (side * (1.0 - cos * cos).sqrt())))
}

/// Contacts whose slip turns into a jam within a negligible time have f below this, or f / m_nn of one.
pub(crate) const TURNS: f64 = 1e-2;

/// The surface of an impact without collision, where f = m_nn - mu m_nt with t along the slip is not yet
/// zero, but so small that the contact jams: its friction is increased so that f becomes as small and
/// negative. The increase is less than `2 JAM` times m_nn / m_nt.
fn jammed(here: &ContactState<f64>, surface: Surface<f64>) -> Surface<f64> {
    let (reduced, slip) = (&here.reduced, here.velocity.yz());
    let along_slip = Vector2::new(reduced.nt, reduced.ns).dot(&slip) / slip.norm();
    let f = reduced.nn - surface.mu * along_slip;
    let least = JAM * reduced.nn;
    // the event is located where f = least, up to rounding
    if f >= 0.0 && f <= 1.5 * least {
        Surface { mu: (reduced.nn + least) / along_slip, ..surface }
    } else {
        surface
    }
}
