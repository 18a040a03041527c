//! What is allowed at a place, judged by the tokens before it; the text may be incomplete.

use hodograph_model::model::mechanism::Kind;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;
use hodograph_model::words;

/// Kinds of names.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Kinds {
    /// parameters
    pub parameters: bool,
    /// inputs
    pub inputs: bool,
    /// coordinates
    pub coordinates: bool,
    /// speeds
    pub speeds: bool,
    /// definitions, and the time
    pub definitions: bool,
    /// frames
    pub frames: bool,
    /// points
    pub points: bool,
    /// bodies
    pub bodies: bool,
    /// shapes
    pub shapes: bool,
    /// contacts
    pub contacts: bool,
}

impl Kinds {
    /// names that have a value
    pub const VALUES: Kinds = Kinds {
        parameters: true,
        inputs: true,
        coordinates: true,
        speeds: true,
        definitions: true,
        frames: false,
        points: false,
        bodies: false,
        shapes: false,
        contacts: false,
    };
    const NONE: Kinds = Kinds {
        parameters: false,
        inputs: false,
        coordinates: false,
        speeds: false,
        definitions: false,
        ..Kinds::VALUES
    };
    const FRAMES: Kinds = Kinds { frames: true, ..Kinds::NONE };
    const POINTS: Kinds = Kinds { points: true, ..Kinds::NONE };
    const BODIES: Kinds = Kinds { bodies: true, ..Kinds::NONE };
    /// only shapes
    pub const SHAPES: Kinds = Kinds { shapes: true, ..Kinds::NONE };
    const CONTACTS: Kinds = Kinds { contacts: true, ..Kinds::NONE };
    const FRAMES_AND_BODIES: Kinds = Kinds { bodies: true, ..Kinds::FRAMES };
    const STARTS: Kinds = Kinds { parameters: true, coordinates: true, speeds: true, ..Kinds::NONE };
}

