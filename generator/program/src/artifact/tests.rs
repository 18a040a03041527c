use super::*;
use crate::program::graph::{Graph, Input};
use crate::program::{Derived, Guard, Output, Quantity, Structure};

fn program() -> Program {
    let mut graph = Graph::new();
    let q = graph.input(Input::Coordinate(0));
    let m = graph.input(Input::Parameter(0));
    let sine = graph.call(Function::Sin, vec![q]);
    let cosine = graph.call(Function::Cos, vec![q]);
    let third = graph.number(hodograph_model::number::Number::ratio(-1, 3));
    let product = graph.product([third, m, sine]);
    let quotient = graph.div(product, cosine);
    let angle = graph.call(Function::Atan2, vec![quotient, m]);
    let outputs = vec![
        Output { quantity: Quantity::Forcing, rows: 2, columns: 1, values: vec![quotient, angle] },
        Output { quantity: Quantity::DependentSpeeds, rows: 0, columns: 1, values: vec![] },
    ];
    let guards = vec![Guard { value: cosine, scale: Some(m), message: "the arm\nis  stretched".into() }];
    Program::new(&Derived {
        graph,
        outputs,
        guards,
        structures: vec![Structure::Planar, Structure::General],
        samples: vec![],
        apart: vec![],
        solve: None,
    })
}

#[test]
fn decoding_inverts_encoding() {
    let mut program = program();
    let text = encode(&program, "00ff");
    program.guards[0].message = "the arm is stretched".into();
    let artifact = decode(&text).unwrap();
    assert_eq!(artifact.model, "00ff");
    assert_eq!(artifact.program, program);
    assert_eq!(encode(&artifact.program, "00ff"), text);
}

#[test]
fn damaged_derivations_are_refused_or_valid() {
    let text = encode(&program(), "00ff");
    for end in 0..text.len() - 1 {
        assert!(decode(&text[..end]).is_err(), "cut at {end}");
    }
    // Replace every single character: no panic, no operand out of order.
    for at in 0..text.len() {
        for replacement in ["", "9", " ", "\n", "-", "x", "99999999999999999999"] {
            let damaged = format!("{}{replacement}{}", &text[..at], &text[at + 1..]);
            if let Ok(artifact) = decode(&damaged) {
                for (index, operation) in artifact.program.operations.iter().enumerate() {
                    assert!(operation.operands().all(|operand| operand.index() < index));
                }
            }
        }
    }
}

#[test]
fn the_error_names_another_format() {
    let text = encode(&program(), "00ff").replacen("derivation 2", "derivation 7", 1);
    let error = decode(&text).unwrap_err();
    assert_eq!(error.line, 1);
    assert!(error.message.contains("format \"7\""), "{error}");
}

#[test]
fn text_after_the_end_is_refused() {
    let text = encode(&program(), "00ff");
    for more in ["\n", " ", "x\n", "digest 00\n", &text] {
        assert!(decode(&format!("{text}{more}")).is_err(), "{more:?}");
    }
    let error = decode(&format!("{text}more\n")).unwrap_err();
    assert_eq!(
        (error.line, error.message.as_str()),
        (text.lines().count() + 1, "there is text after the end of the derivation")
    );
}

#[test]
fn line_ends_of_a_checkout_do_not_matter_if_they_are_all_alike() {
    let text = encode(&program(), "00ff");
    assert_eq!(decode(&text.replace('\n', "\r\n")), decode(&text));
    assert!(decode(&text.replacen('\n', "\r\n", 1)).is_err());
    assert!(decode(&text.replace('\n', "\r")).is_err());
}

/// A text that differs from a derivation in one character is refused: one character changed, left out,
/// inserted, or exchanged with the next.
#[test]
fn a_single_character_makes_a_derivation_invalid() {
    let others = ['0', '7', '.', '-', ' ', '\n', '\r', '\t', 'e', 'A', 'é', '\u{200b}'];
    let mut tried = 0;
    for text in [
        encode(&program(), "00ff"),
        include_str!("../../tests/golden/pendulum.derivation").to_owned(),
        include_str!("../../../../tests/fixtures/cart/models/cart.derivation").to_owned(),
        include_str!("../../../../tests/fixtures/downstream/derived/puck.derivation").to_owned(),
    ] {
        assert!(decode(&text).is_ok());
        let characters: Vec<char> = text.chars().collect();
        let mut refused = |changed: String, at: usize, what: &str| {
            assert!(changed == text || decode(&changed).is_err(), "character {at} {what}: {changed}");
            tried += usize::from(changed != text);
        };
        let with = |at: usize, put: &[char], skip: usize| -> String {
            characters[..at].iter().chain(put).chain(&characters[at + skip..]).collect()
        };
        for at in 0..=characters.len() {
            // replace it by another character
            let other = others[at % others.len()];
            refused(with(at, &[other], 0), at, "put in");
            let Some(&here) = characters.get(at) else { continue };
            refused(with(at, &[], 1), at, "left out");
            refused(with(at, &[here], 0), at, "doubled");
            refused(with(at, &[other], 1), at, "changed");
            // replace a digit by the next digit
            let next = if here == '9' { '8' } else { char::from_u32(here as u32 + 1).unwrap_or(' ') };
            refused(with(at, &[next], 1), at, "replaced by the next digit");
            if let Some(&after) = characters.get(at + 1) {
                refused(with(at, &[after, here], 2), at, "exchanged with the next");
            }
        }
    }
    assert!(tried > 20_000, "{tried}");
}
