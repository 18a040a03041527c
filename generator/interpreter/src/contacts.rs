//! Implements the trait `Contacts` by interpreting the program of a model.

use hodograph::generated::{
    Contact, Resolved, check_length, closed_contact, kept_contact, resolve, resolve_structured,
    resolve_without_collision, slip_noise,
};
use hodograph::nalgebra::Vector3;
use hodograph::structure::{Balanced, Diagonal, Isotropic, Planar};
use hodograph::{
    Budgeted, ClosedContactError, ClosedContacts, CollisionError, CollisionOutcome, ComponentKind,
    ContactMode, ContactOutcome, ContactState, ContactSurface, Contacts, Distance, ImpactError, Law,
    ReducedMatrix, RelativeRotation, State, StateError, StatedLaw, Surface,
};
use hodograph_model::model::mechanism::Mechanism;
use hodograph_program::program::operation::Operation;
use hodograph_program::program::{ContactQuantity, Quantity, Structure};

use crate::InterpretedMechanism;
use crate::routines::{CLOSED, COLLISION, OF_EACH, OfContact, OfSeveral, Request};

/// Without these a contact has no collision.
pub const COLLISION_NEEDS: &[ContactQuantity] = COLLISION.split_at(6).0;
/// What is undefined then.
pub const NO_COLLISION: &str = "collision of this contact";

/// Normal, first, second, velocity and reduced matrix.
const CORE: usize = 3 + 3 + 3 + 3 + 6;

impl InterpretedMechanism {
    /// How many numbers the program has for a quantity of a contact.
    pub(crate) fn size(&self, contact: usize, quantity: ContactQuantity) -> usize {
        self.sizes.get(&Quantity::Contact(contact as u32, quantity)).copied().unwrap_or(0)
    }

