//! The twenty states of `tests/data/doors` by the tool: every door gives the same bits. And bad input, to which every
//! door has the same errors.

use serde_json::Value;

use crate::common::{data, hodograph, root};

#[test]
fn twenty_states_have_the_bits_of_every_door() {
    let table = std::fs::read_to_string(root().join("tests/data/doors/planar_double_pendulum.csv")).unwrap();
    let model = root().join("models/planar_double_pendulum.mech");
    let mut count = 0;
    for line in table.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let names = ["q1", "q2", "u1", "u2"];
        let state: Vec<String> =
            names.iter().zip(&cells).map(|(name, value)| format!("{name}={value}")).collect();
        let state = state.join(",");
        let found = hodograph(&["eval", model.to_str().unwrap(), "--state", &state], "").line();
        let numbers = [&found["udot"]["u1"], &found["udot"]["u2"], &found["kinetic_energy"]];
        let expected: Vec<f64> = cells[4..].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(numbers.map(|number| number.as_f64().unwrap()).to_vec(), expected, "{state}");
        count += 1;
    }
    assert_eq!(count, 20);
}

/// What the tool says of a mistake: the kind, where there is an error object, and the words.
fn told(mistake: &Value) -> (Option<String>, String) {
    let model = root().join("tests/data/doors/errors.mech").display().to_string();
    let text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_owned);
    let mut arguments = Vec::new();
    let mut add = |option: &str, value: String| arguments.extend([option.to_owned(), value]);
    for (section, option) in [("q", "--state"), ("u", "--state"), ("parameters", "--parameter")] {
        for (name, value) in mistake[section].as_object().into_iter().flatten() {
            add(option, format!("{name}={}", text(value)));
        }
    }
    let surface = ["mu", "e", "law"].map(|part| (part, text(&mistake[part])));
    let call = mistake["call"].as_str().unwrap();
    if call == "simulate" {
        add("--until", "0.1".to_owned());
    } else if call == "collide" {
        add("--contact", text(mistake.get("contact").unwrap_or(&Value::from("floor"))));
    }
    if call == "simulate" && !mistake["contact"].is_null() {
        let parts = surface.map(|(_, value)| value).join(",");
        add("--surface", format!("{}={parts}", text(&mistake["contact"])));
    } else if !mistake["mu"].is_null() {
        for (part, value) in surface {
            add(&format!("--{part}"), value);
        }
    }
    if !mistake["tolerance"].is_null() {
        add("--tolerance", text(&mistake["tolerance"]));
    }
    let command = if call == "accelerations" { "eval" } else { call };
    let arguments: Vec<&str> =
        [command, &model].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    let run = hodograph(&arguments, "");
    assert_ne!(run.code, 0, "{arguments:?}");
    // A motion is on standard output, so its errors are on the other; mistakes of a call are there, too.
    match run.lines().last().map(|line| line["error"].clone()).filter(|error| !error.is_null()) {
        Some(error) => (Some(text(&error["kind"])), text(&error["message"])),
        None => (None, run.stderr),
    }
}

#[test]
fn bad_input_has_the_errors_of_every_door() {
    let mistakes: Vec<Value> = serde_json::from_str(&data("doors/errors.json")).unwrap();
    let (mut count, mut kinds) = (0, 0);
    for mistake in &mistakes {
        if !mistake["doors"].as_array().unwrap().iter().any(|door| door == "tool") {
            continue;
        }
        let (kind, words) = told(mistake);
        assert!(words.contains(mistake["words"].as_str().unwrap()), "{mistake}: {words}");
        if let Some(kind) = kind {
            assert_eq!(kind, mistake["kind"], "{words}");
            kinds += 1;
        }
        count += 1;
    }
    assert!(count > 20 && kinds > 12, "{count} {kinds}");
}
