//! Newton steps for many contacts, each of which touches few others: elimination by 3 x 3 blocks.
//!
//! Contacts are eliminated in the order of minimum degree, with pivots in their own blocks only, since the
//! matrix is nearly positive definite. Each solution is refined, and rejected if refinement does not
//! converge.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::several::{NewtonSteps, Scaled};
use nalgebra::{DMatrix, Matrix3, Vector3};

/// The fill-in pattern of an elimination, and storage for its numbers.
pub(super) struct Sparse {
    /// The contacts in the order of their elimination, and the place of each in it.
    order: Vec<usize>,
    /// For each step the later steps that it changes, increasing.
    fronts: Vec<Vec<usize>>,
    /// The entries of W next to each contact in the order of steps: (step, step) with blocks that are not zero.
    entries: Vec<(usize, usize)>,
    diagonal: Vec<Matrix3<f64>>,
    upper: Vec<Vec<Matrix3<f64>>>,
    lower: Vec<Vec<Matrix3<f64>>>,
    places: Vec<usize>,
}

impl Sparse {
    /// `None` if the elimination would fill more than half of the matrix.
    pub fn new(w: &DMatrix<f64>) -> Option<Self> {
        let k = w.nrows() / 3;
        let touches = |i: usize, j: usize| {
            let zero = |i: usize, j: usize| w.view((3 * i, 3 * j), (3, 3)).iter().all(|entry| *entry == 0.0);
            !zero(i, j) || !zero(j, i)
        };
        let pairs: Vec<(usize, usize)> =
            (0..k).flat_map(|i| (0..i).map(move |j| (i, j))).filter(|&(i, j)| touches(i, j)).collect();
        let mut neighbours: Vec<Vec<bool>> = vec![vec![false; k]; k];
        for &(i, j) in &pairs {
            neighbours[i][j] = true;
            neighbours[j][i] = true;
        }
        let (mut order, mut fronts) = (Vec::with_capacity(k), Vec::with_capacity(k));
        let mut degree: Vec<usize> =
            neighbours.iter().map(|row| row.iter().filter(|one| **one).count()).collect();
        let mut left: Vec<bool> = vec![true; k];
        let mut filled = 0;
        for _ in 0..k {
            let next = (0..k).filter(|&i| left[i]).min_by_key(|&i| degree[i])?;
            left[next] = false;
            let front: Vec<usize> = (0..k).filter(|&j| left[j] && neighbours[next][j]).collect();
            for &a in &front {
                degree[a] -= 1;
                for &b in &front {
                    if a != b && !neighbours[a][b] {
                        neighbours[a][b] = true;
                        degree[a] += 1;
                    }
                }
            }
            filled += 2 * front.len() + 1;
            if 2 * filled > k * k {
                return None;
            }
            order.push(next);
            fronts.push(front);
        }
        let mut steps = vec![0; k];
        order.iter().enumerate().for_each(|(step, &i)| steps[i] = step);
        for front in &mut fronts {
            front.iter_mut().for_each(|contact| *contact = steps[*contact]);
            front.sort_unstable();
        }
        let entries = pairs.into_iter().map(|(i, j)| (steps[i], steps[j])).collect();
        let blocks: Vec<Vec<Matrix3<f64>>> =
            fronts.iter().map(|front| vec![Matrix3::zeros(); front.len()]).collect();
        Some(Self {
            order,
            fronts,
            entries,
            diagonal: vec![Matrix3::zeros(); k],
            lower: blocks.clone(),
            upper: blocks,
            places: vec![0; k],
        })
    }

    /// Fills in A + B (W + alpha).
    fn fill(
        &mut self,
        matrix: &Scaled<'_, f64>,
        blocks: &dyn Fn(usize) -> (Matrix3<f64>, Matrix3<f64>),
        alpha: f64,
    ) {
        let by: Vec<(Matrix3<f64>, Matrix3<f64>)> = self.order.iter().map(|&i| blocks(i)).collect();
        for (step, &i) in self.order.iter().enumerate() {
            let (a, b) = &by[step];
            self.diagonal[step] = a + b * (matrix.block(i, i) + Matrix3::from_diagonal_element(alpha));
            self.upper[step].fill(Matrix3::zeros());
            self.lower[step].fill(Matrix3::zeros());
        }
        for &(one, other) in &self.entries {
            let (first, second) = (one.min(other), one.max(other));
            let Ok(place) = self.fronts[first].binary_search(&second) else { continue };
            let (i, j) = (self.order[first], self.order[second]);
            self.upper[first][place] = by[first].1 * matrix.block(i, j);
            self.lower[first][place] = by[second].1 * matrix.block(j, i);
        }
    }

