//! Suggests the name nearest to a misspelled one.

/// The candidate nearest to `word`, if one is near enough to be meant.
pub fn nearest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let letters = word.chars().take(LETTERS).count();
    let allowed = match letters {
        0 => return None,
        1..=2 => 1,
        n => ((n + 1) / 3).max(1),
    };
    candidates
        .take(5_000)
        .filter(|candidate| *candidate != word)
        .filter_map(|candidate| {
            let others = candidate.chars().take(LETTERS + 1).count();
            if letters.abs_diff(others) > allowed {
                return None;
            }
            let distance = if candidate.eq_ignore_ascii_case(word) { 0 } else { distance(word, candidate) };
            // two names of one letter have nothing in common
            (distance <= allowed && distance < letters.max(others)).then_some((distance, candidate))
        })
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// The distance of two words by optimal string alignment: how many letters must be put in, taken out,
/// exchanged with their neighbour or replaced. At most 64 letters of each are looked at.
pub fn distance(a: &str, b: &str) -> usize {
    strsim::osa_distance(beginning(a), beginning(b))
}

/// The first letters of a word: long names are no typing mistakes of each other, and comparing them is slow.
fn beginning(word: &str) -> &str {
    word.char_indices().nth(LETTERS).map_or(word, |(end, _)| &word[..end])
}

/// How many letters are looked at.
const LETTERS: usize = 64;

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
