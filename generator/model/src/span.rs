//! Places in the text of a model.

use std::ops::Range;

/// A place in the source: bytes of a file, or tokens of an inline model (see `syntax`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// first byte (file) or first token (inline)
    pub start: u32,
    /// one past the last
    pub end: u32,
}

impl Span {
    /// The place as a range.
    pub fn range(self) -> Range<usize> {
        self.start as usize..self.end as usize
    }

    /// The smallest place that holds both.
    pub fn to(self, other: Span) -> Span {
        Span { start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// Line and column, both from 1; the column counts characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Location {
    /// line, from 1
    pub line: usize,
    /// column in characters, from 1
    pub column: usize,
}
