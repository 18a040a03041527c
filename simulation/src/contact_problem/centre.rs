//! The forces in the middle of those that the laws allow.
//!
//! Forces x_0 + Z y give one and the same motion. Each sticking contact asks u_n >= abs(u_tan), where u_tan is lambda_tan /
//! mu, and each sliding one u_n >= 0. The centre has the least sum of -ln(u_n^2 - abs(u_tan)^2), of -ln u_n and of
//! abs(x)^2 / (2 load^2). Where these conditions exclude each other, the forces are taken whose greatest lack of normal
//! force is least.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector};

use super::{
    cone::{Cone, least_reserve},
    squares::Squares,
};

/// How the steps of Newton's method are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum By {
    /// from the Hessian, by Cholesky
    Hessian,
    /// from its squares, by orthogonal transformations: where hardly any forces are left, and for cones of different kinds
    /// that share normal forces, whose greatest common reserve lies in a corner that the Hessian does not see
    /// ([`super::squares`])
    Squares,
}

/// The centre of the forces x_0 + Z y, and whether it lies within all cones. `start` is a first guess of the
/// forces. With `decide` it ends as soon as it is known that none do.
pub(super) fn centre(
    cones: &[Cone],
    least: &DVector<f64>,
    basis: &DMatrix<f64>,
    load: f64,
    start: Option<&DVector<f64>>,
    (decide, by): (bool, By),
) -> (DVector<f64>, bool) {
    let project = |x: &DVector<f64>| least + basis * basis.tr_mul(&(x - least));
    let starts = start.map(project).into_iter().chain([least.clone()]);
    let follow_on = |x: DVector<f64>| {
        let x = follow(cones, basis, load, x, by);
        // Where hardly any forces are left the Hessian does not see along the thin set that they form.
        let thin = by == By::Hessian && least_reserve(cones, &x) < THIN * load;
        if thin { follow(cones, basis, load, x, By::Squares) } else { x }
    };
    for x in starts {
        if least_reserve(cones, &x) > START * load {
            return (follow_on(x), true);
        }
    }
    match enter(cones, basis, load, least.clone(), (decide, by)) {
        Ok(x) => (follow_on(x), true),
        Err(x) => (x, false),
    }
}

/// A reserve with which the way to the centre may begin, beside the load.
const START: f64 = 1e-3;

/// Reserves below this part of the load have rows of the Hessian beside whose squares others lose half of their digits.
const THIN: f64 = 1e-4;

