//! The distance of forces from a solution, by a map that is independent of the method that finds them.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use nalgebra::{DVector, Matrix3, Vector3};

use super::{Problem, problem::three};

/// The greatest distance of a contact from a solution, r - P(r - rho (v + mu abs(v_tan) n)), divided by rho
/// and by the greatest component of beta and v. P is the projection onto Coulomb's cone, 1 / rho the greatest
/// eigenvalue of the contact's block of W. For a contact that slips along d it is the distance of r_tan from
/// -mu r_n d.
pub fn natural_residual(problem: &Problem<'_>, force: &DVector<f64>) -> f64 {
    let velocity = problem.w * force + problem.beta;
    let greatest = problem.beta.amax().max(velocity.amax());
    let mut worst = 0.0_f64;
    for i in 0..problem.contacts() {
        let block: Matrix3<f64> = problem.w.fixed_view::<3, 3>(3 * i, 3 * i).into();
        // by entries: rustc 1.95 optimises the sum of a matrix and its transpose wrongly
        let symmetric = Matrix3::from_fn(|a, b| 0.5 * (block[(a, b)] + block[(b, a)]));
        let stiffest = symmetric.symmetric_eigenvalues().max();
        let (r, v, mu) = (three(force, i), three(&velocity, i), problem.mu[i]);
        let rho = if stiffest > 0.0 { 1.0 / stiffest } else { 1.0 };
        let distance = match problem.slip[i] {
            None => {
                let saxce = v + Vector3::x() * (mu * hypot(v.y, v.z));
                r - onto_cone(&(r - saxce * rho), mu)
            }
            Some(d) => {
                let normal = r.x - (r.x - rho * v.x).max(0.0);
                Vector3::new(normal, r.y + mu * r.x * d.x, r.z + mu * r.x * d.y)
            }
        };
        worst = worst.max(distance.norm() / rho);
    }
    if greatest > 0.0 { worst / greatest } else { worst }
}

/// The projection of `z` onto Coulomb's cone.
fn onto_cone(z: &Vector3<f64>, mu: f64) -> Vector3<f64> {
    let size = hypot(z.y, z.z);
    if size <= mu * z.x {
        return *z;
    }
    if mu * size <= -z.x {
        return Vector3::zeros();
    }
    let normal = (z.x + mu * size) / (1.0 + mu * mu);
    if size > 0.0 {
        Vector3::new(normal, mu * normal * z.y / size, mu * normal * z.z / size)
    } else {
        Vector3::new(normal, 0.0, 0.0)
    }
}
