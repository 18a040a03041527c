//! The directions in which contacts begin to slip while the others keep given modes.
//!
//! The others are eliminated. For the contacts that begin to slip a = W' lambda + beta' remains, with a_n =
//! 0, lambda_tan = -mu lambda_n d and a_tan = gamma d, gamma > 0. For given directions the normal forces
//! follow from linear equations, so that the angles are the only unknowns: the components of a_tan
//! perpendicular to d vanish.
//!
//! Theory: docs/theory.md, section 17.10.

use std::sync::LazyLock;

use nalgebra::{DMatrix, DVector, Vector2};

use super::{
    Mode, Problem,
    linear::{Elimination, SINGULAR, Square, Vector, vector},
};

/// A mode whose direction may be unknown.
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

/// In a planar problem the direction is exactly along its axis.
fn direction(angle: f64) -> Vector2<f64> {
    let exact = |part: f64| if part.abs() <= 4.0 * f64::EPSILON { 0.0 } else { part };
    Vector2::new(exact(angle.cos()), exact(angle.sin()))
}

fn unit(angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin())
}

/// The directions at which the function of one contact is sampled: number, the first angle in steps, and the step.
const SAMPLES: usize = 256;
const FIRST: f64 = 0.37;
const STEP: f64 = std::f64::consts::TAU / SAMPLES as f64;
static CIRCLE: LazyLock<[Vector2<f64>; SAMPLES]> =
    LazyLock::new(|| std::array::from_fn(|i| direction((i as f64 + FIRST) * STEP)));

/// The points of a grid of directions of several contacts.
struct Grid {
    side: usize,
    size: usize,
    /// between neighbours along each axis
    strides: [usize; MOST],
}

impl Grid {
    fn new(contacts: usize) -> Self {
        let side: usize = [1, 32, 12, 8, 6][contacts.min(MOST)];
        Self { side, size: side.pow(contacts as u32), strides: std::array::from_fn(|j| side.pow(j as u32)) }
    }

    /// Where a point lies along an axis.
    fn place(&self, number: usize, axis: usize) -> usize {
        number / self.strides[axis] % self.side
    }

    fn angle(&self, place: usize, axis: usize) -> f64 {
        place as f64 * std::f64::consts::TAU / self.side as f64 + 0.31 * (axis + 1) as f64
    }

    /// The point so many steps further around an axis.
    fn beside(&self, number: usize, axis: usize, steps: usize) -> usize {
        let place = self.place(number, axis);
        number + ((place + steps) % self.side) * self.strides[axis] - place * self.strides[axis]
    }
}

/// The problem of the contacts that begin to slip.
struct Reduced {
    w: [[f64; 3 * MOST]; 3 * MOST],
    beta: [f64; 3 * MOST],
    mu: [f64; MOST],
    /// number of contacts
    count: usize,
}

/// The greatest number of contacts of which all modes are tried.
pub const MOST_ENUMERATED: usize = 4;
/// The largest number of contacts that begin to slip.
const MOST: usize = MOST_ENUMERATED;

impl Reduced {
    fn new(problem: &Problem<'_>, chosen: &[Choice], open: &[usize]) -> Self {
        // Unknowns and equations of the other contacts, and their forces.
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
        let mut inner = Square::zeros(m * m);
        for (b, entries) in inner.chunks_exact_mut(m.max(1)).enumerate() {
            entries.iter_mut().enumerate().for_each(|(a, w)| *w = scale[a] * scale[b] * column(rows[a], b));
        }
        let elimination = Elimination::new(inner, m, SINGULAR);
        let solve = |right: Vector| DVector::from_column_slice(&elimination.solve(&right));
        let mut w = DMatrix::from_fn(own.len(), own.len(), |a, b| problem.w[(own[a], own[b])]);
        let mut beta = DVector::from_fn(own.len(), |a, _| problem.beta[own[a]]);
        let from = DMatrix::from_fn(own.len(), m, |a, b| scale[b] * column(own[a], b));
        if m > 0 {
            for (b, &from_own) in own.iter().enumerate() {
                let x = solve(vector(m, |a| scale[a] * problem.w[(rows[a], from_own)]));
                let mut column = w.column_mut(b);
                column -= &from * x;
            }
            beta -= &from * solve(vector(m, |a| scale[a] * problem.beta[rows[a]]));
        }
        let mut reduced =
            Self { w: Default::default(), beta: [0.0; 3 * MOST], mu: [0.0; MOST], count: open.len() };
        for (row, entries) in reduced.w.iter_mut().enumerate().take(own.len()) {
            reduced.beta[row] = beta[row];
            entries.iter_mut().zip(w.row(row).iter()).for_each(|(entry, w)| *entry = *w);
        }
        reduced.mu.iter_mut().zip(open).for_each(|(mu, &i)| *mu = problem.mu[i]);
        reduced
    }