/// Gradient and Hessian of the barrier by y and by the reserve s that all cones keep, and of the square.
struct Barrier {
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

/// The barrier of the cones lessened by `s`; the last variable is s.
fn barrier(cones: &[Cone], basis: &DMatrix<f64>, load: f64, x: &DVector<f64>, s: f64) -> Barrier {
    let p = basis.ncols();
    let mut by_x = DVector::zeros(x.len());
    // Rows of the Hessian by x times the basis: added contact by contact.
    let mut gradient = DVector::zeros(p + 1);
    let mut hessian = DMatrix::zeros(p + 1, p + 1);
    let square = 1.0 / (load * load);
    for cone in cones {
        let n = x[cone.normal] - s;
        let Some((t, r, factor)) = cone.tangential else {
            by_x[cone.normal] -= 1.0 / n;
            gradient[p] += 1.0 / n;
            let row = row_of(basis, &[(cone.normal, 1.0 / n)], -1.0 / n);
            hessian.ger(1.0, &row, &row, 1.0);
            continue;
        };
        let (ut, us) = (factor * x[t], factor * x[r]);
        let size = ut.hypot(us);
        let q = (n - size) * (n + size);
        // -ln q with q = n^2 - ut^2 - us^2.
        let (dn, dt, ds) = (-2.0 * n / q, 2.0 * ut / q, 2.0 * us / q);
        by_x[cone.normal] += dn;
        by_x[t] += factor * dt;
        by_x[r] += factor * ds;
        gradient[p] -= dn;
        let row = row_of(basis, &[(cone.normal, dn), (t, factor * dt), (r, factor * ds)], -dn);
        hessian.ger(1.0, &row, &row, 1.0);
        let row = row_of(basis, &[(cone.normal, 1.0)], -1.0);
        hessian.ger(-2.0 / q, &row, &row, 1.0);
        for axis in [t, r] {
            let row = row_of(basis, &[(axis, factor)], 0.0);
            hessian.ger(2.0 / q, &row, &row, 1.0);
        }
    }
    by_x.axpy(square, x, 1.0);
    gradient.rows_mut(0, p).copy_from(&basis.tr_mul(&by_x));
    for i in 0..p {
        hessian[(i, i)] += square;
    }
    Barrier { gradient, hessian }
}

/// The derivative by (y, s) of a sum of components of x and of s.
fn row_of(basis: &DMatrix<f64>, parts: &[(usize, f64)], by_s: f64) -> DVector<f64> {
    let p = basis.ncols();
    let mut row = DVector::zeros(p + 1);
    for &(place, factor) in parts {
        for j in 0..p {
            row[j] += factor * basis[(place, j)];
        }
    }
    row[p] = by_s;
    row
}

/// Newton's method to the centre from forces within all cones.
fn follow(cones: &[Cone], basis: &DMatrix<f64>, load: f64, mut x: DVector<f64>, by: By) -> DVector<f64> {
    let p = basis.ncols();
    let newton = |x: &DVector<f64>| match by {
        By::Hessian => {
            let Barrier { gradient, hessian } = barrier(cones, basis, load, x, 0.0);
            let right = -gradient.rows(0, p);
            let factors = hessian.view((0, 0), (p, p)).into_owned().cholesky()?;
            let step = factors.solve(&right);
            // The length of the step in the metric of the barrier.
            let length = right.dot(&step).max(0.0).sqrt();
            Some((step, length))
        }
        By::Squares => Squares::new(cones, basis, load, x, 0.0).step(p, 0.0),
    };
    for _ in 0..STEPS {
        let Some((step, length)) = newton(&x) else { break };
        let part = if length > 0.25 { 1.0 / (1.0 + length) } else { 1.0 };
        let next = &x + basis * &step * part;
        if least_reserve(cones, &next) <= 0.0 {
            break;
        }
        x = next;
        if length < 1e-9 {
            break;
        }
    }
    x
}

/// Forces within all cones, or those whose least reserve is the greatest.
fn enter(
    cones: &[Cone],
    basis: &DMatrix<f64>,
    load: f64,
    mut x: DVector<f64>,
    (decide, by): (bool, By),
) -> Result<DVector<f64>, DVector<f64>> {
    let p = basis.ncols();
    // Besides the barrier -weight s / load, and s below the load.
    let newton = |x: &DVector<f64>, s: f64, weight: f64| {
        let room = load - s;
        match by {
            By::Hessian => {
                let Barrier { mut gradient, mut hessian } = barrier(cones, basis, load, x, s);
                gradient[p] += 1.0 / room - weight / load;
                hessian[(p, p)] += 1.0 / (room * room);
                let right = -gradient;
                let factors = hessian.cholesky()?;
                let step = factors.solve(&right);
                let length = right.dot(&step).max(0.0).sqrt();
                Some((step, length))
            }
            By::Squares => {
                let mut squares = Squares::new(cones, basis, load, x, s);
                squares.add(1.0 / room, -1.0);
                squares.step(p + 1, -weight / load)
            }
        }
    };
    let mut s = least_reserve(cones, &x) - load;
    let mut weight = 1.0;
    // On the path s is greatest but for the degree over the weight.
    let degree = 2.0 * cones.len() as f64 + 1.0;
    while degree / weight > GAP {
        let mut moved = false;
        for _ in 0..INNER {
            let Some((step, length)) = newton(&x, s, weight) else { break };
            let change = basis * step.rows(0, p);
            let inside = |part: f64| {
                let (next, slack) = (&x + &change * part, s + step[p] * part);
                (least_reserve(cones, &next) > slack && slack < load).then_some((next, slack))
            };
            // Far from the path as long a part as the cones allow, near it a whole step.
            let mut part = 1.0;
            let next = loop {
                match inside(part) {
                    Some(next) if part == 1.0 && length < 0.25 => break Some(next),
                    Some(_) => break inside(if length < 0.25 { part } else { 0.9 * part }),
                    None if part < 1e-9 => break None,
                    None => part *= 0.7,
                }
            };
            let Some((next, slack)) = next else { break };
            (x, s) = (next, slack);
            moved = true;
            if least_reserve(cones, &x) > START * load || (s > 0.0 && length < 0.5) {
                return Ok(x);
            }
            if length < 0.1 {
                break;
            }
        }
        if !moved || (decide && s < -2.0 * degree / weight * load) {
            break;
        }
        weight *= 30.0;
    }
    if least_reserve(cones, &x) > GAP * load { Ok(x) } else { Err(x) }
}

/// Newton steps to the centre; usual are 5 to 15.
const STEPS: usize = 80;

/// How near to the greatest reserve the path ends, beside the load.
const GAP: f64 = 1e-13;

/// Newton steps for one point of the path to the greatest reserve.
const INNER: usize = 40;
