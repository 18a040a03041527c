//! The trait `Contacts` by interpretation.

use hodograph::generated::{Contact, Resolved, check_length, resolve, resolve_structured};
use hodograph::nalgebra::Vector3;
use hodograph::structure::{Balanced, Diagonal, Isotropic, Planar};
use hodograph::{
    CollisionError, CollisionOutcome, ContactState, Contacts, ImpactError, Kind, ReducedMatrix, State,
    StateError, Surface,
};
use hodograph_generator::program::operation::Operation;
use hodograph_generator::program::{ContactQuantity, Quantity, Structure};

use crate::InterpretedMechanism;
use crate::routines::{COLLISION, OfContact, Request};

/// Normal, first, second, velocity and reduced matrix.
const CORE: usize = 3 + 3 + 3 + 3 + 6;

impl InterpretedMechanism {
    /// How many numbers the program has for a quantity of a contact.
    fn size(&self, contact: usize, quantity: ContactQuantity) -> usize {
        self.program()
            .output(Quantity::Contact(contact as u32, quantity))
            .map_or(0, |output| output.values.len())
    }

    fn vector_of_contact(
        &self,
        contact: usize,
        quantity: ContactQuantity,
        state: &State<'_>,
        what: &'static str,
    ) -> Result<Vector3<f64>, StateError> {
        self.exists(Kind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(quantity));
        if !self.has(request) {
            return Err(StateError::Undefined { what });
        }
        self.array::<3>(request, state, &[]).map(Vector3::from)
    }

    /// Solves a contact as the generated module does: the structure that the symbols show selects a closed form.
    fn resolve(
        &self,
        index: usize,
        contact: &Contact<f64>,
        surface: &Surface<f64>,
    ) -> Result<Resolved<f64>, ImpactError<f64>> {
        match self.program().structures.get(index) {
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
        let Some(output) = self.program().output(quantity) else { return };
        let zero = |place: usize| {
            output.values.get(place).is_none_or(|&value| {
                matches!(self.program().operation(value), Operation::Constant(bits) if bits.get() == 0.0)
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
        self.exists(Kind::Contact, contact)?;
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
        self.exists(Kind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(ContactQuantity::Gap));
        let [gap] = self.array::<1>(request, state, &[])?;
        Ok(self.has(request).then_some(gap))
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
        self.exists(Kind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(ContactQuantity::PartialVelocities));
        self.write(request, state, &[], partial_velocities, "the partial velocities")
    }

    fn response(&self, contact: usize, state: &State<'_>, response: &mut [f64]) -> Result<(), StateError> {
        self.exists(Kind::Contact, contact)?;
        let request = Request::Contact(contact, OfContact::One(ContactQuantity::Response));
        self.write(request, state, &[], response, "the response")
    }

    fn collide(
        &self,
        contact: usize,
        state: &State<'_>,
        surface: &Surface<f64>,
        speeds: &mut [f64],
    ) -> Result<CollisionOutcome<f64>, CollisionError<f64>> {
        self.exists(Kind::Contact, contact)?;
        if COLLISION[..6].iter().any(|&quantity| self.size(contact, quantity) == 0) {
            return Err(StateError::Undefined { what: "collision of this contact" }.into());
        }
        self.check(state)?;
        let mut numbers = Vec::new();
        let request = Request::Contact(contact, OfContact::Collision);
        self.compute(request, state, &[], |_, number| numbers.push(number))?;
        let remainder = CORE + self.size(contact, ContactQuantity::Response);
        let prescribed = remainder + self.size(contact, ContactQuantity::Remainder);
        let there = |quantity, at| match self.size(contact, quantity) {
            3 => three(&numbers, at),
            _ => Vector3::zeros(),
        };
        let known = Contact {
            normal: three(&numbers, 0),
            first: three(&numbers, 3),
            second: three(&numbers, 6),
            velocity: three(&numbers, 9),
            reduced: six(&numbers, 12),
            remainder: there(ContactQuantity::Remainder, remainder),
            prescribed_work: there(ContactQuantity::PrescribedWork, prescribed),
        };
        let hit = self.resolve(contact, &known, surface)?;
        check_length(speeds, state.speeds.len(), "the speeds after the collision")?;
        speeds.iter_mut().zip(state.speeds).for_each(|(after, &before)| *after = before);
        self.after(contact, speeds, numbers.get(CORE..remainder).unwrap_or(&[]), hit.impulse.into());
        Ok(CollisionOutcome {
            normal: known.normal,
            tangent: hit.tangent,
            binormal: hit.binormal,
            approach: hit.approach,
            reduced: hit.reduced,
            impulse_on_point: hit.impulse_on_point,
            energy_change: hit.energy_change,
            impact: hit.impact,
        })
    }
}
