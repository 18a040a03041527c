//! The pair of surfaces in contact: friction and restitution, and how much work a collision there may take.

use crate::Law;

/// The pair of surfaces in contact: one coefficient of friction, one of restitution, and what the latter
/// means.
///
/// The fields are plain numbers; [`crate::solve`] checks them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Surface<T> {
    /// Coulomb's coefficient of friction, not negative.
    pub mu: T,
    /// Coefficient of restitution, in [0, 1].
    pub e: T,
    /// The hypothesis `e` belongs to.
    pub law: Law,
}

/// What a model states of a contact beyond mu, e and law of its [`Surface`]: names and numbers, in SI units, of which
/// simulations make laws (`hodograph_simulation::ContactLaw`). Collisions of a generated module take a [`Surface`] and
/// nothing of this.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StatedLaw<'a> {
    /// static coefficient of friction
    pub mu_static: Option<f64>,
    /// coefficient of friction in impacts
    pub mu_impact: Option<f64>,
    /// sliding friction as a function of the speed of slip: name and numbers
    pub sliding: Option<(&'a str, &'a [f64])>,
    /// restitution as a function of the speed of approach: name and numbers
    pub restitution: Option<(&'a str, &'a [f64])>,
    /// lever arm of rolling friction, m
    pub rolling: Option<f64>,
    /// lever arm of spinning friction, m
    pub spinning: Option<f64>,
}

impl<T> Surface<T> {
    /// The same surface with a budget: the solver stops with [`crate::ImpactError::BudgetExceeded`] before it
    /// makes more than this many quadratures.
    ///
    /// ```
    /// # use hodograph::{ImpactError, Law, ReducedMatrix, Surface, nalgebra::Vector3, solve};
    /// # let matrix = ReducedMatrix::new(0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211);
    /// # let approach = Vector3::new(-0.946108022, 1.06306701, 0.0);
    /// let surface = Surface { mu: 0.6, e: 0.8, law: Law::Stronge };
    /// assert_eq!(solve(&matrix, &approach, &surface.with_budget(16))?, solve(&matrix, &approach, &surface)?);
    /// let stopped = solve(&matrix, &approach, &surface.with_budget(1));
    /// assert!(matches!(stopped, Err(ImpactError::BudgetExceeded { quadratures: 1, .. })));
    /// # Ok::<(), ImpactError<f64>>(())
    /// ```
    #[inline]
    pub const fn with_budget(self, quadratures: u32) -> Budgeted<T>
    where
        T: Copy,
    {
        Budgeted { surface: self, quadratures }
    }
}

/// A surface and the greatest number of quadratures that one collision may take there: for loops that must
/// keep a deadline.
///
/// A quadrature integrates one stretch of the sliding arc with 16 nodes. It is the only part of the solver
/// whose number depends on the input; all else is done at most a fixed number of times per quadrature or per
/// collision. An outcome within the budget has the bits of the outcome without one. Contacts of a known
/// [`structure`](crate::structure) are solved in closed form and take quadratures only where that form does
/// not apply.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[doc(alias = "Budget")]
pub struct Budgeted<T> {
    /// The surface.
    pub surface: Surface<T>,
    /// The greatest number of quadratures.
    pub quadratures: u32,
}

/// A surface as collisions take it: a [`Surface`], or a [`Budgeted`] one.
pub trait ContactSurface<T> {
    /// Friction and restitution.
    fn surface(&self) -> &Surface<T>;

    /// The greatest number of quadratures; `u32::MAX` means no limit but the solver's own.
    fn quadratures(&self) -> u32;
}

impl<T> ContactSurface<T> for Surface<T> {
    #[inline]
    fn surface(&self) -> &Surface<T> {
        self
    }

    #[inline]
    fn quadratures(&self) -> u32 {
        u32::MAX
    }
}

impl<T, S: ContactSurface<T>> ContactSurface<T> for &S {
    #[inline]
    fn surface(&self) -> &Surface<T> {
        S::surface(self)
    }

    #[inline]
    fn quadratures(&self) -> u32 {
        S::quadratures(self)
    }
}

impl<T> ContactSurface<T> for Budgeted<T> {
    #[inline]
    fn surface(&self) -> &Surface<T> {
        &self.surface
    }

    #[inline]
    fn quadratures(&self) -> u32 {
        self.quadratures
    }
}
