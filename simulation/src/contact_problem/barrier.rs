//! The logarithmic barrier of the cones in which forces are allowed, and Newton's steps on it.
//!
//! The barrier of the cones reduced by s, with u_tan = lambda_tan / mu, is the sum of -ln((u_n - s)^2 - abs(u_tan)^2), of
//! -ln(u_n - s) for contacts that slide, and of abs(x)^2 / (2 load^2). Its variables are y, of the forces x_0 + Z y, and s.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use nalgebra::DMatrix;

use super::{
    cone::Cone,
    linear::{Square, Vector},
};

/// Gradient and Hessian of the barrier, and the work space for them.
pub(super) struct Barrier<'c> {
    cones: &'c [Cone],
    load: f64,
    /// number of components of y
    p: usize,
    /// the basis Z by rows
    rows: Square,
    by_x: Vector,
    row: Vector,
    /// with respect to y and s
    gradient: Vector,
    /// its lower triangle, by columns
    hessian: Square,
}

impl<'c> Barrier<'c> {
    /// Work space for the barrier of these cones; the basis is orthonormal.
    pub fn new(cones: &'c [Cone], basis: &DMatrix<f64>, load: f64) -> Self {
        let (n, p) = basis.shape();
        let mut rows = Square::zeros(n * p);
        for (j, column) in basis.as_slice().chunks_exact(n.max(1)).enumerate() {
            column.iter().enumerate().for_each(|(i, entry)| rows[i * p + j] = *entry);
        }
        Self {
            cones,
            load,
            p,
            rows,
            by_x: Vector::zeros(n),
            row: Vector::zeros(p + 1),
            gradient: Vector::zeros(p + 1),
            hessian: Square::zeros((p + 1) * (p + 1)),
        }
    }

    /// Computes gradient and Hessian at these forces, with the cones reduced by `s`.
    pub fn evaluate(&mut self, x: &[f64], s: f64) {
        let p = self.p;
        self.by_x.fill(0.0);
        self.gradient.fill(0.0);
        self.hessian.fill(0.0);
        let square = 1.0 / (self.load * self.load);
        for cone in self.cones {
            let n = x[cone.normal] - s;
            let Some((t, r, factor)) = cone.tangential else {
                self.by_x[cone.normal] -= 1.0 / n;
                self.gradient[p] += 1.0 / n;
                self.add_square(1.0, &[(cone.normal, 1.0 / n)], -1.0 / n);
                continue;
            };
            let (ut, us) = (factor * x[t], factor * x[r]);
            let size = hypot(ut, us);
            let q = (n - size) * (n + size);
            // -ln q with q = n^2 - ut^2 - us^2.
            let (dn, dt, ds) = (-2.0 * n / q, 2.0 * ut / q, 2.0 * us / q);
            self.by_x[cone.normal] += dn;
            self.by_x[t] += factor * dt;
            self.by_x[r] += factor * ds;
            self.gradient[p] -= dn;
            self.add_square(1.0, &[(cone.normal, dn), (t, factor * dt), (r, factor * ds)], -dn);
            self.add_square(-2.0 / q, &[(cone.normal, 1.0)], -1.0);
            for axis in [t, r] {
                self.add_square(2.0 / q, &[(axis, factor)], 0.0);
            }
        }
        for (sum, x) in self.by_x.iter_mut().zip(x) {
            *sum += square * x;
        }
        for (along, row) in self.by_x.iter().zip(self.rows.chunks_exact(p.max(1))) {
            self.gradient[..p].iter_mut().zip(row).for_each(|(sum, part)| *sum += along * part);
        }
        for i in 0..p {
            self.hessian[i * (p + 1) + i] += square;
        }
    }

    /// Adds to the Hessian a factor times the square of a sum of components of x, and of s.
    fn add_square(&mut self, factor: f64, parts: &[(usize, f64)], by_s: f64) {
        let (p, row) = (self.p, &mut self.row);
        row.fill(0.0);
        for &(place, factor) in parts {
            let own = &self.rows[place * p..][..p];
            row.iter_mut().zip(own).for_each(|(sum, part)| *sum += factor * part);
        }
        row[p] = by_s;
        for (j, column) in self.hessian.chunks_exact_mut(p + 1).enumerate() {
            let scaled = factor * row[j];
            column[j..].iter_mut().zip(&row[j..]).for_each(|(entry, own)| *entry += scaled * own);
        }
    }