    /// For one contact: f times the perpendicular component is a trigonometric polynomial of degree two.
    fn of_one(&self) -> Vec<Vec<f64>> {
        let (w, beta, mu) = (&self.w, &self.beta, self.mu[0]);
        // f times an acceleration along the surface: a constant, and factors of the components of d.
        let along = |row: usize| {
            let part = |column: usize| w[0][column] * beta[row] - beta[0] * w[row][column];
            [part(0), -mu * part(1), -mu * part(2)]
        };
        let (t, s) = (along(1), along(2));
        let of = |[c, x, y]: [f64; 3], d: &Vector2<f64>| c + x * d.x + y * d.y;
        let across = |d: &Vector2<f64>| d.x * of(s, d) - d.y * of(t, d);
        let at = |angle: f64| across(&direction(angle));
        let values: Vec<f64> = CIRCLE.iter().map(across).collect();
        let angle = |i: usize| (i as f64 + FIRST) * STEP;
        let mut roots = Vec::new();
        for i in 0..SAMPLES {
            let (left, here, right) =
                (values[(i + SAMPLES - 1) % SAMPLES], values[i], values[(i + 1) % SAMPLES]);
            if (here > 0.0) != (right > 0.0) {
                roots.push(vec![zero(&at, angle(i), angle(i) + STEP)]);
            } else if here.abs() < left.abs() && here.abs() <= right.abs() && (here > 0.0) == (left > 0.0) {
                // Two zeros may lie between samples, on both sides of an extremum.
                let curved = left - 2.0 * here + right;
                let top = angle(i) + 0.5 * STEP * (left - right) / curved;
                if curved != 0.0 && (at(top) > 0.0) != (here > 0.0) {
                    roots.push(vec![zero(&at, angle(i) - STEP, top)]);
                    roots.push(vec![zero(&at, top, angle(i) + STEP)]);
                }
            }
        }
        roots
    }

    /// For several contacts: Newton's method from the cells of a grid of directions in which all
    /// perpendicular components change sign, or are smallest.
    fn by_grid(&self) -> Vec<Vec<f64>> {
        let u = self.count;
        let grid = Grid::new(u);
        let units: Vec<Vec<Vector2<f64>>> =
            (0..u).map(|j| (0..grid.side).map(|place| unit(grid.angle(place, j))).collect()).collect();
        let mut values = vec![[0.0; MOST]; grid.size];
        for (number, values) in values.iter_mut().enumerate() {
            let mut d = [Vector2::zeros(); MOST];
            (0..u).for_each(|j| d[j] = units[j][grid.place(number, j)]);
            *values = self.smooth(&d);
        }
        let norms: Vec<f64> =
            values.iter().map(|values| values.iter().map(|value| value * value).sum()).collect();
        // Which components are positive somewhere, and which everywhere, on the corners of the cell that begins at a point.
        let positive = values.iter().map(|values| (0..u).map(|j| u8::from(values[j] > 0.0) << j).sum());
        let mut somewhere: Vec<u8> = positive.collect();
        let mut everywhere = somewhere.clone();
        let mut least = vec![true; grid.size];
        for j in 0..u {
            let (some, all) = (somewhere.clone(), everywhere.clone());
            for number in 0..grid.size {
                let (next, before) = (grid.beside(number, j, 1), grid.beside(number, j, grid.side - 1));
                somewhere[number] |= some[next];
                everywhere[number] &= all[next];
                least[number] &= norms[number] <= norms[next] && norms[number] <= norms[before];
            }
        }
        let changes = |number: usize| somewhere[number] == (1 << u) - 1 && everywhere[number] == 0;
        let mut found: Vec<Vec<f64>> = Vec::new();
        for number in (0..grid.size).filter(|&number| least[number] || changes(number)) {
            let mut start = [0.0; MOST];
            (0..u).for_each(|j| start[j] = grid.angle(grid.place(number, j), j));
            let Some(angles) = self.newton(start) else { continue };
            let angles = &angles[..u];
            let near = |other: &Vec<f64>| {
                other.iter().zip(angles).all(|(a, b)| (direction(*a) - direction(*b)).norm() < 1e-6)
            };
            if !found.iter().any(near) {
                found.push(angles.to_vec());
            }
        }
        found
    }

