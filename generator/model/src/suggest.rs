//! Suggests the name nearest to a misspelled one.

/// The candidate nearest to `word`, if one is near enough to be meant.
pub fn nearest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // long names are no typing mistakes of each other, and comparing them is slow
    let letters: Vec<char> = word.chars().take(64).collect();
    let allowed = match letters.len() {
        0 => return None,
        1..=2 => 1,
        n => ((n + 1) / 3).max(1),
    };
    candidates
        .take(5_000)
        .filter(|candidate| *candidate != word)
        .filter_map(|candidate| {
            let other: Vec<char> = candidate.chars().take(65).collect();
            if letters.len().abs_diff(other.len()) > allowed {
                return None;
            }
            let same_but_for_case = candidate.eq_ignore_ascii_case(word);
            let distance = if same_but_for_case { 0 } else { between(&letters, &other) };
            // two names of one letter have nothing in common
            (distance <= allowed && distance < letters.len().max(other.len()))
                .then_some((distance, candidate))
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// The distance of two words by optimal string alignment: how many letters must be put in, taken out,
/// exchanged with their neighbour or replaced. At most 64 letters of each are looked at.
pub fn distance(a: &str, b: &str) -> usize {
    let letters = |word: &str| word.chars().take(64).collect::<Vec<char>>();
    between(&letters(a), &letters(b))
}

fn between(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 0..a.len() {
        let mut row = vec![i + 1];
        for j in 0..b.len() {
            let replaced = last[j] + usize::from(a[i] != b[j]);
            let mut best = replaced.min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j] {
                best = best.min(before[j - 1] + 1);
            }
            row.push(best);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn typing_mistakes_are_recognised() {
        let names = ["parameters", "points", "gamma", "q1", "BcAc"];
        assert_eq!(nearest("paramters", names.into_iter()), Some("parameters"));
        assert_eq!(nearest("gmama", names.into_iter()), Some("gamma"));
        assert_eq!(nearest("bcac", names.into_iter()), Some("BcAc"));
        assert_eq!(nearest("q7", names.into_iter()), Some("q1"));
        assert_eq!(nearest("z", names.into_iter()), None);
        assert_eq!(nearest("something", names.into_iter()), None);
    }
}
