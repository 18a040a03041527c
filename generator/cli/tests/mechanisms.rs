//! Mechanisms that are not shipped: those written from the language reference alone, against Lagrange's
//! equations (`tests/data/mechanisms`, see `tests/data/README.md`), and the examples of the reference itself.

use crate::common::{difference, hodograph, number, numbers, root};
use hodograph_generator::check::check;
use hodograph_generator::explanations::within;
use hodograph_generator::model::mechanism::Variable;
use hodograph_generator::numeric::{self, State};
use hodograph_generator::source::Source;
use serde_json::{Value, json};

/// Named numbers in the order of the names expected.
fn named(found: &Value, expected: &Value) -> (Vec<f64>, Vec<f64>) {
    let expected = expected.as_object().unwrap();
    (expected.keys().map(|name| number(&found[name])).collect(), expected.values().map(number).collect())
}

/// A matrix with three rows along n, t, s, along N.x, N.y, N.z.
fn along_n(contact: &Value, rows: &[Vec<f64>]) -> Vec<f64> {
    let basis = ["normal", "tangent", "binormal"].map(|name| numbers(&contact[name]));
    let columns = rows[0].len();
    (0..3)
        .flat_map(|axis| (0..columns).map(move |column| (axis, column)))
        .map(|(axis, column)| (0..3).map(|row| basis[row][axis] * rows[row][column]).sum())
        .collect()
}

fn transposed(flat: &[f64]) -> Vec<Vec<f64>> {
    (0..3).map(|row| (0..3).map(|column| flat[3 * column + row]).collect()).collect()
}

#[test]
fn they_agree_with_lagranges_equations() {
    let data = root().join("tests/data/mechanisms");
    // derived once for all states
    let folder = tempfile::tempdir().unwrap();
    let mut expectations = Vec::new();
    for entry in std::fs::read_dir(&data).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "json") {
            let text = std::fs::read_to_string(&path).unwrap();
            expectations.push(serde_json::from_str::<Value>(&text).unwrap());
        } else {
            std::fs::copy(&path, folder.path().join(path.file_name().unwrap())).unwrap();
        }
    }
    let derived = hodograph(&["derive", folder.path().to_str().unwrap()], "");
    assert_eq!(derived.code, 0, "{}", derived.stderr);
    // The ends of the spring of `colliding_pendula` coincide with the initial values: a true warning.
    let warnings: Vec<_> = derived.stderr.lines().filter(|line| line.starts_with("warning[")).collect();
    assert!(matches!(warnings[..], [told] if told.starts_with("warning[W015]")), "{}", derived.stderr);
    let mut compared = 0;
    let mut faults = Vec::new();
    for expected in &expectations {
        let model = folder.path().join(format!("{}.mech", expected["name"].as_str().unwrap()));
        let model = model.to_str().unwrap();
        for state in expected["states"].as_array().unwrap() {
            let run = hodograph(&["eval", model, "--state", "-"], &state["state"].to_string());
            assert_eq!(run.code, 0, "{model}: {}{}", run.stdout, run.stderr);
            let answer = run.line();
            let mut compare = |what: &str, found: Vec<f64>, expected: Vec<f64>| {
                let off = difference(&found, &expected, 1e-3);
                if off.is_nan() || off > 1e-12 {
                    faults.push(format!("{model} {what}: {off:e}"));
                }
                compared += 1;
            };
            for what in ["mass_matrix", "forcing", "kinetic_energy"] {
                let list = |value: &Value| numbers(&Value::Array(vec![value.clone()]));
                compare(what, list(&answer[what]), list(&state[what]));
            }
            for what in ["q", "qdot", "udot", "dependent"] {
                let (found, expected) = named(&answer[what], &state[what]);
                compare(what, found, expected);
            }
            for (name, expected) in state["contacts"].as_object().unwrap() {
                let contact = &answer["contacts"][name];
                for what in ["normal", "velocity"] {
                    compare(what, numbers(&contact[what]), numbers(&expected[what]));
                }
                let partials: Vec<Vec<f64>> = contact["V"].as_array().unwrap().iter().map(numbers).collect();
                compare("V", along_n(contact, &partials), numbers(&expected["partials_N"]));
                let [nn, nt, ns, tt, ts, ss] = numbers(&contact["reduced"])[..] else {
                    panic!("six entries")
                };
                let reduced = [vec![nn, nt, ns], vec![nt, tt, ts], vec![ns, ts, ss]];
                let reduced = along_n(contact, &transposed(&along_n(contact, &reduced)));
                compare("reduced", reduced, numbers(&expected["reduced_N"]));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(compared > 300, "{compared}");
}

/// The examples of `docs/language.md`, each completed by the comment above it.
fn examples() -> Vec<String> {
    let page = std::fs::read_to_string(root().join("docs/language.md")).unwrap();
    page.split("```text\n")
        .scan(String::new(), |before, part| {
            let (text, rest) = part.split_once("```\n").unwrap_or(("", part));
            let context =
                before.rsplit_once("<!-- context\n").and_then(|(_, context)| context.split_once("-->"));
            let context =
                context.map_or(String::new(), |(context, _)| format!("mechanism Example;\n{context}"));
            *before = rest.to_owned();
            Some((context, text))
        })
        .filter(|(_, text)| !text.is_empty())
        .map(|(context, text)| within(&context, text))
        .collect()
}

/// What the language reference shows derives, and computes what the numeric evaluation does.
#[test]
fn examples_of_the_language_reference_agree_with_the_numeric_road() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("example.mech");
    let mut compared = 0;
    for text in examples() {
        std::fs::write(&path, &text).unwrap();
        let mechanism = check(&Source::file("example.mech", &text)).mechanism.unwrap();
        // away from zero, where angles have poles and lengths vanish
        let mut state = State::of(&mechanism);
        for (i, (value, coordinate)) in state.coordinates.iter_mut().zip(&mechanism.coordinates).enumerate() {
            if coordinate.value.is_none() && !coordinate.name.starts_with('e') {
                *value = 0.2 + 0.1 * i as f64;
            }
        }
        state.speeds.iter_mut().enumerate().for_each(|(i, value)| *value = 0.4 - 0.15 * i as f64);
        numeric::assemble(&mechanism, &mut state).unwrap();
        let expected =
            numeric::evaluate(&mechanism, &state).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let named = |list: &[Variable], values: &[f64]| -> Value {
            list.iter().zip(values).map(|(quantity, value)| (quantity.name.clone(), json!(value))).collect()
        };
        let given = json!({
            "q": named(&mechanism.coordinates, &state.coordinates),
            "u": named(&mechanism.speeds, &state.speeds),
        });
        let run = hodograph(&["eval", path.to_str().unwrap(), "--state", "-"], &given.to_string());
        assert_eq!(run.code, 0, "{text}\n{}{}", run.stdout, run.stderr);
        let answer = run.line();
        for (found, expected) in [
            (numbers(&answer["mass_matrix"]), expected.mass_matrix.concat()),
            (numbers(&answer["forcing"]), expected.forcing),
        ] {
            assert!(difference(&found, &expected, 1e-3) < 1e-11, "{text}\n{found:?}\n{expected:?}");
            compared += 1;
        }
    }
    assert!(compared > 20, "{compared}");
}
