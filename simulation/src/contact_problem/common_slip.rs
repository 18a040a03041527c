//! Directions of slip that begins very slowly.
//!
//! If friction is hardly exceeded, the accelerations of slip are small compared with forces over masses, and
//! their directions cannot be computed as differences of these: for a box that begins to slide with 1e-9 g on
//! its four corners the directions would be accurate only to 1e-7 rad. But the accelerations of the points of
//! a body are not independent. Here the unknown is the common motion: the accelerations that the mechanism
//! can give to all of these contacts at once, while the others keep their modes. The directions are then
//! accurate to rounding.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector, SymmetricEigen, Vector2};

use super::{
    Mode, Problem,
    linear::{Elimination, SINGULAR, Square, Vector, vector},
    prescribed::{Admissible, with_modes_near},
};

/// Largest number of Newton steps, and the change of directions that counts as zero, rad.
const ROUNDS: usize = 40;
const TURNED: f64 = 4e-15;
const NEARLY: f64 = 1e-11;
/// The square of an angle, rad^2: directions that differ by less from those of a motion are taken for its own.
const EQUAL: f64 = 1e-6;
/// Least cosine of the angle between a contact's direction and its first common motion.
const FORWARD: f64 = 0.5;

/// Modes in which each of these contacts slips along its own acceleration, computed from modes with similar
/// directions; `None` if there is no such common motion. `across` holds the required accelerations
/// perpendicular to the directions of existing slip, which may grow or decrease; without them slip begins.
pub(crate) fn slip_together(
    problem: &Problem<'_>,
    modes: &[Mode],
    open: &[usize],
    across: Option<&[f64]>,
    force: &DVector<f64>,
) -> Option<Vec<Mode>> {
    let common = CommonMotion::new(problem, modes, open)?;
    let mut modes = modes.to_vec();
    let mut found = with_modes_near(problem, &modes, Some(force)).ok()?;
    let wanted = |(j, &i): (usize, &usize)| across.map_or(0.0, |across| across[j] * problem.scale(i));
    let wanted: Vec<f64> = open.iter().enumerate().map(wanted).collect();
    let (mut y, sign) = common.start(problem, &modes, &found, (across.is_none(), &wanted))?;
    let mut last = f64::INFINITY;
    for _ in 0..ROUNDS {
        let step = common.step(problem, &modes, &found, &y, sign, &wanted)?;
        let (motion, change) = (&common.basis * &y, &common.basis * &step);
        let parts = (0..open.len()).map(|j| two(&change, j).norm() / two(&motion, j).norm());
        let part = (0.5 / parts.fold(0.0, f64::max)).min(1.0);
        y += part * step;
        let before = modes.clone();
        common.directions(&mut modes, &y, sign, &wanted)?;
        let turned = open.iter().map(|&i| angle(&before[i], &modes[i])).fold(0.0, f64::max);
        found = with_modes_near(problem, &modes, Some(&found.force)).ok()?;
        if turned <= TURNED || (turned <= NEARLY && turned >= 0.5 * last) {
            return Some(modes);
        }
        last = turned;
    }
    None
}

/// The accelerations that contacts can have while the others keep their modes, in the units of the problem.
struct CommonMotion<'a> {
    open: &'a [usize],
    /// rows of the other equations: normals of all pressed contacts, and friction of the sticking ones
    held: Vec<usize>,
    /// rows of the tangential accelerations of the contacts that slip
    rows: Vec<usize>,
    /// an orthonormal basis of these motions
    basis: DMatrix<f64>,
}

