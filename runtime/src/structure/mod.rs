//! Structure of a contact that is known while compiling, and what it spares.
//!
//! The marker types say which entries vanish; those are then not read, whatever they hold. Each has its own closed form of the sliding arc:
//!
//! | structure | slip | impulse |
//! | --- | --- | --- |
//! | [`Planar`], [`Frictionless`] | linear in I_n | is the variable |
//! | [`Isotropic`] | exponentials of sigma, dI_n = s dsigma | exponentials of sigma |
//! | [`Balanced`], [`Diagonal`] | exponentials of sigma | an incomplete beta function of the direction |
//!
//! Theory: docs/theory.md, section 11.

mod balanced;
mod course;
mod diagonal;
mod frictionless;
mod isotropic;
mod planar;

use nalgebra::Vector3;

pub(crate) use self::implementation::Shape;
use crate::{
    Impact, ImpactError, ReducedMatrix, Scalar, Surface,
    solve::{Restitution, checked, collide},
};

/// A structure of the reduced matrix and the approach: one of the marker types of this module.
pub trait Structure: implementation::Shape {}

mod implementation {
    use nalgebra::{Vector2, Vector3};

    use crate::{
        ReducedMatrix, Surface,
        scalar::Real,
        solve::{Contact, Restitution, Slide, slide},
    };

    /// What a structure does; not to be implemented elsewhere.
    pub trait Shape {
        /// Sets to zero what vanishes.
        #[expect(private_bounds, reason = "nobody else implements this")]
        fn impose<T: Real>(_: &mut ReducedMatrix<T>, _: &mut Vector3<T>, _: &mut Surface<T>) {}

        /// Follows the sliding arc.
        #[expect(private_bounds, private_interfaces, reason = "nobody else implements this")]
        #[inline(always)]
        fn slide<T: Real>(
            c: &Contact<T>,
            from: Vector2<T>,
            speed: T,
            restitution: &mut Restitution<T>,
        ) -> Slide<T> {
            slide(c, from, speed, restitution)
        }
    }
}

/// No structure: as [`crate::solve`].
#[derive(Clone, Copy, Debug)]
pub struct General;

/// m_ns = m_ts = 0 and v_s = 0: everything happens in the plane of n and t, and is piecewise linear. m_ss may be anything.
#[derive(Clone, Copy, Debug)]
pub struct Planar;

/// m_nt = m_ns = 0: friction does not act on v_n, which is linear in I_n, and the three laws agree.
#[derive(Clone, Copy, Debug)]
pub struct Balanced;

/// m_nt = m_ns = m_ts = 0.
#[derive(Clone, Copy, Debug)]
pub struct Diagonal;

/// m_ts = 0 and m_ss = m_tt, which is what is read.
#[derive(Clone, Copy, Debug)]
pub struct Isotropic;

/// mu = 0: the impulse is along n.
#[derive(Clone, Copy, Debug)]
pub struct Frictionless;

impl Structure for General {}
impl Structure for Planar {}
impl Structure for Balanced {}
impl Structure for Diagonal {}
impl Structure for Isotropic {}
impl Structure for Frictionless {}

impl Shape for General {}

/// Solves one collision of known structure: the same outcome and errors as [`crate::solve`] with the vanishing entries set to zero.
///
/// # Errors
/// What [`crate::solve`] refuses.
#[inline]
pub fn solve_structured<S: Structure, T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &Surface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    let (mut matrix, mut approach, mut surface) = (*matrix, *approach, *surface);
    S::impose(&mut matrix, &mut approach, &mut surface);
    if let Some(cleaned) = checked(&matrix, &approach, &surface)? {
        matrix = cleaned;
    }
    let restitution = Restitution::new(surface.law, surface.e);
    collide(&matrix, &approach, -approach.x, &surface, restitution, S::slide)
}
