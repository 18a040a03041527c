//! Compares the messages about malformed models word for word: `tests/diagnostics/NAME.mech` and the expected
//! `NAME.txt`.
//!
//! `HODOGRAPH_UPDATE=1 cargo test -p hodograph-generator --test all diagnostics::` writes the expectations anew;
//! read the difference before you commit it.

use std::path::{Path, PathBuf};

use hodograph_generator::expand::Inline;
use hodograph_generator::{
    check::{Checked, check},
    rendering::render,
    source::Source,
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/diagnostics")
}

fn cases() -> Vec<PathBuf> {
    let mut cases: Vec<PathBuf> = std::fs::read_dir(folder())
        .expect("cases")
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "mech"))
        .collect();
    cases.sort();
    cases
}

#[test]
fn messages_are_as_expected() {
    let update = crate::expectations::are_written_anew();
    let mut wrong = Vec::new();
    for path in cases() {
        let name = path.file_name().and_then(|n| n.to_str()).expect("a name").to_owned();
        let text = std::fs::read_to_string(&path).expect("text");
        let source = Source::file(name.as_str(), text);
        let checked = check(&source);
        assert!(!checked.diagnostics.is_empty(), "{name} is accepted");
        let said = render(&checked.diagnostics, &source);
        let expected = path.with_extension("txt");
        if update {
            std::fs::write(&expected, &said).expect("writing");
        } else if std::fs::read_to_string(&expected).unwrap_or_default() != said {
            wrong.push(format!("{name}:\n{said}"));
        }
    }
    assert!(wrong.is_empty(), "HODOGRAPH_UPDATE=1 accepts these:\n{}", wrong.join("\n"));
}

#[test]
fn there_are_many_cases() {
    assert!(cases().len() >= 60);
}

/// The same model inline has the same mistakes, each at tokens of the user's.
#[test]
fn inline_models_have_the_same_mistakes() {
    for path in cases() {
        let text = std::fs::read_to_string(&path).expect("text");
        // what is not a sequence of Rust tokens does not reach the macro
        let Ok(stream) = text.parse::<proc_macro2::TokenStream>() else { continue };
        let file = check(&Source::file("x.mech", text));
        let model = Inline::new("here", stream);
        let source = &model.source;
        let inline = check(source);
        let said = |checked: &Checked| -> Vec<(String, String)> {
            checked.diagnostics.iter().map(|d| (d.code.to_string(), d.message.clone())).collect()
        };
        assert_eq!(said(&file), said(&inline), "{}", path.display());
        for diagnostic in &inline.diagnostics {
            let empty = source.tokens().is_ok_and(|tokens| tokens.is_empty());
            assert!(empty || model.rust_spans(diagnostic.primary.span).is_some());
        }
    }
}

/// What the checks see does not depend on the units in which a model counts its coordinates and speeds.
#[test]
fn mistakes_do_not_depend_on_units() {
    let text = std::fs::read_to_string(folder().join("gaps_of_one_sign.mech")).expect("text");
    let said = |text: &str| -> Vec<String> {
        let checked = check(&Source::file("x.mech", text.to_owned()));
        checked.diagnostics.iter().map(|d| d.message.clone()).collect()
    };
    let wanted = said(&text);
    assert_eq!(wanted.len(), 3, "{wanted:?}");
    for (unit, metres) in [("km", 1e3), ("mm", 1e-3), ("um", 1e-6), ("nm", 1e-9)] {
        let coordinates =
            format!("coordinates {{ x: {unit} = {:e}, y: {unit} = {:e} }}", 0.1 / metres, 0.5 / metres);
        let speeds = format!("speeds {{ u1: {unit}/s, u2: {unit}/s }}");
        let other = text
            .replace("coordinates { x: m = 0.1, y: m = 0.5 }", &coordinates)
            .replace("speeds { u1: m/s, u2: m/s }", &speeds);
        assert_eq!(said(&other), wanted, "{unit}");
    }
}
