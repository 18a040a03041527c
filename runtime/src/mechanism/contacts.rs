//! The trait [`Contacts`]: state, collision and force of a mechanism's contacts, selected by number.

use nalgebra::Vector3;

use super::{
    ContactOutcome, Mechanism, State,
    slices::{check_length, check_room},
};
use crate::{
    Budgeted, ClosedContactError, CollisionError, ContactMode, Impact, ReducedMatrix, Scalar, StateError,
    StatedLaw, Surface,
};

/// Gap, contact basis, velocity and reduced matrix of a contact in a state. The contact basis is `normal`,
/// `first`, `second`: unit vectors, right-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct ContactState<T: nalgebra::Scalar = f64> {
    /// distance of the striking point from what it strikes, m; `None` where the model gives no gap
    pub gap: Option<T>,
    /// normal n along N.x, N.y, N.z, from what is struck towards the striking point
    pub normal: Vector3<T>,
    /// first tangential axis along N.x, N.y, N.z
    pub first: Vector3<T>,
    /// second tangential axis along N.x, N.y, N.z
    pub second: Vector3<T>,
    /// velocity of the striking point relative to what it strikes, along the contact basis, m/s
    pub velocity: Vector3<T>,
    /// reduced mass matrix V M^-1 V^T (20)-(22) along the contact basis, 1/kg
    pub reduced: ReducedMatrix<T>,
}

/// A solved collision of a contact: n is the contact's normal, t lies along the slip of approach, s = n x t.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct CollisionOutcome<T: nalgebra::Scalar = f64> {
    /// n along N.x, N.y, N.z
    pub normal: Vector3<T>,
    /// t along N.x, N.y, N.z
    pub tangent: Vector3<T>,
    /// s along N.x, N.y, N.z
    pub binormal: Vector3<T>,
    /// velocity of approach along n, t, s, m/s
    pub approach: Vector3<T>,
    /// reduced mass matrix along n, t, s, 1/kg
    pub reduced: ReducedMatrix<T>,
    /// impulse on the striking point along N.x, N.y, N.z, N s; what is struck receives its opposite
    pub impulse_on_point: Vector3<T>,
    /// change of the kinetic energy, J; it differs from `impact.contact_work` where motion is prescribed:
    /// (24)
    pub energy_change: T,
    /// the outcome of the solver along n, t, s: impulse, velocity of separation, phases
    pub impact: Impact<T>,
}

/// How far what touches at a contact is apart, and how far the place is within it: what [`Contacts::gap`] and
/// [`Contacts::validity`] give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance<T = f64> {
    /// the gap, m; `None` where the model gives none
    pub gap: Option<T>,
    /// how far the place is within the faces and edges that touch there, m; `None` where these do not end
    pub validity: Option<T>,
}

impl<T> Default for Distance<T> {
    /// That of a contact whose model gives neither.
    fn default() -> Self {
        Distance { gap: None, validity: None }
    }
}

/// Room for what forces of closed contacts follow from: what [`Contacts::closed_contacts`] gives of k contacts of a
/// mechanism with `n` coordinates and `p` independent speeds.
#[derive(Debug)]
pub struct ClosedContacts<'a, T = f64> {
    /// rates q' of the coordinates (`n`)
    pub coordinate_rates: &'a mut [T],
    /// rates u' of the independent speeds without contact forces (`p`)
    pub accelerations: &'a mut [T],
    /// V of each contact (k x 3 x `p`), as [`Contacts::partial_velocities`]
    pub partial_velocities: &'a mut [T],
    /// M^-1 V^T of each contact (k x `p` x 3), as [`Contacts::response`]
    pub responses: &'a mut [T],
    /// velocity of each contact (k x 3), m/s
    pub velocities: &'a mut [T],
    /// beta of each contact (k x 3), m/s^2
    pub free_accelerations: &'a mut [T],
}

impl<T> ClosedContacts<'_, T> {
    /// Whether the slices have their lengths.
    ///
    /// # Errors
    ///
    /// [`StateError::Length`].
    pub fn check(&self, contacts: usize, coordinates: usize, speeds: usize) -> Result<(), StateError> {
        let rows = 3 * contacts;
        check_length(self.coordinate_rates, coordinates, "the rates of the coordinates")?;
        check_length(self.accelerations, speeds, "the accelerations")?;
        check_length(self.partial_velocities, rows * speeds, "the partial velocities")?;
        check_length(self.responses, rows * speeds, "the responses")?;
        check_length(self.velocities, rows, "the velocities")?;
        check_length(self.free_accelerations, rows, "the free accelerations")
    }
}

