//! One run of the fuzzer: checks a text, renders the diagnostics, and tests properties that must always hold.

use hodograph_generator::artifact::model_hash;
use hodograph_generator::expand::Inline;
use hodograph_generator::rendering::render;
use hodograph_generator::{check::check, source::Source};

/// Checks bytes as a file and, if they are Rust tokens, as an inline model. Panics if a promise is broken.
pub fn run(bytes: &[u8]) {
    let source = Source::bytes("fuzz.mech", bytes.to_vec());
    let checked = check(&source);
    assert_eq!(checked.has_errors(), checked.mechanism.is_none());
    if checked.has_errors() {
        assert!(!checked.diagnostics.is_empty(), "refused without a reason");
    }
    let _ = render(&checked.diagnostics, &source);
    let _ = model_hash(&source);
}

/// As [`run`], for the input of a macro too. `proc_macro2` itself recurses with the nesting of brackets, so
/// only texts without deep nesting are tried.
pub fn run_inline(text: &str) {
    let depth = text.bytes().filter(|b| b"([{".contains(b)).count();
    if depth > 200 {
        return;
    }
    let Ok(stream) = text.parse::<proc_macro2::TokenStream>() else { return };
    let inline = Inline::new("fuzz", stream);
    let source = &inline.source;
    let checked = check(source);
    for diagnostic in &checked.diagnostics {
        // a model without tokens has no place of its own
        let empty = source.tokens().is_ok_and(|tokens| tokens.is_empty());
        assert!(empty || inline.rust_spans(diagnostic.primary.span).is_some());
        let _ = diagnostic.compiler_text(source);
    }
    let file = Source::file("fuzz.mech", text);
    // a text that both can read means the same to both
    if checked.mechanism.is_some() {
        assert!(check(&file).mechanism.is_some(), "inline and file differ");
        assert_eq!(model_hash(source), model_hash(&file));
    }
}

/// Numbers that look random and are the same in every run (xorshift).
pub struct Random(u64);

impl Random {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
        (0..4).for_each(|_| {
            random.bits();
        });
        random
    }

    /// The next number.
    pub fn bits(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// Below a bound.
    pub fn below(&mut self, bound: usize) -> usize {
        (self.bits() >> 16) as usize % bound.max(1)
    }
}

/// Words that matter to the grammar.
pub const WORDS: &[&str] = &[
    "mechanism",
    "parameters",
    "inputs",
    "coordinates",
    "speeds",
    "dependent",
    "definitions",
    "frames",
    "angular_velocities",
    "points",
    "velocities",
    "bodies",
    "particles",
    "loads",
    "kinematics",
    "constraints",
    "configuration",
    "contacts",
    "fixed",
    "in",
    "of",
    "on",
    "from",
    "to",
    "about",
    "velocity",
    "gravity",
    "force",
    "torque",
    "spring",
    "torsion",
    "frame",
    "centre",
    "mass",
    "inertia",
    "point",
    "against",
    "normal",
    "gap",
    "rotate",
    "euler",
    "space",
    "quaternion",
    "spin",
    "vec",
    "x",
    "y",
    "z",
    "xyz",
    "dot",
    "cross",
    "norm",
    "unit",
    "position",
    "angular_velocity",
    "d",
    "dt",
    "sin",
    "cos",
    "sqrt",
    "sinh",
    "cosh",
    "tanh",
    "pow",
    "atan2",
    "N",
    "O",
    "time",
    "pi",
    "q1",
    "u1",
    "m",
    "kg",
    "rad",
    "s",
    "0",
    "1",
    "2",
    "0.5",
    "1e300",
    "1e-300",
    "99999999999999999999",
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    ",",
    ";",
    ":",
    "=",
    "+",
    "-",
    "*",
    "/",
    "^",
    ".",
    "//",
    "/*",
    "*/",
    "///",
    "//!",
    "\"",
    "'",
    "\n",
    "\r\n",
    "\t",
    "é",
    "·",
    "²",
    "\u{0}",
    "\u{feff}",
    "self",
    "type",
    "_",
    "r#a",
    "A",
    "B",
    "G",
    "P",
];

/// A model changed in a few places.
pub fn mutate(models: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut text = models[random.below(models.len())].clone();
    let many = random.below(3) == 0;
    for _ in 0..=random.below(if many { 8 } else { 2 }) {
        if text.is_empty() {
            break;
        }
        let at = random.below(text.len());
        let length = 1 + random.below(12);
        let end = (at + length).min(text.len());
        match random.below(9) {
            0 => drop(text.drain(at..end)),
            1 => text[at] = random.bits() as u8,
            2 => text[at] ^= 1 << random.below(8),
            3 | 4 => {
                let word = WORDS[random.below(WORDS.len())].as_bytes();
                text.splice(at..at, word.iter().copied());
            }
            5 => {
                let word = WORDS[random.below(WORDS.len())].as_bytes();
                text.splice(at..end, word.iter().copied());
            }
            6 => {
                let piece = text[at..end].to_vec();
                let to = random.below(text.len());
                text.splice(to..to, piece);
            }
            7 => {
                // a name for another name of the same text: often still a sentence
                let names = names(&text);
                if names.len() > 1 {
                    let (a, b) =
                        (names[random.below(names.len())].clone(), names[random.below(names.len())].clone());
                    let other = text[b].to_vec();
                    text.splice(a, other);
                }
            }
            _ => {
                let other = &models[random.below(models.len())];
                let from = random.below(other.len());
                let to = (from + 1 + random.below(200)).min(other.len());
                text.splice(at..at, other[from..to].iter().copied());
            }
        }
    }
    text
}

fn names(text: &[u8]) -> Vec<std::ops::Range<usize>> {
    let letter = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let mut out = Vec::new();
    let mut i = 0;
    while i < text.len() {
        if letter(text[i]) {
            let start = i;
            while i < text.len() && letter(text[i]) {
                i += 1;
            }
            out.push(start..i);
        } else {
            i += 1;
        }
    }
    out
}

/// Tokens thrown together.
pub fn soup(random: &mut Random) -> Vec<u8> {
    let mut out = Vec::new();
    for _ in 0..random.below(80) {
        out.extend_from_slice(WORDS[random.below(WORDS.len())].as_bytes());
        if random.below(3) > 0 {
            out.push(b' ');
        }
    }
    out
}
