//! Solves linear equations by elimination; there may be more equations than unknowns if they are consistent.

use super::hyper_dual::HyperDual;

/// What became of a system of equations.
pub struct Solved {
    /// the unknowns, each as a row of right sides
    pub unknowns: Vec<Vec<HyperDual>>,
    /// the equation that contradicts the others most, and by how much relative to its terms
    pub contradiction: (usize, f64),
}

/// Why there is no solution.
pub struct Undetermined {
    /// the unknown that no equation determines
    pub unknown: usize,
}

/// Solves `A x = B` for `count` unknowns. Each row holds the coefficients of the unknowns and then the right
/// sides.
///
/// Gaussian elimination with the largest pivots; equations are scaled to their largest coefficient. `sizes`
/// tells the size of the unit of each column in SI units: columns are compared in these, so that the units
/// of a model decide nothing. Columns past the last of them are in SI units.
pub fn solve(mut rows: Vec<Vec<HyperDual>>, count: usize, sizes: &[f64]) -> Result<Solved, Undetermined> {
    let width = rows.first().map_or(count, Vec::len);
    rows.iter_mut().for_each(|row| in_si(row, sizes, |c, size| c * HyperDual::constant(1.0 / size)));
    let size = |row: &Vec<HyperDual>| row.iter().fold(0.0_f64, |m, c| m.max(c.re.abs()));
    // what is this small beside the other equations is the rounding error of an equation that says 0 = 0
    let noise = 1e-12 * rows.iter().map(size).fold(0.0_f64, f64::max);
    let mut numbered: Vec<(usize, Vec<HyperDual>)> = Vec::new();
    for (i, row) in rows.drain(..).enumerate() {
        let largest = size(&row);
        if largest > noise && largest.is_finite() {
            let scale = HyperDual::constant(1.0 / largest);
            numbered.push((i, row.into_iter().map(|c| c * scale).collect()));
        }
    }
    // columns in the order in which they were eliminated, so that the largest coefficient can always be taken
    let mut order: Vec<usize> = Vec::new();
    for step in 0..count {
        let mut best = (0.0, step, 0);
        for (r, (_, row)) in numbered.iter().enumerate().skip(step) {
            for c in (0..count).filter(|c| !order.contains(c)) {
                if row[c].re.abs() > best.0 {
                    best = (row[c].re.abs(), r, c);
                }
            }
        }
        let (size, pivot, column) = best;
        if size < 1e-9 {
            let unknown = (0..count).find(|c| !order.contains(c)).unwrap_or(0);
            return Err(Undetermined { unknown });
        }
        numbered.swap(step, pivot);
        order.push(column);
        let row = numbered[step].1.clone();
        for (r, (_, other)) in numbered.iter_mut().enumerate() {
            if r != step && other[column] != HyperDual::ZERO {
                let factor = other[column] / row[column];
                for (entry, above) in other.iter_mut().zip(&row) {
                    *entry = *entry - factor * *above;
                }
            }
        }
    }
    let mut unknowns = vec![vec![HyperDual::ZERO; width - count]; count];
    for (step, &column) in order.iter().enumerate() {
        let row = &numbered[step].1;
        let unit = HyperDual::constant(sizes.get(column).copied().unwrap_or(1.0));
        let right = row[count..].iter().map(|right| *right / (row[column] * unit));
        unknowns[column] = right.collect();
        in_si(&mut unknowns[column], sizes.get(count..).unwrap_or(&[]), |c, size| {
            c * HyperDual::constant(size)
        });
    }
    let mut contradiction = (0, 0.0);
    for (i, row) in numbered.iter().skip(count) {
        let left = row[count..].iter().fold(0.0_f64, |m, c| m.max(c.re.abs()));
        if left > contradiction.1 {
            contradiction = (*i, left);
        }
    }
    Ok(Solved { unknowns, contradiction })
}

/// Converts the entries of columns whose units are not those of SI.
fn in_si(row: &mut [HyperDual], sizes: &[f64], convert: impl Fn(HyperDual, f64) -> HyperDual) {
    for (entry, &size) in row.iter_mut().zip(sizes).filter(|(_, size)| **size != 1.0) {
        *entry = convert(*entry, size);
    }
}

/// How many of the rows are independent; rows of very different sizes count alike.
pub fn rank(mut rows: Vec<Vec<f64>>) -> usize {
    let size = |row: &[f64]| row.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    let noise = 1e-12 * rows.iter().map(|row| size(row)).fold(0.0_f64, f64::max);
    rows.retain(|row| size(row) > noise);
    for row in &mut rows {
        let size = size(row);
        row.iter_mut().for_each(|c| *c /= size);
    }
    let mut rank = 0;
    // each step takes the largest coefficient and clears its column
    while let Some(best) = (0..rows.len()).max_by(|&a, &b| size(&rows[a]).total_cmp(&size(&rows[b]))) {
        let row = rows.swap_remove(best);
        let Some(column) = (0..row.len()).max_by(|&a, &b| row[a].abs().total_cmp(&row[b].abs())) else {
            break;
        };
        if row[column].abs() < 1e-9 {
            break;
        }
        for other in &mut rows {
            let factor = other[column] / row[column];
            other.iter_mut().zip(&row).for_each(|(entry, above)| *entry -= factor * above);
        }
        rank += 1;
    }
    rank
}

/// The factors of a symmetric matrix scaled to a unit diagonal: the column at which it is singular, if it is.
/// A diagonal entry is 0 if it is no more than its `noise`.
pub fn singular_column(matrix: &[Vec<f64>], noise: &[f64]) -> Option<usize> {
    let n = matrix.len();
    let noise_of = |i: usize| noise.get(i).copied().unwrap_or(0.0).max(0.0);
    let scale: Vec<f64> = (0..n).map(|i| matrix[i][i].max(0.0).sqrt()).collect();
    if let Some(i) = (0..n).find(|&i| matrix[i][i] <= noise_of(i)) {
        return Some(i);
    }
    let mut a: Vec<Vec<f64>> =
        (0..n).map(|i| (0..n).map(|j| matrix[i][j] / (scale[i] * scale[j])).collect()).collect();
    for k in 0..n {
        if a[k][k] < 1e-11 {
            return Some(k);
        }
        let (above, below) = a.split_at_mut(k + 1);
        let pivot = &above[k];
        for row in below {
            let factor = row[k] / pivot[k];
            row.iter_mut().zip(pivot).skip(k).for_each(|(entry, above)| *entry -= factor * above);
        }
    }
    None
}
