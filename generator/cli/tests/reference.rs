//! `hodograph eval` and `hodograph collide` against numbers computed elsewhere (`tests/data/README.md`).

use std::collections::BTreeMap;

use crate::common::{data, difference, hodograph, model, number, numbers, root};
use serde_json::{Map, Value, json};

fn parsed(name: &str) -> Value {
    serde_json::from_str(&data(name)).unwrap()
}

/// The names of all reference files.
fn names(folder: &str) -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(root().join("tests/data").join(folder))
        .unwrap()
        .filter_map(|entry| {
            Some(entry.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "json"))
        })
        .map(|path| path.file_stem().unwrap().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn zip(names: &Value, values: &Value) -> Value {
    let pairs = names.as_array().unwrap().iter().zip(values.as_array().unwrap());
    Value::Object(
        pairs.map(|(name, value)| (name.as_str().unwrap().to_owned(), json!(number(value)))).collect(),
    )
}

/// A state as the tool reads it.
fn state(file: &Value, state: &Value) -> String {
    json!({
        "parameters": file["params"].as_object().unwrap().iter().map(|(k, v)| (k.clone(), json!(number(v)))).collect::<Map<_, _>>(),
        "t": number(&state["t"]),
        "q": zip(&file["q"], &state["q"]),
        "u": zip(&file["u_ind"], &state["u_ind"]),
    })
    .to_string()
}

/// The numbers of an object in the order of a list of names.
fn pick(object: &Value, names: &Value) -> Vec<f64> {
    names.as_array().unwrap().iter().map(|name| number(&object[name.as_str().unwrap()])).collect()
}

/// Rows and columns in the order of the reference, which need not be the file's.
fn order(answer: &Value, names: &Value) -> Vec<usize> {
    let speeds = answer["speeds"].as_array().unwrap();
    names
        .as_array()
        .unwrap()
        .iter()
        .map(|name| speeds.iter().position(|speed| speed == name).unwrap())
        .collect()
}

#[test]
fn eval_agrees_with_every_reference_state() {
    let mut seen = BTreeMap::new();
    for name in names("reference") {
        let file = parsed(&format!("reference/{name}.json"));
        for (index, reference) in file["states"].as_array().unwrap().iter().enumerate() {
            let run = hodograph(&["eval", &model(&name), "--state", "-"], &state(&file, reference));
            assert_eq!(run.code, 0, "{name} {index}: {}{}", run.stdout, run.stderr);
            let answer = run.line();
            let order = order(&answer, &file["u_ind"]);
            let row =
                |values: &Value| -> Vec<f64> { order.iter().map(|&place| number(&values[place])).collect() };
            let mut check = |what: &str, found: Vec<f64>, expected: Vec<f64>, bound: f64| {
                // What should be zero is compared with what it is the difference of.
                let floor = if what == "remainder" { 1.0 } else { 1e-9 };
                let error = difference(&found, &expected, floor);
                let worst: &mut f64 = seen.entry(what.to_owned()).or_default();
                *worst = worst.max(error);
                assert!(error <= bound, "{name} {index} {what}: {error:e}\n{found:?}\n{expected:?}");
            };
            let matrix = order.iter().flat_map(|&place| row(&answer["mass_matrix"][place])).collect();
            check("mass_matrix", matrix, numbers(&reference["M"]), 1e-12);
            check("forcing", row(&answer["forcing"]), numbers(&reference["forcing"]), 1e-11);
            check("udot", pick(&answer["udot"], &file["u_ind"]), numbers(&reference["udot"]), 1e-11);
            check("qdot", pick(&answer["qdot"], &file["q"]), numbers(&reference["qdot"]), 1e-12);
            check("q", pick(&answer["q"], &file["q"]), numbers(&reference["q"]), 1e-12);
            let energy = numbers(&reference["kinetic_energy"]);
            check("kinetic_energy", vec![number(&answer["kinetic_energy"])], energy, 1e-12);
            if file["u_dep"].as_array().is_some_and(|names| !names.is_empty()) {
                check(
                    "dependent",
                    pick(&answer["dependent"], &file["u_dep"]),
                    numbers(&reference["u_dep"]),
                    1e-12,
                );
                check(
                    "udot_dep",
                    pick(&answer["udot"], &file["u_dep"]),
                    numbers(&reference["udot_dep"]),
                    1e-11,
                );
            }
            for (contact, reference) in reference["contacts"].as_object().unwrap() {
                let answer = &answer["contacts"][contact];
                for (ours, theirs) in
                    [("normal", "n"), ("tangent", "t"), ("binormal", "s"), ("velocity", "vR_N")]
                {
                    if !reference[theirs].is_null() {
                        check(ours, numbers(&answer[ours]), numbers(&reference[theirs]), 1e-12);
                    }
                }
                let rows = answer["V"].as_array().unwrap().iter().flat_map(&row).collect();
                check("V", rows, numbers(&reference["V"]), 1e-12);
                check(
                    "remainder",
                    numbers(&answer["remainder"]),
                    numbers(&reference["v_remainder_nts"]),
                    1e-12,
                );
                let m = numbers(&reference["reduced"]);
                check(
                    "reduced",
                    numbers(&answer["reduced"]),
                    vec![m[0], m[1], m[2], m[4], m[5], m[8]],
                    1e-12,
                );
                let v = ["v_n1", "v_t1", "v_s1"].map(|name| number(&reference[name])).to_vec();
                check("v", numbers(&answer["v"]), v, 1e-12);
            }
        }
    }
    for (what, worst) in seen {
        println!("{what:16} {worst:.1e}");
    }
}

/// The words of the reference for paths.
fn path(word: &str, slides: bool) -> Vec<&'static str> {
    match (word, slides) {
        ("slide", _) => vec!["sliding"],
        ("sliding_renewal", true) => vec!["sliding", "renewal"],
        ("sliding_renewal", false) => vec!["renewal"],
        (_, true) => vec!["sliding", "sticking"],
        (_, false) => vec!["sticking"],
    }
}

