//! A text with its lines, and positions as editors count them.

use hodograph_model::span::Span;

/// The unit in which an editor counts the characters of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Encoding {
    /// bytes of UTF-8
    Utf8,
    /// units of UTF-16: characters beyond U+FFFF count twice
    #[default]
    Utf16,
    /// characters
    Utf32,
}

/// Line and character, both from 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position {
    /// line
    pub line: u32,
    /// units before it in its line
    pub character: u32,
}

/// A change of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// the place of the replaced text
    pub span: Span,
    /// the new text
    pub text: String,
}

/// A text with the places of its lines. Lines end with a line feed, a carriage return, or both.
#[derive(Clone, Debug)]
pub struct Text {
    text: String,
    starts: Vec<u32>,
}

impl Text {
    /// The text with its lines.
    pub fn new(text: String) -> Text {
        let bytes = text.as_bytes();
        let ends = bytes.iter().enumerate().filter(|(i, byte)| match byte {
            b'\n' => true,
            b'\r' => bytes.get(i + 1) != Some(&b'\n'),
            _ => false,
        });
        let starts = std::iter::once(0).chain(ends.map(|(i, _)| i as u32 + 1)).collect();
        Text { text, starts }
    }

    /// All of it.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// The text at a place; empty if the place is not in the text.
    pub fn at(&self, span: Span) -> &str {
        self.text.get(span.range()).unwrap_or_default()
    }

    /// The number of lines.
    pub fn lines(&self) -> u32 {
        self.starts.len() as u32
    }

    /// The line of a place, from 0.
    pub fn line_of(&self, offset: u32) -> u32 {
        (self.starts.partition_point(|start| *start <= offset) - 1) as u32
    }

    /// The place of a line without its line end.
    pub fn line(&self, line: u32) -> Span {
        let Some(&start) = self.starts.get(line as usize) else {
            let end = self.text.len() as u32;
            return Span { start: end, end };
        };
        let end = self.starts.get(line as usize + 1).map_or(self.text.len(), |next| *next as usize);
        let whole = &self.text[start as usize..end];
        Span { start, end: start + whole.trim_end_matches(['\n', '\r']).len() as u32 }
    }

    /// The position of a byte. A place inside a character counts as its beginning.
    pub fn position(&self, offset: u32, encoding: Encoding) -> Position {
        let mut offset = (offset as usize).min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.line_of(offset as u32);
        let before = &self.text[self.starts[line as usize] as usize..offset];
        let character = match encoding {
            Encoding::Utf8 => before.len(),
            Encoding::Utf16 => before.chars().map(char::len_utf16).sum(),
            Encoding::Utf32 => before.chars().count(),
        };
        Position { line, character: character as u32 }
    }

    /// The byte of a position. A position after the end of a line is moved to that end, one after the last
    /// line to the end of the text, and one inside a character to the end of that character.
    pub fn offset(&self, position: Position, encoding: Encoding) -> u32 {
        let line = self.line(position.line);
        let mut units = 0;
        for (i, c) in self.at(line).char_indices() {
            if units >= position.character {
                return line.start + i as u32;
            }
            units += match encoding {
                Encoding::Utf8 => c.len_utf8(),
                Encoding::Utf16 => c.len_utf16(),
                Encoding::Utf32 => 1,
            } as u32;
        }
        line.end
    }

    /// The text after a change. An invalid place is moved to the nearest valid one.
    pub fn edited(&self, edit: &Edit) -> String {
        let bound = |offset: u32| {
            let mut offset = (offset as usize).min(self.text.len());
            while !self.text.is_char_boundary(offset) {
                offset -= 1;
            }
            offset
        };
        let start = bound(edit.span.start);
        let end = bound(edit.span.end).max(start);
        [&self.text[..start], &edit.text, &self.text[end..]].concat()
    }
}

/// A text after changes that do not overlap.
pub fn apply(text: &str, edits: &[Edit]) -> String {
    let mut edits: Vec<&Edit> = edits.iter().collect();
    edits.sort_by_key(|edit| edit.span);
    let (mut out, mut at) = (String::with_capacity(text.len()), 0);
    for edit in edits {
        out.push_str(text.get(at..edit.span.start as usize).unwrap_or_default());
        out.push_str(&edit.text);
        at = edit.span.end as usize;
    }
    out + text.get(at..).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_bytes_are_inverse() {
        let text = Text::new("\u{feff}a\r\nπ = 𝛼;\n\rx\n".to_owned());
        assert_eq!(text.lines(), 5);
        for encoding in [Encoding::Utf8, Encoding::Utf16, Encoding::Utf32] {
            for (i, _) in text.as_str().char_indices().filter(|(_, c)| !"\r\n".contains(*c)) {
                let position = text.position(i as u32, encoding);
                assert_eq!(text.offset(position, encoding), i as u32, "{i} {encoding:?} {position:?}");
            }
        }
        // the letter beyond U+FFFF counts twice in UTF-16
        let after = text.as_str().find(';').unwrap() as u32;
        assert_eq!(text.position(after, Encoding::Utf16), Position { line: 1, character: 6 });
        assert_eq!(text.position(after, Encoding::Utf32), Position { line: 1, character: 5 });
        assert_eq!(text.offset(Position { line: 1, character: 999 }, Encoding::Utf16), after + 1);
        assert_eq!(text.offset(Position { line: 99, character: 0 }, Encoding::Utf16), 20);
        // within the letter
        let within = Position { line: 1, character: 5 };
        assert_eq!(text.offset(within, Encoding::Utf16), after);
    }

    #[test]
    fn edits_never_cut_a_character() {
        let text = Text::new("aπb".to_owned());
        let edit = |start, end| text.edited(&Edit { span: Span { start, end }, text: "-".to_owned() });
        assert_eq!(edit(1, 3), "a-b");
        assert_eq!(edit(2, 2), "a-πb");
        assert_eq!(edit(9, 2), "aπb-");
    }
}
