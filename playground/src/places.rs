//! Bytes of a text, and places in it as JavaScript counts them.

use hodograph_language::Span;
use serde_json::Value;

use crate::answer::object;

/// Converts between bytes and units of UTF-16.
pub struct Places<'a> {
    text: &'a str,
    plain: bool,
}

impl<'a> Places<'a> {
    /// Those of a text.
    pub fn new(text: &'a str) -> Self {
        Places { text, plain: text.is_ascii() }
    }

    /// The units before a byte.
    pub fn units(&self, byte: u32) -> u32 {
        let mut byte = (byte as usize).min(self.text.len());
        if self.plain {
            return byte as u32;
        }
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        self.text[..byte].chars().map(char::len_utf16).sum::<usize>() as u32
    }

    /// The byte after so many units.
    pub fn byte(&self, units: u32) -> u32 {
        if self.plain {
            return units.min(self.text.len() as u32);
        }
        let mut seen = 0;
        for (byte, letter) in self.text.char_indices() {
            if seen >= units {
                return byte as u32;
            }
            seen += letter.len_utf16() as u32;
        }
        self.text.len() as u32
    }

    /// Beginning and end of a place.
    pub fn span(&self, span: Span) -> [u32; 2] {
        [self.units(span.start), self.units(span.end)]
    }

    /// Changes of the text.
    pub fn edits(&self, edits: &[hodograph_language::text::Edit]) -> Value {
        let one = |edit: &hodograph_language::text::Edit| {
            let [from, to] = self.span(edit.span);
            object!({ "from": from, "to": to, "insert": edit.text.as_str() })
        };
        edits.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Places;

    #[test]
    fn places_go_there_and_back_in_texts_with_letters_of_all_lengths() {
        for text in ["", "abc", "\u{3b1} = 1;", "\u{1f600}x\u{20ac}y"] {
            let places = Places::new(text);
            for (byte, _) in text.char_indices() {
                assert_eq!(places.byte(places.units(byte as u32)), byte as u32, "{text}");
            }
            assert_eq!(places.units(99) as usize, text.encode_utf16().count());
            assert_eq!(places.byte(99) as usize, text.len());
        }
    }
}
