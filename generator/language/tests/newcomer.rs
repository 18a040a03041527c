//! What a newcomer does first, and what the editor offers for it: the table in docs/editors.md.

use std::path::Path;

use hodograph_language::text::apply;
use hodograph_language::{Document, Span};

fn pendulum() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../playground/page/pendulum.mech");
    std::fs::read_to_string(path).unwrap()
}

fn labels(text: &str, at: usize) -> Vec<String> {
    Document::new(text).completion(at as u32).into_iter().map(|proposal| proposal.label).collect()
}

#[test]
fn an_empty_file_becomes_a_model_by_what_is_offered() {
    assert_eq!(labels("", 0), ["mechanism"]);
    let sections = labels("mechanism A;\n\n", 14);
    assert_eq!(sections[..2], ["parameters", "inputs"]);
    let text = "mechanism A;\nparameters { m:  }\n";
    assert!(labels(text, text.find(":  ").unwrap() + 2).contains(&"kg".to_owned()));
    let text = pendulum();
    let begun = format!(
        "{}contacts {{\n    wall {{\n        \n    }}\n}}\n",
        &text[..text.find("contacts {").unwrap()]
    );
    let at = begun.find("        \n    }\n}").unwrap() + 8;
    assert_eq!(labels(&begun, at), ["point", "against", "normal", "gap", "surface"]);
}

/// Each mistake has a first change that cures it.
#[test]
fn first_mistakes_are_mended_by_one_key() {
    let text = pendulum();
    for (right, wrong, title) in [
        ("u1: rad/s", "w1: rad/s", "Add `kinematics { d(q1)/dt = w1; }`"),
        ("l/2*B.y;", "l/2*B.y", "Write `;`"),
        ("frames { B =", "frames { B:", "Change to `=`"),
        ("surface: { mu: 0.3, e: 0.7, law: stronge }", "surface: { }", "Add `mu: 0.3, e: 0.5, law: stronge`"),
        ("law: stronge", "law: strong", "Change to `stronge`"),
        (
            "gravity: -g*N.y",
            "gravity: -g*N.y; torque on B: -c*u1*N.z",
            "Declare the parameter `c: N*m*s = 1`",
        ),
        ("rotate(z, q1)", "rotate(z, q)", "Change to `q1`"),
        ("m: kg", "m: Kg", "Change to `kg`"),
        ("normal: -N.x, ", "", "Add `normal: N.y`"),
    ] {
        let mistaken = text.replacen(right, wrong, 1);
        assert_ne!(mistaken, text, "{right}");
        let document = Document::new(mistaken.as_str());
        let actions = document.fixes(Span { start: 0, end: mistaken.len() as u32 });
        let Some(action) = actions.iter().find(|action| action.title == title) else {
            panic!("{wrong}: {:?}\n{actions:?}", document.findings());
        };
        let mended = apply(&mistaken, &action.edits);
        let left = Document::new(mended.as_str()).findings();
        assert!(!left.iter().any(|found| found.is_error), "{wrong}: {left:?}\n{mended}");
    }
}

/// Why the unit of a whole is as it is: each sign tells what it gives.
#[test]
fn hovering_over_a_sign_tells_the_dimension_of_its_operation() {
    let text = pendulum().replacen("gravity: -g*N.y", "gravity: -m*g*N.y", 1);
    let document = Document::new(text.as_str());
    assert_eq!(document.findings()[0].code, "E031");
    let at = |part: &str| text.find(part).unwrap() as u32;
    for (sign, told) in [
        (
            at("*g*N.y"),
            "`-m*g*N.y`: a vector, in N\n- `-m`: in kg\n- `g`: in m/s^2\n- `N.y`: a vector, a plain number or an angle",
        ),
        (
            at("/2*B.y"),
            "`l/2*B.y`: a vector, in m\n- `l`: in m\n- `2`: a plain number or an angle\n- `B.y`: a vector, a plain number or an angle",
        ),
    ] {
        assert_eq!(document.hover(sign).unwrap().text, told);
    }
}