    /// Newton's method for the perpendicular components of a_tan; `None` if it does not converge to
    /// directions with gamma >= 0 and lambda_n >= 0.
    fn newton(&self, mut angles: [f64; MOST]) -> Option<[f64; MOST]> {
        let u = self.count;
        let greatest = |values: &[f64]| values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let size = greatest(&self.beta);
        let mut last = f64::INFINITY;
        for round in 0..ROUNDS {
            let Across { value, rates, fits } = self.across(&angles)?;
            let norm = greatest(&value);
            if norm <= 1e-13 * size {
                return fits.then_some(angles);
            }
            if round > 12 && norm > 0.9 * last {
                return (norm <= 1e-9 * size && fits).then_some(angles);
            }
            last = norm;
            let step = Small::new(rates, u)?.solve(value);
            let longest = greatest(&step);
            let part = if longest > 0.5 { 0.5 / longest } else { 1.0 };
            for (angle, step) in angles.iter_mut().zip(step) {
                *angle -= part * step;
            }
        }
        None
    }

    /// The contribution of a unit normal force with its friction along d to a row.
    fn push(&self, row: usize, j: usize, d: &Vector2<f64>) -> f64 {
        let w = &self.w[row];
        w[3 * j] - self.mu[j] * (w[3 * j + 1] * d.x + w[3 * j + 2] * d.y)
    }

    /// Accelerations along t and s, normal forces, and the equations of these, for slip along `d`.
    fn moving(&self, d: &[Vector2<f64>; MOST]) -> Option<Moving> {
        let u = self.count;
        let mut normal = [[0.0; MOST]; MOST];
        let mut right = [0.0; MOST];
        for i in 0..u {
            right[i] = -self.beta[3 * i];
            for j in 0..u {
                normal[i][j] = self.push(3 * i, j, &d[j]);
            }
        }
        let normal = Small::new(normal, u)?;
        let lambda = normal.solve(right);
        let mut tangential = [Vector2::zeros(); MOST];
        for (i, tangential) in tangential.iter_mut().enumerate().take(u) {
            let a = |row: usize| {
                self.beta[row] + (0..u).map(|j| self.push(row, j, &d[j]) * lambda[j]).sum::<f64>()
            };
            *tangential = Vector2::new(a(3 * i + 1), a(3 * i + 2));
        }
        Some(Moving { tangential, lambda, normal })
    }

    /// The perpendicular components of a_tan times the determinant of the equations of the normal forces: a
    /// function without poles.
    fn smooth(&self, d: &[Vector2<f64>; MOST]) -> [f64; MOST] {
        let mut values = [f64::MAX.sqrt(); MOST];
        if let Some(Moving { tangential, normal, .. }) = self.moving(d) {
            for (value, (d, a)) in values.iter_mut().zip(d.iter().zip(&tangential)) {
                *value = normal.determinant * (d.x * a.y - d.y * a.x);
            }
        }
        values
    }

