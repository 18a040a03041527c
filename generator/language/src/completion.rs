//! Proposals for the text at a place, the best first.

use hodograph_model::model::names::Symbol;
use hodograph_model::model::symbols::Declared;
use hodograph_model::span::Span;
use hodograph_model::syntax::token::TokenKind;
use hodograph_model::syntax::tree::Section;
use hodograph_model::syntax::units;
use hodograph_model::words::{self, Word};

use crate::Document;
use crate::context::{Context, Kinds, call, context};
use crate::expected::Expected;
use crate::hover::in_words;

/// The kind of a proposal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proposed {
    /// a declared or predefined name
    Name(Symbol),
    /// a word of the language
    Word,
    /// a section
    Section,
    /// a field
    Field,
    /// a function
    Function,
    /// a member of a frame, after the dot
    Member,
    /// a unit
    Unit,
}

/// A proposal for completion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Proposal {
    /// the text
    pub label: String,
    /// its kind
    pub kind: Proposed,
    /// its dimension, or its syntax
    pub detail: String,
    /// its documentation
    pub docs: String,
    /// 0 if its dimension fits, 1 if it may fit, 2 if it does not
    pub rank: u8,
}

/// A function or load, and its argument at the cursor.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// its syntax
    pub form: &'static str,
    /// its meaning
    pub meaning: &'static str,
    /// index of the argument, from 0
    pub argument: usize,
}

impl Document {
    /// The incomplete word at a place, if there is one, and the number of tokens before it.
    fn word_before(&self, offset: u32) -> (Option<Span>, usize) {
        let tokens = self.tokens();
        let before = tokens.partition_point(|token| token.span.end < offset);
        // of two tokens that touch at the place, the name is taken
        let touching = (before..tokens.len()).take_while(|i| tokens[*i].span.start < offset);
        match touching.clone().find(|i| tokens[*i].kind == TokenKind::Name) {
            Some(i) => (Some(tokens[i].span), i),
            None => (None, before + touching.count()),
        }
    }

    /// Whether a place is inside a comment.
    fn in_comment(&self, offset: u32) -> bool {
        let is_comment =
            |kind| matches!(kind, crate::colours::Kind::Comment | crate::colours::Kind::Documentation);
        let line = self.text.line_of(offset);
        let whole = self.text.line(line);
        // a line comment, or a block comment around the place
        if !self.text.at(whole).contains("//") && !self.text.as_str().contains("/*") {
            return false;
        }
        self.colours()
            .iter()
            .any(|word| is_comment(word.kind) && word.span.start < offset && offset <= word.span.end)
    }

    /// The proposals at a place, the best first.
    pub fn completion(&self, offset: u32) -> Vec<Proposal> {
        if self.in_comment(offset) {
            return Vec::new();
        }
        let (word, count) = self.word_before(offset);
        // numbers are not completed
        let tokens = self.tokens();
        if count > 0 && tokens[count - 1].kind == TokenKind::Number && tokens[count - 1].span.end >= offset {
            return Vec::new();
        }
        let mut out = match context(&tokens[..count]) {
            Context::Nothing => Vec::new(),
            Context::Start => {
                vec![proposal(words::look(words::WORDS, "mechanism"), "mechanism", Proposed::Word)]
            }
            Context::Sections => self.sections(),
            Context::Words(list) => list.iter().map(|text| plain(text)).collect(),
            Context::Fields(list) => {
                let field = |text: &&str| proposal(words::look(words::FIELDS, text), text, Proposed::Field);
                let mut out: Vec<Proposal> = list.iter().map(field).collect();
                // `Foot on Floor`
                if list.contains(&"normal") {
                    out.extend(self.expression(Kinds::SHAPES, false, &[], Expected::default()));
                }
                out
            }
            Context::Loads => from_table(words::LOAD_FORMS, Proposed::Word),
            Context::Laws(list) => from_table(list, Proposed::Word),
            Context::Members { orients } => {
                let orientation = |word: &&Word| words::ORIENTATIONS.contains(&word.text);
                let members = words::MEMBERS.iter().filter(|word| orientation(word) == orients);
                members.map(|word| proposal(Some(word), word.text, Proposed::Member)).collect()
            }
            Context::Unit => self.unit_proposals(offset),
            Context::Expression { kinds, functions, words } => {
                let wanted = functions.then(|| self.expected_behind(count, word, offset)).flatten();
                let expected = wanted.unwrap_or_default();
                self.expression(kinds, functions, &words, expected)
            }
        };
        let given = |proposal: &Proposal| words::look(words::GIVEN, &proposal.label).is_some();
        out.sort_by_key(|proposal| (proposal.rank, given(proposal)));
        out
    }

    fn sections(&self) -> Vec<Proposal> {
        let there = |word: &str| {
            let section = Section::of_word(word);
            self.tree().sections.iter().any(|(other, _)| Some(*other) == section)
        };
        let missing = words::SECTIONS.iter().filter(|word| !there(word.text));
        missing.map(|word| proposal(Some(word), word.text, Proposed::Section)).collect()
    }