/// What is allowed at a place.
#[derive(Clone, Debug)]
pub enum Context {
    /// a new name, or unknown
    Nothing,
    /// `mechanism`
    Start,
    /// the word of a section
    Sections,
    /// one of these words
    Words(Vec<&'static str>),
    /// one of these fields, which are still missing
    Fields(Vec<&'static str>),
    /// a load
    Loads,
    /// a unit
    Unit,
    /// a member of a frame, after its dot
    Members {
        /// whether it is the value of a frame
        orients: bool,
    },
    /// an expression with names of these kinds and axes of frames
    Expression {
        /// names
        kinds: Kinds,
        /// whether functions are allowed
        functions: bool,
        /// further words that are allowed
        words: Vec<&'static str>,
    },
    /// the name of a hypothesis or law
    Laws(&'static [words::Word]),
}

/// An open bracket at a place.
struct Level {
    bracket: char,
    /// index of the bracket
    at: usize,
    /// index of the first token of the incomplete statement
    start: usize,
    /// number of commas in the bracket before the place
    commas: usize,
}

/// The brackets that are open after the last token.
fn levels(tokens: &[Token]) -> Vec<Level> {
    let mut open: Vec<Level> = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(bracket) => {
                let section = i > 0 && bracket == '{' && Section::of_word(&tokens[i - 1].text).is_some();
                if section && tokens[i - 1].kind == TokenKind::Name {
                    open.clear();
                }
                open.push(Level { bracket, at: i, start: i + 1, commas: 0 });
            }
            TokenKind::Close(bracket) => {
                if bracket == '}' {
                    while open.last().is_some_and(|level| level.bracket != '{') {
                        open.pop();
                    }
                }
                open.pop();
            }
            TokenKind::Sign(sign @ (',' | ';')) => {
                while sign == ';' && open.last().is_some_and(|level| level.bracket != '{') {
                    open.pop();
                }
                if let Some(level) = open.last_mut() {
                    level.start = i + 1;
                    level.commas += 1;
                }
            }
            TokenKind::OuterDoc => {
                if let Some(level) = open.last_mut().filter(|level| level.start == i) {
                    level.start = i + 1;
                }
            }
            _ => {}
        }
    }
    open
}

/// The function whose arguments are open after the last token, and the index of the argument.
pub fn call(tokens: &[Token]) -> Option<(usize, usize)> {
    let open = levels(tokens);
    let inner = open.iter().rev().find(|level| level.bracket == '(' && level.at > 0)?;
    (tokens[inner.at - 1].kind == TokenKind::Name).then_some((inner.at - 1, inner.commas))
}

/// The separator of entries after the last token.
pub fn separator(tokens: &[Token]) -> char {
    let open = levels(tokens);
    let braces = open.iter().filter(|level| level.bracket == '{').count();
    let section =
        open.first().and_then(|level| Section::of_word(&tokens.get(level.at.checked_sub(1)?)?.text));
    use Section::*;
    match section {
        Some(
            Parameters | Inputs | Coordinates | Speeds | Dependent | Bodies | Particles | Shapes | Contacts,
        ) => ',',
        _ if braces > 1 => ',',
        _ => ';',
    }
}

/// What is allowed after the last token.
pub fn context(tokens: &[Token]) -> Context {
    let open = levels(tokens);
    let Some(outer) = open.first() else {
        let named = tokens.iter().any(|token| token.is_word("mechanism"));
        return match tokens.last() {
            _ if !named => Context::Start,
            Some(last) if last.is_word("mechanism") => Context::Nothing,
            Some(last) if matches!(last.kind, TokenKind::Sign(';') | TokenKind::Close(_)) => {
                Context::Sections
            }
            _ => Context::Nothing,
        };
    };
    let section = outer.at.checked_sub(1).and_then(|i| Section::of_word(&tokens[i].text));
    let Some(section) = section else { return Context::Nothing };
    if tokens.last().is_some_and(|last| last.is_sign('.')) {
        return Context::Members { orients: section == Section::Frames };
    }
    if let Some(arguments) = arguments(tokens, &open) {
        return arguments;
    }
    // the innermost braces determine the statement; parentheses inside them belong to expressions
    let braces: Vec<&Level> = open.iter().filter(|level| level.bracket == '{').collect();
    let Some(inner) = braces.last() else { return Context::Nothing };
    let statement = &tokens[inner.start..];
    if braces.len() > 1 {
        let known = record(section, tokens, braces[1], braces.len());
        return field(section, statement, known, &tokens[inner.at + 1..inner.start]);
    }
    entry(section, statement)
}

/// Functions whose arguments are names or words.
fn arguments(tokens: &[Token], open: &[Level]) -> Option<Context> {
    let inner = open.last().filter(|level| level.bracket == '(')?;
    let name = tokens.get(inner.at.checked_sub(1)?)?;
    let names = |kinds| Context::Expression { kinds, functions: false, words: Vec::new() };
    let begins = inner.start == tokens.len();
    Some(match (name.text.as_str(), inner.commas) {
        ("position" | "velocity", _) => names(Kinds::POINTS),
        ("angular_velocity", _) => names(Kinds::FRAMES_AND_BODIES),
        ("touching", 0) => names(Kinds::CONTACTS),
        ("rotate", 0) if begins || tokens.last()?.is_sign('-') => Context::Words(vec!["x", "y", "z"]),
        ("euler" | "space", 0) => Context::Words(vec!["xyz", "zxz", "zyx", "xyx", "xzx", "yzy"]),
        ("quaternion", _) => names(Kinds { coordinates: true, ..Kinds::NONE }),
        _ => return None,
    })
}

/// The fields of the open record.
fn record(section: Section, tokens: &[Token], brace: &Level, depth: usize) -> Vec<&'static str> {
    let known: &[&str] = match section {
        Section::Shapes => {
            return words::SHAPE.into_iter().chain(Kind::ALL.map(|kind| kind.word())).collect();
        }
        Section::Bodies => return words::BODY.into_iter().chain(["shape"]).collect(),
        Section::Particles => &words::PARTICLE,
        Section::Contacts if depth > 2 => &words::SURFACE,
        Section::Contacts => &words::CONTACT,
        Section::Loads => {
            let torsion = tokens[..brace.at].iter().rev().take_while(|token| !token.is_sign(';'));
            if torsion.into_iter().any(|token| token.is_word("torsion")) {
                &words::TORSION
            } else {
                &words::SPRING
            }
        }
        _ => &[],
    };
    known.to_vec()
}

fn expression(kinds: Kinds) -> Context {
    Context::Expression { kinds: Kinds { frames: true, ..kinds }, functions: true, words: Vec::new() }
}