    /// Adds a term of s alone, by its first and second derivative.
    pub fn add(&mut self, first: f64, second: f64) {
        let p = self.p;
        self.gradient[p] += first;
        self.hessian[p * (p + 1) + p] += second;
    }

    /// Newton's step of the first variables, as many as `step` has room for: its length in the metric of the Hessian, which
    /// is overwritten by its factor. `None` where it is not positive definite.
    pub fn step(&mut self, step: &mut [f64]) -> Option<f64> {
        let (m, stride) = (step.len(), self.p + 1);
        let factor = &mut self.hessian;
        for j in 0..m {
            for k in 0..j {
                let lead = factor[k * stride + j];
                for i in j..m {
                    factor[j * stride + i] -= lead * factor[k * stride + i];
                }
            }
            let pivot = factor[j * stride + j];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            let root = pivot.sqrt();
            factor[j * stride + j..j * stride + m].iter_mut().for_each(|entry| *entry /= root);
        }
        // L v = -gradient, then L^T step = v; the length is that of v.
        step.iter_mut().zip(&self.gradient[..m]).for_each(|(step, gradient)| *step = -gradient);
        for j in 0..m {
            step[j] /= factor[j * stride + j];
            let known = step[j];
            for i in j + 1..m {
                step[i] -= factor[j * stride + i] * known;
            }
        }
        let length = step.iter().map(|part| part * part).sum::<f64>().sqrt();
        for j in (0..m).rev() {
            let rest: f64 = (j + 1..m).map(|i| factor[j * stride + i] * step[i]).sum();
            step[j] = (step[j] - rest) / factor[j * stride + j];
        }
        length.is_finite().then_some(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The gradient is that of the barrier, and the step solves Newton's equations, by differences.
    #[test]
    fn steps_solve_newtons_equations() {
        let cones = [
            Cone { normal: 0, tangential: Some((1, 2, 1.0 / 0.7)) },
            Cone { normal: 3, tangential: None },
            Cone { normal: 4, tangential: Some((5, 6, 1.0 / 0.4)) },
        ];
        let basis = DMatrix::from_fn(7, 3, |i, j| ((3 * i + 5 * j + 1) as f64).sin()).qr().q();
        let (load, s) = (3.0, -0.4);
        let start = [1.0, 0.2, -0.3, 0.5, 2.0, 0.1, 0.3];
        let forces = |y: &[f64]| -> Vec<f64> {
            (0..7).map(|i| start[i] + (0..3).map(|j| basis[(i, j)] * y[j]).sum::<f64>()).collect()
        };
        let mut barrier = Barrier::new(&cones, &basis, load);
        let mut gradient = |z: &[f64; 4]| {
            barrier.evaluate(&forces(&z[..3]), s + z[3]);
            [0, 1, 2, 3].map(|i| barrier.gradient[i])
        };
        let here = gradient(&[0.0; 4]);
        let h = 1e-5;
        let hessian = DMatrix::from_fn(4, 4, |i, j| {
            let at = |side: f64| std::array::from_fn(|k| if k == j { side * h } else { 0.0 });
            (gradient(&at(1.0))[i] - gradient(&at(-1.0))[i]) / (2.0 * h)
        });
        barrier.evaluate(&forces(&[0.0; 3]), s);
        let mut step = [0.0; 4];
        let length = barrier.step(&mut step).unwrap();
        let mut decrease = 0.0;
        for i in 0..4 {
            let left: f64 = (0..4).map(|j| hessian[(i, j)] * step[j]).sum();
            assert!((left + here[i]).abs() < 1e-7, "{i}: {left} {}", here[i]);
            decrease -= here[i] * step[i];
        }
        assert!((length * length - decrease).abs() < 1e-9);
        // a direction without a bound has no step
        let flat = DMatrix::zeros(7, 1);
        let mut barrier = Barrier::new(&[], &flat, f64::INFINITY);
        barrier.evaluate(&start, 0.0);
        assert!(barrier.step(&mut [0.0]).is_none());
    }
}
