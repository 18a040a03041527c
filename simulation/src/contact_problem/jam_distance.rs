//! How far contacts that slide are from a jam, in which their forces grow without bound.
//!
//! Theory: docs/theory.md, section 17.10.

use smallvec::SmallVec;

use super::linear::{Elimination, Square};

/// The distance of sliding contacts from a jam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distance {
    /// See [`super::Admissible::f`].
    pub f: f64,
    /// The contact whose own force grows most as f falls to zero, as a place among the sliding ones.
    pub jams: Option<usize>,
    /// See [`super::Admissible::parts`].
    pub parts: bool,
}

impl Distance {
    /// Of k contacts, while all others keep their modes. `ratio` is M^-1 M_0, M being the matrix of normal accelerations by
    /// normal forces with their friction, and M_0 the same without friction: k x k, by columns. `own` are the diagonal
    /// entries of M^-1, each times its W_nn.
    pub fn new(ratio: &Square, own: &[f64]) -> Self {
        let jams = (0..own.len()).max_by(|&a, &b| own[a].abs().total_cmp(&own[b].abs()));
        Self { f: least_of_groups(ratio, own.len()), jams, parts: own.iter().all(|&own| own > 0.0) }
    }

    /// Of contacts whose forces are not unique: the least f of one by itself.
    pub fn of_each(f: impl Iterator<Item = f64>) -> Self {
        let least = f.enumerate().min_by(|(_, one), (_, other)| one.total_cmp(other));
        let f = least.map_or(1.0, |(_, f)| f);
        Self { f, jams: least.map(|(place, _)| place), parts: f > 0.0 }
    }
}

/// The least of det M / det M_0 of the groups of contacts that depend on one another; the product of all does not tell
/// whether two groups have jammed. 1 without contacts.
fn least_of_groups(ratio: &Square, k: usize) -> f64 {
    let groups = groups(ratio, k);
    let of = |group: usize| -> SmallVec<[usize; 8]> { (0..k).filter(|&i| groups[i] == group).collect() };
    let distance = |group: SmallVec<[usize; 8]>| {
        let size = group.len();
        let mut block = Square::zeros(size * size);
        for (place, value) in block.iter_mut().enumerate() {
            *value = ratio[group[place / size] * k + group[place % size]];
        }
        1.0 / Elimination::new(block, size, 0.0).determinant()
    };
    (0..k).map(of).filter(|group| !group.is_empty()).map(distance).reduce(f64::min).unwrap_or(1.0)
}

/// For each contact the first one of its group.
fn groups(ratio: &Square, k: usize) -> SmallVec<[usize; 8]> {
    let mut groups: SmallVec<[usize; 8]> = (0..k).collect();
    for (place, _) in ratio.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
        let (one, other) = (groups[place / k], groups[place % k]);
        groups.iter_mut().filter(|group| **group == one.max(other)).for_each(|group| *group = one.min(other));
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn least(rows: &[&[f64]]) -> f64 {
        let k = rows.len();
        let mut ratio = Square::zeros(k * k);
        ratio.iter_mut().enumerate().for_each(|(place, value)| *value = rows[place % k][place / k]);
        least_of_groups(&ratio, k)
    }

    /// Contacts of two bodies that jam at once, whose determinant is positive.
    #[test]
    fn contacts_of_two_bodies_do_not_hide_each_others_jams() {
        for (one, other, expected) in [(2.0, 4.0, 0.25), (-2.0, 4.0, -0.5), (-2.0, -4.0, -0.5)] {
            assert_eq!(least(&[&[one, 0.0], &[0.0, other]]), expected);
        }
        assert_eq!(least(&[&[1.0, 0.0, 2.0], &[0.0, -4.0, 0.0], &[-1.0, 0.0, 2.0]]), -0.25);
        assert_eq!(least(&[]), 1.0);
    }

    /// The determinant counts exchanged rows and columns.
    #[test]
    fn signs_of_determinants() {
        let near = |one: f64, other: f64| (one * other - 1.0).abs() < 1e-14;
        assert!(near(least(&[&[1.0, 5.0], &[-5.0, 1.0]]), 26.0));
        assert!(near(least(&[&[1.0, 5.0], &[5.0, 1.0]]), -24.0));
        assert!(near(least(&[&[0.0, 5.0, 1.0], &[1.0, 0.0, 5.0], &[5.0, 1.0, 0.0]]), 126.0));
        assert!(near(least(&[&[0.0, 5.0, 1.0], &[5.0, 1.0, 0.0], &[1.0, 0.0, 5.0]]), -126.0));
    }
}
