//! The directions in which contacts begin to slip while the others keep given modes.
//!
//! The others are eliminated; of those that begin to slip a = W' lambda + beta' is left, with a_n = 0, lambda_tan =
//! -mu lambda_n d and a_tan = gamma d, gamma > 0. For given directions the normal forces follow from linear equations, so
//! that the angles are the only unknowns: the components of a_tan across d vanish.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{Mode, Problem, linear::Elimination, prescribed::SINGULAR};

/// A mode whose direction may be open.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Choice {
    Known(Mode),
    Begin,
}

/// All sets of directions found for the contacts in `open`.
pub(super) fn directions(problem: &Problem<'_>, chosen: &[Choice], open: &[usize]) -> Vec<Vec<Vector2<f64>>> {
    let reduced = Reduced::new(problem, chosen, open);
    let angles = match open {
        [_] => reduced.of_one(),
        _ => reduced.by_grid(),
    };
    angles.iter().map(|angles| angles.iter().map(|&angle| direction(angle)).collect()).collect()
}

/// Of a planar problem exactly along its axis.
fn direction(angle: f64) -> Vector2<f64> {
    let exact = |part: f64| if part.abs() <= 4.0 * f64::EPSILON { 0.0 } else { part };
    Vector2::new(exact(angle.cos()), exact(angle.sin()))
}

/// The problem of the contacts that begin to slip.
struct Reduced {
    w: DMatrix<f64>,
    beta: DVector<f64>,
    mu: Vec<f64>,
}

