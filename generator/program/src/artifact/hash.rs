//! The two hashes of a derivation: of the model that it belongs to, and of its own text.

use sha2::{Digest, Sha256};

use hodograph_model::source::Source;
use hodograph_model::syntax::token::{Token, TokenKind};
use hodograph_model::syntax::tree::Section;

/// A hash of everything on which the equations of a model depend, as 64 hexadecimal digits: the tokens of the
/// model without documentation, without the values of quantities that are not `fixed`, and without the
/// surfaces of contacts. These values and surfaces are defaults of the module and not part of its equations;
/// only the words of a surface that require the relative rotation of two bodies count. Blanks, line ends and
/// comments do not matter, and a model has the same hash in a file and inline.
pub fn model_hash(source: &Source) -> String {
    let mut hash = Sha256::new();
    hash.update(b"hodograph model 2\n");
    if let Ok(tokens) = source.tokens() {
        let significant: Vec<&Token> = tokens.iter().filter(|token| !is_documentation(token)).collect();
        let surfaces = surfaces(&significant);
        let skipped =
            defaults(&significant).into_iter().zip(surfaces).map(|(default, surface)| default || surface);
        for (token, _) in significant.iter().zip(skipped).filter(|(_, skipped)| !skipped) {
            let (kind, text) = match token.kind {
                TokenKind::Name => (b'n', token.text.clone()),
                TokenKind::Number => (b'0', token.text.clone()),
                TokenKind::Sign(c) | TokenKind::Open(c) | TokenKind::Close(c) => (b's', c.to_string()),
                TokenKind::OuterDoc | TokenKind::InnerDoc => continue,
                TokenKind::Bad(_) => (b'?', token.text.clone()),
            };
            hash.update([kind]);
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text.as_bytes());
        }
    }
    hexadecimal(hash)
}

/// The hash of a text.
pub(super) fn of_text(text: &str) -> String {
    let mut hash = Sha256::new();
    hash.update(text.as_bytes());
    hexadecimal(hash)
}

fn hexadecimal(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

fn is_documentation(token: &Token) -> bool {
    matches!(token.kind, TokenKind::OuterDoc | TokenKind::InnerDoc)
}

/// For each token: whether it is part of the `= value` of a quantity that is not `fixed`.
fn defaults(tokens: &[&Token]) -> Vec<bool> {
    let mut is_default = vec![false; tokens.len()];
    // depth of open brackets; whether a section of quantities is open; position within its entry
    let (mut depth, mut within, mut entry) = (0_usize, false, Entry::Before);
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => {
                if depth == 0 {
                    within = i > 0 && holds_quantities(tokens[i - 1]);
                    entry = Entry::Before;
                }
                depth += 1;
            }
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        if !within || depth == 0 {
            continue;
        }
        entry = match entry {
            _ if depth == 1 && (token.is_sign(',') || token.is_sign(';')) => Entry::Before,
            Entry::Before if token.kind == TokenKind::Name => {
                let named = tokens.get(i + 1).is_some_and(|next| next.kind == TokenKind::Name);
                if named && token.text == "fixed" { Entry::Fixed } else { Entry::Declared }
            }
            Entry::Declared if depth == 1 && token.is_sign('=') => Entry::Value,
            other => other,
        };
        is_default[i] = entry == Entry::Value;
    }
    is_default
}

/// For each token: whether it is part of the `surface: { .. }` of a contact, or of the comma that separates
/// it from the other fields.
fn surfaces(tokens: &[&Token]) -> Vec<bool> {
    let mut is_surface = vec![false; tokens.len()];
    let (mut depth, mut of_contacts) = (0_usize, false);
    for (i, token) in tokens.iter().enumerate() {
        match token.kind {
            TokenKind::Open(_) => {
                if depth == 0 {
                    of_contacts = i > 0 && tokens[i - 1].is_word(Section::Contacts.word());
                }
                depth += 1;
            }
            TokenKind::Close(_) => depth = depth.saturating_sub(1),
            _ => {}
        }
        let begins = of_contacts && depth == 2 && token.is_word("surface");
        let opens =
            |ahead: usize, kind: TokenKind| tokens.get(i + ahead).is_some_and(|next| next.kind == kind);
        if !begins || !opens(1, TokenKind::Sign(':')) || !opens(2, TokenKind::Open('{')) {
            continue;
        }
        let mut inside = 0_usize;
        let mut end = i + 2;
        for (at, token) in tokens.iter().enumerate().skip(i + 2) {
            end = at;
            match token.kind {
                TokenKind::Open(_) => inside += 1,
                TokenKind::Close(_) => inside -= 1,
                _ => {}
            }
            if inside == 0 {
                break;
            }
        }
        let mut begin = i;
        if i > 0 && tokens[i - 1].is_sign(',') {
            begin -= 1;
        } else if tokens.get(end + 1).is_some_and(|next| next.is_sign(',')) {
            end += 1;
        }
        is_surface[begin..=end].fill(true);
        for (at, token) in tokens.iter().enumerate().take(end).skip(i + 3) {
            let field = opens(at + 1 - i, TokenKind::Sign(':'));
            is_surface[at] = !(field && (token.is_word("rolling") || token.is_word("spinning")));
        }
    }
    is_surface
}