/// A field of a record, or its value.
fn field(section: Section, statement: &[Token], known: Vec<&'static str>, before: &[Token]) -> Context {
    let names = |kinds, words: Vec<&'static str>| Context::Expression { kinds, functions: false, words };
    let Some(colon) = statement.iter().position(|token| token.is_sign(':')) else {
        // the shapes of a pair take the place of a field
        if section == Section::Contacts && !statement.is_empty() {
            let on = statement.len() > 1;
            return if on { names(Kinds::SHAPES, Vec::new()) } else { Context::Words(vec!["on", "in"]) };
        }
        let there = |field: &&str| {
            let given = |pair: &[Token]| pair[0].is_word(field) && pair[1].is_sign(':');
            !before.windows(2).any(given)
        };
        return Context::Fields(known.into_iter().filter(there).collect());
    };
    let last = statement.last().map_or("", |token| token.text.as_str());
    let name = colon.checked_sub(1).map_or("", |i| statement[i].text.as_str());
    let begins = statement.len() == colon + 1;
    match (name, last) {
        (_, "of") => names(Kinds::BODIES, Vec::new()),
        ("inertia", "in") => names(Kinds::FRAMES, Vec::new()),
        (_, "about") => names(Kinds::POINTS, Vec::new()),
        ("shape", _) => names(Kinds::SHAPES, Vec::new()),
        ("of", _) => names(Kinds::FRAMES_AND_BODIES, Vec::new()),
        ("at", _) => expression(Kinds { points: true, ..Kinds::VALUES }),
        ("frame" | "axes", _) => names(Kinds::FRAMES, Vec::new()),
        ("centre" | "point", _) if begins => names(Kinds::POINTS, Vec::new()),
        ("point", _) => Context::Words(vec!["of"]),
        ("against", _) if begins => {
            let kinds = Kinds { points: true, frames: true, ..Kinds::BODIES };
            names(kinds, vec!["velocity"])
        }
        ("law", _) => Context::Laws(words::LAWS),
        ("sliding", _) => Context::Laws(words::SLIDING),
        ("restitution", _) if section == Section::Contacts => Context::Laws(words::RESTITUTION),
        ("gap", _) if begins => Context::Expression {
            kinds: Kinds { frames: true, ..Kinds::VALUES },
            functions: true,
            words: vec!["none"],
        },
        ("mu" | "e" | "mu_static" | "mu_impact" | "rolling" | "spinning", _) => Context::Nothing,
        _ => expression(Kinds::VALUES),
    }
}

/// An entry of a section.
fn entry(section: Section, statement: &[Token]) -> Context {
    use Section::*;
    let has = |sign| statement.iter().any(|token| token.is_sign(sign));
    let last = statement.last().map_or("", |token| token.text.as_str());
    let begins = statement.is_empty();
    let names = |kinds, words: Vec<&'static str>| Context::Expression { kinds, functions: false, words };
    match section {
        Parameters | Inputs | Coordinates | Speeds | Dependent => match (has('='), has(':')) {
            (true, _) if matches!(section, Coordinates | Speeds) => Context::Expression {
                kinds: Kinds::STARTS,
                functions: true,
                words: if section == Coordinates { vec!["touching"] } else { Vec::new() },
            },
            (true, _) => Context::Expression { kinds: Kinds::NONE, functions: true, words: Vec::new() },
            (false, true) => Context::Unit,
            (false, false) if begins && section == Parameters => Context::Words(vec!["fixed"]),
            (false, false) if begins && section == Coordinates => Context::Words(vec!["dependent"]),
            _ => Context::Nothing,
        },
        Definitions if has('=') => expression(Kinds::VALUES),
        Definitions if has(':') => Context::Unit,
        Frames if has('=') && statement.last().is_some_and(|token| token.is_sign('=')) => {
            names(Kinds::FRAMES, Vec::new())
        }
        Frames if has('=') => expression(Kinds::VALUES),
        AngularVelocities if begins || last == "in" => names(Kinds::FRAMES, Vec::new()),
        AngularVelocities | Velocities if has('=') => expression(Kinds::VALUES),
        AngularVelocities => Context::Words(vec!["in"]),
        Points if last == "of" => names(Kinds::FRAMES_AND_BODIES, Vec::new()),
        Points if has('=') => expression(Kinds { points: true, ..Kinds::VALUES }),
        Points if statement.last().is_some_and(|token| token.is_sign(':')) => {
            Context::Words(vec!["velocity"])
        }
        Points if has(':') => expression(Kinds::VALUES),
        Points if !begins => Context::Words(vec!["of"]),
        Velocities if begins => names(Kinds::POINTS, Vec::new()),
        Loads if begins => Context::Loads,
        Loads if has(':') => expression(Kinds::VALUES),
        Loads => load(statement, last),
        Kinematics | Constraints | Configuration => expression(Kinds::VALUES),
        _ => Context::Nothing,
    }
}

/// The target of a load.
fn load(statement: &[Token], last: &str) -> Context {
    let names = |kinds| Context::Expression { kinds, functions: false, words: Vec::new() };
    let word = statement[0].text.as_str();
    let kinds = match word {
        "torque" | "torsion" => Kinds::FRAMES_AND_BODIES,
        _ => Kinds::POINTS,
    };
    match (word, last) {
        ("torsion", "about") => expression(Kinds::VALUES),
        (_, "on" | "from" | "to" | "spring" | "torsion") => names(kinds),
        ("force" | "torque", "force" | "torque") => Context::Words(vec!["on"]),
        ("force" | "torque", _) => Context::Words(vec!["from"]),
        ("spring", _) => Context::Words(vec!["to"]),
        ("torsion", _) => Context::Words(vec!["from", "about"]),
        _ => Context::Nothing,
    }
}
