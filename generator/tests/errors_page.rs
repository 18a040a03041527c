//! Compares `docs/errors.md` with the explanations in the code, and runs its examples.

use std::path::Path;

use hodograph_generator::diagnostics::Code;
use hodograph_generator::diagnostics::codes::{ALL, NO_GAP};
use hodograph_generator::explanations::{explanation, page, whole};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

fn check(code: Code, example: &str) -> (Vec<Code>, String) {
    let source = Source::file(format!("{code}.mech"), whole(example));
    let mut found = hodograph_generator::check::check(&source).diagnostics;
    // examples of other codes need no gap
    found.retain(|d| d.code != NO_GAP || code == NO_GAP);
    let said = render(&found, &source);
    (found.iter().map(|d| d.code).collect(), said)
}

#[test]
fn every_code_is_explained() {
    for (code, _) in ALL {
        assert!(explanation(*code).is_some(), "{code} is not explained");
    }
}

#[test]
fn examples_do_what_they_claim() {
    let mut wrong = String::new();
    for (code, _) in ALL {
        let Some(explanation) = explanation(*code) else { continue };
        if let Some(example) = explanation.wrong {
            let (found, said) = check(*code, example);
            if found.is_empty() || found.iter().any(|other| other != code) {
                wrong.push_str(&format!("{code}, wrong example, says:\n{said}\n"));
            }
        }
        if let Some(example) = explanation.right {
            let (found, said) = check(*code, example);
            if !found.is_empty() {
                wrong.push_str(&format!("{code}, right example, says:\n{said}\n"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_page_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/errors.md");
    if crate::expectations::are_written_anew() {
        std::fs::write(&path, page()).expect("writing");
    }
    let there = std::fs::read_to_string(&path).unwrap_or_default();
    assert_eq!(there, page(), "HODOGRAPH_UPDATE=1 writes docs/errors.md anew");
}