    /// A length that not all contacts have.
    fn length_at_contact(
        &self,
        contact: usize,
        quantity: ContactQuantity,
        state: &State<'_>,
    ) -> Result<Option<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(quantity));
        let [length] = self.array::<1>(request, state, &[])?;
        Ok(self.has(request).then_some(length))
    }

    /// Computes something of several contacts, pair of shapes by pair, for one routine serves every choice of contacts of a
    /// pair: each number with its contact, the quantity and its place there. `false` where it cannot be told of some, of
    /// which these may be none.
    fn of_several(
        &self,
        contacts: &[usize],
        what: OfSeveral,
        state: &State<'_>,
        mut with: impl FnMut(usize, ContactQuantity, usize, f64),
    ) -> Result<bool, StateError> {
        self.check(state)?;
        for &contact in contacts {
            self.exists(ComponentKind::Contact, contact)?;
        }
        let pair = |contact: usize| self.model.contacts[contact].first_of_pair;
        let mut asked: Vec<Option<usize>> = contacts.iter().map(|&contact| pair(contact)).collect();
        asked.sort_unstable();
        asked.dedup();
        for one in asked {
            let all: Vec<usize> =
                (0..self.model.contacts.len()).filter(|&contact| pair(contact) == one).collect();
            let slots: Vec<(usize, ContactQuantity, usize)> = all
                .iter()
                .flat_map(|&contact| what.of_each().iter().map(move |&quantity| (contact, quantity)))
                .flat_map(|(contact, quantity)| {
                    (0..self.size(contact, quantity)).map(move |place| (contact, quantity, place))
                })
                .collect();
            let set = |index: usize, number: f64| {
                let (contact, quantity, place) = slots[index];
                with(contact, quantity, place, number);
            };
            if self.compute_together(what, &all, slots.len(), state, set).is_err() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn vector_of_contact(
        &self,
        contact: usize,
        quantity: ContactQuantity,
        state: &State<'_>,
        what: &'static str,
    ) -> Result<Vector3<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(quantity));
        if !self.has(request) {
            return Err(StateError::Undefined { what });
        }
        self.array::<3>(request, state, &[]).map(Vector3::from)
    }

    /// Solves a contact as the generated module does: the structure that the symbols show selects a closed
    /// form.
    fn resolve(
        &self,
        index: usize,
        contact: &Contact<f64>,
        surface: &impl ContactSurface<f64>,
    ) -> Result<Resolved<f64>, ImpactError<f64>> {
        match self.program.structures.get(index) {
            Some(Structure::Planar) => resolve_structured::<Planar, f64>(contact, surface),
            Some(Structure::Balanced) => resolve_structured::<Balanced, f64>(contact, surface),
            Some(Structure::Diagonal) => resolve_structured::<Diagonal, f64>(contact, surface),
            Some(Structure::Isotropic) => resolve_structured::<Isotropic, f64>(contact, surface),
            Some(Structure::General) | None => resolve(contact, surface),
        }
    }

    /// The speeds after an impulse along the contact basis; what is 0 whatever the state is not added.
    fn after(&self, contact: usize, speeds: &mut [f64], response: &[f64], impulse: [f64; 3]) {
        let quantity = Quantity::Contact(contact as u32, ContactQuantity::Response);
        let Some(output) = self.program.output(quantity) else { return };
        let zero = |place: usize| {
            output.values.get(place).is_none_or(|&value| {
                matches!(self.program.operation(value), Operation::Constant(bits) if bits.get() == 0.0)
            })
        };
        for (row, (speed, response)) in speeds.iter_mut().zip(response.chunks_exact(3)).enumerate() {
            for (column, (response, impulse)) in response.iter().zip(impulse).enumerate() {
                if !zero(3 * row + column) {
                    *speed += response * impulse;
                }
            }
        }
    }

    /// Solves collisions of a contact, each on its surface; `answer` is called once for each with its place, in any order.
    #[cfg(feature = "internal")]
    pub(crate) fn resolve_each(
        &self,
        index: usize,
        contacts: &[(Contact<f64>, Surface<f64>)],
        mut answer: impl FnMut(usize, Result<Resolved<f64>, ImpactError<f64>>),
    ) {
        #[cfg(feature = "lanes")]
        if let Some(Structure::General) | None = self.program.structures.get(index) {
            hodograph::generated::resolve_each(contacts, answer);
            return;
        }
        for (place, (contact, surface)) in contacts.iter().enumerate() {
            answer(place, self.resolve(index, contact, surface));
        }
    }

    /// The contact as the runtime takes it, from the numbers of `COLLISION`.
    pub(crate) fn known(&self, contact: usize, numbers: &[f64]) -> Contact<f64> {
        let remainder = CORE + self.size(contact, ContactQuantity::Response);
        let prescribed = remainder + self.size(contact, ContactQuantity::Remainder);
        let there = |quantity, at| match self.size(contact, quantity) {
            3 => three(numbers, at),
            _ => Vector3::zeros(),
        };
        Contact {
            normal: three(numbers, 0),
            first: three(numbers, 3),
            second: three(numbers, 6),
            velocity: three(numbers, 9),
            reduced: six(numbers, 12),
            remainder: there(ContactQuantity::Remainder, remainder),
            prescribed_work: there(ContactQuantity::PrescribedWork, prescribed),
        }
    }

    /// The numbers of a request of a contact that needs all of `quantities`; `what` is undefined without
    /// them.
    fn numbers(
        &self,
        contact: usize,
        of: OfContact,
        quantities: &[ContactQuantity],
        state: &State<'_>,
        what: &'static str,
    ) -> Result<Vec<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        if quantities.iter().any(|&quantity| self.size(contact, quantity) == 0) {
            return Err(StateError::Undefined { what });
        }
        self.check(state)?;
        let mut numbers = Vec::new();
        self.compute(Request::Contact(contact, of), state, &[], |_, number| numbers.push(number))?;
        Ok(numbers)
    }

    /// A collision that `resolve` solves.
    fn struck(
        &self,
        contact: usize,
        state: &State<'_>,
        speeds: &mut [f64],
        what: &'static str,
        resolve: impl FnOnce(&Contact<f64>) -> Result<Resolved<f64>, ImpactError<f64>>,
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        let numbers = self.numbers(contact, OfContact::Collision, COLLISION_NEEDS, state, what)?;
        check_length(speeds, state.speeds.len(), "the speeds after the collision")?;
        speeds.iter_mut().zip(state.speeds).for_each(|(after, &before)| *after = before);
        Ok(self.outcome(contact, &numbers, speeds, resolve)?)
    }

    fn outcome(
        &self,
        contact: usize,
        numbers: &[f64],
        speeds: &mut [f64],
        resolve: impl FnOnce(&Contact<f64>) -> Result<Resolved<f64>, ImpactError<f64>>,
    ) -> Result<CollisionOutcome<f64>, ImpactError<f64>> {
        let known = self.known(contact, numbers);
        Ok(self.told(contact, numbers, speeds, &known, resolve(&known)?))
    }

    /// What is told of a solved collision of which `numbers` are those of `COLLISION`. `speeds` are those before it and
    /// become those after it.
    pub(crate) fn told(
        &self,
        contact: usize,
        numbers: &[f64],
        speeds: &mut [f64],
        known: &Contact<f64>,
        hit: Resolved<f64>,
    ) -> CollisionOutcome<f64> {
        let response = CORE + self.size(contact, ContactQuantity::Response);
        self.after(contact, speeds, numbers.get(CORE..response).unwrap_or(&[]), hit.impulse.into());
        hit.outcome(known.normal)
    }

    /// A closed contact of which `decide` finds mode and force.
    fn touching(
        &self,
        contact: usize,
        state: &State<'_>,
        accelerations: &mut [f64],
        what: &'static str,
        decide: impl FnOnce(&Touching) -> Result<ContactOutcome<f64>, ClosedContactError<f64>>,
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        let needed = [&COLLISION[..6], &CLOSED].concat();
        let numbers = self.numbers(contact, OfContact::Closed, &needed, state, what)?;
        let known = self.known(contact, &numbers);
        let sizes = COLLISION[5..].iter().map(|&quantity| self.size(contact, quantity));
        let free = CORE + sizes.sum::<usize>();
        let partial = free + 3;
        let rates = partial + self.size(contact, ContactQuantity::PartialVelocities);
        let noise = slip_noise(numbers.get(partial..rates).unwrap_or(&[]), state.speeds, &known.remainder);
        let outcome = decide(&Touching { known, free: three(&numbers, free), noise })?;
        check_length(accelerations, state.speeds.len(), "the accelerations")?;
        accelerations.iter_mut().zip(numbers.iter().skip(rates)).for_each(|(slot, &rate)| *slot = rate);
        let response = CORE + self.size(contact, ContactQuantity::Response);
        let force = outcome.answer.force.into();
        self.after(contact, accelerations, numbers.get(CORE..response).unwrap_or(&[]), force);
        Ok(outcome)
    }
}

