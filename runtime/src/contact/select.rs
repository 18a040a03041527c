//! Selects the mode of a closed contact, and computes the force of a mode that is kept.
//!
//! Theory: docs/theory.md, sections 17.1 and 17.3.

use nalgebra::{Vector2, Vector3};

use super::{
    ContactError, ContactForce, ContactMode, Margins, Selection,
    begin::{Beginning, beginnings},
    stick::{Stuck, stuck},
    tangential::Closed,
};
use crate::{
    Law, ReducedMatrix, Scalar, Surface,
    scalar::{direction, length},
    solve::check,
};

/// A closed contact in scaled units, with the input that converts results back.
struct ScaledContact<'a, T: Scalar> {
    matrix: &'a ReducedMatrix<T>,
    beta: &'a Vector3<T>,
    closed: Closed<T>,
}

/// See [`super::contact_mode_after`].
pub(super) fn select<T: Scalar>(
    matrix: &ReducedMatrix<T>,
    beta: &Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
    before: &Vector3<T>,
) -> Result<ContactForce<T>, ContactError<T>> {
    let contact = scaled_contact(matrix, beta, slip, mu)?;
    let answer = match direction(slip) {
        Some((d, speed)) => contact.slipping(&d, speed),
        None => contact.resting(before),
    };
    answer.and_then(finite)
}

/// See [`super::contact_force`].
pub(super) fn keep<T: Scalar>(
    mode: ContactMode,
    matrix: &ReducedMatrix<T>,
    beta: &Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
) -> Result<ContactForce<T>, ContactError<T>> {
    let contact = scaled_contact(matrix, beta, slip, mu)?;
    let none = ContactError::NoMode { free_acceleration: beta.x };
    let answer = match mode {
        ContactMode::Separate => Ok(contact.separate()),
        ContactMode::Slide => match direction(slip) {
            Some((d, speed)) => contact.slide(&d, Some(speed)),
            None => Err(none),
        },
        ContactMode::Stick => stuck(&contact.closed).map(|stuck| contact.stick(&stuck)).ok_or(none),
        ContactMode::BeginSlip => {
            let mut best: Option<Beginning<T>> = None;
            for way in beginnings(&contact.closed, false).into_iter().flatten() {
                if best.is_none_or(|other| other.f < way.f) {
                    best = Some(way);
                }
            }
            best.map(|way| contact.begin(&way)).ok_or(none)
        }
    };
    answer.and_then(finite)
}

/// Checks the input.
fn scaled_contact<'a, T: Scalar>(
    matrix: &'a ReducedMatrix<T>,
    beta: &'a Vector3<T>,
    slip: &Vector2<T>,
    mu: T,
) -> Result<ScaledContact<'a, T>, ContactError<T>> {
    let surface = Surface { mu, e: T::zero(), law: Law::Poisson };
    check(matrix, &Vector3::new(-T::one(), slip.x, slip.y), &surface)?;
    for value in beta.iter().copied() {
        if !value.is_finite() {
            return Err(ContactError::Input(crate::ImpactError::NotFinite { value }));
        }
    }
    Ok(ScaledContact { matrix, beta, closed: Closed::new(matrix, beta, mu) })
}

/// The answer, or an error if one of its numbers is not finite.
fn finite<T: Scalar>(answer: ContactForce<T>) -> Result<ContactForce<T>, ContactError<T>> {
    for value in answer.force.iter().chain(answer.acceleration.iter()).copied() {
        if !value.is_finite() {
            return Err(ContactError::Input(crate::ImpactError::NotFinite { value }));
        }
    }
    Ok(answer)
}

