//! Recognises Cyrillic and Greek letters that look like Latin ones.

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

#[cfg(test)]
mod tests {
    use super::*;

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