impl<'a> CommonMotion<'a> {
    fn new(problem: &Problem<'_>, modes: &[Mode], open: &'a [usize]) -> Option<Self> {
        let mut held = Vec::new();
        for (i, mode) in modes.iter().enumerate() {
            match mode {
                Mode::Separate => {}
                Mode::Stick if problem.mu[i] > 0.0 => held.extend([3 * i, 3 * i + 1, 3 * i + 2]),
                _ => held.push(3 * i),
            }
        }
        let rows: Vec<usize> = open.iter().flat_map(|&i| [3 * i + 1, 3 * i + 2]).collect();
        // The Schur complement of W after elimination of the other contacts.
        let elimination = Elimination::new(square(&held, &held, problem), held.len(), SINGULAR);
        let mut left = DMatrix::from_fn(rows.len(), rows.len(), |a, b| entry(problem, rows[a], rows[b]));
        for b in 0..rows.len() {
            let x = elimination.solve(&vector(held.len(), |a| entry(problem, held[a], rows[b])));
            for a in 0..rows.len() {
                left[(a, b)] -=
                    held.iter().zip(x.iter()).map(|(&c, x)| entry(problem, rows[a], c) * x).sum::<f64>();
            }
        }
        let left = 0.5 * (&left + left.transpose());
        let eigen = SymmetricEigen::new(left);
        let greatest = eigen.eigenvalues.amax();
        let kept: Vec<usize> =
            (0..rows.len()).filter(|&j| eigen.eigenvalues[j] > SINGULAR * greatest).collect();
        let basis = eigen.eigenvectors.select_columns(&kept);
        (!kept.is_empty()).then_some(Self { open, held, rows, basis })
    }

    /// The first common motion, and whether slip grows (1) or decreases (-1). Directions of slip that exists are those of a
    /// motion: of the motions along them it is the one with the most equal speeds. Directions in which slip begins are only
    /// near those of a motion: then it is the one nearest to equal speeds.
    fn start(
        &self,
        problem: &Problem<'_>,
        modes: &[Mode],
        found: &Admissible,
        (begins, wanted): (bool, &[f64]),
    ) -> Option<(DVector<f64>, f64)> {
        let r = self.basis.ncols();
        let mut along = DVector::zeros(self.rows.len());
        let mut across = DMatrix::zeros(self.open.len(), r);
        for (j, &i) in self.open.iter().enumerate() {
            if let Mode::Slide(d) = modes[i] {
                along.rows_mut(2 * j, 2).copy_from(&d);
                let turned = self.basis.row(2 * j + 1) * d.x - self.basis.row(2 * j) * d.y;
                across.row_mut(j).copy_from(&turned);
            }
        }
        // Velocities across the directions cost 1 / EQUAL times as much as differences of speeds.
        let equal = DMatrix::identity(r, r) * EQUAL;
        let near = (&equal + across.tr_mul(&across)).cholesky()?;
        let all = self.basis.tr_mul(&along);
        let y = if begins { all } else { near.solve(&(equal * all)) };
        let motion = &self.basis * &y;
        let rate: f64 = self
            .rows
            .iter()
            .zip(motion.iter())
            .map(|(&row, along)| problem.scale(row / 3) * found.acceleration[row] * along)
            .sum();
        let rate = rate / motion.norm_squared();
        // Forces in wrong directions may seem to prevent slip.
        let rate = if begins { rate.abs() } else { rate };
        let forward = (0..self.open.len()).all(|j| {
            let moves = two(&motion, j);
            moves.dot(&two(&along, j)) > FORWARD * moves.norm()
        });
        let turning = near.solve(&across.tr_mul(&DVector::from_column_slice(wanted)));
        (forward && rate != 0.0 && rate.is_finite()).then(|| (rate * y + turning, rate.signum()))
    }

    /// Sets the directions of the contacts to those of this motion.
    fn directions(&self, modes: &mut [Mode], y: &DVector<f64>, sign: f64, wanted: &[f64]) -> Option<()> {
        let motion = &self.basis * y;
        for (j, &i) in self.open.iter().enumerate() {
            let Mode::Slide(d) = &mut modes[i] else { return None };
            let slips = sign * (two(&motion, j) - wanted[j] * Vector2::new(-d.y, d.x));
            *d = slips.try_normalize(0.0)?;
        }
        Some(())
    }

