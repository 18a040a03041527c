//! Friction of rolling and spinning: torques between the bodies in contact, bounded by the normal force.
//!
//! A torque is treated as an additional contact that shares the normal force of its own contact. Its
//! tangential velocities are the components of the relative angular velocity that it resists, times a lever
//! arm; its friction is the torque divided by that lever arm. So modes, forces and events of torques are
//! computed like those of friction.
//!
//! Theory: docs/theory.md, section 17.17.

use std::ops::Deref;

use hodograph::{ComponentKind, Contacts, RelativeRotation, State, StateError};
use nalgebra::{DMatrix, DVector, Vector3};

use crate::closed::pair::{Friction, Pair};

/// The rotation that a torque resists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turning {
    /// about axes in the tangent plane
    Rolling,
    /// about the normal
    Spinning,
}

impl Turning {
    /// The components of the relative angular velocity along n, t, s that correspond to the two tangential
    /// velocities.
    fn axes(self) -> &'static [usize] {
        match self {
            Self::Rolling => &[1, 2],
            Self::Spinning => &[0],
        }
    }
}

/// Friction of rolling or spinning at a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Torque {
    /// the contact whose normal force bounds it
    pub contact: usize,
    pub turning: Turning,
    /// The lever arm that converts angular velocities to velocities and forces to torques, m.
    pub lever: f64,
    /// the greatest torque divided by the normal force and the lever arm
    pub mu: f64,
}

/// The relative rotation at a contact, along n, t, s.
struct Rotation {
    velocity: [f64; 3],
    free: [f64; 3],
    /// by axes, then speeds
    partials: Vec<f64>,
    /// by speeds, then axes
    response: Vec<f64>,
}

impl Rotation {
    /// `None` if the mechanism does not provide it.
    fn of(
        mechanism: &dyn Contacts<f64>,
        contact: usize,
        state: &State<'_>,
    ) -> Result<Option<Self>, StateError> {
        let p = state.speeds.len();
        let (mut velocity, mut free) = ([0.0; 3], [0.0; 3]);
        let (mut partials, mut response) = (vec![0.0; 3 * p], vec![0.0; 3 * p]);
        let mut values = RelativeRotation {
            angular_velocity: &mut velocity,
            free_acceleration: &mut free,
            partial_velocities: &mut partials,
            response: &mut response,
        };
        let tells = mechanism.relative_rotation(contact, state, &mut values)?;
        Ok(tells.then_some(Self { velocity, free, partials, response }))
    }
}

/// The quantities from which the forces of a torque are computed, along its normal and tangential axes.
pub(crate) struct Rows {
    pub velocity: Vector3<f64>,
    pub free: Vector3<f64>,
    /// by speeds
    pub partials: Vec<Vector3<f64>>,
    /// by speeds
    pub responses: Vec<Vector3<f64>>,
}

/// A mechanism with torques as additional contacts; their indices follow those of its own contacts.
#[derive(Clone, Copy)]
pub(crate) struct WithTorques<'a> {
    pub mechanism: &'a dyn Contacts<f64>,
    torques: &'a [Torque],
    /// number of contacts of the mechanism
    own: usize,
}

impl<'a> Deref for WithTorques<'a> {
    type Target = dyn Contacts<f64> + 'a;

    fn deref(&self) -> &Self::Target {
        self.mechanism
    }
}

impl<'a> WithTorques<'a> {
    /// A mechanism with these torques.
    pub fn new(mechanism: &'a dyn Contacts<f64>, torques: &'a [Torque]) -> Self {
        let own = if torques.is_empty() { usize::MAX } else { mechanism.count(ComponentKind::Contact) };
        Self { mechanism, torques, own }
    }