/// The position of a token in the declaration of a quantity.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Entry {
    /// before the declaration
    Before,
    /// in the declaration of a quantity that is not `fixed`, before its value
    Declared,
    /// in the declaration of a `fixed` quantity
    Fixed,
    /// in the value of a quantity that is not `fixed`
    Value,
}

fn holds_quantities(word: &Token) -> bool {
    use Section::{Coordinates, Dependent, Inputs, Parameters, Speeds};
    let section = (word.kind == TokenKind::Name).then(|| Section::of_word(&word.text)).flatten();
    section.is_some_and(|section| [Parameters, Inputs, Coordinates, Speeds, Dependent].contains(&section))
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODEL: &str = "//! A rod.
mechanism Rod;
parameters { /// mass
  m: kg = 1, fixed l: m = 0.5, g: m/s^2 = 9.81, fixed: rad = pi/2 }
inputs { F: N }
coordinates { q1: rad = (0.3 + 0.1) }
speeds { u1: rad/s = 2 }
definitions { d: m = l/2; }
frames { B = N.rotate(z, q1); }
points { P = O - d*B.y; }
particles { A { point: P, mass: m } }
loads { gravity: -g*N.y; force on P: F*N.x; }
";

    fn hash(text: &str) -> String {
        model_hash(&Source::file("rod.mech", text))
    }

    fn with(from: &str, to: &str) -> String {
        assert_eq!(MODEL.matches(from).count(), 1, "{from}");
        hash(&MODEL.replace(from, to))
    }

    #[test]
    fn texts_with_the_same_equations_have_the_same_hash() {
        for (from, to) in [
            ("A rod.", "Another text."),
            ("/// mass\n", "// a remark\n"),
            ("m: kg = 1,", "m: kg = 2.5e3,"),
            ("m: kg = 1,", "m: kg,"),
            ("fixed: rad = pi/2", "fixed: rad = pi*(1/3 + 1)"),
            ("F: N ", "F: N = 7 "),
            (" = (0.3 + 0.1)", ""),
            ("u1: rad/s = 2", "u1: rad/s = -2"),
            ("definitions { ", "definitions {\r\n\t/* more */ "),
        ] {
            assert_eq!(with(from, to), hash(MODEL), "{from}");
        }
    }

    #[test]
    fn surfaces_do_not_matter() {
        let contact = |fields: &str| hash(&format!("{MODEL}contacts {{ c {{ {fields} }} }}"));
        let plain = contact("point: P, normal: N.y");
        let surface = "surface: { mu: 0.3, e: (1/2), law: stronge }";
        assert_eq!(contact(&format!("point: P, normal: N.y, {surface}")), plain);
        assert_eq!(contact(&format!("point: P, {surface}, normal: N.y")), plain);
        assert_eq!(contact(&format!("{surface}, point: P, normal: N.y")), plain);
        assert_eq!(contact("point: P, normal: N.y, surface: { mu: 0.4 }"), plain);
        // Except the words that require equations of rotation.
        let turns = contact("point: P, normal: N.y, surface: { mu: 0.4, rolling: 0.01 }");
        assert_ne!(turns, plain);
        assert_eq!(contact("point: P, normal: N.y, surface: { rolling: 0 }"), turns);
        assert_ne!(contact("point: P, normal: N.y, surface: { spinning: 0 }"), plain);
        assert_ne!(contact("point: P, normal: N.x"), plain);
        assert_ne!(contact("point: P, normal: N.y, gap: l"), plain);
    }

    #[test]
    fn texts_with_other_equations_have_other_hashes() {
        for (from, to) in [
            ("fixed l: m = 0.5", "fixed l: m = 0.6"),
            ("fixed l: m = 0.5", "l: m = 0.5"),
            ("m: kg = 1", "m: g = 1"),
            ("d: m = l/2", "d: m = l/3"),
            ("B = N", "C = N"),
            ("F*N.x", "-F*N.x"),
            ("q1: rad = (0.3 + 0.1)", "q2: rad = (0.3 + 0.1)"),
            ("u1: rad/s = 2", "u1: rad/s = 2, u2: m/s"),
        ] {
            assert_ne!(with(from, to), hash(MODEL), "{from}");
        }
    }
}
