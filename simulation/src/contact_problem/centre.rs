//! The analytic centre of the forces that the laws allow.
//!
//! The forces x_0 + Z y give the same motion. Each sticking contact requires u_n >= abs(u_tan), where u_tan
//! is lambda_tan / mu, and each sliding one u_n >= 0. The centre minimises the sum of -ln(u_n^2 -
//! abs(u_tan)^2), of -ln u_n, and of abs(x)^2 / (2 load^2). If these conditions are incompatible, the forces
//! whose greatest violation is least are taken.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use nalgebra::{DMatrix, DVector};

use super::{
    cone::{Cone, least_reserve},
    linear::Vector,
    squares::Squares,
};

/// How Newton steps are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum By {
    /// from the Hessian, by a Cholesky factorisation
    Hessian,
    /// from the square roots of the Hessian's terms, by orthogonal transformations: if the set of allowed
    /// forces is thin, and for cones of different kinds with shared normal forces, whose greatest common
    /// reserve lies in a corner where the Hessian is inaccurate ([`super::squares`])
    Squares,
}

/// The centre of the forces x_0 + Z y, and whether it lies inside all cones. `start` is an initial guess of
/// the forces. With `decide` the computation ends as soon as it is known that no forces lie inside.
pub(super) fn centre(
    cones: &[Cone],
    least: &DVector<f64>,
    basis: &DMatrix<f64>,
    load: f64,
    start: Option<&DVector<f64>>,
    (decide, by): (bool, By),
) -> (DVector<f64>, bool) {
    let project = |x: &DVector<f64>| least + basis * basis.tr_mul(&(x - least));
    // Forces of a state nearby are next to the centre, however thin the set is.
    let starts = start.map(|start| (project(start), NEAR)).into_iter().chain([(least.clone(), START)]);
    let follow_on = |x: DVector<f64>| {
        let x = follow(cones, basis, load, x, by);
        // If the set of allowed forces is thin, the Hessian is inaccurate along it.
        let thin = by == By::Hessian && least_reserve(cones, &x) < THIN * load;
        if thin { follow(cones, basis, load, x, By::Squares) } else { x }
    };
    for (x, reserve) in starts {
        if least_reserve(cones, &x) > reserve * load {
            return (follow_on(x), true);
        }
    }
    let entered = match enter(cones, basis, load, least.clone(), (decide, by)) {
        // Where so little is left the Hessian does not tell whether any forces are allowed.
        Err(x) if by == By::Hessian && least_reserve(cones, &x).abs() < THIN * load => {
            enter(cones, basis, load, x, (decide, By::Squares))
        }
        entered => entered,
    };
    match entered {
        Ok(x) => (follow_on(x), true),
        Err(x) => (x, false),
    }
}

/// Reserves at which the path to the centre may start, relative to the load: from any forces, and from those of a state
/// nearby.
const START: f64 = 1e-3;
const NEAR: f64 = 1e-6;

/// Reserves below this part of the load have terms in the Hessian beside which the squares of others lose
/// half of their digits.
const THIN: f64 = 1e-4;

