//! Linear equations whose coefficients are of very different sizes: a gear of ratio 1e5, a wheel of a
//! micrometre. Equations and unknowns are counted in other units first, in which the coefficients are alike.

use super::hyper_dual::HyperDual;
use super::linear_system::{Solved, Undetermined, solve};

/// A coefficient this small beside the others of its equation is what rounding leaves of 0.
const ROUNDING: f64 = 1e-13;
/// An equation this small beside the others says 0 = 0.
const NOTHING: f64 = 1e-12;
/// Units are found one after another so often, or until they change no more.
const SWEEPS: usize = 500;

/// As [`solve`]; what is not determined in the units as they stand is looked at in others.
pub fn solve_in_any_units(
    rows: Vec<Vec<HyperDual>>,
    count: usize,
    sizes: &[f64],
) -> Result<Solved, Undetermined> {
    let undetermined = match solve(rows.clone(), count, sizes) {
        Err(undetermined) => undetermined,
        solved => return solved,
    };
    let mut rows = rows;
    let units = balance(&mut rows, sizes);
    let Ok(mut solved) = solve(rows, count, &[]) else { return Err(undetermined) };
    let (own, right) = units.split_at(count.min(units.len()));
    for (unknown, own) in solved.unknowns.iter_mut().zip(own) {
        for (entry, other) in unknown.iter_mut().zip(right) {
            *entry = *entry * HyperDual::constant(own / other);
        }
    }
    Ok(solved)
}

/// Multiplies rows and columns such that the coefficients have the size 1 as nearly as that can be; the factors of
/// the columns.
fn balance(rows: &mut [Vec<HyperDual>], sizes: &[f64]) -> Vec<f64> {
    let width = rows.first().map_or(0, Vec::len);
    let mut units: Vec<f64> = (0..width).map(|c| 1.0 / sizes.get(c).copied().unwrap_or(1.0)).collect();
    scale(rows, &units);
    let largest: Vec<f64> =
        rows.iter().map(|row| row.iter().fold(0.0_f64, |most, c| most.max(c.re.abs()))).collect();
    let nothing = NOTHING * largest.iter().copied().fold(0.0_f64, f64::max);
    // the logarithm of each coefficient, with its row and column
    let mut known: Vec<(usize, usize, f64)> = Vec::new();
    for (r, (row, largest)) in rows.iter_mut().zip(&largest).enumerate() {
        if *largest <= nothing {
            row.fill(HyperDual::ZERO);
        }
        for (c, entry) in row.iter_mut().enumerate() {
            if entry.re.abs() <= ROUNDING * largest {
                entry.re = 0.0;
            } else {
                known.push((r, c, entry.re.abs().log2()));
            }
        }
    }
    let (of_rows, of_columns) = factors(&known, rows.len(), width);
    for (row, factor) in rows.iter_mut().zip(of_rows) {
        row.iter_mut().for_each(|entry| *entry = *entry * HyperDual::constant(factor));
    }
    scale(rows, &of_columns);
    units.iter_mut().zip(of_columns).for_each(|(unit, factor)| *unit *= factor);
    units
}

fn scale(rows: &mut [Vec<HyperDual>], columns: &[f64]) {
    for row in rows {
        row.iter_mut()
            .zip(columns)
            .for_each(|(entry, factor)| *entry = *entry * HyperDual::constant(*factor));
    }
}

/// Powers of 2 for rows and columns with which the logarithms of these coefficients are least in the mean square.
fn factors(known: &[(usize, usize, f64)], rows: usize, columns: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut of_rows, mut of_columns) = (vec![0.0_f64; rows], vec![0.0_f64; columns]);
    for _ in 0..SWEEPS {
        let mut change = 0.0_f64;
        let means = means(known.iter().map(|&(r, c, size)| (r, size + of_columns[c])), rows);
        for (own, mean) in of_rows.iter_mut().zip(means) {
            change = change.max((*own + mean).abs());
            *own = -mean;
        }
        of_columns = self::means(known.iter().map(|&(r, c, size)| (c, size + of_rows[r])), columns);
        of_columns.iter_mut().for_each(|own| *own = -*own);
        if change < 0.1 {
            break;
        }
    }
    let power = |list: Vec<f64>| list.into_iter().map(|exponent| exponent.round().exp2()).collect();
    (power(of_rows), power(of_columns))
}

/// The mean of the values of each index; 0 where there are none.
fn means(values: impl Iterator<Item = (usize, f64)>, count: usize) -> Vec<f64> {
    let mut sums = vec![(0.0_f64, 0.0_f64); count];
    for (index, value) in values {
        sums[index].0 += value;
        sums[index].1 += 1.0;
    }
    sums.into_iter().map(|(sum, number)| if number > 0.0 { sum / number } else { 0.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solved(rows: &[&[f64]], count: usize) -> Option<Vec<Vec<f64>>> {
        let rows = rows.iter().map(|row| row.iter().map(|c| HyperDual::constant(*c)).collect()).collect();
        let solved = solve_in_any_units(rows, count, &[]).ok()?;
        Some(solved.unknowns.iter().map(|row| row.iter().map(|c| c.re).collect()).collect())
    }

    #[test]
    fn equations_of_very_different_sizes_are_solved() {
        let two = solved(&[&[1.0, 0.0, 1e5], &[-1e5, 1.0, 0.0]], 2).unwrap();
        assert!((two[0][0] / 1e5 - 1.0).abs() < 1e-12 && (two[1][0] / 1e10 - 1.0).abs() < 1e-12, "{two:?}");
        let far = solved(&[&[1.0, 0.0, 1e11], &[-1.0, 1.0, 0.0]], 2).unwrap();
        assert!((far[1][0] / 1e11 - 1.0).abs() < 1e-12, "{far:?}");
        let small = solved(&[&[1e-12, 0.0, 1.0], &[0.0, 1e-12, 1.0]], 2).unwrap();
        assert!((small[0][0] / 1e12 - 1.0).abs() < 1e-12, "{small:?}");
        // a chain of gears
        let n = 12;
        let rows: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                let mut row = vec![0.0; n + 1];
                row[i] = 1.0;
                if i == 0 {
                    row[n] = 10.0
                } else {
                    row[i - 1] = -10.0
                }
                row
            })
            .collect();
        let chain = solved(&rows.iter().map(Vec::as_slice).collect::<Vec<_>>(), n).unwrap();
        assert!((chain[n - 1][0] / 1e12 - 1.0).abs() < 1e-12, "{chain:?}");
    }

    #[test]
    fn singular_equations_stay_singular_in_any_units() {
        assert!(solved(&[&[1.0, 2.0, 1.0], &[2.0, 4.0, 1.0]], 2).is_none());
        assert!(solved(&[&[1e5, 2e-4, 1.0], &[2e8, 4e-1, 1.0]], 2).is_none());
        assert!(solved(&[&[0.1, 0.3, 1.0], &[0.2, 0.6, 1.0], &[0.3, 0.9, 5.0]], 2).is_none());
        // what rounding leaves of 0 determines nothing
        assert!(solved(&[&[6.1e-17, 1.0]], 1).is_none());
        assert!(solved(&[&[1.0, 0.0, 1.0], &[1e-17, 3e-17, 0.0]], 2).is_none());
        assert!(solved(&[&[1.0, 0.0, 1.0], &[-1.0, 1e-16, 1.0]], 2).is_none());
    }
}