    /// A Newton step for the motion and its forces.
    fn step(
        &self,
        problem: &Problem<'_>,
        modes: &[Mode],
        found: &Admissible,
        y: &DVector<f64>,
        sign: f64,
        wanted: &[f64],
    ) -> Option<DVector<f64>> {
        let (m, r) = (self.held.len(), self.basis.ncols());
        let motion = &self.basis * y;
        // The change of the friction directions with the motion.
        let mut turning = DMatrix::zeros(self.rows.len(), self.rows.len());
        for (j, &i) in self.open.iter().enumerate() {
            let Mode::Slide(d) = modes[i] else { return None };
            let across = Vector2::new(-d.y, d.x);
            let speed = (two(&motion, j) - wanted[j] * across).norm();
            let size = sign * problem.mu[i] * found.force[3 * i] / (problem.scale(i) * speed);
            turning.view_mut((2 * j, 2 * j), (2, 2)).copy_from(&(size * across * across.transpose()));
        }
        let turning = &turning * &self.basis;
        // Small motions change the directions considerably: each change is relative to them.
        let eigen = SymmetricEigen::new(self.basis.tr_mul(&turning));
        let mut scaled = eigen.eigenvectors;
        for (mut column, turns) in scaled.column_iter_mut().zip(eigen.eigenvalues.iter()) {
            column /= 1.0 + turns.abs();
        }
        let turning = turning * &scaled;
        let between = |rows: &[usize], columns: &[usize]| {
            DMatrix::from_fn(rows.len(), columns.len(), |a, b| entry(problem, rows[a], columns[b]))
        };
        let along = |rows: &[usize]| {
            DMatrix::from_fn(rows.len(), m, |a, b| {
                let (row, from) = (rows[a], self.held[b]);
                let own = entry(problem, row, from);
                match modes[from / 3] {
                    Mode::Slide(d) => {
                        own - problem.mu[from / 3]
                            * (entry(problem, row, from + 1) * d.x + entry(problem, row, from + 2) * d.y)
                    }
                    _ => own,
                }
            })
        };
        let pulls = |rows: &[usize]| {
            DVector::from_fn(rows.len(), |a, _| {
                let w = problem.w.row(rows[a]);
                let forces: f64 = w.iter().zip(found.force.iter()).map(|(w, force)| w * force).sum();
                problem.scale(rows[a] / 3) * (problem.pull(rows[a]) + forces)
            })
        };
        let mut matrix = DMatrix::zeros(m + r, m + r);
        matrix.view_mut((0, 0), (m, m)).copy_from(&along(&self.held));
        matrix.view_mut((0, m), (m, r)).copy_from(&-(between(&self.held, &self.rows) * &turning));
        matrix.view_mut((m, 0), (r, m)).copy_from(&self.basis.tr_mul(&along(&self.rows)));
        let moves = self.basis.tr_mul(&(between(&self.rows, &self.rows) * &turning)) + &scaled;
        matrix.view_mut((m, m), (r, r)).copy_from(&-moves);
        let mut right = Vector::zeros(m + r);
        let (held, slips) = (pulls(&self.held), self.basis.tr_mul(&pulls(&self.rows)) - y);
        for (right, value) in right.iter_mut().zip(held.iter().chain(slips.iter())) {
            *right = -value;
        }
        let mut numbers = Square::zeros((m + r) * (m + r));
        numbers.copy_from_slice(matrix.as_slice());
        let elimination = Elimination::new(numbers, m + r, SINGULAR);
        let mut step = DVector::from_column_slice(&elimination.solve(&right));
        if elimination.rank < m + r {
            // Of many distributions of the load, take the nearest.
            let basis = elimination.null_space();
            step -= &basis * basis.tr_mul(&step);
        }
        let step = scaled * step.rows(m, r);
        step.iter().all(|value| value.is_finite()).then_some(step)
    }
}

/// An entry of W in units in which the block of each contact has the trace one.
fn entry(problem: &Problem<'_>, row: usize, column: usize) -> f64 {
    problem.scale(row / 3) * problem.scale(column / 3) * problem.w[(row, column)]
}

