//! Newton steps for the barrier of many cones, by least squares.
//!
//! With u_n = n and abs(u_tan) = a the barrier of a cone is -ln(n - a) - ln(n + a), and its Hessian a sum of three squares:
//!
//! ```text
//! g1 g1^T / (n - a)^2 + g2 g2^T / (n + a)^2 + 2 / (n^2 - a^2) t t^T,     g1, g2 = (1, -+u_tan / a), t across u_tan,
//! ```
//!
//! This form avoids the differences of large terms in which the Hessian would lose its components along the
//! cone. The Hessian is J^T J with the rows J of these squares, and steps are computed from J by orthogonal
//! transformations, whose errors depend on 1 / (n - a) and not on its square.
//!
//! Theory: docs/theory.md, section 17.17.

use hodograph::generated::hypot;
use nalgebra::{DMatrix, DVector};

use super::cone::Cone;

/// The entries of a square over the variables, and its right side.
struct Row {
    entries: DVector<f64>,
    right: f64,
    /// of the entries
    greatest: f64,
}

impl Row {
    fn new(entries: DVector<f64>, right: f64) -> Self {
        let greatest = entries.amax();
        Self { entries, right, greatest }
    }
}

/// A sum of squares: rows over (y, s), and the right sides for which -J^T e is the gradient.
pub(super) struct Squares {
    rows: Vec<Row>,
}

impl Squares {
    /// The barrier of the cones reduced by `s`, and the square of the forces; the last variable is s.
    pub fn new(cones: &[Cone], basis: &DMatrix<f64>, load: f64, x: &DVector<f64>, s: f64) -> Self {
        let p = basis.ncols();
        let mut rows = Vec::new();
        let mut add = |parts: &[(usize, f64)], by_s: f64, right: f64| {
            let mut row = DVector::zeros(p + 1);
            for &(place, factor) in parts {
                for j in 0..p {
                    row[j] += factor * basis[(place, j)];
                }
            }
            row[p] = by_s;
            rows.push(Row::new(row, right));
        };
        for cone in cones {
            let n = x[cone.normal] - s;
            let Some((t, r, factor)) = cone.tangential else {
                add(&[(cone.normal, 1.0 / n)], -1.0 / n, 1.0);
                continue;
            };
            let (ut, us) = (factor * x[t], factor * x[r]);
            let a = hypot(ut, us);
            let (dt, ds) = if a > 0.0 { (ut / a, us / a) } else { (1.0, 0.0) };
            for (size, sign) in [(n - a, -1.0), (n + a, 1.0)] {
                let along = sign * factor / size;
                add(&[(cone.normal, 1.0 / size), (t, along * dt), (r, along * ds)], -1.0 / size, 1.0);
            }
            let across = factor * (2.0 / ((n - a) * (n + a))).sqrt();
            add(&[(t, -across * ds), (r, across * dt)], 0.0, 0.0);
        }
        let along = basis.tr_mul(x);
        for j in 0..p {
            let mut row = DVector::zeros(p + 1);
            row[j] = 1.0 / load;
            rows.push(Row::new(row, -along[j] / load));
        }
        Self { rows }
    }

    /// Adds a square that depends on s alone.
    pub fn add(&mut self, by_s: f64, right: f64) {
        let Some(size) = self.rows.first().map(|row| row.entries.len()) else { return };
        let mut row = DVector::zeros(size);
        row[size - 1] = by_s;
        self.rows.push(Row::new(row, right));
    }

    /// The Newton step of the first `variables` variables, with the rate `along` of the last variable, and
    /// its length in the metric of the Hessian.
    pub fn step(mut self, variables: usize, along: f64) -> Option<(DVector<f64>, f64)> {
        // Large rows first, so that small ones keep their digits.
        self.rows.sort_by(|one, other| other.greatest.total_cmp(&one.greatest));
        let count = self.rows.len();
        let matrix = DMatrix::from_fn(count, variables, |i, j| self.rows[i].entries[j]);
        let mut right = DVector::from_fn(count, |i, _| self.rows[i].right);
        let qr = matrix.qr();
        qr.q_tr_mul(&mut right);
        let r = qr.r();
        let mut right = right.rows(0, variables).into_owned();
        if along != 0.0 {
            let mut rate = DVector::zeros(variables);
            rate[variables - 1] = along;
            right -= r.tr_solve_upper_triangular(&rate)?;
        }
        let step = r.solve_upper_triangular(&right)?;
        let length = right.norm();
        (length.is_finite() && step.iter().all(|value| value.is_finite())).then_some((step, length))
    }
}
