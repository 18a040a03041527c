//! Contacts whose reduced matrix has a structure that is known at compile time, and solvers in closed form
//! for them.
//!
//! A marker type says which entries of the matrix, of the velocity of approach or of the surface are zero or
//! equal. These are then not read, whatever their value. Each structure has a closed form of the sliding arc,
//! with s the speed of slip and dI_n = s dsigma:
//!
//! | structure | slip | impulse |
//! | --- | --- | --- |
//! | [`Planar`], [`Frictionless`] | linear in I_n | the variable itself |
//! | [`Isotropic`] | exponentials of sigma | exponentials of sigma |
//! | [`Balanced`], [`Diagonal`] | exponentials of sigma | an incomplete beta function of the direction |
//!
//! Theory: docs/theory.md, section 11.

mod balanced;
mod course;
mod diagonal;
mod frictionless;
mod isotropic;
mod planar;

use core::marker::PhantomData;

use nalgebra::{Vector2, Vector3};

pub(crate) use self::implementation::Shape;
use crate::{
    ContactSurface, Impact, ImpactError, ReducedMatrix, Scalar, Surface,
    scalar::Real,
    solve::{Contact, Restitution, Slide, Slides, checked, collide},
};

/// A structure of a contact: one of the marker types of this module.
pub trait Structure: implementation::Shape {}

mod implementation {
    use nalgebra::{Vector2, Vector3};

    use crate::{
        ReducedMatrix, Surface,
        scalar::Real,
        solve::{Contact, Restitution, Slide, slide},
    };

    /// What a structure does. Other crates cannot implement it.
    pub trait Shape {
        /// Sets the entries that the structure fixes.
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

/// The sliding arcs of a structure.
struct Of<S>(PhantomData<S>);

impl<S: Structure> Slides for Of<S> {
    #[inline(always)]
    fn slide<T: Real>(
        c: &Contact<T>,
        from: Vector2<T>,
        speed: T,
        restitution: &mut Restitution<T>,
    ) -> Slide<T> {
        S::slide(c, from, speed, restitution)
    }
}

/// No structure: the general solver, as [`crate::solve`].
#[derive(Clone, Copy, Debug)]
pub struct General;

/// m_ns = m_ts = 0 and v_s = 0: all velocities and impulses lie in the plane of n and t, and are piecewise
/// linear in I_n. m_ss is not read.
#[derive(Clone, Copy, Debug)]
pub struct Planar;

/// m_nt = m_ns = 0: friction does not change v_n, which is linear in I_n; the three laws of restitution
/// agree.
#[derive(Clone, Copy, Debug)]
pub struct Balanced;

/// m_nt = m_ns = m_ts = 0.
#[derive(Clone, Copy, Debug)]
pub struct Diagonal;

/// m_ts = 0 and m_ss = m_tt; m_tt is read, m_ss is not.
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

/// Solves one collision of known structure: the same outcome and errors as [`crate::solve`] for the matrix,
/// velocity and surface with the entries set as the structure `S` says. Arguments and units are those of
/// [`crate::solve`].
///
/// # Errors
/// Those of [`crate::solve`].
#[inline]
pub fn solve_structured<S: Structure, T: Scalar>(
    matrix: &ReducedMatrix<T>,
    approach: &Vector3<T>,
    surface: &impl ContactSurface<T>,
) -> Result<Impact<T>, ImpactError<T>> {
    structured::<S, T>(*matrix, *approach, *surface.surface(), surface.quadratures())
}

/// [`solve_structured`] for every number type of the solver.
#[inline(always)]
pub(crate) fn structured<S: Structure, T: Real>(
    mut matrix: ReducedMatrix<T>,
    mut approach: Vector3<T>,
    mut surface: Surface<T>,
    quadratures: u32,
) -> Result<Impact<T>, ImpactError<T>> {
    S::impose(&mut matrix, &mut approach, &mut surface);
    if let Some(cleaned) = checked(&matrix, &approach, &surface)? {
        matrix = cleaned;
    }
    let restitution = Restitution::new(surface.law, surface.e).within(quadratures);
    collide::<Of<S>, T>(&matrix, &approach, -approach.x, &surface, restitution)
}