    /// Units that occur in the model come first.
    fn unit_proposals(&self, offset: u32) -> Vec<Proposal> {
        let used = self.units();
        let used = used.into_iter().filter(|span| offset < span.start || span.end < offset);
        let mut texts: Vec<String> = Vec::new();
        for text in used.map(|span| self.text.at(span).to_owned()) {
            if !text.is_empty() && !texts.contains(&text) {
                texts.push(text);
            }
        }
        let unit = |label: String, detail: String, rank| Proposal {
            label,
            kind: Proposed::Unit,
            detail,
            docs: String::new(),
            rank,
        };
        let mut out: Vec<Proposal> =
            texts.iter().map(|text| unit(text.clone(), "used in this model".to_owned(), 0)).collect();
        let common = ["1", "kg", "kg*m^2", "m/s", "m/s^2", "rad/s", "N*m", "N/m", "N*s/m", "mm", "cm"];
        let rest = units::symbols().map(|(text, dimension)| (text, in_words(Some(dimension))));
        let all = common.iter().map(|text| (*text, String::new())).chain(rest);
        for (text, detail) in all {
            if !out.iter().any(|other| other.label == text) {
                out.push(unit(text.to_owned(), detail, 1));
            }
        }
        out
    }

    fn expression(&self, kinds: Kinds, functions: bool, list: &[&str], expected: Expected) -> Vec<Proposal> {
        let fits = |declared: &Declared| of_kind(declared.symbol, kinds, functions);
        let names = self.symbols().declared.iter().filter(|declared| fits(declared));
        let mut out: Vec<Proposal> = names.map(|declared| self.name(declared, expected, functions)).collect();
        out.extend(list.iter().map(|text| plain(text)));
        if functions {
            let vector = |word: &Word| {
                ["cross", "unit", "position", "velocity", "angular_velocity"].contains(&word.text)
            };
            for word in words::FUNCTIONS {
                let rank = match expected.is_vector {
                    Some(wanted) if wanted != vector(word) => 2,
                    _ => 1,
                };
                out.push(Proposal { rank, ..proposal(Some(word), word.text, Proposed::Function) });
            }
        }
        out
    }

    fn name(&self, declared: &Declared, expected: Expected, in_expression: bool) -> Proposal {
        let known = matches!(
            declared.symbol,
            Symbol::Parameter(_)
                | Symbol::Input(_)
                | Symbol::Coordinate(_)
                | Symbol::Speed(_)
                | Symbol::Definition(_)
        );
        let valued = known || matches!(declared.symbol, Symbol::Time | Symbol::Pi);
        let other_kind = expected.is_vector.is_some_and(|wanted| wanted != declared.is_vector);
        let rank = match (valued, expected.dimension, declared.dimension) {
            // an axis of the frame is a vector
            (false, ..) if matches!(declared.symbol, Symbol::Frame(_)) => {
                u8::from(in_expression && expected.is_vector != Some(true))
            }
            (false, ..) => 0,
            (true, Some(wanted), Some(dimension)) if wanted == dimension && !other_kind => 0,
            // a scalar times an axis is a vector
            (true, Some(wanted), Some(dimension)) if wanted == dimension => 1,
            (true, Some(_), _) => 2,
            (true, None, _) => u8::from(!known || other_kind),
        };
        let kind = declared.symbol.kind();
        let detail = match valued {
            true => format!("{kind}, {}", in_words(declared.dimension)),
            false => kind.to_owned(),
        };
        let (label, kind) = (declared.name.clone(), Proposed::Name(declared.symbol));
        Proposal { label, kind, detail, docs: declared.docs.clone(), rank }
    }

    /// The function whose arguments are at a place.
    pub fn signature(&self, offset: u32) -> Option<Signature> {
        let count = self.tokens().partition_point(|token| token.span.end <= offset);
        let (name, argument) = call(&self.tokens()[..count])?;
        let text = self.tokens()[name].text.as_str();
        let member = name > 0 && self.tokens()[name - 1].is_sign('.');
        let word = match member {
            true => words::look(words::MEMBERS, text),
            false => {
                words::look(words::FUNCTIONS, text).or_else(|| words::look(words::START_FUNCTIONS, text))
            }
        }?;
        Some(Signature { form: word.form, meaning: word.meaning, argument })
    }
}

/// Whether a symbol is of one of these kinds; if functions are allowed, numbers are, too.
fn of_kind(symbol: Symbol, kinds: Kinds, numbers: bool) -> bool {
    match symbol {
        Symbol::Parameter(_) => kinds.parameters,
        Symbol::Input(_) => kinds.inputs,
        Symbol::Coordinate(_) => kinds.coordinates,
        Symbol::Speed(_) => kinds.speeds,
        Symbol::Definition(_) | Symbol::Time => kinds.definitions,
        Symbol::Pi => numbers,
        Symbol::Frame(_) => kinds.frames,
        Symbol::Point(_) => kinds.points,
        Symbol::Body(_) => kinds.bodies,
        Symbol::Shape(_) => kinds.shapes,
        Symbol::Contact(_) => kinds.contacts,
        Symbol::Broken => false,
    }
}

fn plain(text: &str) -> Proposal {
    let word = words::look(words::WORDS, text).or_else(|| words::look(words::START_FUNCTIONS, text));
    proposal(word, text, Proposed::Word)
}

fn from_table(table: &'static [Word], kind: Proposed) -> Vec<Proposal> {
    table.iter().map(|word| proposal(Some(word), word.text, kind)).collect()
}

fn proposal(word: Option<&Word>, text: &str, kind: Proposed) -> Proposal {
    let (detail, docs) = word.map_or(("", ""), |word| (word.form, word.meaning));
    Proposal { label: text.to_owned(), kind, detail: detail.to_owned(), docs: docs.to_owned(), rank: 1 }
}