#[test]
fn collide_agrees_with_every_reference_impact() {
    let mut worst: f64 = 0.0;
    for name in names("reference/impacts") {
        let file = parsed(&format!("reference/{name}.json"));
        for impact in parsed(&format!("reference/impacts/{name}.json"))["impacts"].as_array().unwrap() {
            let reference = &file["states"][impact["state"].as_u64().unwrap() as usize];
            let (mu, e) = (number(&impact["mu"]).to_string(), number(&impact["e"]).to_string());
            let contact = impact["contact"].as_str().unwrap();
            for law in ["newton", "poisson", "stronge"] {
                let expected = &impact[law];
                let call =
                    ["collide", &model(&name), "--contact", contact, "--mu", &mu, "--e", &e, "--law", law];
                let run = hodograph(&[&call[..], &["--state", "-"]].concat(), &state(&file, reference));
                let what = format!("{name} {contact} mu {mu} e {e} {law}");
                if expected.is_null() || expected["end"].is_null() {
                    // Stuck, and v_n cannot change any more: Poisson's law is content with v_n = 0, the
                    // others are not.
                    if law == "poisson" {
                        let answer = run.line();
                        // Without a compression of its own it ends where slip does.
                        let compressed =
                            impact.get("compression").map_or(&impact["I_nS"], |phase| &phase["I_n"]);
                        let normal = (1.0 + number(&impact["e"])) * number(compressed);
                        assert!((number(&answer["impulse"][0]) / normal - 1.0).abs() < 1e-10, "{what}");
                        assert_eq!(answer["v"], json!([0.0, 0.0, 0.0]), "{what}");
                    } else {
                        assert_eq!(run.error_kind(), "wedged", "{what}");
                    }
                    continue;
                }
                assert_eq!(run.code, 0, "{what}: {}{}", run.stdout, run.stderr);
                let answer = run.line();
                let bound = 1e-10;
                let get = |names: [&str; 3]| names.map(|name| number(&expected[name])).to_vec();
                let impulse = get(["I_n", "I_t", "I_s"]);
                let v = get(["v_n2", "v_t2", "v_s2"]);
                let approach = ["v_n1", "v_t1"].map(|name| number(&impact[name]).abs()).iter().sum::<f64>();
                let scale = approach * impulse[0];
                let u: Vec<f64> = numbers(&reference["u_ind"])
                    .iter()
                    .zip(numbers(&expected["delta_u_ind"]))
                    .map(|(before, change)| before + change)
                    .collect();
                let errors = [
                    difference(&numbers(&answer["impulse"]), &impulse, 0.0),
                    difference(&numbers(&answer["v"]), &v, approach),
                    (number(&answer["dE"]) - number(&expected["dE"])).abs() / scale,
                    (number(&answer["dEn"]) - number(&expected["E_n"])).abs() / scale,
                    difference(&pick(&answer["u_after"], &file["u_ind"]), &u, 0.0),
                ];
                let error = errors.iter().fold(0.0, |a: f64, b| a.max(*b));
                assert!(error <= bound, "{what}: {errors:?}\n{answer}\n{expected}");
                worst = worst.max(error);
                let words: Vec<&str> =
                    answer["path"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
                let slides = number(&impact["v_t1"]) > 0.0;
                assert_eq!(words, path(expected["end"].as_str().unwrap(), slides), "{what}");
            }
        }
    }
    println!("{worst:.1e}");
}
