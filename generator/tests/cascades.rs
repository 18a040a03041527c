//! One mistake gives one error: mistakes are made in every shipped model, one at a time.

use std::path::Path;

use hodograph_generator::check::check;
use hodograph_generator::diagnostics::{Diagnostic, Severity, codes};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

/// The shipped models: name and text.
fn models() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let mut models: Vec<(String, String)> = std::fs::read_dir(folder)
        .expect("models")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "mech"))
        .map(|path| {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            (name, std::fs::read_to_string(&path).expect("text"))
        })
        .collect();
    models.sort();
    models
}

/// Every declaration of a unit: the name, and the range of bytes of its unit.
fn declared_units(text: &str) -> Vec<(String, std::ops::Range<usize>)> {
    let mut found = Vec::new();
    for section in ["parameters", "inputs", "coordinates", "speeds", "dependent"] {
        let Some(start) = text.find(&format!("\n{section} {{")) else { continue };
        let end = start + text[start..].find('}').expect("closed");
        let mut at = start + text[start..].find('{').expect("open") + 1;
        while at < end {
            let line = at + text[at..].find('\n').unwrap_or(text.len());
            if text[at..].trim_start().starts_with("//") {
                at = line + 1;
                continue;
            }
            let stop = at + text[at..=end].find([',', '\n', '}']).unwrap_or(end - at);
            let entry = &text[at..stop];
            let entry = entry.split("//").next().unwrap_or(entry);
            if let Some(colon) = entry.find(':') {
                let name = entry[..colon].trim().rsplit(' ').next().unwrap_or("").to_owned();
                let unit = &entry[colon + 1..];
                let unit = unit.split('=').next().unwrap_or(unit);
                let from = at + colon + 1 + (unit.len() - unit.trim_start().len());
                found.push((name, from..from + unit.trim().len()));
            }
            at = if text[stop..].starts_with(',') { stop + 1 } else { stop.max(at) + 1 };
        }
    }
    found
}

fn errors(name: &str, text: &str) -> (usize, Vec<Diagnostic>, String) {
    let source = Source::file(name, text.to_owned());
    let found = check(&source).diagnostics;
    let said = render(&found, &source);
    (found.iter().filter(|d| d.severity == Severity::Error).count(), found, said)
}

/// A declaration in a wrong unit contradicts many uses, but it is one mistake.
#[test]
fn a_wrong_unit_is_one_error() {
    let mut tried = 0;
    for (name, text) in models() {
        for (quantity, unit) in declared_units(&text) {
            let right = &text[unit.clone()];
            for wrong in ["s", "kg", "m", "rad", "N"] {
                if right == wrong || [right, wrong] == ["1", "rad"] {
                    continue;
                }
                let mut changed = text.clone();
                changed.replace_range(unit.clone(), wrong);
                let (count, found, said) = errors(&name, &changed);
                assert_eq!(count, 1, "{quantity} in {wrong}:\n{said}");
                // nor are there warnings beside it
                assert_eq!(found.len(), 1, "{quantity} in {wrong}:\n{said}");
                assert_eq!(found[0].code, codes::DIMENSION, "{quantity} in {wrong}:\n{said}");
                let line = 1 + text[..unit.start].matches('\n').count();
                let names_it =
                    said.contains(&format!("`{quantity}`")) || said.contains(&format!("\n{line} |"));
                assert!(names_it || found[0].related.is_empty(), "{quantity} in {wrong}:\n{said}");
                tried += 1;
            }
        }
    }
    assert!(tried > 2000, "{tried}");
}

/// Two wrong declarations are two errors, unless one hides in the expression that the other makes senseless.
#[test]
fn two_wrong_units_are_at_most_two_errors() {
    let (mut both, mut tried) = (0, 0);
    for (name, text) in models() {
        let units = declared_units(&text);
        for (i, (one, a)) in units.iter().enumerate() {
            let others = [1, 4].into_iter().filter_map(|step| units.get(i + step));
            for ((other, b), (wrong, wrong_too)) in
                others.flat_map(|other| [("N*s^3", "N*s^3"), ("kg^2", "m^3*s")].map(|wrong| (other, wrong)))
            {
                let mut changed = text.clone();
                let mut replacements = [(a, wrong), (b, wrong_too)];
                replacements.sort_by_key(|(place, _)| std::cmp::Reverse(place.start));
                for (place, unit) in replacements {
                    changed.replace_range(place.clone(), unit);
                }
                let (count, _, said) = errors(&name, &changed);
                assert!((1..=2).contains(&count), "{one} in {wrong}, {other} in {wrong_too}:\n{said}");
                tried += 1;
                both += usize::from(count == 2);
            }
        }
    }
    assert!(both * 10 > tried * 9, "{both} of {tried}");
}

