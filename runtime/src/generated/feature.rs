//! Contacts that a generated module reaches by number alone: those of two boxes, of which a pair has dozens.

use nalgebra::Vector3;

use super::{Contact, Resolved, check_length, slip_noise};
use crate::{
    ClosedContactError, CollisionError, CollisionOutcome, ContactOutcome, ContactState, ImpactError, Scalar,
    State,
};

/// Such a contact in a state, of a mechanism whose independent speeds are a third of `R`.
#[derive(Clone, Copy, Debug)]
pub struct Feature<T: nalgebra::Scalar, const R: usize> {
    /// distance, m
    pub gap: T,
    /// what its collision follows from
    pub contact: Contact<T>,
    /// M^-1 V^T, by rows
    pub response: [T; R],
    /// V, by rows
    pub partial_velocities: [T; R],
    /// beta
    pub free_acceleration: Vector3<T>,
}

impl<T: Scalar, const R: usize> Feature<T, R> {
    /// Gap, basis, velocity and reduced matrix.
    pub fn state(&self) -> ContactState<T> {
        let Contact { normal, first, second, velocity, reduced, .. } = self.contact;
        ContactState { gap: Some(self.gap), normal, first, second, velocity, reduced }
    }

    /// The collision that `resolve` solves; `speeds` receives the independent speeds after it.
    ///
    /// # Errors
    ///
    /// Those of `resolve`, and [`crate::StateError::Length`].
    pub fn struck(
        &self,
        state: &State<'_, T>,
        speeds: &mut [T],
        resolve: impl FnOnce(&Contact<T>) -> Result<Resolved<T>, ImpactError<T>>,
    ) -> Result<CollisionOutcome<T>, CollisionError<T>> {
        check_length(speeds, state.speeds.len(), "the speeds after the collision")?;
        let hit = resolve(&self.contact)?;
        speeds.iter_mut().zip(state.speeds).for_each(|(after, &before)| *after = before);
        self.change(speeds, &hit.impulse);
        Ok(hit.outcome(self.contact.normal))
    }

    /// The closed contact of which `decide` finds mode and force; `accelerations` are those without it and become
    /// those with it.
    ///
    /// # Errors
    ///
    /// Those of `decide`.
    pub fn touching(
        &self,
        state: &State<'_, T>,
        accelerations: &mut [T],
        decide: impl FnOnce(&Contact<T>, &Vector3<T>, T) -> Result<ContactOutcome<T>, ClosedContactError<T>>,
    ) -> Result<ContactOutcome<T>, ClosedContactError<T>> {
        let noise = slip_noise(&self.partial_velocities, state.speeds, &self.contact.remainder);
        let outcome = decide(&self.contact, &self.free_acceleration, noise)?;
        self.change(accelerations, &outcome.answer.force);
        Ok(outcome)
    }

    /// Adds the response to an impulse or a force.
    fn change(&self, speeds: &mut [T], impulse: &Vector3<T>) {
        for (speed, response) in speeds.iter_mut().zip(self.response.chunks_exact(3)) {
            let terms = response.iter().zip(impulse.iter());
            *speed = terms.fold(*speed, |sum, (&response, &impulse)| sum + response * impulse);
        }
    }
}