impl<T: Scalar> ScaledContact<'_, T> {
    /// The mode of a contact that slips.
    fn slipping(&self, d: &Vector2<T>, speed: T) -> Result<ContactForce<T>, ContactError<T>> {
        let f = self.closed.f(d);
        if f > self.closed.f_noise() {
            if self.beta.x > T::zero() {
                return Ok(self.separate());
            }
            return self.slide(d, Some(speed));
        }
        if self.beta.x >= T::zero() {
            let mut answer = self.separate();
            answer.selection = Selection::Indeterminate;
            return Ok(answer);
        }
        Err(self.without_force(f))
    }

    /// The mode of a contact that does not slip.
    fn resting(&self, before: &Vector3<T>) -> Result<ContactForce<T>, ContactError<T>> {
        // f > 0 in all directions: if the free acceleration separates the bodies, no other mode fits.
        let moderate = self.closed.mu * length(&self.closed.b) < T::one() - self.closed.f_noise();
        if moderate && self.beta.x > T::zero() {
            return Ok(self.separate());
        }
        let stuck = stuck(&self.closed);
        if moderate
            && self.closed.one_mode()
            && let Some(stuck) = stuck.filter(Stuck::fits)
        {
            return Ok(self.stick(&stuck));
        }
        let ways = beginnings(&self.closed, stuck.is_some_and(|stuck| !stuck.unique));
        let sticks = stuck.filter(Stuck::fits).map(|stuck| self.stick(&stuck));
        let separates = (self.beta.x > T::zero()).then(|| self.separate());
        let begins = ways.iter().flatten().map(|way| self.begin(way));
        let mut count = 0;
        let mut best: Option<(T, bool, ContactForce<T>)> = None;
        for answer in sticks.into_iter().chain(separates).chain(begins) {
            count += 1;
            // Slip that would begin with f < 0 ends at once: it is chosen only if nothing else fits.
            let lasts = answer.margins.f.is_none_or(|f| f > T::zero());
            let change = (answer.force - before).norm();
            let better = best
                .as_ref()
                .is_none_or(|(least, other, _)| (lasts && !other) || (lasts == *other && change < *least));
            if better {
                best = Some((change, lasts, answer));
            }
        }
        if let Some((_, _, mut answer)) = best {
            if count > 1 {
                answer.selection = Selection::SeveralModes;
            }
            return Ok(answer);
        }
        // On the boundary between stick and begin to slip, rounding may refuse both: stick is taken.
        let near = T::default_epsilon().sqrt();
        match stuck {
            Some(stuck) if stuck.force.x >= -near && stuck.cone >= -near => Ok(self.stick(&stuck)),
            _ => Err(ContactError::NoMode { free_acceleration: self.beta.x }),
        }
    }

    fn separate(&self) -> ContactForce<T> {
        let margins = Margins { lambda_n: None, f: None, cone: None, s: None };
        self.answer(ContactMode::Separate, Vector3::zeros(), None, margins)
    }

    fn slide(&self, d: &Vector2<T>, speed: Option<T>) -> Result<ContactForce<T>, ContactError<T>> {
        let f = self.closed.f(d);
        if f <= self.closed.f_noise() {
            return Err(self.without_force(f));
        }
        Ok(self.against(ContactMode::Slide, d, -self.closed.normal / f, f, speed))
    }

    fn begin(&self, way: &Beginning<T>) -> ContactForce<T> {
        self.against(ContactMode::BeginSlip, &way.direction, way.lambda, way.f, None)
    }

    /// The answer in which friction is fully used (mu lambda_n) and acts against a direction.
    fn against(
        &self,
        mode: ContactMode,
        d: &Vector2<T>,
        lambda: T,
        f: T,
        speed: Option<T>,
    ) -> ContactForce<T> {
        let lambda = lambda * self.closed.force;
        let push = lambda * self.closed.mu;
        let margins = Margins { lambda_n: Some(lambda), f: Some(f * self.matrix.nn), cone: None, s: speed };
        self.answer(mode, Vector3::new(lambda, -push * d.x, -push * d.y), Some(*d), margins)
    }

    fn stick(&self, stuck: &Stuck<T>) -> ContactForce<T> {
        let unit = self.closed.force;
        let margins =
            Margins { lambda_n: Some(stuck.force.x * unit), f: None, cone: Some(stuck.cone * unit), s: None };
        let mut answer = self.answer(ContactMode::Stick, stuck.force * unit, None, margins);
        answer.force_is_unique = stuck.unique;
        answer
    }

    fn answer(
        &self,
        mode: ContactMode,
        force: Vector3<T>,
        direction: Option<Vector2<T>>,
        margins: Margins<T>,
    ) -> ContactForce<T> {
        ContactForce {
            mode,
            selection: Selection::Unique,
            force,
            acceleration: self.matrix.apply(&force) + self.beta,
            direction,
            margins,
            force_is_unique: true,
        }
    }

    /// The error of a sliding contact that has no finite force.
    fn without_force(&self, f: T) -> ContactError<T> {
        let free_acceleration = self.beta.x;
        if free_acceleration >= T::zero() {
            return ContactError::NoMode { free_acceleration };
        }
        if f < -self.closed.f_noise() {
            ContactError::ImpactWithoutCollision { f: f * self.matrix.nn, free_acceleration }
        } else {
            ContactError::Jam { free_acceleration }
        }
    }
}