fn square(rows: &[usize], columns: &[usize], problem: &Problem<'_>) -> Square {
    let mut matrix = Square::zeros(rows.len() * columns.len());
    for (b, column) in matrix.chunks_exact_mut(rows.len().max(1)).enumerate() {
        column.iter_mut().enumerate().for_each(|(a, value)| *value = entry(problem, rows[a], columns[b]));
    }
    matrix
}

fn two(values: &DVector<f64>, j: usize) -> Vector2<f64> {
    Vector2::new(values[2 * j], values[2 * j + 1])
}

fn angle(one: &Mode, other: &Mode) -> f64 {
    match (one, other) {
        (Mode::Slide(a), Mode::Slide(b)) => (a.x * b.y - a.y * b.x).atan2(a.dot(b)).abs(),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::contact_problem::Mode;

    /// A box on its four corners, rotated by an angle about the normal of an incline: W, and beta directed
    /// downwards along t.
    fn a_box(turn: f64, slope: f64) -> (DMatrix<f64>, DVector<f64>) {
        let (a, b, c) = (0.2, 0.15, 0.1);
        let (sin, cos) = turn.sin_cos();
        let mut partials = DMatrix::zeros(6, 12);
        for (i, (x, y)) in [(-a, -b), (a, -b), (-a, b), (a, b)].into_iter().enumerate() {
            let arm = Vector3::new(cos * x - sin * y, sin * x + cos * y, -c);
            for (row, axis) in [Vector3::z(), Vector3::x(), Vector3::y()].into_iter().enumerate() {
                let turn = arm.cross(&axis);
                for k in 0..3 {
                    partials[(k, 3 * i + row)] = axis[k];
                    partials[(3 + k, 3 * i + row)] =
                        cos * turn[k] + [sin * turn[1], -sin * turn[0], (1.0 - cos) * turn[2]][k];
                }
            }
        }
        let inertia = [1.0, 1.0, 1.0, (b * b + c * c) / 3.0, (a * a + c * c) / 3.0, (a * a + b * b) / 3.0];
        let response = DMatrix::from_fn(6, 12, |row, column| partials[(row, column)] / inertia[row]);
        let pull = DVector::from_vec(vec![9.81 * slope.sin(), 0.0, -9.81 * slope.cos(), 0.0, 0.0, 0.0]);
        (partials.tr_mul(&response), partials.tr_mul(&pull))
    }

    /// All four corners slip down the incline without rotation of the box, even if its friction is hardly
    /// exceeded.
    #[test]
    fn corners_slip_along_the_common_motion() {
        let slope = 0.3_f64.atan();
        for power in 3..13 {
            for k in 0..9 {
                let (turn, excess) = (0.37 * f64::from(k), 3.0 * 0.1_f64.powi(power));
                let (w, beta) = a_box(turn, slope);
                let mu = [0.3 - excess; 4];
                let problem = Problem { w: &w, beta: &beta, mu: &mu, slip: &[None; 4], noise: None };
                let start = |i: i32| {
                    let angle = 1e-5 * f64::from((i + k) % 3 - 1);
                    Mode::Slide(Vector2::new(angle.cos(), angle.sin()))
                };
                let modes: Vec<Mode> = (0..4).map(start).collect();
                let force = DVector::zeros(12);
                let found = slip_together(&problem, &modes, &[0, 1, 2, 3], None, &force);
                let found = found.unwrap_or_else(|| panic!("{turn} {excess:e}"));
                for mode in found {
                    let Mode::Slide(d) = mode else { panic!("{mode:?}") };
                    // Downwards. The square of the remaining component is far below the excess.
                    let close = if excess > 1e-11 { 1e-12 } else { 1e-6 };
                    assert!(d.y.abs() < close && d.x > 0.0, "{turn} {excess:e}: {d}");
                }
            }
        }
    }
}
