//! Line and column of an offset in a text, by binary search.

/// The beginnings of the lines of a text.
pub struct Lines<'a> {
    text: &'a str,
    starts: Vec<usize>,
}

impl<'a> Lines<'a> {
    /// The lines of a text.
    pub fn of(text: &'a str) -> Self {
        let starts = [0].into_iter().chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Lines { text, starts }
    }

    /// `3:14`: line and column of a byte, both counted from 1; the column counts characters.
    pub fn place(&self, offset: usize) -> String {
        let line = self.starts.partition_point(|&start| start <= offset).max(1);
        let before = self.text.get(self.starts[line - 1]..offset);
        format!("{line}:{}", before.map_or(0, |before| before.chars().count()) + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_count_characters() {
        let lines = Lines::of("äb\n\ncd");
        for (offset, place) in [(0, "1:1"), (2, "1:2"), (3, "1:3"), (4, "2:1"), (5, "3:1"), (7, "3:3")] {
            assert_eq!(lines.place(offset), place, "{offset}");
        }
        assert_eq!(Lines::of("").place(0), "1:1");
    }
}