/// Friction and restitution that a model states for a contact.
pub fn stated_surface(model: &Mechanism, contact: usize) -> Option<Surface<f64>> {
    let stated = model.contacts.get(contact)?.surface?;
    Some(Surface { mu: stated.mu, e: stated.e, law: Law::named(stated.law)? })
}

/// What a model states of a contact beyond that.
pub fn stated_law(model: &Mechanism, contact: usize) -> StatedLaw<'_> {
    let Some(contact) = model.contacts.get(contact) else { return StatedLaw::default() };
    let law = &contact.law;
    StatedLaw {
        mu_static: law.mu_static,
        mu_impact: law.mu_impact,
        sliding: law.sliding.as_ref().map(|law| (law.name.as_str(), law.numbers.as_slice())),
        restitution: law.restitution.as_ref().map(|law| (law.name.as_str(), law.numbers.as_slice())),
        rolling: law.rolling,
        spinning: law.spinning,
    }
}

/// What the mode of a closed contact is decided from.
struct Touching {
    known: Contact<f64>,
    /// free acceleration along the contact basis
    free: Vector3<f64>,
    /// slip below counts as none
    noise: f64,
}

fn three(numbers: &[f64], at: usize) -> Vector3<f64> {
    numbers.get(at..at + 3).map_or_else(Vector3::zeros, Vector3::from_row_slice)
}

fn six(numbers: &[f64], at: usize) -> ReducedMatrix<f64> {
    let mut six = [0.0; 6];
    six.iter_mut().zip(numbers.iter().skip(at)).for_each(|(slot, &number)| *slot = number);
    six.into()
}

