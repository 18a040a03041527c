//! One style, without a change of meaning, whatever the layout was before.

use std::path::Path;

use proptest::prelude::*;

use super::*;

fn formatted(text: &str) -> String {
    format(&Source::file("x.mech", text)).unwrap_or_else(|error| panic!("{error:?}\n{text}"))
}

/// The style, and that it is its own.
fn becomes(text: &str, expected: &str) {
    assert_eq!(formatted(text), expected);
    assert_eq!(formatted(expected), expected);
}

#[test]
fn blanks_follow_the_operators() {
    becomes(
        "mechanism  A ;\nframes{B=N.rotate( z,q1 ) ;C = B.rotate([ cos (a),- sin(a) , 0 ],a - pi / 2);}",
        "mechanism A;\nframes { B = N.rotate(z, q1); C = B.rotate([cos(a), -sin(a), 0], a - pi/2); }\n",
    );
    becomes(
        "mechanism A;\nloads { gravity : -g * N.y; torque on B about - N.z:-k*( q1- -q0 )^-2*B.z; }",
        "mechanism A;\nloads { gravity: -g*N.y; torque on B about -N.z: -k*(q1 - -q0)^-2*B.z; }\n",
    );
}

#[test]
fn declarations_on_adjacent_lines_are_aligned() {
    becomes(
        "mechanism A;\nparameters {\nm: kg = 1,\n  radius : kg*m ^ 2= 0.5,\n\n\n  /// doc\n  long_name: m = 2, // far\n  b: m\n}",
        "mechanism A;\nparameters {\n    m:      kg     = 1,\n    radius: kg*m^2 = 0.5,\n\n    /// doc\n    long_name: m = 2, // far\n    \
         b:         m\n}\n",
    );
}

#[test]
fn what_does_not_fit_is_broken() {
    let term = "l1*sin(q1)*N.x";
    let long = format!("mechanism A;\npoints {{\nP = O + {0} + {0} + {0} + {0} + {0} + {0};\n}}\n", term);
    becomes(
        &long,
        &format!(
            "mechanism A;\npoints {{\n    P = O + {0} + {0} + {0} + {0} + {0}\n        + {0};\n}}\n",
            term
        ),
    );
    becomes(
        "mechanism A;\nbodies { Crank { frame: A, centre: GA, mass: m1, inertia: [0, m1*l1^2/12, m1*l1^2/12] }, Rod { frame: B } }",
        "mechanism A;\nbodies {\n    Crank { frame: A, centre: GA, mass: m1, inertia: [0, m1*l1^2/12, m1*l1^2/12] },\n    Rod { \
         frame: B }\n}\n",
    );
}

#[test]
fn comments_stay_where_they_are() {
    becomes(
        "//! about\n\n\n// first\nmechanism A; // name\n/* a\n   b */\nframes { // open\n  A = N.rotate(z, // axis\n   q1);\n\n  // last\n}\n\n// end",
        "//! about\n\n// first\nmechanism A; // name\n/* a\n   b */\nframes {\n    // open\n    A = N.rotate(z, // axis\n        \
         q1);\n\n    // last\n}\n\n// end\n",
    );
}

/// Between a number and the two points of a range the author may have broken the line.
#[test]
fn ranges_stay_ranges() {
    for range in ["1 .\n. n", "1 . // to\n. n", "1 . /* to */ . n", "1\n. . n", "1 ..\nn"] {
        let text = format!(
            "mechanism A;\ncount n = 2;\npart L {{ }}\nfor i in /* all */ {range} {{ use L as l[i](); }}\n"
        );
        let once = formatted(&text);
        assert_eq!(formatted(&once), once, "{text}");
    }
}

#[test]
fn what_cannot_be_parsed_is_left_alone() {
    let error = format(&Source::file("x.mech", "mechanism A;\nframes { A = ; }")).unwrap_err();
    assert!(matches!(error, Unformatted::Mistakes(mistakes) if mistakes.len() == 1));
}

/// All models of the repository, and whether they have a derivation.
fn models() -> Vec<(String, bool)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut folders =
        vec![root.join("models"), root.join("tests"), root.join("generator"), root.join("simulation")];
    let mut models = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            if path.is_dir() && name != "target" {
                folders.push(path);
            } else if name.ends_with(".mech")
                && let Ok(text) = std::fs::read_to_string(&path)
            {
                models.push((text, path.with_extension("derivation").exists()));
            }
        }
    }
    assert!(models.len() > 200, "{}", models.len());
    models
}

#[test]
fn every_model_keeps_its_meaning_and_its_style() {
    let mut parsed = 0;
    for (text, _) in models() {
        let source = Source::file("x.mech", text.as_str());
        match format(&source) {
            Ok(once) => {
                parsed += 1;
                assert_eq!(formatted(&once), once, "{text}");
                // what is said about it is the same but for places
                let said = |text: &str| {
                    let checked = crate::check::check(&Source::file("x.mech", text));
                    checked.diagnostics.iter().map(|d| (d.code, d.message.clone())).collect::<Vec<_>>()
                };
                let (mut before, mut after) = (said(&text), said(&once));
                before.sort();
                after.sort();
                assert_eq!(before, after, "{text}");
            }
            Err(Unformatted::Mistakes(mistakes)) => assert!(!mistakes.is_empty()),
            Err(other) => panic!("{other:?}: {text}"),
        }
    }
    assert!(parsed > 150, "{parsed}");
}

#[test]
fn derived_models_are_laid_out() {
    let derived: Vec<String> =
        models().into_iter().filter(|(_, derived)| *derived).map(|(text, _)| text).collect();
    assert!(derived.len() > 60, "{}", derived.len());
    for text in derived {
        assert_eq!(formatted(&text), text, "run `hodograph fmt` on this model");
    }
}

/// A model with other blanks, line breaks and comments between its tokens.
fn in_disorder(text: &str, seed: u64) -> String {
    let tokens = lexer::tokens(text, MAX_TOKENS);
    let mut random = hodograph_random::Random::new(seed);
    let blanks =
        [" ", "  ", "\n", "\n\n\n", "\t", " /* in between */ ", " // aside\n", "\r\n", "/* a\n  b */\n", ""];
    let mut out = String::new();
    for (i, token) in tokens.iter().enumerate() {
        let written = text[token.span.range()].trim_end();
        out.push_str(written);
        let documents = written.starts_with("//");
        let joins = tokens.get(i + 1).is_some_and(|after| {
            let word =
                |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == '.' || c == '/');
            word(written.chars().last()) && word(text[after.span.range()].chars().next())
        });
        match blanks[random.below(blanks.len())] {
            _ if documents => out.push('\n'),
            "" if joins => out.push(' '),
            blank => out.push_str(blank),
        }
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(50), ..ProptestConfig::with_cases(100) })]
    #[test]
    fn any_layout_is_put_in_order(which in 0usize..10_000, seed in any::<u64>()) {
        thread_local!(static MODELS: Vec<String> = models().into_iter().map(|(text, _)| text).collect());
        let text = MODELS.with(|models| models[which % models.len()].clone());
        let text = in_disorder(&text, seed);
        match format(&Source::file("x.mech", text.as_str())) {
            Ok(once) => prop_assert_eq!(formatted(&once), once),
            Err(Unformatted::Mistakes(_)) => {}
            Err(other) => prop_assert!(false, "{:?}: {}", other, text),
        }
    }
}