    /// The torque with this index; `None` for a contact of the mechanism.
    pub fn torque(&self, contact: usize) -> Option<&'a Torque> {
        self.torques.get(contact.checked_sub(self.own)?)
    }

    /// The contact of the mechanism: the contact itself, or the one to which a torque belongs.
    pub fn contact(&self, contact: usize) -> usize {
        self.torque(contact).map_or(contact, |torque| torque.contact)
    }

    /// The torques of these contacts, by index.
    pub fn torques_of(&self, contacts: &[usize]) -> impl Iterator<Item = usize> {
        let torques = self.torques.iter().enumerate();
        torques.filter(|(_, torque)| contacts.contains(&torque.contact)).map(|(place, _)| self.own + place)
    }

    /// These contacts and their torques, the contacts of the mechanism first.
    pub fn with_torques(&self, contacts: &[usize]) -> Vec<usize> {
        let mut all: Vec<usize> =
            contacts.iter().copied().filter(|&contact| self.torque(contact).is_none()).collect();
        let torques: Vec<usize> = self.torques_of(&all).collect();
        all.extend(torques);
        all
    }

    /// Like [`Contacts::gap`]; torques have none.
    pub fn gap(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        match self.torque(contact) {
            Some(_) => Ok(None),
            None => self.mechanism.gap(contact, state),
        }
    }

    /// Like [`Contacts::validity`]; torques have none.
    pub fn validity(&self, contact: usize, state: &State<'_>) -> Result<Option<f64>, StateError> {
        match self.torque(contact) {
            Some(_) => Ok(None),
            None => self.mechanism.validity(contact, state),
        }
    }

    /// Like [`Contacts::contact_velocity`]; for a torque the velocity of its rotation.
    pub fn contact_velocity(&self, contact: usize, state: &State<'_>) -> Result<Vector3<f64>, StateError> {
        let Some(torque) = self.torque(contact) else {
            return self.mechanism.contact_velocity(contact, state);
        };
        let rotation = self.rotation(torque, state)?;
        Ok(torque.tangential(|axis| rotation.velocity[axis]))
    }

    /// The rotation that a torque resists; at the start it was checked that the mechanism provides it.
    fn rotation(&self, torque: &Torque, state: &State<'_>) -> Result<Rotation, StateError> {
        let undefined = StateError::Undefined { what: "relative rotation at this contact" };
        Rotation::of(self.mechanism, torque.contact, state)?.ok_or(undefined)
    }

    /// The quantities for the forces of a torque; `None` for a contact of the mechanism.
    pub fn rows(&self, contact: usize, state: &State<'_>) -> Result<Option<Rows>, StateError> {
        let Some(torque) = self.torque(contact) else { return Ok(None) };
        let rotation = self.rotation(torque, state)?;
        let p = state.speeds.len();
        let partial = |speed: usize| torque.tangential(|axis| rotation.partials[axis * p + speed]);
        let response = |speed: usize| torque.tangential(|axis| rotation.response[3 * speed + axis]);
        Ok(Some(Rows {
            velocity: torque.tangential(|axis| rotation.velocity[axis]),
            free: torque.tangential(|axis| rotation.free[axis]),
            partials: (0..p).map(partial).collect(),
            responses: (0..p).map(response).collect(),
        }))
    }

    /// Makes torques share the normal forces of their contacts in the matrix of all: nu - lambda_n >= 0,
    /// nu >= 0 and nu (nu - lambda_n) = 0 leave only nu = lambda_n. A component that the mechanism cannot move
    /// is kept at zero.
    pub fn share_normal_forces(
        &self,
        contacts: &[usize],
        own: usize,
        coupled: &mut DMatrix<f64>,
        velocity: &DVector<f64>,
        beta: &DVector<f64>,
    ) {
        for i in own..contacts.len() {
            let Some(torque) = self.torque(contacts[i]) else { continue };
            let of = contacts[..own].iter().position(|&contact| contact == torque.contact);
            let size = of.map_or(0.0, |of| coupled[(3 * of, 3 * of)]);
            let size = if size > 0.0 { size } else { 1.0 };
            coupled[(3 * i, 3 * i)] = size;
            if let Some(of) = of {
                coupled[(3 * i, 3 * of)] = -size;
            }
            for row in 3 * i + 1..3 * i + 3 {
                if coupled[(row, row)] == 0.0 && velocity[row] == 0.0 && beta[row] == 0.0 {
                    coupled[(row, row)] = size;
                }
            }
        }
    }
}

impl Torque {
    /// The tangential velocities that correspond to the components of a vector.
    fn tangential(&self, component: impl Fn(usize) -> f64) -> Vector3<f64> {
        let mut velocity = Vector3::zeros();
        for (place, &axis) in self.turning.axes().iter().enumerate() {
            velocity[1 + place] = self.lever * component(axis);
        }
        velocity
    }

    /// The torque along n, t, s that corresponds to a force, N m.
    pub fn torque(&self, force: &Vector3<f64>) -> Vector3<f64> {
        let mut torque = Vector3::zeros();
        for (place, &axis) in self.turning.axes().iter().enumerate() {
            torque[axis] = self.lever * force[1 + place];
        }
        torque
    }

    /// Its coefficients of friction.
    pub fn friction(&self) -> Friction {
        Friction::same(self.mu)
    }
}

/// Why there are no torques at a contact.
pub(crate) enum Lacking {
    /// The mechanism does not provide its relative rotation.
    Rotation,
    /// The mechanism cannot be evaluated.
    State(StateError),
}

/// The torques that the surfaces require.
///
/// # Errors
///
/// The contact whose torque cannot be formed, and why.
pub(crate) fn torques(
    mechanism: &dyn Contacts<f64>,
    surfaces: &[Option<Pair>],
    state: &State<'_>,
) -> Result<Vec<Torque>, (usize, Lacking)> {
    let mut torques = Vec::new();
    for (contact, pair) in surfaces.iter().enumerate() {
        let Some(pair) = pair else { continue };
        for (turning, arm) in [(Turning::Rolling, pair.law.rolling), (Turning::Spinning, pair.law.spinning)] {
            let Some(arm) = arm.filter(|arm| *arm > 0.0) else { continue };
            let lever = lever(mechanism, contact, state)
                .map_err(Lacking::State)
                .and_then(|lever| lever.ok_or(Lacking::Rotation))
                .map_err(|lacking| (contact, lacking))?;
            torques.push(Torque { contact, turning, lever, mu: arm / lever });
        }
    }
    Ok(torques)
}

/// A lever arm for which unit forces of the torque move the bodies as much as unit forces of the contact, so
/// that both have numbers of the same size; about the radius of gyration of a single body. `None` if the
/// mechanism does not provide the rotation.
fn lever(
    mechanism: &dyn Contacts<f64>,
    contact: usize,
    state: &State<'_>,
) -> Result<Option<f64>, StateError> {
    let Some(rotation) = Rotation::of(mechanism, contact, state)? else { return Ok(None) };
    let own = mechanism.contact_state(contact, state)?.reduced;
    let p = state.speeds.len();
    let turns = |axis: usize| -> f64 {
        (0..p).map(|speed| rotation.partials[axis * p + speed] * rotation.response[3 * speed + axis]).sum()
    };
    let lever = ((own.nn + own.tt + own.ss) / (0..3).map(turns).sum::<f64>()).sqrt();
    Ok(Some(if lever.is_finite() && lever > 0.0 { lever } else { 1.0 }))
}