impl Contacts for InterpretedMechanism {
    fn contact_state(&self, contact: usize, state: &State<'_>) -> Result<ContactState<f64>, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        if self.size(contact, ContactQuantity::Reduced) == 0 {
            return Err(StateError::Undefined { what: "reduced matrix of this contact" });
        }
        let request = Request::Contact(contact, OfContact::State);
        let numbers = self.array::<{ CORE + 1 }>(request, state, &[])?;
        let has_gap = self.size(contact, ContactQuantity::Gap) > 0;
        Ok(ContactState {
            gap: has_gap.then_some(numbers[CORE]),
            normal: three(&numbers, 0),
            first: three(&numbers, 3),
            second: three(&numbers, 6),
            velocity: three(&numbers, 9),
            reduced: six(&numbers, 12),
        })
    }

    fn gap(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        self.length_at_contact(contact, ContactQuantity::Gap, state)
    }

    fn validity(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        if self.size(contact, ContactQuantity::Validity) == 0 {
            return self.exists(ComponentKind::Contact, contact).map(|()| None);
        }
        self.length_at_contact(contact, ContactQuantity::Validity, state)
    }

    fn gaps(
        &self,
        contacts: &[usize],
        state: &State<'_>,
        distances: &mut [Distance],
    ) -> Result<(), StateError> {
        check_length(distances, contacts.len(), "the distances")?;
        if contacts.len() > 1 {
            let mut known = vec![Distance::default(); self.model.contacts.len()];
            let set = |contact: usize, quantity: ContactQuantity, _: usize, length: f64| {
                let Distance { gap, validity } = &mut known[contact];
                *if quantity == ContactQuantity::Gap { gap } else { validity } = Some(length);
            };
            if self.of_several(contacts, OfSeveral::Near, state, set)? {
                distances
                    .iter_mut()
                    .zip(contacts)
                    .for_each(|(distance, &contact)| *distance = known[contact]);
                return Ok(());
            }
        }
        for (&contact, distance) in contacts.iter().zip(distances) {
            let (gap, validity) = (self.gap(contact, state)?, self.validity(contact, state)?);
            *distance = Distance { gap, validity };
        }
        Ok(())
    }

    fn pair(&self, contact: usize) -> Option<usize> {
        self.model.contacts.get(contact)?.first_of_pair
    }

    fn clearances(
        &self,
        pairs: &[usize],
        state: &State<'_>,
        clearances: &mut [f64],
    ) -> Result<(), StateError> {
        check_length(clearances, pairs.len(), "the clearances")?;
        for &pair in pairs {
            self.exists(ComponentKind::Contact, pair)?;
            if self.size(pair, ContactQuantity::Clearance) == 0 {
                return Err(StateError::Undefined { what: "clearance of this contact" });
            }
        }
        let all: Vec<usize> = (0..self.model.contacts.len())
            .filter(|&contact| self.size(contact, ContactQuantity::Clearance) > 0)
            .collect();
        let mut known = vec![0.0; all.len()];
        self.check(state)?;
        let set = |index: usize, length: f64| known[index] = length;
        self.compute_together(OfSeveral::Clear, &all, all.len(), state, set)?;
        let place = |pair: &usize| all.binary_search(pair).map_or(0.0, |place| known[place]);
        clearances.iter_mut().zip(pairs).for_each(|(clearance, pair)| *clearance = place(pair));
        Ok(())
    }

    fn contact_velocities(
        &self,
        contacts: &[usize],
        state: &State<'_>,
        velocities: &mut [Vector3<f64>],
    ) -> Result<(), StateError> {
        check_length(velocities, contacts.len(), "the velocities")?;
        let have = |contact: &usize| self.size(*contact, ContactQuantity::Velocity) == 3;
        if contacts.len() > 1 && contacts.iter().all(have) {
            let mut known = vec![Vector3::zeros(); self.model.contacts.len()];
            let set = |contact: usize, _: ContactQuantity, place: usize, number: f64| {
                known[contact][place] = number;
            };
            if self.of_several(contacts, OfSeveral::Moving, state, set)? {
                velocities
                    .iter_mut()
                    .zip(contacts)
                    .for_each(|(velocity, &contact)| *velocity = known[contact]);
                return Ok(());
            }
        }
        for (&contact, velocity) in contacts.iter().zip(velocities) {
            *velocity = self.contact_velocity(contact, state)?;
        }
        Ok(())
    }

    fn surface(&self, contact: usize) -> Option<Surface<f64>> {
        stated_surface(&self.model, contact)
    }

    fn stated_law(&self, contact: usize) -> StatedLaw<'_> {
        stated_law(&self.model, contact)
    }

    fn contact_velocity(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        self.vector_of_contact(contact, ContactQuantity::Velocity, state, "velocity of this contact")
    }

    fn free_acceleration(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        let what = "free acceleration of this contact";
        self.vector_of_contact(contact, ContactQuantity::FreeAcceleration, state, what)
    }

    fn partial_velocities(
        &self,
        contact: usize,
        state: &State<'_>,
        partial_velocities: &mut [f64],
    ) -> Result<(), StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(ContactQuantity::PartialVelocities));
        self.write(request, state, &[], partial_velocities, "the partial velocities")
    }

    fn response(&self, contact: usize, state: &State<'_>, response: &mut [f64]) -> Result<(), StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(ContactQuantity::Response));
        self.write(request, state, &[], response, "the response")
    }

    fn relative_rotation(
        &self,
        contact: usize,
        state: &State<'_>,
        values: &mut RelativeRotation<'_, f64>,
    ) -> Result<bool, StateError> {
        self.exists(ComponentKind::Contact, contact)?;
        let request = |quantity| Request::Contact(contact, OfContact::One(quantity));
        if !self.has(request(ContactQuantity::AngularVelocity)) {
            self.check(state)?;
            return Ok(false);
        }
        let RelativeRotation { angular_velocity, free_acceleration, partial_velocities, response } = values;
        let parts: [(ContactQuantity, &mut [f64], &'static str); 4] = [
            (ContactQuantity::AngularVelocity, angular_velocity, "the angular velocity"),
            (ContactQuantity::FreeAngularAcceleration, free_acceleration, "the free angular acceleration"),
            (ContactQuantity::PartialAngularVelocities, partial_velocities, "the partial angular velocities"),
            (ContactQuantity::AngularResponse, response, "the angular response"),
        ];
        for (quantity, slice, what) in parts {
            self.write(request(quantity), state, &[], slice, what)?;
        }
        Ok(true)
    }

    fn closed_contacts(
        &self,
        contacts: &[usize],
        state: &State<'_>,
        values: &mut ClosedContacts<'_, f64>,
    ) -> Result<(), StateError> {
        let (k, n, p) = (contacts.len(), state.coordinates.len(), state.speeds.len());
        values.check(k, n, p)?;
        self.check(state)?;
        for &contact in contacts {
            self.exists(ComponentKind::Contact, contact)?;
            if OF_EACH.into_iter().any(|quantity| self.size(contact, quantity) == 0) {
                return Err(StateError::Undefined { what: "closed contact" });
            }
        }
        // The numbers come in the order of the quantities.
        let of_each = 6 * p + 6;
        self.compute_together(OfSeveral::Closed, contacts, n + p + k * of_each, state, |index, number| {
            let slot = if index < n {
                &mut values.coordinate_rates[index]
            } else if index < n + p {
                &mut values.accelerations[index - n]
            } else {
                let (place, index) = ((index - n - p) / of_each, (index - n - p) % of_each);
                match index {
                    _ if index < 3 * p => &mut values.partial_velocities[3 * p * place + index],
                    _ if index < 6 * p => &mut values.responses[3 * p * place + index - 3 * p],
                    _ if index < 6 * p + 3 => &mut values.velocities[3 * place + index - 6 * p],
                    _ => &mut values.free_accelerations[3 * place + index - 6 * p - 3],
                }
            };
            *slot = number;
        })
    }

    fn collide(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, NO_COLLISION, |known| self.resolve(contact, known, surface))
    }

    fn collide_with_budget(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Budgeted<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.struck(contact, state, speeds, NO_COLLISION, |known| self.resolve(contact, known, surface))
    }

    fn impact_without_collision(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        let what = "impact without collision of this contact";
        self.struck(contact, state, speeds, what, |known| resolve_without_collision(known, surface))
    }

    fn contact_mode(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        accelerations: &mut [f64],
    ) -> Result<ContactOutcome<f64>, ClosedContactError<f64>> {
        self.touching(contact, state, accelerations, "mode of this contact", |touch| {
            closed_contact(&touch.known, &touch.free, touch.noise, surface.mu)
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
        self.touching(contact, state, accelerations, "force of this contact", |touch| {
            kept_contact(mode, &touch.known, &touch.free, surface.mu)
        })
    }
}
