//! Finds the pairs of items that occur in several lists, the most frequent first: the common parts of sums
//! and products.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// An item of a list: an id, and for terms of sums whether the term is subtracted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Item {
    /// the id
    pub id: u32,
    /// whether it is subtracted
    pub negative: bool,
}

/// Two items with a relative sign: pairs that differ in both signs count as the same pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Pair {
    /// the lesser id
    pub first: u32,
    /// the other
    pub second: u32,
    /// whether the two have opposite signs
    pub opposite: bool,
}

impl Pair {
    fn new(a: Item, b: Item) -> Self {
        let (a, b) = if a.id <= b.id { (a, b) } else { (b, a) };
        Pair { first: a.id, second: b.id, opposite: a.negative != b.negative }
    }
}

/// Longer lists are left as they are, since the search would cost more than it saves.
const LONGEST: usize = 1000;

/// Replaces every pair that occurs in two lists or more by a new item, most frequent first. `new` returns the
/// item for a pair.
pub fn extract(lists: &mut [Vec<Item>], mut new: impl FnMut(Pair) -> u32) {
    let mut found = Found::default();
    for (index, list) in lists.iter().enumerate() {
        if list.len() <= LONGEST {
            found.enter(index, list, |_| true);
        }
    }
    let mut heap: BinaryHeap<(usize, Reverse<Pair>)> = found
        .pairs
        .iter()
        .filter(|(_, at)| at.len() > 1)
        .map(|(pair, at)| (at.len(), Reverse(*pair)))
        .collect();
    while let Some((count, Reverse(pair))) = heap.pop() {
        let Some(at) = found.pairs.get(&pair) else { continue };
        if at.len() != count {
            // The count is out of date, because the pair has lost occurrences; sort it in again.
            if at.len() > 1 {
                heap.push((at.len(), Reverse(pair)));
            }
            continue;
        }
        if count < 2 {
            continue;
        }
        let item = new(pair);
        let mut touched = BTreeSet::new();
        for index in at.clone() {
            let Some(list) = lists.get_mut(index) else { continue };
            // Pairs without the two items stay.
            let is_part = |other: Item| [pair.first, pair.second].contains(&other.id);
            found.leave(index, list, is_part);
            replace(list, pair, item);
            touched.extend(found.enter(index, list, |other| is_part(other) || other.id == item));
        }
        for pair in touched {
            let count = found.pairs.get(&pair).map_or(0, BTreeSet::len);
            if count > 1 {
                heap.push((count, Reverse(pair)));
            }
        }
    }
}

/// Replaces every occurrence of a pair by its item.
fn replace(list: &mut Vec<Item>, pair: Pair, item: u32) {
    while let Some((i, j)) = position(list, pair) {
        let negative = if list[i].id == pair.first { list[i].negative } else { list[j].negative };
        list.remove(i.max(j));
        list.remove(i.min(j));
        list.push(Item { id: item, negative });
    }
}

fn position(list: &[Item], pair: Pair) -> Option<(usize, usize)> {
    let is_part = |item: &Item| [pair.first, pair.second].contains(&item.id);
    for (i, &a) in list.iter().enumerate().filter(|(_, item)| is_part(item)) {
        for (j, &b) in list.iter().enumerate().skip(i + 1).filter(|(_, item)| is_part(item)) {
            if Pair::new(a, b) == pair {
                return Some((i, j));
            }
        }
    }
    None
}

/// The lists in which each pair occurs.
#[derive(Default)]
struct Found {
    pairs: BTreeMap<Pair, BTreeSet<usize>>,
}

impl Found {
    /// Records the pairs of a list of which at least one item satisfies `which`, and returns them.
    fn enter(&mut self, index: usize, list: &[Item], which: impl Fn(Item) -> bool) -> BTreeSet<Pair> {
        let pairs = pairs_of(list, which);
        for &pair in &pairs {
            self.pairs.entry(pair).or_default().insert(index);
        }
        pairs
    }

    /// Removes such pairs from the record.
    fn leave(&mut self, index: usize, list: &[Item], which: impl Fn(Item) -> bool) {
        for pair in pairs_of(list, which) {
            if let Some(at) = self.pairs.get_mut(&pair) {
                at.remove(&index);
            }
        }
    }
}

fn pairs_of(list: &[Item], which: impl Fn(Item) -> bool) -> BTreeSet<Pair> {
    let mut pairs = BTreeSet::new();
    for (i, &a) in list.iter().enumerate().filter(|(_, item)| which(**item)) {
        pairs.extend(list.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, &b)| Pair::new(a, b)));
    }
    pairs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn list(items: &[i32]) -> Vec<Item> {
        items.iter().map(|&item| Item { id: item.unsigned_abs(), negative: item < 0 }).collect()
    }

    #[test]
    fn the_most_frequent_pair_comes_out_first_with_its_sign() {
        let mut lists = vec![list(&[1, -2, 3]), list(&[-1, 2, 4]), list(&[1, -2]), list(&[3, 4])];
        let mut pairs = Vec::new();
        extract(&mut lists, |pair| {
            pairs.push(pair);
            99 + pairs.len() as u32
        });
        assert_eq!(pairs, [Pair { first: 1, second: 2, opposite: true }]);
        assert_eq!(lists, [list(&[3, 100]), list(&[4, -100]), list(&[100]), list(&[3, 4])]);
    }

    #[test]
    fn long_lists_become_one_item_or_stay() {
        let numbers: Vec<i32> = (1..=400).collect();
        let mut lists = vec![list(&numbers), list(&numbers), list(&(1..=1001).collect::<Vec<_>>())];
        let mut count = 2000;
        extract(&mut lists, |_| {
            count += 1;
            count
        });
        assert_eq!((lists[0].len(), lists[1].len(), lists[2].len()), (1, 1, 1001));
    }

    #[test]
    fn a_pair_within_a_pair_is_found() {
        let mut lists = vec![list(&[1, 2, 3]), list(&[1, 2, 3]), list(&[1, 1, 5])];
        let mut count = 99;
        extract(&mut lists, |_| {
            count += 1;
            count
        });
        assert_eq!(lists[0], lists[1]);
        assert_eq!(lists[0].len(), 1);
        assert_eq!(lists[2], list(&[1, 1, 5]));
    }
}