/// Room for the rotation of what strikes relative to what is struck, along the contact basis: what
/// [`Contacts::relative_rotation`] gives of a mechanism with `p` independent speeds.
#[derive(Debug)]
pub struct RelativeRotation<'a, T = f64> {
    /// relative angular velocity (3), rad/s
    pub angular_velocity: &'a mut [T],
    /// rates of its components without contact forces (3), rad/s^2, as [`Contacts::free_acceleration`]
    pub free_acceleration: &'a mut [T],
    /// its partial velocities (3 x `p`): a torque tau on what strikes, whose opposite acts on what is struck, has the
    /// generalised forces given by their transpose times tau
    pub partial_velocities: &'a mut [T],
    /// change of the independent speeds per unit of angular impulse (`p` x 3), and of their rates per unit of torque
    pub response: &'a mut [T],
}

/// The contacts of a mechanism, by number; [`Mechanism::index`] with [`ComponentKind::Contact`](crate::ComponentKind::Contact)
/// gives the number of a name. A mechanism without contacts has the trait too, and its count is 0.
///
/// `p` is the number of independent speeds; matrices are written by rows; components along the contact basis
/// stand in the order normal, first, second (see [`ContactState`]).
///
/// # Errors
///
/// As those of [`Mechanism`], and [`StateError::Missing`] where there is no contact of that number.
pub trait Contacts<T: Scalar = f64>: Mechanism<T> {
    /// Gap, basis, velocity and reduced matrix of a contact.
    fn contact_state(&self, contact: usize, state: &State<'_, T>) -> Result<ContactState<T>, StateError>;
    /// Gap alone, m; `None` where the model gives none.
    fn gap(&self, contact: usize, state: &State<'_, T>) -> Result<Option<T>, StateError>;
    /// How far the place of contact is within the faces and edges that touch there, m; `None` where these do not
    /// end. Of a contact that has a validity, gap and normal belong together where it is positive, and a closed
    /// contact ends where it falls below zero; elsewhere the gap is positive as long as the features are apart.
    fn validity(&self, contact: usize, state: &State<'_, T>) -> Result<Option<T>, StateError> {
        let _ = (contact, state);
        Ok(None)
    }
    /// Gaps and validities of several contacts in one pass: what several of the single methods need (kinematics, the
    /// directions of faces) is computed once.
    ///
    /// # Errors
    ///
    /// As those of the single methods, for any of these contacts.
    fn gaps(
        &self,
        contacts: &[usize],
        state: &State<'_, T>,
        distances: &mut [Distance<T>],
    ) -> Result<(), StateError> {
        check_length(distances, contacts.len(), "the distances")?;
        for (&contact, distance) in contacts.iter().zip(distances) {
            let (gap, validity) = (self.gap(contact, state)?, self.validity(contact, state)?);
            *distance = Distance { gap, validity };
        }
        Ok(())
    }
    /// The number of the first contact of the same two shapes, where these have many contacts and a clearance; `None`
    /// elsewhere.
    fn pair(&self, contact: usize) -> Option<usize> {
        let _ = contact;
        None
    }
    /// Bounds from below on how far pairs of shapes are apart, m, by the number of the first contact of each
    /// ([`Contacts::pair`]): none of the contacts of a pair touches as long as its clearance is positive (docs/theory.md,
    /// 16.14).
    ///
    /// # Errors
    ///
    /// As those of the single methods, and [`StateError::Undefined`] for a contact that is not the first of such a pair.
    fn clearances(
        &self,
        pairs: &[usize],
        state: &State<'_, T>,
        clearances: &mut [T],
    ) -> Result<(), StateError> {
        check_length(clearances, pairs.len(), "the clearances")?;
        let _ = state;
        if pairs.is_empty() {
            Ok(())
        } else {
            Err(StateError::Undefined { what: "clearance of this contact" })
        }
    }
    /// Friction and restitution that the model states for a contact; `None` where it states none. A simulation
    /// takes it where its options say nothing else.
    fn surface(&self, contact: usize) -> Option<Surface<T>> {
        let _ = contact;
        None
    }
    /// What the model states of a contact beyond mu, e and law of its surface. A simulation takes it where its
    /// options say nothing else.
    fn stated_law(&self, contact: usize) -> StatedLaw<'_> {
        let _ = contact;
        StatedLaw::default()
    }
    /// Velocity of the striking point relative to what it strikes, along the contact basis, m/s.
    fn contact_velocity(&self, contact: usize, state: &State<'_, T>) -> Result<Vector3<T>, StateError>;
    /// Velocities of several contacts in one pass, as those of [`Contacts::contact_velocity`].
    ///
    /// # Errors
    ///
    /// As those of [`Contacts::contact_velocity`], for any of these contacts.
    fn contact_velocities(
        &self,
        contacts: &[usize],
        state: &State<'_, T>,
        velocities: &mut [Vector3<T>],
    ) -> Result<(), StateError> {
        check_length(velocities, contacts.len(), "the velocities")?;
        for (&contact, velocity) in contacts.iter().zip(velocities) {
            *velocity = self.contact_velocity(contact, state)?;
        }
        Ok(())
    }
    /// beta: rates of the three components of the contact velocity without contact forces, m/s^2. It is the
    /// derivative of these components, as functions of (t, q, u), along (1, q', u'), so that the turning of
    /// the contact basis counts. Named inputs are held: where a velocity depends on an input, the input's own
    /// rate is not in beta.
    fn free_acceleration(&self, contact: usize, state: &State<'_, T>) -> Result<Vector3<T>, StateError>;
    /// V (3 x `p`): partial velocities along the contact basis (rows) for the independent speeds (columns).
    fn partial_velocities(
        &self,
        contact: usize,
        state: &State<'_, T>,
        partial_velocities: &mut [T],
    ) -> Result<(), StateError>;
    /// M^-1 V^T (`p` x 3): change of the independent speeds per unit of impulse along the contact basis, and
    /// of their rates per unit of force.
    fn response(&self, contact: usize, state: &State<'_, T>, response: &mut [T]) -> Result<(), StateError>;
    /// Writes the rotation of what strikes relative to what is struck, and answers whether the mechanism tells it: it
    /// does of contacts whose surface in the model states `rolling` or `spinning`.
    fn relative_rotation(
        &self,
        contact: usize,
        state: &State<'_, T>,
        values: &mut RelativeRotation<'_, T>,
    ) -> Result<bool, StateError> {
        let _ = (contact, state, values);
        Ok(false)
    }
    /// Solves the collision of a contact. `speeds` (`p`) receives the independent speeds after it: (12a).
    ///
    /// # Errors
    ///
    /// [`CollisionError::Impact`] where the collision has no outcome.
    fn collide(
        &self,
        contact: usize,
        state: &State<'_, T>,
        surface: &Surface<T>,
        speeds: &mut [T],
    ) -> Result<CollisionOutcome<T>, CollisionError<T>>;

    /// [`Contacts::collide`] with a budget of quadratures.
    ///
    /// # Errors
    ///
    /// Those of [`Contacts::collide`], and
    /// [`ImpactError::BudgetExceeded`](crate::ImpactError::BudgetExceeded).
    fn collide_with_budget(
        &self,
        contact: usize,
        state: &State<'_, T>,
        surface: &Budgeted<T>,
        speeds: &mut [T],
    ) -> Result<CollisionOutcome<T>, CollisionError<T>>;

    /// Selects the mode of a closed contact (stick, slide, begin to slip, separate) with its force, coming
    /// from no contact force. The gap and v_n count as zero: neither is looked at. Of the surface only `mu`
    /// is read. Slip that rounding alone may make of zero counts as none.
    /// `accelerations` (`p`) receives the rates u' of the independent speeds under that force.
    ///
    /// # Errors
    ///
    /// [`ClosedContactError::Contact`] where no finite force exists: an impact without collision follows, or
    /// no mode fits. [`StateError::Undefined`] where the model does not determine it.
    fn contact_mode(
        &self,
        contact: usize,
        state: &State<'_, T>,
        surface: &Surface<T>,
        accelerations: &mut [T],
    ) -> Result<ContactOutcome<T>, ClosedContactError<T>>;
    /// Force of a closed contact in a mode that is kept, as [`Contacts::contact_mode`] gives it for the mode
    /// that it selects. A margin that is not positive says that the mode has ended; the force is then the one
    /// that would keep it.
    ///
    /// # Errors
    ///
    /// As [`Contacts::contact_mode`].
    fn contact_force(
        &self,
        contact: usize,
        mode: ContactMode,
        state: &State<'_, T>,
        surface: &Surface<T>,
        accelerations: &mut [T],
    ) -> Result<ContactOutcome<T>, ClosedContactError<T>>;
    /// Solves the impact without collision of a contact that slides with f < 0 and is pressed together; v_n
    /// counts as zero. See [`impact_without_collision`](crate::impact_without_collision). `speeds` (`p`)
    /// receives the independent speeds after it.
    ///
    /// # Errors
    ///
    /// [`CollisionError::Impact`] where f > 0 or nothing slips: then a finite force exists.
    fn impact_without_collision(
        &self,
        contact: usize,
        state: &State<'_, T>,
        surface: &Surface<T>,
        speeds: &mut [T],
    ) -> Result<CollisionOutcome<T>, CollisionError<T>>;

    /// Everything that the forces of closed contacts follow from, in one pass: what several of the single methods
    /// need (kinematics, the factorisation of the mass matrix) is computed once.
    ///
    /// # Errors
    ///
    /// [`StateError::Undefined`] where the mechanism does not tell all of it.
    fn closed_contacts(
        &self,
        contacts: &[usize],
        state: &State<'_, T>,
        values: &mut ClosedContacts<'_, T>,
    ) -> Result<(), StateError> {
        let p = self.count(super::ComponentKind::Speed);
        values.check(contacts.len(), self.count(super::ComponentKind::Coordinate), p)?;
        self.coordinate_rates(state, values.coordinate_rates)?;
        self.accelerations(state, values.accelerations)?;
        let vectors =
            values.velocities.chunks_exact_mut(3).zip(values.free_accelerations.chunks_exact_mut(3));
        for (&contact, (velocity, free)) in contacts.iter().zip(vectors) {
            velocity.copy_from_slice(self.contact_velocity(contact, state)?.as_slice());
            free.copy_from_slice(self.free_acceleration(contact, state)?.as_slice());
        }
        if p == 0 {
            return Ok(());
        }
        let partial = values.partial_velocities.chunks_exact_mut(3 * p);
        for (&contact, (partial, response)) in
            contacts.iter().zip(partial.zip(values.responses.chunks_exact_mut(3 * p)))
        {
            self.partial_velocities(contact, state, partial)?;
            self.response(contact, state, response)?;
        }
        Ok(())
    }

    /// W (3k x 3k) of the k `contacts`, symmetric: forces along their contact bases accelerate the contact
    /// velocities by W times the forces. The blocks are W_ij = V_i M^-1 V_j^T, also called the Delassus
    /// matrix. `workspace` needs 3 p (k + 1) numbers.
    #[doc(alias = "Delassus")]
    fn coupled_matrix(
        &self,
        contacts: &[usize],
        state: &State<'_, T>,
        matrix: &mut [T],
        workspace: &mut [T],
    ) -> Result<(), StateError> {
        let (k, p) = (contacts.len(), self.count(super::ComponentKind::Speed));
        let size = 3 * k;
        check_length(matrix, size * size, "the coupled matrix")?;
        check_room(workspace, 3 * p * (k + 1), "the workspace")?;
        let (rows, response) = workspace.split_at_mut(3 * p * k);
        let Some(response) = response.get_mut(..3 * p) else { return Ok(()) };
        if p == 0 {
            matrix.fill(T::zero());
            return Ok(());
        }
        for (&contact, rows) in contacts.iter().zip(rows.chunks_exact_mut(3 * p)) {
            self.partial_velocities(contact, state, rows)?;
        }
        for (j, &contact) in contacts.iter().enumerate() {
            self.response(contact, state, response)?;
            for axis in 0..3 {
                // the upper triangle of a column; the lower triangle mirrors it
                let column = 3 * j + axis;
                for (row, partial) in rows.chunks_exact(p).enumerate().take(column + 1) {
                    let terms = partial.iter().zip(response.iter().skip(axis).step_by(3));
                    let sum = terms.fold(T::zero(), |sum, (&partial, &response)| sum + partial * response);
                    for place in [row * size + column, column * size + row] {
                        if let Some(entry) = matrix.get_mut(place) {
                            *entry = sum;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Rates u' of the independent speeds (`p`) with forces at contacts: those without, plus M^-1 V^T times
    /// each force. A force acts on the striking point, its opposite on what is struck; its components are
    /// along the contact basis, N.
    /// `workspace` needs 3 p numbers.
    fn accelerations_with_forces(
        &self,
        state: &State<'_, T>,
        forces: &[(usize, Vector3<T>)],
        accelerations: &mut [T],
        workspace: &mut [T],
    ) -> Result<(), StateError> {
        let needed = 3 * self.count(super::ComponentKind::Speed);
        check_room(workspace, needed, "the workspace")?;
        let Some(response) = workspace.get_mut(..needed) else { return Ok(()) };
        self.accelerations(state, accelerations)?;
        for (contact, force) in forces {
            self.response(*contact, state, response)?;
            for (rate, response) in accelerations.iter_mut().zip(response.chunks_exact(3)) {
                let terms = response.iter().zip(force.iter());
                *rate = terms.fold(*rate, |sum, (&response, &force)| sum + response * force);
            }
        }
        Ok(())
    }
}