    /// Eliminates; the diagonal becomes its inverse, the lower blocks are multiplied by it.
    fn eliminate(&mut self) -> bool {
        for step in 0..self.order.len() {
            let Some(inverse) = self.diagonal[step].lu().try_inverse() else { return false };
            self.diagonal[step] = inverse;
            let (fronts, later) = (&self.fronts[step], &self.fronts);
            let (upper_here, upper) = self.upper.split_at_mut(step + 1);
            let (lower_here, lower) = self.lower.split_at_mut(step + 1);
            let (upper_here, lower_here) = (&upper_here[step], &mut lower_here[step]);
            for (a, &row) in fronts.iter().enumerate() {
                for (place, &column) in later[row].iter().enumerate() {
                    self.places[column] = place;
                }
                let factor = lower_here[a] * inverse;
                // Row `row` of the upper blocks, and column `row` of the lower ones.
                if factor.iter().any(|entry| *entry != 0.0) {
                    self.diagonal[row] -= factor * upper_here[a];
                    for (b, &column) in fronts.iter().enumerate().skip(a + 1) {
                        upper[row - step - 1][self.places[column]] -= factor * upper_here[b];
                    }
                }
                let across = inverse * upper_here[a];
                if across.iter().any(|entry| *entry != 0.0) {
                    for (b, &column) in fronts.iter().enumerate().skip(a + 1) {
                        lower[row - step - 1][self.places[column]] -= lower_here[b] * across;
                    }
                }
            }
            for lower in lower_here.iter_mut() {
                *lower *= inverse;
            }
        }
        true
    }

    /// Solves the system in place of the right side, in the order of the contacts.
    fn solve(&self, right: &mut [f64]) {
        let at = |step: usize| 3 * self.order[step];
        let read = |right: &[f64], step: usize| Vector3::from_column_slice(&right[at(step)..at(step) + 3]);
        for step in 0..self.order.len() {
            let here = read(right, step);
            for (&row, lower) in self.fronts[step].iter().zip(&self.lower[step]) {
                let changed = read(right, row) - lower * here;
                right[at(row)..at(row) + 3].copy_from_slice(changed.as_slice());
            }
        }
        for step in (0..self.order.len()).rev() {
            let mut here = read(right, step);
            for (&column, upper) in self.fronts[step].iter().zip(&self.upper[step]) {
                here -= upper * read(right, column);
            }
            right[at(step)..at(step) + 3].copy_from_slice((self.diagonal[step] * here).as_slice());
        }
    }
}

impl NewtonSteps<f64> for Sparse {
    fn solve(
        &mut self,
        matrix: &Scaled<'_, f64>,
        blocks: &dyn Fn(usize) -> (Matrix3<f64>, Matrix3<f64>),
        alpha: f64,
        right: &mut [f64],
    ) -> bool {
        self.fill(matrix, blocks, alpha);
        if !self.eliminate() {
            return false;
        }
        let wanted = right.to_vec();
        let size = wanted.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        Sparse::solve(self, right);
        let mut applied = vec![0.0; wanted.len()];
        for _ in 0..REFINED {
            matrix.apply(right, &mut applied);
            let mut left = wanted.clone();
            for (i, left) in left.chunks_exact_mut(3).enumerate() {
                let (a, b) = blocks(i);
                let x = Vector3::from_column_slice(&right[3 * i..3 * i + 3]);
                let w = Vector3::from_column_slice(&applied[3 * i..3 * i + 3]);
                let value = a * x + b * (w + x * alpha);
                left.iter_mut().zip(value.iter()).for_each(|(left, value)| *left -= value);
            }
            let worst = left.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            if !worst.is_finite() {
                return false;
            }
            if worst <= 1e-12 * size {
                break;
            }
            Sparse::solve(self, &mut left);
            right.iter_mut().zip(&left).for_each(|(right, left)| *right += left);
        }
        right.iter().all(|value| value.is_finite())
    }
}

/// Number of refinements of a solution.
const REFINED: usize = 2;
