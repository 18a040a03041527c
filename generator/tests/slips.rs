//! Common slips in otherwise correct models (`tests/slips`): each is reported at its place with the right
//! code.

use std::path::Path;

use hodograph_generator::check::check;
use hodograph_generator::diagnostics::codes;
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

/// A change of a model and what is to be said of it.
#[derive(Default)]
struct Slip {
    model: String,
    name: String,
    codes: Vec<String>,
    elsewhere: bool,
    /// what is replaced, and by what
    changes: Vec<(String, String)>,
}

fn read(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/slips").join(name);
    std::fs::read_to_string(path).expect("a file")
}

fn slips() -> Vec<Slip> {
    let (mut slips, mut model, mut last): (Vec<Slip>, String, char) = (Vec::new(), String::new(), ' ');
    for line in read("slips.txt").lines() {
        let (sign, text) = (line.chars().next().unwrap_or(' '), line.get(2..).unwrap_or(""));
        match (sign, slips.last_mut()) {
            ('=', _) => model = text.to_owned(),
            ('#', _) => {
                let (name, codes) = text.split_once(": ").expect("name: codes");
                let words: Vec<&str> = codes.split(' ').collect();
                slips.push(Slip {
                    model: model.clone(),
                    name: name.to_owned(),
                    codes: words.iter().filter(|w| **w != "elsewhere").map(|w| (*w).to_owned()).collect(),
                    elsewhere: words.contains(&"elsewhere"),
                    changes: Vec::new(),
                });
            }
            ('-', Some(slip)) if last == '-' => {
                slip.changes.last_mut().expect("a change").0 += &format!("\n{text}");
            }
            ('-', Some(slip)) => slip.changes.push((text.to_owned(), String::new())),
            ('+', Some(slip)) => {
                let by = &mut slip.changes.last_mut().expect("a change").1;
                *by = if last == '+' { format!("{by}\n{text}") } else { text.to_owned() };
            }
            _ => {}
        }
        last = sign;
    }
    slips
}

#[test]
fn the_models_are_sound() {
    for name in ["cart_rod.mech", "four_bar.mech", "rolling_disc.mech", "ball.mech"] {
        let source = Source::file(name, read(name));
        let found: Vec<_> =
            check(&source).diagnostics.into_iter().filter(|d| d.code != codes::NO_GAP).collect();
        let said = render(&found, &source);
        assert!(said.trim().is_empty(), "{said}");
    }
}

#[test]
fn every_slip_is_told_where_it_was_made() {
    let mut wrong = Vec::new();
    let slips = slips();
    assert!(slips.len() >= 90);
    for slip in slips {
        let mut text = read(&format!("{}.mech", slip.model));
        let mut changed: Vec<usize> = Vec::new();
        for (old, new) in &slip.changes {
            let at = text.find(old).unwrap_or_else(|| panic!("{}: no `{old}`", slip.name));
            text.replace_range(at..at + old.len(), new);
            let line = 1 + text[..at].matches('\n').count();
            changed.extend(line..=line + new.matches('\n').count());
        }
        let source = Source::file(format!("{}.mech", slip.name), text);
        let mut found = check(&source).diagnostics;
        found.retain(|d| d.code != codes::NO_GAP);
        let codes: Vec<String> = found.iter().map(|d| d.code.to_string()).collect();
        let spans = found.iter().flat_map(|d| [&d.primary].into_iter().chain(&d.related));
        let lines: Vec<usize> =
            spans.filter_map(|label| source.location(label.span)).map(|at| at.line).collect();
        let here = changed.iter().any(|line| lines.contains(line));
        if codes != slip.codes || here == slip.elsewhere {
            let said = render(&found, &source);
            wrong.push(format!("{}: {codes:?}, lines {lines:?} for {changed:?}\n{said}", slip.name));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
