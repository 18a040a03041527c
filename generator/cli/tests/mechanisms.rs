//! Mechanisms that are not shipped, written from the language reference alone, against Lagrange's equations
//! (`tests/data/mechanisms`, see `tests/data/README.md`).

mod common;

use common::{difference, hodograph, number, numbers, root};
use serde_json::Value;

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
    let folder = root().join("tests/data/mechanisms");
    let mut compared = 0;
    let mut faults = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "json") {
            continue;
        }
        let expected: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
        let model = path.with_extension("mech");
        let model = model.to_str().unwrap();
        let checked = hodograph(&["check", model], "");
        assert_eq!((checked.code, checked.stderr.contains("warning")), (0, false), "{}", checked.stderr);
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