impl Reduced {
    fn new(problem: &Problem<'_>, chosen: &[Choice], open: &[usize]) -> Self {
        // Unknowns and equations of the others, and the forces that belong to these.
        let (mut rows, mut along): (Vec<usize>, Vec<[f64; 3]>) = (Vec::new(), Vec::new());
        for (i, choice) in chosen.iter().enumerate() {
            match choice {
                Choice::Known(Mode::Stick) if problem.mu[i] > 0.0 => {
                    rows.extend([3 * i, 3 * i + 1, 3 * i + 2]);
                    along.extend([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
                }
                Choice::Known(Mode::Stick) => {
                    rows.push(3 * i);
                    along.push([1.0, 0.0, 0.0]);
                }
                Choice::Known(Mode::Slide(d)) => {
                    rows.push(3 * i);
                    along.push([1.0, -problem.mu[i] * d.x, -problem.mu[i] * d.y]);
                }
                _ => {}
            }
        }
        let own: Vec<usize> = open.iter().flat_map(|&i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let scale: Vec<f64> = rows.iter().map(|&row| problem.scale(row / 3)).collect();
        let column = |row: usize, b: usize| -> f64 {
            let first = rows[b] - rows[b] % 3;
            (0..3).map(|axis| along[b][axis] * problem.w[(row, first + axis)]).sum()
        };
        let m = rows.len();
        let inner = DMatrix::from_fn(m, m, |a, b| scale[a] * scale[b] * column(rows[a], b));
        let elimination = Elimination::new(inner, SINGULAR);
        let solve = |right: DVector<f64>| elimination.solve(&right);
        let mut w = DMatrix::from_fn(own.len(), own.len(), |a, b| problem.w[(own[a], own[b])]);
        let mut beta = DVector::from_fn(own.len(), |a, _| problem.beta[own[a]]);
        let from = DMatrix::from_fn(own.len(), m, |a, b| scale[b] * column(own[a], b));
        if m > 0 {
            for (b, &from_own) in own.iter().enumerate() {
                let x = solve(DVector::from_fn(m, |a, _| scale[a] * problem.w[(rows[a], from_own)]));
                let mut column = w.column_mut(b);
                column -= &from * x;
            }
            beta -= &from * solve(DVector::from_fn(m, |a, _| scale[a] * problem.beta[rows[a]]));
        }
        Self { w, beta, mu: open.iter().map(|&i| problem.mu[i]).collect() }
    }

    /// Of one contact: f times the component across d is a trigonometric polynomial of degree two.
    fn of_one(&self) -> Vec<Vec<f64>> {
        let (w, beta, mu) = (&self.w, &self.beta, self.mu[0]);
        let across = |angle: f64| {
            let d = direction(angle);
            let f = w[(0, 0)] - mu * (w[(0, 1)] * d.x + w[(0, 2)] * d.y);
            let push = |row: usize| w[(row, 0)] - mu * (w[(row, 1)] * d.x + w[(row, 2)] * d.y);
            let (t, s) = (f * beta[1] - beta[0] * push(1), f * beta[2] - beta[0] * push(2));
            d.x * s - d.y * t
        };
        let step = std::f64::consts::TAU / SAMPLES as f64;
        let angles: Vec<f64> = (0..SAMPLES).map(|i| (i as f64 + 0.37) * step).collect();
        let values: Vec<f64> = angles.iter().map(|&angle| across(angle)).collect();
        let mut roots = Vec::new();
        for i in 0..SAMPLES {
            let (left, here, right) =
                (values[(i + SAMPLES - 1) % SAMPLES], values[i], values[(i + 1) % SAMPLES]);
            if (here > 0.0) != (right > 0.0) {
                roots.push(vec![zero(&across, angles[i], angles[i] + step)]);
            } else if here.abs() < left.abs() && here.abs() <= right.abs() && (here > 0.0) == (left > 0.0) {
                // Two zeros may lie between the samples, on both sides of an extremum.
                let curved = left - 2.0 * here + right;
                let top = angles[i] + 0.5 * step * (left - right) / curved;
                if curved != 0.0 && (across(top) > 0.0) != (here > 0.0) {
                    roots.push(vec![zero(&across, angles[i] - step, top)]);
                    roots.push(vec![zero(&across, top, angles[i] + step)]);
                }
            }
        }
        roots
    }

    /// Of several: Newton's method from a grid of directions.
    fn by_grid(&self) -> Vec<Vec<f64>> {
        let u = self.mu.len();
        let count: usize = [1, 32, 12, 8, 6][u.min(4)];
        let step = std::f64::consts::TAU / count as f64;
        let mut found: Vec<Vec<f64>> = Vec::new();
        for number in 0..count.pow(u as u32) {
            let mut left = number;
            let mut angles = Vec::with_capacity(u);
            for j in 0..u {
                angles.push((left % count) as f64 * step + 0.31 * (j + 1) as f64);
                left /= count;
            }
            let Some(angles) = self.newton(angles) else { continue };
            let near = |other: &Vec<f64>| {
                other.iter().zip(&angles).all(|(a, b)| (direction(*a) - direction(*b)).norm() < 1e-6)
            };
            if !found.iter().any(near) {
                found.push(angles);
            }
        }
        found
    }

    /// Newton's method on the components of a_tan across the directions; `None` where it does not come to directions with
    /// gamma >= 0 and lambda_n >= 0.
    fn newton(&self, mut angles: Vec<f64>) -> Option<Vec<f64>> {
        let size = self.beta.amax();
        let mut last = f64::INFINITY;
        for round in 0..ROUNDS {
            let Across { value, rates, fits } = self.across(&angles)?;
            let norm = value.amax();
            if norm <= 1e-13 * size {
                return fits.then_some(angles);
            }
            if round > 12 && norm > 0.9 * last {
                return (norm <= 1e-9 * size && fits).then_some(angles);
            }
            last = norm;
            let step = rates.lu().solve(&value)?;
            let longest = step.amax();
            let part = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            for (angle, step) in angles.iter_mut().zip(step.iter()) {
                *angle -= part * step;
            }
        }
        None
    }

    /// The components of a_tan across the directions, and their derivatives by the angles.
    fn across(&self, angles: &[f64]) -> Option<Across> {
        let (w, u) = (&self.w, angles.len());
        let d: Vec<Vector2<f64>> = angles.iter().map(|&angle| direction(angle)).collect();
        let turned: Vec<Vector2<f64>> = d.iter().map(|d| Vector2::new(-d.y, d.x)).collect();
        // What a normal force with its friction does to a row, and how that changes with the angle.
        let push = |row: usize, j: usize| {
            w[(row, 3 * j)] - self.mu[j] * (w[(row, 3 * j + 1)] * d[j].x + w[(row, 3 * j + 2)] * d[j].y)
        };
        let turn = |row: usize, j: usize| {
            -self.mu[j] * (w[(row, 3 * j + 1)] * turned[j].x + w[(row, 3 * j + 2)] * turned[j].y)
        };
        let normal = DMatrix::from_fn(u, u, |i, j| push(3 * i, j)).lu();
        let lambda = normal.solve(&DVector::from_fn(u, |i, _| -self.beta[3 * i]))?;
        let a = |row: usize| self.beta[row] + (0..u).map(|j| push(row, j) * lambda[j]).sum::<f64>();
        let tangential: Vec<Vector2<f64>> =
            (0..u).map(|i| Vector2::new(a(3 * i + 1), a(3 * i + 2))).collect();
        let value = DVector::from_fn(u, |i, _| turned[i].dot(&tangential[i]));
        let mut rates = DMatrix::zeros(u, u);
        for j in 0..u {
            let change = normal.solve(&DVector::from_fn(u, |i, _| -turn(3 * i, j) * lambda[j]))?;
            for i in 0..u {
                let rate = |row: usize| {
                    turn(row, j) * lambda[j] + (0..u).map(|l| push(row, l) * change[l]).sum::<f64>()
                };
                rates[(i, j)] = turned[i].x * rate(3 * i + 1) + turned[i].y * rate(3 * i + 2);
            }
            rates[(j, j)] -= d[j].dot(&tangential[j]);
        }
        let fits = (0..u).all(|i| lambda[i] >= 0.0 && d[i].dot(&tangential[i]) >= 0.0);
        value.iter().all(|value| value.is_finite()).then_some(Across { value, rates, fits })
    }
}

struct Across {
    value: DVector<f64>,
    rates: DMatrix<f64>,
    fits: bool,
}

/// Samples around the circle, and rounds of Newton's method.
const SAMPLES: usize = 256;
const ROUNDS: usize = 30;

/// The zero between two angles with values of unlike sign: bisection with secants.
fn zero(function: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (function(low), function(high));
    for round in 0..200 {
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let inside = secant > low && secant < high && round % 3 != 2;
        let next = if inside { secant } else { 0.5 * (low + high) };
        if next <= low || next >= high {
            break;
        }
        let value = function(next);
        if value == 0.0 {
            return next;
        }
        if (value > 0.0) == (at_low > 0.0) {
            (low, at_low) = (next, value);
        } else {
            (high, at_high) = (next, value);
        }
    }
    if at_low.abs() < at_high.abs() { low } else { high }
}
