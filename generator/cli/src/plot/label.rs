//! Text of figures: words, symbols and their indices.
//!
//! A label is a single string, so that it can pass through `plotters`; characters of Unicode's private use
//! area, which do not occur in words, mark the beginnings of symbols and indices.

/// The typeface of a piece of a label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// upright
    Word,
    /// italic
    Symbol,
    /// small and lowered
    Index,
    /// small and raised
    Exponent,
}

const STARTS: [(char, Kind); 4] = [
    ('\u{e000}', Kind::Word),
    ('\u{e001}', Kind::Symbol),
    ('\u{e002}', Kind::Index),
    ('\u{e003}', Kind::Exponent),
];

/// Text with symbols and indices.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Label(String);

impl Label {
    /// A label of words.
    pub fn words(text: &str) -> Self {
        Label::default().then(text)
    }

    /// A symbol with an index, which may be empty: v and t for v_t.
    pub fn symbol(symbol: &str, index: &str) -> Self {
        Label::default().with(symbol, index)
    }

    #[allow(dead_code)] // for figures over time
    /// The name of a quantity of a model; its trailing digits are the index.
    pub fn name(name: &str) -> Self {
        let head = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
        match head {
            "" => Label::symbol(name, ""),
            _ => Label::symbol(head, &name[head.len()..]),
        }
    }

    /// Appends words.
    pub fn then(self, text: &str) -> Self {
        self.push(Kind::Word, text)
    }

    /// Appends a symbol with its index.
    pub fn with(self, symbol: &str, index: &str) -> Self {
        self.push(Kind::Symbol, symbol).push(Kind::Index, index)
    }

    /// Appends a power of ten.
    pub fn with_power_of_ten(self, exponent: i32) -> Self {
        let exponent = exponent.to_string().replace('-', "\u{2212}");
        self.push(Kind::Word, "10").push(Kind::Exponent, &exponent)
    }

    /// The text with its marks, which the canvas interprets.
    pub fn marked(&self) -> &str {
        &self.0
    }

    /// The pieces of marked text.
    pub fn pieces(marked: &str) -> impl Iterator<Item = (Kind, &str)> {
        let kind_of = |letter: char| STARTS.iter().find(|(start, _)| *start == letter).map(|(_, kind)| *kind);
        let mut rest = marked;
        std::iter::from_fn(move || {
            let first = rest.chars().next()?;
            let (kind, text) = match kind_of(first) {
                Some(kind) => (kind, &rest[first.len_utf8()..]),
                None => (Kind::Word, rest),
            };
            let end = text.find(|letter| kind_of(letter).is_some()).unwrap_or(text.len());
            rest = &text[end..];
            Some((kind, &text[..end]))
        })
        .filter(|(_, text)| !text.is_empty())
    }

    /// The text without its marks: v_t, 10^-3.
    pub fn plain(&self) -> String {
        let piece = |(kind, text): (Kind, &str)| match kind {
            Kind::Word | Kind::Symbol => text.to_owned(),
            Kind::Index => format!("_{text}"),
            Kind::Exponent => format!("^{text}"),
        };
        Self::pieces(&self.0).map(piece).collect()
    }

    fn push(mut self, kind: Kind, text: &str) -> Self {
        if !text.is_empty() {
            self.0.extend(STARTS.iter().find(|(_, known)| *known == kind).map(|(start, _)| start));
            let allowed = |letter: &char| !letter.is_control() && !('\u{e000}'..='\u{f8ff}').contains(letter);
            self.0.extend(text.chars().filter(allowed));
        }
        self
    }
}

impl From<&str> for Label {
    fn from(text: &str) -> Self {
        Label::words(text)
    }
}

impl From<String> for Label {
    fn from(text: String) -> Self {
        Label::words(&text)
    }
}
