//! Solves the collision of a contact of a generated module: turns the contact basis so that t lies along the
//! slip, calls the solver, and turns the result back.

use nalgebra::{Vector2, Vector3};

use super::number;
use crate::{
    CollisionOutcome, ContactSurface, Impact, ImpactError, ReducedMatrix, Scalar, impact_without_collision,
    solve,
    specialised::{KnownLaw, solve_inlined},
    structure::{General, Structure, solve_structured},
};

/// The quantities of a contact in a state of the mechanism. The contact basis is `normal`, `first`, `second`,
/// right-handed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<T> {
    /// n along N.x, N.y, N.z
    pub normal: Vector3<T>,
    /// first tangential axis along N.x, N.y, N.z
    pub first: Vector3<T>,
    /// second tangential axis along N.x, N.y, N.z
    pub second: Vector3<T>,
    /// velocity of approach in the contact basis, m/s
    pub velocity: Vector3<T>,
    /// reduced matrix in the contact basis, 1/kg
    pub reduced: ReducedMatrix<T>,
    /// the part of the velocity of approach that prescribed motion causes (the paper's v_t^R), in the
    /// contact basis, m/s
    pub remainder: Vector3<T>,
    /// work of the prescribed motion per unit impulse, in the contact basis, m/s: the sum of m v_t . dv in
    /// (24)
    pub prescribed_work: Vector3<T>,
}

/// A solved collision of a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolved<T: nalgebra::Scalar> {
    /// t along N.x, N.y, N.z: along the slip of approach
    pub tangent: Vector3<T>,
    /// s = n x t along N.x, N.y, N.z
    pub binormal: Vector3<T>,
    /// velocity of approach along n, t, s, m/s
    pub approach: Vector3<T>,
    /// reduced matrix along n, t, s, 1/kg
    pub reduced: ReducedMatrix<T>,
    /// the outcome along n, t, s
    pub impact: Impact<T>,
    /// impulse in the contact basis, N s
    pub impulse: Vector3<T>,
    /// impulse on the striking point along N.x, N.y, N.z, N s
    pub impulse_on_point: Vector3<T>,
    /// change of kinetic energy, J: (24)
    pub energy_change: T,
}

impl<T: Scalar> Resolved<T> {
    /// What is told of the collision of a contact with this normal.
    #[inline(always)]
    pub fn outcome(self, normal: Vector3<T>) -> CollisionOutcome<T> {
        CollisionOutcome {
            normal,
            tangent: self.tangent,
            binormal: self.binormal,
            approach: self.approach,
            reduced: self.reduced,
            impulse_on_point: self.impulse_on_point,
            energy_change: self.energy_change,
            impact: self.impact,
        }
    }
}

/// Cosine and sine of the angle from `first` to t. t lies along the slip of approach; without slip it is the
/// projection of the first of N.x, N.y, N.z that is not within 30 degrees of the normal.
///
/// Slip of a collision is zero where both of its components are: no bound decides, and the flags of
/// [`crate::Sensitivity`] say where rounding may matter. Contact that lasts has a bound of rounding
/// ([`super::slip_noise`]), because there the slip selects a mode.
#[inline(always)]
pub fn contact_axes<T: Scalar>(contact: &Contact<T>) -> (T, T) {
    let along = |direction: Vector2<T>| {
        let length = (direction.x * direction.x + direction.y * direction.y).sqrt();
        (length > T::zero()).then(|| (direction.x / length, direction.y / length))
    };
    if let Some(axes) = along(Vector2::new(contact.velocity.y, contact.velocity.z)) {
        return axes;
    }
    let Contact { normal, first, second, .. } = contact;
    let far = |component: T| component * component < number(0.75);
    let projection = if far(normal.x) {
        Vector2::new(first.x, second.x)
    } else if far(normal.y) {
        Vector2::new(first.y, second.y)
    } else {
        Vector2::new(first.z, second.z)
    };
    along(projection).unwrap_or((T::one(), T::zero()))
}

