//! Impact without collision (Painleve's paradox): v_n = 0, but the friction of the present slip makes a
//! normal impulse reduce v_n (f < 0), so that no finite contact force exists.
//!
//! Theory: docs/theory.md, section 17.6.

use nalgebra::{Vector2, Vector3};

use super::{
    collision::{collide, long},
    contact::Contact,
    input::check_closely,
    range::AnyArc,
    restitution::Restitution,
};
use crate::{
    ContactSurface, Impact, ImpactError, ReducedMatrix,
    scalar::{Real, constant, length},
};

/// Solves an impact that begins with v_n = 0: reduced matrix and slip (t, s) in, impulse and velocity of
/// separation out.
///
/// A sliding contact with f < 0 (31) that is pressed together, beta_n < 0, has no finite force (Painleve's
/// paradox): it suffers an impact at once. Slip drives the point into the surface until it has slowed down or
/// turned enough for f to become positive; then compression ends, and restitution follows as in a collision.
/// Velocities scale with the slip, impulses with the slip over m_nn, works with both.
///
/// Poisson's and Stronge's hypotheses hold as in [`crate::solve`], of which this is the limit for v_n1 -> 0.
/// Newton's, v_n2 = -e v_n1, says v_n2 = 0 whatever e is: it acts as e = 0.
///
/// Where f is zero but for rounding, and does not rise, the contact jams: an impact that
/// [`crate::Sensitivity::jam`] flags.
///
/// ```
/// # use hodograph::{Law, ReducedMatrix, Surface, impact_without_collision};
/// # use nalgebra::Vector2;
/// // A uniform rod of mass 1 and length 2 that slides on its tip, at the angle of tangent 2 with the plane.
/// let (sin, cos) = 2.0_f64.atan().sin_cos();
/// let matrix = ReducedMatrix::new(1.0 + 3.0 * cos * cos, 3.0 * sin * cos, 0.0, 1.0 + 3.0 * sin * sin, 0.0, 0.0);
/// let surface = Surface { mu: 1.5, e: 0.5, law: Law::Stronge };
/// let jump = impact_without_collision(&matrix, &Vector2::new(1.0, 0.0), &surface)?;
/// assert!(jump.velocity.x > 0.0 && jump.contact_work < 0.0);
/// # Ok::<(), hodograph::ImpactError<f64>>(())
/// ```
///
/// # Errors
/// [`ImpactError::NoImpact`] where f > 0 or nothing slips: then finite forces exist and nothing happens. Else
/// those of [`crate::solve`].
pub fn impact_without_collision<T: crate::Scalar>(
    matrix: &ReducedMatrix<T>,
    slip: &Vector2<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    without_collision(matrix, slip, surface)
}

/// [`impact_without_collision`] for every number type of the solver: the public scalars and dual numbers.
pub(crate) fn without_collision<T: Real>(
    matrix: &ReducedMatrix<T>,
    slip: &Vector2<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let (quadratures, surface) = (surface.quadratures(), surface.surface());
    let (zero, eps) = (T::zero(), T::default_epsilon());
    let approach = Vector3::new(zero, slip.x, slip.y);
    let matrix = check_closely(matrix, &approach, surface)?;
    let speed = long(slip);
    if speed <= zero {
        return Err(ImpactError::NoImpact { rate: matrix.nn });
    }
    let contact = Contact::new(&matrix, surface.mu);
    let f = contact.normal_rate(&(slip / speed));
    let jam = f.abs() <= constant::<T>(16.0) * eps * contact.normal_size();
    if f > zero && !jam {
        return Err(ImpactError::NoImpact { rate: f * matrix.nn });
    }
    let restitution = Restitution::without_collision(surface.law, surface.e).within(quadratures);
    let mut impact = collide::<AnyArc, T>(&matrix, &approach, speed, surface, restitution)?;
    // f becomes positive at once: v_n has not fallen, and there is no impact.
    if impact.impulse.x * matrix.nn <= eps * speed * length(&(slip / speed)) {
        return Err(ImpactError::NoImpact { rate: f * matrix.nn });
    }
    impact.sensitivity.jam = jam;
    Ok(impact)
}
