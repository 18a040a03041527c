//! The stability bound on the step of recursive summation (6.1 of the paper).

use nalgebra::Complex;

use super::equations::Problem;
use crate::ReducedMatrix;

/// How (34), linearised about a point, bounds the step of Euler's method (56).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stability {
    /// The two eigenvalues that are not zero, in 1/(N s): (h' +- sqrt(h'^2 - 4 h g')) / (2 s).
    pub eigenvalues: [Complex<f64>; 2],
    /// The largest step D in N s with |1 + lambda D| <= 1 for both; 0 if one of them grows whatever the
    /// step, infinite if both are zero.
    pub largest_step: f64,
}

impl Stability {
    /// Whether a step in N s is stable.
    pub fn permits(&self, step: f64) -> bool {
        step <= self.largest_step
    }
}

/// The eigenvalues of (34) linearised about slip `s` (m/s, positive) in the direction `phi`, and the step
/// they bound (6.1).
///
/// Corrected: the paper prints 1/s for 1/(2 s), |1 - lambda D| for |1 + lambda D|, and calls the eigenvalues
/// eigenvectors. As s goes to zero at phi_bar, where h = 0, one eigenvalue is zero and the other h' / s, so
/// the bound reads 0 < -h' D / s < 2.
pub fn stability(matrix: &ReducedMatrix<f64>, mu: f64, phi: f64, s: f64) -> Stability {
    let problem = Problem::scaled(matrix, mu, 1.0, s, phi);
    let (sin, cos) = phi.sin_cos();
    let [_, _, h] = problem.fgh(cos, sin);
    let [dg, dh] = problem.derivatives(cos, sin);
    let scale = matrix.nn / (2.0 * s);
    let square = dh * dh - 4.0 * h * dg;
    let eigenvalues = if square >= 0.0 {
        // The smaller one from the product h g', without cancellation.
        let larger = dh + square.sqrt().copysign(dh);
        let smaller = if larger == 0.0 { 0.0 } else { 4.0 * h * dg / larger };
        [larger, smaller].map(|x| Complex::new(x * scale, 0.0))
    } else {
        let width = (-square).sqrt();
        [width, -width].map(|x| Complex::new(dh * scale, x * scale))
    };
    let bound = |l: &Complex<f64>| {
        if *l == Complex::new(0.0, 0.0) { f64::INFINITY } else { (-2.0 * l.re / l.norm_sqr()).max(0.0) }
    };
    Stability { eigenvalues, largest_step: bound(&eigenvalues[0]).min(bound(&eigenvalues[1])) }
}
