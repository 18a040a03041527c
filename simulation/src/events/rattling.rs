//! Ends rattling: several contacts of a body that collide in turn, faster and faster with decreasing heights.
//!
//! A block that rocks, or a box that falls flat on its corners, collides with the ground infinitely often in
//! a finite time T, even with e = 0; speeds and heights tend to zero. To first order in the remaining speeds
//! v, the impulses p of the whole sequence satisfy W p = -v - beta T, with friction along one direction: p =
//! p0 + lambda T, where the impulses p0 make the velocities zero at once and lambda are the forces of lasting
//! contact. Rule: if the heights are below the tolerance and all forces of lasting contact press, the
//! impulses p0 are applied, and the motion continues in contact. For a single contact this is the rule of
//! docs/theory.md, section 17.7.

use hodograph::ComponentKind;

use crate::SimulationError;
use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::phase::{Leaving, Phase};
use crate::integration::motion::Failure;
use crate::state::transition::Transition;

/// Contacts closer than this many times the tolerance take part.
const NEAR: f64 = 8.0;

impl Transition<'_> {
    /// Handles a contact that has closed: whether it and others near it stay closed, because they would only
    /// rattle below the tolerance.
    pub(crate) fn settles_into_contact(&mut self, first: usize) -> Result<bool, SimulationError> {
        let mut near = self.near(first)?;
        if near.len() < 2 || !self.quiet(&near)? {
            return Ok(false);
        }
        let before = self.mark();
        while near.len() > 1 && near.contains(&first) {
            let lies = self.lie(&near);
            if lies == Ok(true) {
                return Ok(true);
            }
            let closed = |contact: &usize| lies.is_ok() && self.front.phases[*contact].is_closed();
            let left: Vec<usize> = near.iter().copied().filter(closed).collect();
            self.return_to(&before);
            if left.len() == near.len() || left.is_empty() {
                break;
            }
            near = left;
        }
        Ok(false)
    }

    /// The contacts that are closed or almost closed.
    fn near(&self, first: usize) -> Result<Vec<usize>, SimulationError> {
        let state = self.here();
        let reach = NEAR * self.options.absolute_tolerance;
        let (mut near, open): (Vec<usize>, Vec<usize>) = (0..self.front.phases.len())
            .filter(|&contact| self.surfaces[contact].is_some())
            .partition(|&contact| contact == first || self.front.phases[contact].is_closed());
        let fault = |error| self.failure(Failure::State(error));
        for (contact, distance) in self.distances_nearby(open.into_iter(), &state).map_err(fault)? {
            let is_low = distance.gap.is_some_and(|gap| gap <= reach);
            if is_low && distance.validity.is_none_or(|validity| validity >= 0.0) {
                near.push(contact);
            }
        }
        near.sort_unstable();
        Ok(near)
    }

    /// Whether the normal velocities are no greater than those of falls from the height of the tolerance.
    fn quiet(&self, near: &[usize]) -> Result<bool, SimulationError> {
        let support = self.support(near, true)?;
        let pull = (0..near.len()).map(|i| support.beta[3 * i].abs()).fold(0.0, f64::max);
        let most = 2.0 * self.options.absolute_tolerance * pull;
        Ok((0..near.len()).all(|i| support.velocity[3 * i].powi(2) <= most))
    }

    /// Closes the contacts; returns whether they stay closed, and would not have risen above the tolerance.
    fn lie(&mut self, near: &[usize]) -> Result<bool, SimulationError> {
        let was = self.front.phases.clone();
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let support = self.support(near, false)?;
        let rates: Vec<f64> = (0..near.len()).map(|i| support.velocity[3 * i]).collect();
        let kinetic = self.kinetic()?;
        let hit = self.plastic_impact(near, &self.front.y[n..n + p])?;
        self.front.y[n..n + p].copy_from_slice(&hit.after);
        self.drive()?;
        for &contact in near {
            // Contacts that stuck may slip after the impact.
            self.front.phases[contact] = Phase::Open(Leaving::NOW);
        }
        let impacts = self.front.energy.impacts;
        self.decide(near, &was)?;
        // Contacts that separate with less than the tolerance stay closed, too: all lost energy is work of
        // the sequence, except that of impacts which the decision has recorded.
        let told = self.front.energy.impacts - impacts;
        self.front.energy.impacts += self.kinetic()? - kinetic - told;
        let support = self.support(near, false)?;
        let low = |(i, &contact): (usize, &usize)| {
            let pull = self.front.forces[contact].x * support.coupled[(3 * i, 3 * i)];
            self.front.phases[contact].is_closed()
                && rates[i].powi(2) <= 2.0 * self.options.absolute_tolerance * pull
        };
        if !near.iter().enumerate().all(low) {
            return Ok(false);
        }
        self.look_for_rest()?;
        Ok(true)
    }

    fn support(&self, contacts: &[usize], accelerate: bool) -> Result<ClosedContacts, SimulationError> {
        ClosedContacts::new(self.mechanism, &self.here(), contacts, accelerate)
            .map_err(|error| self.failure(Failure::State(error)))
    }

    fn kinetic(&self) -> Result<f64, SimulationError> {
        self.mechanism.kinetic_energy(&self.here()).map_err(|error| self.failure(Failure::State(error)))
    }
}
