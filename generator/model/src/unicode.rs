//! Recognises letters that look like others: Cyrillic and Greek ones that look like Latin ones, and letters
//! that Unicode writes in two ways. Rust takes names for one that differ in the second alone (their
//! normalisation form C is the same), so that models must do so too.

use std::borrow::Cow;

/// Whether a character takes no room of its own, or turns the direction of writing.
pub fn is_invisible(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
}

/// Letters, each with the Latin one that it looks like.
const CYRILLIC: &[(char, char)] = &[
    ('а', 'a'),
    ('е', 'e'),
    ('о', 'o'),
    ('р', 'p'),
    ('с', 'c'),
    ('у', 'y'),
    ('х', 'x'),
    ('і', 'i'),
    ('ј', 'j'),
    ('ѕ', 's'),
    ('һ', 'h'),
    ('ԁ', 'd'),
    ('ԛ', 'q'),
    ('ԝ', 'w'),
    ('ѵ', 'v'),
    ('к', 'k'),
    ('м', 'm'),
    ('т', 't'),
    ('г', 'r'),
    ('п', 'n'),
    ('А', 'A'),
    ('В', 'B'),
    ('Е', 'E'),
    ('К', 'K'),
    ('М', 'M'),
    ('Н', 'H'),
    ('О', 'O'),
    ('Р', 'P'),
    ('С', 'C'),
    ('Т', 'T'),
    ('У', 'Y'),
    ('Х', 'X'),
    ('І', 'I'),
    ('Ј', 'J'),
    ('Ѕ', 'S'),
    ('Ԍ', 'G'),
    ('Ԛ', 'Q'),
    ('Ԝ', 'W'),
];

/// The same for Greek: only those that are hard to tell from Latin ones, for Greek letters are good names.
const GREEK: &[(char, char)] = &[
    ('ο', 'o'),
    ('ν', 'v'),
    ('Α', 'A'),
    ('Β', 'B'),
    ('Ε', 'E'),
    ('Ζ', 'Z'),
    ('Η', 'H'),
    ('Ι', 'I'),
    ('Κ', 'K'),
    ('Μ', 'M'),
    ('Ν', 'N'),
    ('Ο', 'O'),
    ('Ρ', 'P'),
    ('Τ', 'T'),
    ('Υ', 'Y'),
    ('Χ', 'X'),
];

/// A word with letters that look like Latin ones.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lookalike {
    /// the word in Latin letters
    pub latin: String,
    /// the first of the other letters
    pub letter: char,
    /// of which script it is
    pub script: &'static str,
}

impl Lookalike {
    /// What to do about it.
    pub fn advice(&self) -> String {
        format!("its `{}` is a {} letter: write `{}` in Latin letters", self.letter, self.script, self.latin)
    }
}

/// Reads letters that look like Latin ones as such. `None` if there are none, or other letters beside them.
pub fn lookalike(word: &str) -> Option<Lookalike> {
    let mut first = None;
    let mut latin = String::with_capacity(word.len());
    for c in word.chars() {
        let find =
            |table: &[(char, char)]| table.iter().find(|(other, _)| *other == c).map(|(_, latin)| *latin);
        let (read, script) = match (c.is_ascii(), find(CYRILLIC), find(GREEK)) {
            (true, ..) => (c, None),
            (false, Some(read), _) => (read, Some("Cyrillic")),
            (false, None, Some(read)) => (read, Some("Greek")),
            _ => return None,
        };
        latin.push(read);
        first = first.or(script.map(|script| (c, script)));
    }
    first.map(|(letter, script)| Lookalike { latin, letter, script })
}

/// The same where Latin letters stand beside Cyrillic ones: nobody means that.
pub fn mixed(word: &str) -> Option<Lookalike> {
    if word.is_ascii() || !word.contains(|c: char| c.is_ascii_alphabetic()) {
        return None;
    }
    lookalike(word).filter(|found| found.script == "Cyrillic")
}

/// Letters that are another one by definition: signs of units, and Greek letters with an acute accent.
const TWICE: &[(char, char)] = &[
    ('\u{212a}', 'K'),
    ('\u{212b}', 'Å'),
    ('\u{2126}', 'Ω'),
    ('\u{1f71}', 'ά'),
    ('\u{1f73}', 'έ'),
    ('\u{1f75}', 'ή'),
    ('\u{1f77}', 'ί'),
    ('\u{1f79}', 'ό'),
    ('\u{1f7b}', 'ύ'),
    ('\u{1f7d}', 'ώ'),
    ('\u{1fbb}', 'Ά'),
    ('\u{1fbe}', 'ι'),
    ('\u{1fc9}', 'Έ'),
    ('\u{1fcb}', 'Ή'),
    ('\u{1fd3}', 'ΐ'),
    ('\u{1fdb}', 'Ί'),
    ('\u{1fe3}', 'ΰ'),
    ('\u{1feb}', 'Ύ'),
    ('\u{1ff9}', 'Ό'),
    ('\u{1ffb}', 'Ώ'),
    ('\u{374}', 'ʹ'),
];

