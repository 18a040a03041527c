//! Forces of several contacts at once.
//!
//! k closed contacts have the accelerations a = W lambda + beta, three components (n, t, s) each. Signorini's law
//! asks lambda_n >= 0, a_n >= 0 and lambda_n a_n = 0 of each, Coulomb's law friction -mu lambda_n d of a contact that
//! slips along d, and of one that does not abs(lambda_tan) <= mu lambda_n, with a_tan = 0 or friction
//! -mu lambda_n a_tan / abs(a_tan). [`solve_several`] finds such forces without allocation, in bounded work, and
//! proves them by a [`Certificate`]. With velocities for accelerations it is the impact of several contacts at once.
//!
//! Sizes are known while compiling where k is:
//!
//! ```
//! use hodograph::several::{Dense, SeveralContacts, memory_of_several, solve_several};
//!
//! // A rod of mass 1 and length 2 that lies on both ends; forces at the ends, vertical and along the rod.
//! let mut matrix = [0.0; 36];
//! for (i, x) in [-1.0, 1.0].into_iter().enumerate() {
//!     for (j, y) in [-1.0, 1.0].into_iter().enumerate() {
//!         matrix[6 * (3 * j) + 3 * i] = 1.0 + 3.0 * x * y;
//!         matrix[6 * (3 * j + 1) + 3 * i + 1] = 1.0;
//!     }
//! }
//! let beta = [-9.81, 2.0, 0.0, -9.81, 2.0, 0.0];
//! let problem = SeveralContacts { matrix: &matrix, beta: &beta, mu: &[0.4, 0.4], slip: &[None, None] };
//! let (mut force, mut acceleration) = ([0.0_f64; 6], [0.0; 6]);
//! let (mut memory, mut space) = ([0.0; memory_of_several(2)], [0.0; 36]);
//! let proof =
//!     solve_several(&problem, &mut force, &mut acceleration, &mut memory, &mut Dense::new(&mut space))?;
//! assert!(proof.greatest() < 1e-14 && (force[0] - 4.905).abs() < 1e-12);
//! assert!((force[1] + force[4] + 2.0).abs() < 1e-12);
//! # Ok::<(), hodograph::several::Unfound<f64>>(())
//! ```
//!
//! Theory: docs/theory.md, section 17.10.

mod certificate;
mod dense;
mod globalise;
mod law;
mod newton;
mod scaled;

use nalgebra::Vector2;

pub use self::{
    certificate::Certificate,
    dense::{Dense, NewtonSteps},
    globalise::{Unfound, certify, memory_of_several, solve_several},
    scaled::Scaled,
};

/// The problem of k contacts.
#[derive(Clone, Copy, Debug)]
pub struct SeveralContacts<'a, T: nalgebra::Scalar> {
    /// W = V (mass matrix)^-1 V^T, 3 k x 3 k, by columns; positive semidefinite, 1/kg
    pub matrix: &'a [T],
    /// The accelerations without contact forces, n, t, s of each, m/s^2.
    pub beta: &'a [T],
    /// The coefficient of friction of each contact.
    pub mu: &'a [T],
    /// The direction of slip (t, s) of each contact, of length one; `None` without slip.
    pub slip: &'a [Option<Vector2<T>>],
}
