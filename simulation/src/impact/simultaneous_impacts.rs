//! Solves simultaneous impacts of several contacts by their stiffnesses.

use hodograph::{ComponentKind, Law, State};
use nalgebra::{DMatrix, DVector};

use crate::closed::closed_contacts::{Along, ClosedContacts};
use crate::impact::lzb::{self, Fault};
use crate::integration::motion::Failure;
use crate::interface::contact_law::Restitution;
use crate::state::transition::Transition;
use crate::{ErrorKind, EventKind, Share, SimulationError, SimultaneousCollision};

impl Transition<'_> {
    /// Solves the impact of the touching contacts that are coupled with `first`, and records it; returns the
    /// speeds after it. `None` if `first` is coupled with none.
    pub(crate) fn strike_together(
        &mut self,
        touching: &[usize],
        first: usize,
    ) -> Result<Option<Vec<f64>>, SimulationError> {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let speeds = self.front.y[n..n + p].to_vec();
        let state = State {
            time: self.front.t,
            coordinates: &self.front.y[..n],
            speeds: &speeds,
            inputs: &self.front.held,
        };
        let fault = |error| self.failure(Failure::State(error));
        let support = ClosedContacts::new(self.mechanism, &state, touching, false).map_err(fault)?;
        let struck: Vec<usize> = touching.iter().position(|&contact| contact == first).into_iter().collect();
        let places = support.coupled_with(&struck, Along::Normal);
        if places.len() < 2 {
            return Ok(None);
        }
        let (mut stiffness, mut restitution) = (Vec::new(), Vec::new());
        for &place in &places {
            let contact = touching[place];
            restitution.push(self.energetic(contact)?);
            let own = self.options.stiffness.iter().rev().find(|(index, _)| *index == contact);
            stiffness.push(own.map_or(1.0, |(_, stiffness)| *stiffness));
        }
        let m = places.len();
        let coupled = DMatrix::from_fn(m, m, |a, b| support.coupled[(3 * places[a], 3 * places[b])]);
        let mut velocity = DVector::zeros(m);
        for (rate, &place) in velocity.iter_mut().zip(&places) {
            // The normal velocity of a lasting contact is a rounding error.
            let rounding = 1e-13 * support.velocity_size(place, &speeds);
            let rounding = self.unseen(&support, place, &speeds, rounding)?;
            let known = support.velocity[3 * place];
            *rate = if known.abs() <= rounding { 0.0 } else { known };
        }
        let outcome = lzb::solve(&coupled, &velocity, &stiffness, &restitution).map_err(|fault| {
            let (contact, why) = match fault {
                Fault::Immobile(a) => (touching[places[a]], "nothing can move along its normal"),
                Fault::TooLong => (first, "the stiffnesses or the coefficients of restitution are too far apart"),
            };
            let message = format!(
                "the contacts struck together have no outcome after Liu, Zhao and Brogliato: {why}; let them answer one after the other (sequential)"
            );
            self.error(Some(contact), ErrorKind::LzbNotCovered(message))
        })?;
        let mut after = speeds.clone();
        let mut shares = Vec::with_capacity(m);
        for (a, &place) in places.iter().enumerate() {
            let impulse = outcome.impulses[a];
            for (speed, response) in after.iter_mut().zip(support.response.column(3 * place).iter()) {
                *speed += response * impulse;
            }
            let normal = self.mechanism.contact_state(touching[place], &state).map_err(fault)?.normal;
            shares.push(Share {
                contact: touching[place],
                impulse,
                impulse_on_point: normal * impulse,
                approach: velocity[a],
                separation: outcome.velocities[a],
                work: outcome.works[a],
            });
        }
        let energy_change = self.energy_change(&speeds, &after)?;
        self.front.energy.impacts += energy_change;
        self.front.y[n..n + p].copy_from_slice(&after);
        self.drive()?;
        let struck = SimultaneousCollision { shares, energy_change, speeds_before: speeds, spread: None };
        self.push(None, EventKind::SimultaneousCollision(Box::new(struck)));
        Ok(Some(after))
    }

    /// The energetic coefficient of restitution of a contact without friction.
    fn energetic(&self, contact: usize) -> Result<f64, SimulationError> {
        let refused = |message: String| Err(self.error(Some(contact), ErrorKind::LzbNotCovered(message)));
        let Some(pair) = self.pair(contact) else {
            return refused("the contact has no surface".to_owned());
        };
        let (surface, mu) = (&pair.surface, pair.mu_in_impacts());
        if pair.law.restitution != Restitution::Constant {
            return refused(format!(
                "it is struck together with others and e depends on the speed of approach, {}: Liu, Zhao and Brogliato take one e; give a constant one, or let contacts \
                 answer one after the other (sequential)",
                pair.law.restitution
            ));
        }
        if mu != 0.0 {
            return refused(format!(
                "it is struck together with others and has mu = {}: impacts after Liu, Zhao and Brogliato are solved without friction only; give mu = 0, or let \
                 contacts answer one after the other (sequential)",
                mu
            ));
        }
        if surface.law != Law::Stronge {
            return refused(
                "it is struck together with others: impacts after Liu, Zhao and Brogliato take e as the energetic coefficient; give the law stronge".to_owned(),
            );
        }
        Ok(surface.e)
    }
}
