//! The layout of `fmt` as small changes, so that an editor keeps its cursor and its marks.

use hodograph_model::format;
use hodograph_model::source::Source;
use hodograph_model::span::Span;

use crate::Document;
use crate::text::Edit;

impl Document {
    /// The changes that `fmt` would make; `None` if the text cannot be parsed.
    pub fn layout(&self) -> Option<Vec<Edit>> {
        let source = Source::file("", self.text.as_str());
        let formatted = format::format(&source).ok()?;
        Some(changes(self.text.as_str(), &formatted))
    }
}

/// The changes of blanks. All other text is the same in both; if it is not, the result is one change of the
/// whole.
fn changes(before: &str, after: &str) -> Vec<Edit> {
    if before == after {
        return Vec::new();
    }
    let whole = |text: &str| Span { start: 0, end: text.len() as u32 };
    let mut edits = Vec::new();
    let (mut a, mut b) = (before, after);
    loop {
        let blank = |text: &str| text.len() - text.trim_start().len();
        let (gap_a, gap_b) = (blank(a), blank(b));
        if a[..gap_a] != b[..gap_b] {
            let start = (before.len() - a.len()) as u32;
            let span = Span { start, end: start + gap_a as u32 };
            edits.push(Edit { span, text: b[..gap_b].to_owned() });
        }
        (a, b) = (&a[gap_a..], &b[gap_b..]);
        let word = |text: &str| text.find(char::is_whitespace).unwrap_or(text.len());
        // where a blank is inserted or removed, the shorter word ends
        let same = word(a).min(word(b));
        if a.get(..same) != b.get(..same) {
            return vec![Edit { span: whole(before), text: after.to_owned() }];
        }
        (a, b) = (&a[same..], &b[same..]);
        if a.is_empty() && b.is_empty() {
            return edits;
        }
        if same == 0 && gap_a == 0 && gap_b == 0 {
            return vec![Edit { span: whole(before), text: after.to_owned() }];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::apply;

    #[test]
    fn only_blanks_change() {
        for (before, after) in [
            ("a:m=1,b", "a: m = 1,\nb\n"),
            ("  a\r\n\tb c", "a\nb c"),
            ("a", "a"),
            ("x\n", "y\n"),
            ("", "a"),
            ("π=1 ", "π = 1"),
        ] {
            let edits = changes(before, after);
            assert_eq!(apply(before, &edits), after);
        }
        assert_eq!(changes("a:m", "a: m").len(), 1);
    }
}
