//! Maps of sums: adds to entries, and removes entries.

use std::collections::BTreeMap;

use crate::algebra::Expr;
use crate::kinematics::axes::Symmetric;
use crate::kinematics::linear_forms::{self, Triple};

/// Adds to a number.
pub fn sum_scalar<K: Ord>(map: &mut BTreeMap<K, Expr>, key: K, value: &Expr) {
    let sum = map.get(&key).map_or_else(|| value.clone(), |have| have.add(value));
    map.insert(key, sum);
}

/// Adds to a vector; zeros create no entry.
pub fn sum_triple<K: Ord>(map: &mut BTreeMap<K, Triple>, key: K, value: &Triple) {
    if linear_forms::is_zero(value) {
        return;
    }
    let sum = map.get(&key).map_or_else(|| value.clone(), |have| linear_forms::add(have, value));
    map.insert(key, sum);
}

/// Adds to a matrix by rows; zeros create no entry.
pub fn sum_matrix<K: Ord>(map: &mut BTreeMap<K, [Triple; 3]>, key: K, value: &[Triple; 3]) {
    if value.iter().all(linear_forms::is_zero) {
        return;
    }
    let sum = match map.get(&key) {
        Some(have) => std::array::from_fn(|i| linear_forms::add(&have[i], &value[i])),
        None => value.clone(),
    };
    map.insert(key, sum);
}

/// Adds to a symmetric matrix.
pub fn sum_symmetric<K: Ord>(map: &mut BTreeMap<K, Symmetric>, key: K, value: &Symmetric) {
    let sum = match map.get(&key) {
        Some(have) => std::array::from_fn(|i| have[i].add(&value[i])),
        None => value.clone(),
    };
    map.insert(key, sum);
}

/// Removes and returns the entries whose keys satisfy `passes`, in the order of the keys.
pub fn take_where<K: Ord + Copy, V>(map: &mut BTreeMap<K, V>, passes: impl Fn(&K) -> bool) -> Vec<(K, V)> {
    let keys: Vec<K> = map.keys().copied().filter(passes).collect();
    keys.into_iter().filter_map(|key| map.remove_entry(&key)).collect()
}

/// Removes and returns everything whose key begins with `first`, in the order of the rest of the keys.
pub fn take_by_first<A: Ord + Copy, B: Ord + Copy, V>(
    map: &mut BTreeMap<(A, B), V>,
    first: A,
) -> Vec<(B, V)> {
    take_where(map, |key| key.0 == first).into_iter().map(|(key, value)| (key.1, value)).collect()
}

/// Removes and returns everything whose key ends with `second`, in the order of the rest of the keys.
pub fn take_by_second<A: Ord + Copy, B: Ord + Copy, V>(
    map: &mut BTreeMap<(A, B), V>,
    second: B,
) -> Vec<(A, V)> {
    take_where(map, |key| key.1 == second).into_iter().map(|(key, value)| (key.0, value)).collect()
}