    /// The perpendicular components of a_tan, and their derivatives with respect to the angles.
    fn across(&self, angles: &[f64; MOST]) -> Option<Across> {
        let u = self.count;
        let mut d = [Vector2::zeros(); MOST];
        d.iter_mut().zip(angles).take(u).for_each(|(d, &angle)| *d = unit(angle));
        let Moving { tangential, lambda, normal } = self.moving(&d)?;
        let turned = d.map(|d| Vector2::new(-d.y, d.x));
        // The derivative of the contribution of a normal force with respect to its angle.
        let turn = |row: usize, j: usize| {
            let w = &self.w[row];
            -self.mu[j] * (w[3 * j + 1] * turned[j].x + w[3 * j + 2] * turned[j].y)
        };
        let mut value = [0.0; MOST];
        for (value, (turned, a)) in value.iter_mut().zip(turned.iter().zip(&tangential)) {
            *value = turned.dot(a);
        }
        let mut rates = [[0.0; MOST]; MOST];
        for j in 0..u {
            let mut right = [0.0; MOST];
            for (i, right) in right.iter_mut().enumerate().take(u) {
                *right = -turn(3 * i, j) * lambda[j];
            }
            let change = normal.solve(right);
            for i in 0..u {
                let rate = |row: usize| {
                    turn(row, j) * lambda[j]
                        + (0..u).map(|l| self.push(row, l, &d[l]) * change[l]).sum::<f64>()
                };
                rates[i][j] = turned[i].x * rate(3 * i + 1) + turned[i].y * rate(3 * i + 2);
            }
            rates[j][j] -= d[j].dot(&tangential[j]);
        }
        let fits = (0..u).all(|i| lambda[i] >= 0.0 && d[i].dot(&tangential[i]) >= 0.0);
        value.iter().all(|value| value.is_finite()).then_some(Across { value, rates, fits })
    }
}

struct Moving {
    tangential: [Vector2<f64>; MOST],
    lambda: [f64; MOST],
    normal: Small,
}

struct Across {
    value: [f64; MOST],
    rates: [[f64; MOST]; MOST],
    fits: bool,
}

/// A small system of linear equations, eliminated with column pivoting.
struct Small {
    lu: [[f64; MOST]; MOST],
    rows: [usize; MOST],
    count: usize,
    determinant: f64,
}

impl Small {
    /// `None` for a singular matrix.
    fn new(mut lu: [[f64; MOST]; MOST], count: usize) -> Option<Self> {
        let (mut rows, mut determinant) = ([0, 1, 2, 3], 1.0);
        for j in 0..count {
            let pivot = (j..count).max_by(|&a, &b| lu[a][j].abs().total_cmp(&lu[b][j].abs()))?;
            if pivot != j {
                lu.swap(pivot, j);
                rows.swap(pivot, j);
                determinant = -determinant;
            }
            determinant *= lu[j][j];
            if lu[j][j] == 0.0 || !lu[j][j].is_finite() {
                return None;
            }
            let pivot_row = lu[j];
            for row in &mut lu[j + 1..count] {
                let factor = row[j] / pivot_row[j];
                row[j] = factor;
                for (entry, above) in row[j + 1..count].iter_mut().zip(&pivot_row[j + 1..count]) {
                    *entry -= factor * above;
                }
            }
        }
        Some(Self { lu, rows, count, determinant })
    }

    fn solve(&self, right: [f64; MOST]) -> [f64; MOST] {
        let mut x = [0.0; MOST];
        for i in 0..self.count {
            x[i] = right[self.rows[i]] - (0..i).map(|j| self.lu[i][j] * x[j]).sum::<f64>();
        }
        for i in (0..self.count).rev() {
            let known: f64 = (i + 1..self.count).map(|j| self.lu[i][j] * x[j]).sum();
            x[i] = (x[i] - known) / self.lu[i][i];
        }
        x
    }
}

/// Largest number of Newton steps.
const ROUNDS: usize = 30;

/// The zero between two angles with values of opposite sign: bisection and secants.
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