/// One wrong use of a parameter that is used rightly elsewhere is told at the use.
#[test]
fn a_wrong_use_is_told_at_the_use() {
    let mut tried = 0;
    for (name, text) in models() {
        for (quantity, unit) in declared_units(&text) {
            // the declaration is the first place
            let uses = places_of(&text, &quantity);
            if uses.len() < 4 || ["1", "rad"].contains(&&text[unit.clone()]) {
                continue;
            }
            for at in &uses[1..] {
                let mut changed = text.clone();
                changed.replace_range(at.clone(), &format!("({quantity}*{quantity})"));
                let (count, found, said) = errors(&name, &changed);
                assert_eq!(count, 1, "{quantity}:\n{said}");
                assert!(found[0].primary.span.start as usize > unit.end, "{quantity}:\n{said}");
                tried += 1;
            }
        }
    }
    assert!(tried > 100, "{tried}");
}

/// Where a name stands as a word, comments left out.
fn places_of(text: &str, name: &str) -> Vec<std::ops::Range<usize>> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut places = Vec::new();
    for (at, _) in text.match_indices(name) {
        let end = at + name.len();
        // `.x` is an axis
        let alone = !text[..at].ends_with(|c| word(c) || c == '.') && !text[end..].starts_with(word);
        let line = text[..at].rfind('\n').map_or(0, |n| n + 1);
        if alone && !text[line..at].contains("//") {
            places.push(at..end);
        }
    }
    places
}

/// Words, numbers and signs with their places, comments left out.
fn tokens(text: &str) -> Vec<std::ops::Range<usize>> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let rest = &text[at..];
        let word = |c: char| c.is_alphanumeric() || c == '_';
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c.is_ascii_digit() {
            rest.find(|c| !word(c) && c != '.').unwrap_or(rest.len())
        } else if word(c) {
            rest.find(|c| !word(c)).unwrap_or(rest.len())
        } else {
            c.len_utf8()
        };
        if !c.is_whitespace() && !rest.starts_with("//") {
            tokens.push(at..at + length);
        }
        at += length;
    }
    tokens
}

/// What a change makes of a word in a model; `None`: it does not apply.
type Change = fn(&str) -> Option<String>;

/// Changes one token here and there and counts the errors: `twos` are allowed to be two, none to be more.
fn one_change(what: &str, twos: usize, change: Change) {
    let (mut tried, mut two) = (0, Vec::new());
    for (number, (name, text)) in models().into_iter().enumerate() {
        for place in tokens(&text).into_iter().skip(number % STRIDE).step_by(STRIDE) {
            let Some(by) = change(&text[place.clone()]) else { continue };
            let mut changed = text.clone();
            changed.replace_range(place.clone(), &by);
            let (count, _, said) = errors(&name, &changed);
            let line = 1 + text[..place.start].matches('\n').count();
            assert!(count <= 2, "{what}, `{}` in line {line}:\n{said}", &text[place]);
            tried += 1;
            if count == 2 {
                two.push(said);
            }
        }
    }
    assert!(tried > 100, "{what}: {tried}");
    assert!(two.len() <= twos, "{what}: {} of {tried} with two errors:\n{}", two.len(), two.join("\n"));
}

/// One token of so many is changed: all of them take half a minute.
const STRIDE: usize = 11;

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

#[test]
fn a_token_left_out_is_one_error() {
    one_change("left out", 3, |_| Some(" ".to_owned()));
}

#[test]
fn a_token_doubled_is_one_error() {
    one_change("doubled", 1, |token| Some(format!("{token} {token}")));
}

#[test]
fn a_word_misspelled_is_one_error() {
    one_change("misspelled", 1, |token| is_word(token).then(|| format!("{token}zz")));
}

#[test]
fn a_word_made_a_vector_is_one_error() {
    one_change("a vector", 1, |token| is_word(token).then(|| format!("({token}*N.x)")));
}

#[test]
fn a_wrong_sign_is_one_error() {
    one_change("another sign", 12, |token| {
        let other = match token {
            "*" => "+",
            "/" | "+" | "-" | "^" => "*",
            "=" => ":",
            ":" => "=",
            "," => ";",
            ";" | "." => ",",
            _ => return None,
        };
        Some(other.to_owned())
    });
}
