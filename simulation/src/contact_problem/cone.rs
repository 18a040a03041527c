//! The conditions that normal forces and friction obey: a cone for each contact that sticks, a half-line for one that
//! slides.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use nalgebra::DVector;

/// A condition on the forces: the row of u_n, and those of u_tan with the factor 1 / mu.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub normal: usize,
    pub tangential: Option<(usize, usize, f64)>,
}

impl Cone {
    /// u_n - abs(u_tan).
    pub fn reserve(&self, x: &DVector<f64>) -> f64 {
        let friction = self.tangential.map_or(0.0, |(t, s, factor)| factor * hypot(x[t], x[s]));
        x[self.normal] - friction
    }
}

/// The least reserve of all cones.
pub(super) fn least_reserve(cones: &[Cone], x: &DVector<f64>) -> f64 {
    cones.iter().map(|cone| cone.reserve(x)).fold(f64::INFINITY, f64::min)
}
