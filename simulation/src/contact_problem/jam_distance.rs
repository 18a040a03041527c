//! How far contacts that slide are from a jam, in which their forces grow without bound.
//!
//! Theory: docs/theory.md, section 17.10.

use smallvec::SmallVec;

use super::linear::{Elimination, FEW, SINGULAR, Square};

/// det M / det M_0 of n unknowns, for the matrix M by columns, its elimination, of full rank, and M_0, the same without
/// friction where contacts slide, which is symmetric and positive definite. Of unknowns that do not depend on one another
/// it is the least: the product does not tell whether two groups of them have jammed. `None` if M_0 is singular.
pub(super) fn distance(matrix: &Square, elimination: &Elimination, smooth: Square, n: usize) -> Option<f64> {
    let groups = groups(matrix, n);
    if groups.iter().all(|&group| group == 0) {
        return ratio(elimination, smooth, n);
    }
    let of = |group: usize| -> SmallVec<[usize; FEW]> { (0..n).filter(|&i| groups[i] == group).collect() };
    let distance = |group: SmallVec<[usize; FEW]>| {
        let elimination = Elimination::new(block(matrix, n, &group), group.len(), 0.0);
        ratio(&elimination, block(&smooth, n, &group), group.len())
    };
    (0..n)
        .map(of)
        .filter(|group| !group.is_empty())
        .map(distance)
        .try_fold(f64::INFINITY, |least, f| Some(least.min(f?)))
}

/// The determinant of an eliminated matrix over that of a symmetric, positive definite one.
fn ratio(elimination: &Elimination, mut smooth: Square, n: usize) -> Option<f64> {
    let mut ratio = elimination.parity();
    let least = SINGULAR * smooth.iter().step_by(n + 1).fold(0.0, |most: f64, entry| most.max(*entry));
    for (j, pivot) in elimination.pivots().enumerate() {
        let (left, right) = smooth.split_at_mut((j + 1) * n);
        let column = &left[j * n..];
        if column[j] <= least {
            return None;
        }
        ratio *= pivot / column[j];
        for (next, right) in right.chunks_exact_mut(n).enumerate() {
            let next = j + 1 + next;
            let factor = column[next] / column[j];
            right[next..].iter_mut().zip(&column[next..]).for_each(|(entry, left)| *entry -= factor * left);
        }
    }
    Some(ratio)
}

/// The rows and columns of a group.
pub(super) fn block(matrix: &Square, n: usize, group: &[usize]) -> Square {
    let mut block = Square::zeros(group.len() * group.len());
    for (place, value) in block.iter_mut().enumerate() {
        *value = matrix[group[place / group.len()] * n + group[place % group.len()]];
    }
    block
}

/// For each unknown the first one of its group.
fn groups(matrix: &Square, n: usize) -> SmallVec<[usize; FEW]> {
    let mut groups: SmallVec<[usize; FEW]> = (0..n).collect();
    let mut more = n - 1;
    for (column, entries) in matrix.chunks_exact(n).enumerate() {
        for (row, _) in entries.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
            let (one, other) = (groups[column], groups[row]);
            if one != other {
                let (first, last) = (one.min(other), one.max(other));
                groups.iter_mut().filter(|group| **group == last).for_each(|group| *group = first);
                more -= 1;
                if more == 0 {
                    return groups;
                }
            }
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(rows: &[&[f64]]) -> Square {
        let n = rows.len();
        let mut square = Square::zeros(n * n);
        square.iter_mut().enumerate().for_each(|(place, value)| *value = rows[place % n][place / n]);
        square
    }

    fn of(rows: &[&[f64]], smooth: &[&[f64]]) -> f64 {
        let (matrix, n) = (square(rows), rows.len());
        distance(&matrix, &Elimination::new(matrix.clone(), n, 0.0), square(smooth), n).unwrap()
    }

    /// Contacts of two bodies that jam at once, whose determinant is positive.
    #[test]
    fn contacts_of_two_bodies_do_not_hide_each_others_jams() {
        for (one, other, expected) in [(2.0, 4.0, 1.0), (-2.0, 4.0, -1.0), (-2.0, -8.0, -2.0)] {
            assert_eq!(of(&[&[one, 0.0], &[0.0, other]], &[&[2.0, 0.0], &[0.0, 4.0]]), expected);
        }
        let smooth: [&[f64]; 3] = [&[1.0, 0.0, 0.0], &[0.0, 2.0, 0.0], &[0.0, 0.0, 1.0]];
        assert_eq!(of(&[&[1.0, 0.0, 2.0], &[0.0, -4.0, 0.0], &[-1.0, 0.0, 2.0]], &smooth), -2.0);
    }

    /// Exchanged rows and columns count, and so does what couples the contacts without friction.
    #[test]
    fn a_ratio_of_determinants() {
        let near = |one: f64, other: f64| (one - other).abs() < 1e-13 * other.abs();
        let smooth: [&[f64]; 2] = [&[2.0, 1.0], &[1.0, 3.0]];
        assert!(near(of(&[&[1.0, 5.0], &[-5.0, 1.0]], &smooth), 26.0 / 5.0));
        assert!(near(of(&[&[1.0, 5.0], &[5.0, 1.0]], &smooth), -24.0 / 5.0));
        let smooth: [&[f64]; 3] = [&[2.0, 1.0, 0.5], &[1.0, 3.0, 0.0], &[0.5, 0.0, 1.0]];
        assert!(near(of(&[&[0.0, 5.0, 1.0], &[1.0, 0.0, 5.0], &[5.0, 1.0, 0.0]], &smooth), 126.0 / 4.25));
        assert!(near(of(&[&[0.0, 5.0, 1.0], &[5.0, 1.0, 0.0], &[1.0, 0.0, 5.0]], &smooth), -126.0 / 4.25));
        assert!(near(of(&smooth, &smooth), 1.0));
        let matrix = square(&[&[1.0, 5.0], &[-5.0, 1.0]]);
        let elimination = Elimination::new(matrix.clone(), 2, 0.0);
        assert!(distance(&matrix, &elimination, square(&[&[1.0, 1.0], &[1.0, 1.0 + 1e-12]]), 2).is_none());
    }
}
