//! Solves one of the impacts at a time: that of one contact by the exact solver, or that of several at once.

use hodograph::{CollisionError, CollisionOutcome, ComponentKind, State, Surface};

use crate::closed::closed_contacts::{ClosedContacts, free_acceleration};
use crate::closed::phase::Closed;
use crate::integration::motion::Failure;
use crate::state::transition::Transition;
use crate::{ErrorKind, Share, SimulationError};

/// An impact, with the speeds before and after.
pub(crate) struct Hit {
    pub kind: HitKind,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
    /// the contacts that would continue to bounce below the tolerance, and for how long, s
    pub bounces: Vec<(usize, f64)>,
}

/// The kind of an impact.
pub(crate) enum HitKind {
    One(usize, Box<CollisionOutcome<f64>>),
    /// several at once, and the change of kinetic energy, J
    Several(Vec<Share>, f64),
}

impl Hit {
    /// The contacts with impulses.
    pub fn contacts(&self) -> Vec<usize> {
        match &self.kind {
            HitKind::One(contact, _) => vec![*contact],
            HitKind::Several(shares, _) => shares.iter().map(|share| share.contact).collect(),
        }
    }

    /// The change of kinetic energy, J.
    pub fn energy_change(&self) -> f64 {
        match &self.kind {
            HitKind::One(_, outcome) => outcome.energy_change,
            HitKind::Several(_, energy_change) => *energy_change,
        }
    }
}

/// Forces of other contacts accelerate one by at most this many times the greatest acceleration without
/// them, in the rule of chatter. Where they do more, a contact bounces once more.
const STRONG: f64 = 1e4;

impl Transition<'_> {
    /// The impact of these contacts; `faded` ones have no restitution.
    pub(crate) fn hit(
        &self,
        contacts: &[usize],
        speeds: &[f64],
        faded: bool,
    ) -> Result<Hit, SimulationError> {
        match contacts {
            [contact] => self.single(*contact, speeds, faded),
            _ => self.impact_at_once(contacts, speeds, faded),
        }
    }

    /// The change of kinetic energy between two sets of speeds, J. If motion is prescribed, it is not the
    /// work of the contacts: (24).
    pub(crate) fn energy_change(&self, before: &[f64], after: &[f64]) -> Result<f64, SimulationError> {
        let kinetic = |speeds| self.mechanism.kinetic_energy(&State { speeds, ..self.here() });
        let change = kinetic(after).and_then(|after| Ok(after - kinetic(before)?));
        change.map_err(|error| self.failure(Failure::State(error)))
    }

    /// The impact of one contact.
    fn single(&self, contact: usize, speeds: &[f64], faded: bool) -> Result<Hit, SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let velocity = self.mechanism.contact_velocity(contact, &state);
        let velocity = velocity.map_err(|error| self.failure(Failure::State(error)))?;
        let surface = self.surface_in_impact(contact, -velocity.x)?;
        let fault = |error: CollisionError<f64>| self.error(Some(contact), ErrorKind::Collision(error));
        let solve = |surface: &Surface<f64>, bounces: Vec<(usize, f64)>| {
            let mut after = speeds.to_vec();
            let outcome = self.mechanism.collide(contact, &state, surface, &mut after).map_err(fault)?;
            let kind = HitKind::One(contact, Box::new(outcome));
            Ok((outcome, Hit { kind, before: speeds.to_vec(), after, bounces }))
        };
        let plastic = Surface { e: 0.0, ..surface };
        let (outcome, hit) = solve(if faded { &plastic } else { &surface }, Vec::new())?;
        let (before, rebound) = (-outcome.approach.x, outcome.impact.velocity.x);
        if faded || rebound <= 0.0 {
            return Ok(hit);
        }
        match self.last_bounce(contact, speeds, before, rebound)? {
            Some(time) => Ok(solve(&plastic, vec![(contact, time)])?.1),
            None => Ok(hit),
        }
    }

    /// The rule of chatter (docs/theory.md, section 17.7): the time for which a contact would continue to
    /// bounce if its next bounce is lower than the tolerance and it is pressed together, s.
    pub(crate) fn last_bounce(
        &self,
        contact: usize,
        speeds: &[f64],
        before: f64,
        rebound: f64,
    ) -> Result<Option<f64>, SimulationError> {
        let pull = self.pull(contact, speeds, rebound)?;
        Ok(match (self.rises_little(pull, rebound), self.pair(contact)) {
            // Bounces that lose nothing have no end: they are contact at once.
            (true, Some(_)) if rebound >= before => Some(0.0),
            (true, Some(pair)) => pair.bounces_for(before, rebound, -pull),
            _ => None,
        })
    }

    /// Whether a contact that separates with this speed is pressed down and rises by less than the tolerance.
    pub(crate) fn is_low(
        &self,
        contact: usize,
        speeds: &[f64],
        rebound: f64,
    ) -> Result<bool, SimulationError> {
        Ok(self.rises_little(self.pull(contact, speeds, rebound)?, rebound))
    }

    fn rises_little(&self, pull: f64, rebound: f64) -> bool {
        pull < 0.0 && rebound * rebound / (-2.0 * pull) < self.options.absolute_tolerance
    }

    /// The surface of a contact in an impact with this speed of approach.
    pub(crate) fn surface_in_impact(
        &self,
        contact: usize,
        approach: f64,
    ) -> Result<Surface<f64>, SimulationError> {
        let pair = self.pair(contact).ok_or("the contact has no surface".to_owned());
        pair.and_then(|pair| pair.in_impact(approach))
            .map_err(|message| self.error(Some(contact), ErrorKind::BadOption(message)))
    }

    /// The normal acceleration of a contact without its own force, while the other lasting contacts keep
    /// their modes. Their forces count only if such an acceleration can matter to a contact that separates
    /// with the speed `rebound`.
    fn pull(&self, contact: usize, speeds: &[f64], rebound: f64) -> Result<f64, SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let mut y = self.front.y.clone();
        y[n..n + speeds.len()].copy_from_slice(speeds);
        let inputs = self.motion(&[]).inputs(self.front.t, &y).map_err(|failure| self.failure(failure))?;
        let state = State { time: self.front.t, coordinates: &y[..n], speeds, inputs: &inputs };
        let fault = |error| self.failure(Failure::State(error));
        let beta = free_acceleration(self.mechanism.mechanism, contact, &state).map_err(fault)?.x;
        // After an impact directions of slip are those of the velocities, not those of the last step.
        let direct = |closed| Closed { omega: None, turning: None, ..closed };
        let others: Vec<_> =
            self.closed().into_iter().filter(|closed| closed.contact != contact).map(direct).collect();
        if others.is_empty() {
            return Ok(beta);
        }
        let places: Vec<usize> = others.iter().map(|closed| closed.contact).collect();
        let free = ClosedContacts::new(self.mechanism, &state, &places, true).map_err(fault)?.beta.amax();
        if rebound * rebound > 2.0 * self.options.absolute_tolerance * STRONG * free.max(beta.abs()) {
            return Ok(beta);
        }
        let Ok(evaluation) = self.motion(&others).estimate(self.front.t, &y) else { return Ok(beta) };
        let Some(forces) = evaluation.forces else { return Ok(beta) };
        let own = ClosedContacts::new(self.mechanism, &state, &[contact], false).map_err(fault)?;
        let rates = forces.rates(&evaluation.support);
        Ok(beta + own.partials.column(0).dot(&rates))
    }
}