/// Solves the collision of a contact.
///
/// # Errors
///
/// Those of [`solve`].
#[inline]
pub fn resolve<T: Scalar>(
    contact: &Contact<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Resolved<T>, ImpactError<T>> {
    let axes = contact_axes(contact);
    let (reduced, approach) = along_slip(contact, axes);
    let impact = solve(&reduced, &approach, surface)?;
    Ok(resolved(contact, axes, reduced, approach, impact))
}

/// [`resolve`] for many contacts, each on its surface, several at once; `answer` is called once for each with its place, in any
/// order.
#[cfg(feature = "lanes")]
pub fn resolve_each(
    contacts: &[(Contact<f64>, crate::Surface<f64>)],
    mut answer: impl FnMut(usize, Result<Resolved<f64>, ImpactError<f64>>),
) {
    let along = |contact: &Contact<f64>| {
        let axes = contact_axes(contact);
        (axes, along_slip(contact, axes))
    };
    let collisions = contacts.iter().map(|(contact, surface)| {
        let (_, (reduced, approach)) = along(contact);
        (reduced, approach, *surface)
    });
    crate::lanes::solve_each(collisions, |place, impact| {
        let Some((contact, _)) = contacts.get(place) else { return };
        let (axes, (reduced, approach)) = along(contact);
        answer(place, impact.map(|impact| resolved(contact, axes, reduced, approach, impact)));
    });
}

/// [`resolve`] as a part of the caller, under the law that `L` knows.
///
/// # Errors
///
/// Those of [`solve`].
#[inline(always)]
pub fn resolve_inlined<L: KnownLaw, T: Scalar>(
    contact: &Contact<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Resolved<T>, ImpactError<T>> {
    let axes = contact_axes(contact);
    let (reduced, approach) = along_slip(contact, axes);
    let impact = solve_inlined::<General, L, T>(&reduced, &approach, surface)?;
    Ok(resolved(contact, axes, reduced, approach, impact))
}

/// Reduced matrix and velocity of approach along n, t and s, t being the direction of slip.
#[inline(always)]
pub fn along_slip<T: Scalar>(contact: &Contact<T>, (cos, sin): (T, T)) -> (ReducedMatrix<T>, Vector3<T>) {
    let Contact { velocity, .. } = contact;
    let reduced = contact.reduced.turned(cos, sin);
    let slip = (velocity.y * velocity.y + velocity.z * velocity.z).sqrt();
    (reduced, Vector3::new(velocity.x, slip, T::zero()))
}

/// Solves the impact without collision of a contact; its normal velocity counts as zero.
///
/// # Errors
///
/// Those of [`impact_without_collision`].
#[inline]
pub fn resolve_without_collision<T: Scalar>(
    contact: &Contact<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Resolved<T>, ImpactError<T>> {
    let (cos, sin) = contact_axes(contact);
    let Contact { velocity, .. } = contact;
    let reduced = contact.reduced.turned(cos, sin);
    let slip = (velocity.y * velocity.y + velocity.z * velocity.z).sqrt();
    let impact = impact_without_collision(&reduced, &Vector2::new(slip, T::zero()), surface)?;
    let approach = Vector3::new(T::zero(), slip, T::zero());
    Ok(resolved(contact, (cos, sin), reduced, approach, impact))
}

/// Solves the collision of a contact whose structure is known, in the contact basis.
///
/// # Errors
///
/// Those of [`solve`].
#[inline]
pub fn resolve_structured<S: Structure, T: Scalar>(
    contact: &Contact<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Resolved<T>, ImpactError<T>> {
    let axes = contact_axes(contact);
    let impact = solve_structured::<S, T>(&contact.reduced, &contact.velocity, surface)?;
    Ok(from_basis(contact, axes, impact))
}

/// [`resolve_structured`] as a part of the caller, under the law that `L` knows.
///
/// # Errors
///
/// Those of [`solve`].
#[inline(always)]
pub fn resolve_structured_inlined<S: Structure, L: KnownLaw, T: Scalar>(
    contact: &Contact<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Resolved<T>, ImpactError<T>> {
    let axes = contact_axes(contact);
    let impact = solve_inlined::<S, L, T>(&contact.reduced, &contact.velocity, surface)?;
    Ok(from_basis(contact, axes, impact))
}

/// The components along n, t and s of a vector along the contact basis.
#[inline(always)]
pub fn along_axes<T: Scalar>(v: &Vector3<T>, (cos, sin): (T, T)) -> Vector3<T> {
    Vector3::new(v.x, v.y * cos + v.z * sin, v.z * cos - v.y * sin)
}

/// Converts an outcome along the contact basis.
#[inline(always)]
fn from_basis<T: Scalar>(contact: &Contact<T>, (cos, sin): (T, T), mut impact: Impact<T>) -> Resolved<T> {
    impact.impulse = along_axes(&impact.impulse, (cos, sin));
    impact.velocity = along_axes(&impact.velocity, (cos, sin));
    let approach = along_axes(&contact.velocity, (cos, sin));
    resolved(contact, (cos, sin), contact.reduced.turned(cos, sin), approach, impact)
}

/// Converts an outcome along n, t, s to the contact basis and to N.
#[inline(always)]
fn resolved<T: Scalar>(
    contact: &Contact<T>,
    (cos, sin): (T, T),
    reduced: ReducedMatrix<T>,
    approach: Vector3<T>,
    impact: Impact<T>,
) -> Resolved<T> {
    let Contact { normal, first, second, .. } = contact;
    let impulse = Vector3::new(
        impact.impulse.x,
        impact.impulse.y * cos - impact.impulse.z * sin,
        impact.impulse.y * sin + impact.impulse.z * cos,
    );
    Resolved {
        tangent: first * cos + second * sin,
        binormal: second * cos - first * sin,
        approach,
        reduced,
        impact,
        impulse,
        impulse_on_point: normal * impulse.x + first * impulse.y + second * impulse.z,
        energy_change: impact.contact_work + impulse.dot(&(contact.prescribed_work - contact.remainder)),
    }
}