/// A name in the spelling that Rust gives it: the sign of kelvins is a K, that of ohms an omega.
pub fn normal(name: &str) -> Cow<'_, str> {
    let other = |c: char| TWICE.iter().find(|(twice, _)| *twice == c).map(|(_, letter)| *letter);
    if name.is_ascii() || !name.contains(|c| other(c).is_some()) {
        return Cow::Borrowed(name);
    }
    Cow::Owned(name.chars().map(|c| other(c).unwrap_or(c)).collect())
}

/// Letters that are the same as several in a row, or as another one that is seldom met, by definition.
const COMPOSED: &[(u32, u32)] = &[
    (0x0345, 0x0345),
    (0x0653, 0x0655),
    (0x0958, 0x095f),
    (0x09dc, 0x09df),
    (0x0a33, 0x0a36),
    (0x0a59, 0x0a5e),
    (0x0b5c, 0x0b5d),
    (0x0f43, 0x0f43),
    (0x0f4d, 0x0f4d),
    (0x0f52, 0x0f52),
    (0x0f57, 0x0f57),
    (0x0f5c, 0x0f5c),
    (0x0f69, 0x0f69),
    (0x0f73, 0x0f81),
    (0x0f93, 0x0fb9),
    (0x1160, 0x11ff),
    (0xf900, 0xfaff),
    (0xfb1d, 0xfb4e),
    (0x113b8, 0x113c9),
    (0x1611e, 0x16129),
    (0x16d63, 0x16d6a),
    (0x2f800, 0x2fa1f),
];

/// Signs that together with one before them are the same as a third: of each, the signs before it.
const COMPOSING: &[(&[u32], &[u32])] = &[
    (&[0x9be, 0x9d7], &[0x9c7]),
    (&[0xb3e, 0xb56, 0xb57], &[0xb47]),
    (&[0xbbe, 0xbd7], &[0xb92, 0xbc6, 0xbc7]),
    (&[0xc56], &[0xc46]),
    (&[0xcc2, 0xcd5, 0xcd6], &[0xcbf, 0xcc6, 0xcca]),
    (&[0xd3e, 0xd57], &[0xd46, 0xd47]),
    (&[0xdcf, 0xddf], &[0xdd9]),
    (&[0x102e], &[0x1025]),
    (&[0x1b35], &[0x1b05, 0x1b07, 0x1b09, 0x1b0b, 0x1b0d, 0x1b11, 0x1b3a, 0x1b3c, 0x1b3e, 0x1b3f, 0x1b42]),
    (&[0x11127], &[0x11131, 0x11132]),
    (&[0x1133e, 0x11357], &[0x11347]),
    (&[0x114b0, 0x114ba, 0x114bd], &[0x114b9]),
    (&[0x115af], &[0x115b8, 0x115b9]),
    (&[0x11930], &[0x11935]),
];

/// The first letter of a name that has a second spelling, which [`normal`] does not know.
pub fn with_two_spellings(name: &str) -> Option<char> {
    let mut before = 0;
    name.chars().find(|&c| {
        let c = c as u32;
        let last = std::mem::replace(&mut before, c);
        let composes = |(second, first): &(&[u32], &[u32])| second.contains(&c) && first.contains(&last);
        COMPOSED.iter().any(|(from, to)| (from..=to).contains(&&c)) || COMPOSING.iter().any(composes)
    })
}

#[cfg(test)]
mod tests {
    use unicode_normalization::UnicodeNormalization;
    use unicode_normalization::char::{compose, is_combining_mark};

    use super::*;

    /// Every name that may be declared has one spelling, by the tables of Unicode.
    #[test]
    fn names_have_one_spelling() {
        let letter = |c: &char| c.is_alphanumeric();
        let letters: Vec<char> = (0..=0x10_ffff).filter_map(char::from_u32).filter(letter).collect();
        for &c in &letters {
            let name = c.to_string();
            if with_two_spellings(&name).is_none() {
                assert_eq!(normal(&name), name.nfc().collect::<String>(), "U+{:04X}", c as u32);
            }
        }
        // pairs that make a third: the second is a mark, or a vowel of Korean
        let joins = |c: &&char| {
            is_combining_mark(**c)
                || (0x1160..0x1200).contains(&(**c as u32))
                || (0x16d63..0x16d6b).contains(&(**c as u32))
        };
        let marks: Vec<char> = letters.iter().filter(joins).copied().collect();
        for &a in &letters {
            for &b in &marks {
                if compose(a, b).is_some() {
                    let found = with_two_spellings(&format!("{a}{b}"));
                    assert!(found.is_some(), "U+{:04X} U+{:04X}", a as u32, b as u32);
                }
            }
        }
        assert_eq!(normal("\u{212a}1"), "K1");
        assert_eq!(normal("ΩK"), "ΩK");
    }

    #[test]
    fn letters_that_look_alike() {
        let found = mixed("m\u{0430}ss").unwrap();
        assert_eq!((found.latin.as_str(), found.letter, found.script), ("mass", '\u{0430}', "Cyrillic"));
        assert_eq!(lookalike("\u{0441}").unwrap().latin, "c");
        assert_eq!(mixed("\u{0441}"), None);
        assert_eq!(mixed("mass"), None);
        // Greek letters are good names, and a Russian word is one too
        assert_eq!(mixed("q_α"), None);
        assert_eq!(mixed("масса"), None);
        assert_eq!(lookalike("угол"), None);
    }
}
