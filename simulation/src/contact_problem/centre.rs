//! The analytic centre of the forces that the laws allow.
//!
//! The forces x_0 + Z y give the same motion. Each sticking contact requires u_n >= abs(u_tan), where u_tan
//! is lambda_tan / mu, and each sliding one u_n >= 0. The centre minimises the sum of -ln(u_n^2 -
//! abs(u_tan)^2), of -ln u_n, and of abs(x)^2 / (2 load^2). If these conditions are incompatible, the forces
//! whose greatest violation is least are taken.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector};

use super::{
    barrier::Barrier,
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

/// Newton's steps on the barrier.
struct Steps<'c> {
    cones: &'c [Cone],
    basis: &'c DMatrix<f64>,
    load: f64,
    /// without it steps are computed from squares
    barrier: Option<Barrier<'c>>,
}

impl<'c> Steps<'c> {
    fn new(cones: &'c [Cone], basis: &'c DMatrix<f64>, load: f64, by: By) -> Self {
        let barrier = (by == By::Hessian).then(|| Barrier::new(cones, basis, load));
        Self { cones, basis, load, barrier }
    }

    /// The step of y at these forces; its length in the local metric of the barrier.
    fn of_forces(&mut self, x: &DVector<f64>, step: &mut [f64]) -> Option<f64> {
        if let Some(barrier) = &mut self.barrier {
            barrier.evaluate(x.as_slice(), 0.0);
            return barrier.step(step);
        }
        by_squares(Squares::new(self.cones, self.basis, self.load, x, 0.0), 0.0, step)
    }

    /// The step of y and s where, besides, there are the barrier -weight s / load, and that of s below the load.
    fn of_reserve(&mut self, x: &DVector<f64>, s: f64, weight: f64, step: &mut [f64]) -> Option<f64> {
        let (room, along) = (self.load - s, weight / self.load);
        if let Some(barrier) = &mut self.barrier {
            barrier.evaluate(x.as_slice(), s);
            barrier.add(1.0 / room - along, 1.0 / (room * room));
            return barrier.step(step);
        }
        let mut squares = Squares::new(self.cones, self.basis, self.load, x, s);
        squares.add(1.0 / room, -1.0);
        by_squares(squares, -along, step)
    }
}

fn by_squares(squares: Squares, along: f64, step: &mut [f64]) -> Option<f64> {
    let (found, length) = squares.step(step.len(), along)?;
    step.copy_from_slice(found.as_slice());
    Some(length)
}

/// Writes `part` of the change of forces along the basis by `step`, added to the forces.
fn moved(x: &DVector<f64>, basis: &DMatrix<f64>, step: &[f64], part: f64, out: &mut DVector<f64>) {
    out.copy_from(x);
    for (column, by) in basis.as_slice().chunks_exact(x.len().max(1)).zip(step) {
        out.iter_mut().zip(column).for_each(|(out, along)| *out += part * by * along);
    }
}

/// Newton's method to the centre, from forces inside all cones.
fn follow(cones: &[Cone], basis: &DMatrix<f64>, load: f64, mut x: DVector<f64>, by: By) -> DVector<f64> {
    let mut steps = Steps::new(cones, basis, load, by);
    let mut step = Vector::zeros(basis.ncols());
    let mut next = x.clone();
    for _ in 0..STEPS {
        let Some(length) = steps.of_forces(&x, &mut step) else { break };
        let part = if length > 0.25 { 1.0 / (1.0 + length) } else { 1.0 };
        moved(&x, basis, &step, part, &mut next);
        if least_reserve(cones, &next) <= 0.0 {
            break;
        }
        std::mem::swap(&mut x, &mut next);
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
    let mut steps = Steps::new(cones, basis, load, by);
    let (mut step, mut next) = (Vector::zeros(p + 1), x.clone());
    let mut s = least_reserve(cones, &x) - load;
    let mut weight = 1.0;
    // On the path the distance of s from its maximum is the degree over the weight.
    let degree = 2.0 * cones.len() as f64 + 1.0;
    while degree / weight > GAP {
        let mut has_moved = false;
        for _ in 0..INNER {
            let Some(length) = steps.of_reserve(&x, s, weight, &mut step) else { break };
            let mut inside = |part: f64| {
                let slack = s + step[p] * part;
                moved(&x, basis, &step[..p], part, &mut next);
                (least_reserve(cones, &next) > slack && slack < load).then_some(slack)
            };
            // Far from the path the step is as long as the cones allow, near it a full step.
            let mut part = 1.0;
            let slack = loop {
                match inside(part) {
                    Some(slack) if part == 1.0 && length < 0.25 => break Some(slack),
                    Some(_) => break inside(if length < 0.25 { part } else { 0.9 * part }),
                    None if part < 1e-9 => break None,
                    None => part *= 0.7,
                }
            };
            let Some(slack) = slack else { break };
            std::mem::swap(&mut x, &mut next);
            s = slack;
            has_moved = true;
            if least_reserve(cones, &x) > START * load || (s > 0.0 && length < 0.5) {
                return Ok(x);
            }
            if length < 0.1 {
                break;
            }
        }
        if !has_moved || (decide && s < -2.0 * degree / weight * load) {
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
