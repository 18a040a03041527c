//! Implements the trait `Contacts` by the numeric evaluation.

use std::sync::Arc;

use hodograph::generated::{
    Contact, Resolved, check_length, closed_contact, kept_contact, resolve, resolve_without_collision,
    slip_noise, write,
};
use hodograph::nalgebra::{MatrixXx3, Vector3};
use hodograph::{
    Budgeted, ClosedContactError, ClosedContacts, CollisionError, CollisionOutcome, ComponentKind,
    ContactMode, ContactOutcome, ContactState, Contacts, ImpactError, State, StateError, StatedLaw, Surface,
};
use hodograph_model::numeric::Level;

use super::snapshot::Snapshot;
use super::{NumericMechanism, finite};
use crate::contacts::{stated_law, stated_surface};

/// Adds what an impulse, or a force, does to speeds, or to their rates.
fn add(speeds: &mut [f64], response: &MatrixXx3<f64>, along: &Vector3<f64>) {
    let change = response * along;
    speeds.iter_mut().zip(change.iter()).for_each(|(speed, change)| *speed += change);
}

impl NumericMechanism {
    fn contact(&self, contact: usize, state: &State<'_>) -> Result<Arc<Snapshot>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        self.snapshot(state)
    }

    fn struck(
        &self,
        contact: usize,
        state: &State<'_>,
        speeds: &mut [f64],
        resolve: impl FnOnce(&Contact<f64>) -> Result<Resolved<f64>, ImpactError<f64>>,
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        let snapshot = self.contact(contact, state)?;
        let known = &snapshot.contacts[contact];
        write(speeds, state.speeds, "the speeds after the collision")?;
        let hit = resolve(&known.contact)?;
        add(speeds, &known.response, &hit.impulse);
        Ok(hit.outcome(known.contact.normal))
    }

    fn touching(
        &self,
        contact: usize,
        state: &State<'_>,
        accelerations: &mut [f64],
        decide: impl FnOnce(
            &Contact<f64>,
            &Vector3<f64>,
            f64,
        ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>>,
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        let snapshot = self.contact(contact, state)?;
        let known = &snapshot.contacts[contact];
        let rows = known.partial_velocities.transpose();
        let noise = slip_noise(rows.as_slice(), state.speeds, &known.contact.remainder);
        let outcome = decide(&known.contact, &known.free, noise)?;
        write(accelerations, snapshot.accelerations.as_slice(), "the accelerations")?;
        add(accelerations, &known.response, &outcome.answer.force);
        Ok(outcome)
    }
}

impl Contacts for NumericMechanism {
    fn contact_state(&self, contact: usize, state: &State<'_>) -> Result<ContactState<f64>, StateError> {
        let snapshot = self.contact(contact, state)?;
        let Contact { normal, first, second, velocity, reduced, .. } = snapshot.contacts[contact].contact;
        let gap = snapshot.values.contacts[contact].gap;
        Ok(ContactState { gap, normal, first, second, velocity, reduced })
    }

    fn gap(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let Some(gap) = &self.model.contacts[contact].gap else { return Ok(None) };
        let gap = self.still(state, |values| Ok(values.scalar(gap, Level::Motion)?.re))?;
        finite([gap]).map(|[gap]| Some(gap))
    }

    fn validity(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let Some(validity) = &self.model.contacts[contact].validity else { return Ok(None) };
        let validity = self.still(state, |values| Ok(values.scalar(validity, Level::Motion)?.re))?;
        finite([validity]).map(|[validity]| Some(validity))
    }

    fn surface(&self, contact: usize) -> Option<Surface<f64>> {
        stated_surface(&self.model, contact)
    }

    fn stated_law(&self, contact: usize) -> StatedLaw<'_> {
        stated_law(&self.model, contact)
    }

    fn contact_velocity(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        Ok(self.contact(contact, state)?.contacts[contact].contact.velocity)
    }

    fn free_acceleration(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        Ok(self.contact(contact, state)?.contacts[contact].free)
    }

    fn partial_velocities(
        &self,
        contact: usize,
        state: &State<'_>,
        partial_velocities: &mut [f64],
    ) -> Result<(), StateError> {
        let snapshot = self.contact(contact, state)?;
        let rows = snapshot.contacts[contact].partial_velocities.transpose();
        write(partial_velocities, rows.as_slice(), "the partial velocities")
    }

    fn response(&self, contact: usize, state: &State<'_>, response: &mut [f64]) -> Result<(), StateError> {
        let snapshot = self.contact(contact, state)?;
        write(response, snapshot.contacts[contact].response.transpose().as_slice(), "the response")
    }

    fn closed_contacts(
        &self,
        contacts: &[usize],
        state: &State<'_>,
        values: &mut ClosedContacts<'_, f64>,
    ) -> Result<(), StateError> {
        let p = state.speeds.len();
        values.check(contacts.len(), state.coordinates.len(), p)?;
        let snapshot = self.snapshot(state)?;
        values.coordinate_rates.copy_from_slice(&snapshot.values.rates);
        values.accelerations.copy_from_slice(snapshot.accelerations.as_slice());
        for (place, &contact) in contacts.iter().enumerate() {
            self.exists(ComponentKind::Contact, contact)?;
            let known = &snapshot.contacts[contact];
            let (three, rows) = (3 * place..3 * place + 3, 3 * p * place..3 * p * (place + 1));
            values.velocities[three.clone()].copy_from_slice(known.contact.velocity.as_slice());
            values.free_accelerations[three].copy_from_slice(known.free.as_slice());
            let partial = known.partial_velocities.transpose();
            values.partial_velocities[rows.clone()].copy_from_slice(partial.as_slice());
            values.responses[rows].copy_from_slice(known.response.transpose().as_slice());
        }
        Ok(())
    }

    fn collide(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |known| resolve(known, surface))
    }

    fn collide_with_budget(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Budgeted<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |known| resolve(known, surface))
    }

    fn impact_without_collision(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, |known| resolve_without_collision(known, surface))
    }

    fn contact_mode(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        accelerations: &mut [f64],
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        check_length(accelerations, state.speeds.len(), "the accelerations")?;
        self.touching(contact, state, accelerations, |known, free, noise| {
            closed_contact(known, free, noise, surface.mu)
        })
    }

    fn contact_force(
        &self,
        contact: usize,
        mode: ContactMode,
        state: &State<'_>,
        surface: &Surface<f64>,
        accelerations: &mut [f64],
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        check_length(accelerations, state.speeds.len(), "the accelerations")?;
        self.touching(contact, state, accelerations, |known, free, _| {
            kept_contact(mode, known, free, surface.mu)
        })
    }
}