/// Gradient and Hessian of the barrier with respect to y and to the reserve s of all cones, and of the
/// square.
struct Barrier {
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

/// The barrier of the cones reduced by `s`; the last variable is s. Of the Hessian the lower triangle is
/// computed, which is what its factorisation reads. `rows` is the transposed basis.
fn barrier(cones: &[Cone], rows: &DMatrix<f64>, load: f64, x: &DVector<f64>, s: f64) -> Barrier {
    let p = rows.nrows();
    let mut by_x = DVector::zeros(x.len());
    // Rows of the Hessian with respect to x, times the basis; added contact by contact.
    let mut gradient = DVector::zeros(p + 1);
    let mut hessian = DMatrix::zeros(p + 1, p + 1);
    let mut row = Vector::zeros(p + 1);
    let mut add_square = |factor: f64, parts: &[(usize, f64)], by_s: f64| {
        fill_row(&mut row, rows, parts, by_s);
        for (j, column) in hessian.as_mut_slice().chunks_exact_mut(p + 1).enumerate() {
            let scaled = factor * row[j];
            column[j..].iter_mut().zip(&row[j..]).for_each(|(entry, own)| *entry += scaled * own);
        }
    };
    let square = 1.0 / (load * load);
    for cone in cones {
        let n = x[cone.normal] - s;
        let Some((t, r, factor)) = cone.tangential else {
            by_x[cone.normal] -= 1.0 / n;
            gradient[p] += 1.0 / n;
            add_square(1.0, &[(cone.normal, 1.0 / n)], -1.0 / n);
            continue;
        };
        let (ut, us) = (factor * x[t], factor * x[r]);
        let size = hypot(ut, us);
        let q = (n - size) * (n + size);
        // -ln q with q = n^2 - ut^2 - us^2.
        let (dn, dt, ds) = (-2.0 * n / q, 2.0 * ut / q, 2.0 * us / q);
        by_x[cone.normal] += dn;
        by_x[t] += factor * dt;
        by_x[r] += factor * ds;
        gradient[p] -= dn;
        add_square(1.0, &[(cone.normal, dn), (t, factor * dt), (r, factor * ds)], -dn);
        add_square(-2.0 / q, &[(cone.normal, 1.0)], -1.0);
        for axis in [t, r] {
            add_square(2.0 / q, &[(axis, factor)], 0.0);
        }
    }
    by_x.axpy(square, x, 1.0);
    for (along, row) in by_x.iter().zip(rows.as_slice().chunks_exact(p.max(1))) {
        gradient.as_mut_slice()[..p].iter_mut().zip(row).for_each(|(sum, part)| *sum += along * part);
    }
    for i in 0..p {
        hessian[(i, i)] += square;
    }
    Barrier { gradient, hessian }
}

/// The derivative with respect to (y, s) of a sum of components of x and of s.
fn fill_row(row: &mut [f64], rows: &DMatrix<f64>, parts: &[(usize, f64)], by_s: f64) {
    let p = rows.nrows();
    row[..p].fill(0.0);
    for &(place, factor) in parts {
        let own = &rows.as_slice()[place * p..][..p];
        row.iter_mut().zip(own).for_each(|(sum, part)| *sum += factor * part);
    }
    row[p] = by_s;
}

/// Newton's method to the centre, from forces inside all cones.
fn follow(cones: &[Cone], basis: &DMatrix<f64>, load: f64, mut x: DVector<f64>, by: By) -> DVector<f64> {
    let p = basis.ncols();
    let rows = basis.transpose();
    let newton = |x: &DVector<f64>| match by {
        By::Hessian => {
            let Barrier { gradient, hessian } = barrier(cones, &rows, load, x, 0.0);
            let right = -gradient.rows(0, p);
            let factors = hessian.view((0, 0), (p, p)).into_owned().cholesky()?;
            let step = factors.solve(&right);
            // The length of the step in the local metric of the barrier.
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

/// Forces inside all cones, or those with the greatest least reserve.
fn enter(
    cones: &[Cone],
    basis: &DMatrix<f64>,
    load: f64,
    mut x: DVector<f64>,
    (decide, by): (bool, By),
) -> Result<DVector<f64>, DVector<f64>> {
    let p = basis.ncols();
    let rows = basis.transpose();
    // Besides the barrier -weight s / load, and s below the load.
    let newton = |x: &DVector<f64>, s: f64, weight: f64| {
        let room = load - s;
        match by {
            By::Hessian => {
                let Barrier { mut gradient, mut hessian } = barrier(cones, &rows, load, x, s);
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
    // On the path the distance of s from its maximum is the degree over the weight.
    let degree = 2.0 * cones.len() as f64 + 1.0;
    while degree / weight > GAP {
        let mut moved = false;
        for _ in 0..INNER {
            let Some((step, length)) = newton(&x, s, weight) else { break };
            let change = basis * step.rows(0, p);
            let inside = |part: f64| {
                let (mut next, slack) = (x.clone(), s + step[p] * part);
                next.axpy(part, &change, 1.0);
                (least_reserve(cones, &next) > slack && slack < load).then_some((next, slack))
            };
            // Far from the path the step is as long as the cones allow, near it a full step.
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

/// Largest number of Newton steps to the centre; usually 5 to 15 are needed.
const STEPS: usize = 80;

/// Distance from the greatest reserve at which the path ends, relative to the load.
const GAP: f64 = 1e-13;

/// Largest number of Newton steps for one point of the path to the greatest reserve.
const INNER: usize = 40;
