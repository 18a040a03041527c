//! `hodograph solve`: the contract of its JSON lines.

use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};

use crate::common::{data, difference, hodograph, kind, number, numbers, tool};
use serde_json::{Value, json};

fn case() -> Value {
    json!({"m": [0.25, -0.125, 0, 0.5, 0, 0.5], "v": [-1, 0.5, 0], "mu": 0.5, "e": 0.5, "law": "stronge"})
}

fn with(change: &[(&str, Value)]) -> Value {
    let mut case = case();
    for (name, value) in change {
        case[*name] = value.clone();
    }
    case
}

#[test]
fn every_reference_case_is_within_its_condition() {
    let cases: Vec<Value> =
        data("impact_cases.jsonl").lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let run = hodograph(&["solve"], &data("impact_cases.jsonl"));
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answers = run.lines();
    assert_eq!(answers.len(), cases.len());
    for (case, answer) in cases.iter().zip(&answers) {
        let expect = &case["expect"];
        let largest = |value: &Value| numbers(value).iter().fold(0.0f64, |a, b| a.max(b.abs()));
        let impulse = largest(&expect["impulse"]);
        let velocity = largest(&expect["v"]) + largest(&case["v"]);
        let error = [
            difference(&numbers(&answer["impulse"]), &numbers(&expect["impulse"]), 0.0),
            difference(&numbers(&answer["v"]), &numbers(&expect["v"]), velocity),
            (number(&answer["dE"]) - number(&expect["dE"])).abs() / (impulse * velocity),
            (number(&answer["dEn"]) - number(&expect["dEn"])).abs() / (impulse * velocity),
        ];
        let bound = f64::max(1e-12, 32.0 * number(&case["cond"]) * 2.2e-16);
        assert!(error.iter().all(|&error| error <= bound), "{error:?} {bound}\n{case}\n{answer}");
        let path: Vec<&str> =
            answer["path"].as_array().unwrap().iter().map(|word| word.as_str().unwrap()).collect();
        if !["near_mu_c", "straight"].contains(&case["family"].as_str().unwrap()) {
            assert_eq!(path.join("+"), expect["phase"].as_str().unwrap(), "{case}");
        }
        if let Some(compressions) = expect.get("compressions") {
            assert_eq!(&answer["compressions"], compressions, "{case}");
        }
    }
}

#[test]
fn answers_have_the_fields_of_the_contract_in_order() {
    let run = hodograph(&["solve"], &case().to_string());
    assert_eq!(run.code, 0);
    let names = [
        "\"impulse\":[",
        "\"v\":[",
        "\"dE\":",
        "\"dEn\":",
        "\"path\":[\"",
        "\"compressions\":1,",
        "\"sensitivity\":[",
    ];
    let places: Vec<usize> = names.iter().map(|name| run.stdout.find(name).unwrap()).collect();
    assert!(places.is_sorted() && run.stdout.ends_with("]}\n"), "{}", run.stdout);
}

#[test]
fn bad_lines_are_answered_and_the_next_is_solved() {
    let mut cases = vec![
        ("{".to_owned(), "bad_json"),
        ("[1, 2]".to_owned(), "bad_json"),
        ("\"solve\"".to_owned(), "bad_json"),
        (r#"{"m":[1,0,0,1,0,1],"m":[1,0,0,1,0,1]}"#.to_owned(), "bad_json"),
        (case().to_string().replace("-1,", "1e999,"), "not_finite"),
        (case().to_string().replace("-1,", "NaN,"), "not_finite"),
        ("[".repeat(100_000), "bad_json"),
        (format!("{{\"x\":\"{}\"}}", "x".repeat(2 << 20)), "bad_json"),
    ];
    for (change, kind) in [
        (("m", json!([1, 0, 0, 1, 0])), "bad_json"),
        (("m", json!([1, 0, 0, 1, 0, "1"])), "bad_json"),
        (("v", json!(null)), "bad_json"),
        (("mu", json!("0.5")), "bad_json"),
        (("law", json!(3)), "bad_json"),
        (("law", json!("Stronger")), "unknown_law"),
        (("mu", json!(-1)), "negative_friction"),
        (("e", json!(1.2)), "restitution_out_of_range"),
        (("e", json!(-0.1)), "restitution_out_of_range"),
        (("v", json!([1, 0, 0])), "not_approaching"),
        (("v", json!([0, 1, 0])), "not_approaching"),
        (("v", json!([-1e200, 1e200, 0])), "not_finite"),
        (("m", json!([1, 2, 0, 1, 0, 1])), "not_positive_semidefinite"),
        (("m", json!([0, 0, 0, 1, 0, 1])), "no_normal_mobility"),
    ] {
        cases.push((with(&[change]).to_string(), kind));
    }
    let slides_forever = with(&[
        ("m", json!([1, 1, 0, 1, 0, 0])),
        ("v", json!([-1, -0.1, 1])),
        ("mu", json!(2)),
        ("e", json!(0.5)),
        ("law", json!("newton")),
    ]);
    cases.push((slides_forever.to_string(), "wedged"));
    for name in ["m", "v", "mu", "e", "law"] {
        let mut case = case();
        case.as_object_mut().unwrap().remove(name);
        cases.push((case.to_string(), "missing_field"));
    }
    let input: String = cases.iter().map(|(line, _)| format!("{line}\n\n  \n{}\r\n", case())).collect();
    let run = hodograph(&["solve"], &input);
    assert_eq!(run.code, 1);
    let lines = run.lines();
    assert_eq!(lines.len(), 2 * cases.len());
    for (pair, (line, expected)) in lines.chunks(2).zip(&cases) {
        assert_eq!(kind(&pair[0]), *expected, "{} {}", &line[..line.len().min(200)], pair[0]);
        assert!(pair[1]["impulse"].is_array());
    }
}

#[test]
fn messages_say_what_to_do() {
    let mistyped = case().to_string().replace("\"mu\"", "\"Mu\"");
    let message = hodograph(&["solve"], &mistyped).line()["error"]["message"].as_str().unwrap().to_owned();
    assert!(message.contains("no field `mu` (there is a field `Mu`)"), "{message}");
}

#[test]
fn other_fields_are_left_alone() {
    assert_eq!(hodograph(&["solve"], &with(&[("label", json!("a"))]).to_string()).code, 0);
}

#[test]
fn each_answer_is_flushed() {
    let mut child =
        Command::new(tool()).arg("solve").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut output = BufReader::new(child.stdout.take().unwrap());
    for _ in 0..3 {
        writeln!(input, "{}", case()).unwrap();
        let mut line = String::new();
        output.read_line(&mut line).unwrap();
        assert!(line.contains("impulse"));
    }
    drop(input);
    assert!(child.wait().unwrap().success());
}

#[test]
fn numbers_read_back_exactly() {
    let run = hodograph(
        &["solve"],
        &with(&[("mu", json!(0)), ("e", json!(1)), ("law", json!("newton"))]).to_string(),
    );
    assert_eq!(run.line()["impulse"], json!([8.0, 0.0, 0.0]));
    assert_eq!(number(&run.line()["v"][0]), 1.0);
}

#[test]
fn wrong_calls_exit_with_2() {
    for arguments in [
        &["solve", "--method", "guess"][..],
        &["solve", "--at=-1"],
        &["solve", "--at", "2,nan"],
        &["solve", "x"],
        &["slove"],
        &[],
    ] {
        let run = hodograph(arguments, "");
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stdout.is_empty() && !run.stderr.is_empty());
    }
    assert_eq!(hodograph(&["solve"], "").code, 0);
}

/// The scaled difference of two answers.
fn apart(ours: &Value, exact: &Value, approach: f64) -> f64 {
    let largest = |value: &Value| numbers(value).iter().fold(0.0f64, |a, b| a.max(b.abs()));
    let (impulse, velocity) = (largest(&exact["impulse"]), largest(&exact["v"]) + approach);
    let of = |name: &str| (number(&ours[name]) - number(&exact[name])).abs() / (impulse * velocity);
    difference(&numbers(&ours["impulse"]), &numbers(&exact["impulse"]), 0.0)
        .max(difference(&numbers(&ours["v"]), &numbers(&exact["v"]), velocity))
        .max(of("dE"))
        .max(of("dEn"))
}

#[test]
fn every_method_comes_near_the_exact_answer() {
    let sleds = json!({"m": [0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211], "v": [-0.946108022, 1.06306701, 0]});
    let mut input = String::new();
    for mu in [0.6, 1.1, 1.6] {
        for law in ["newton", "poisson", "stronge"] {
            let mut line = sleds.clone();
            (line["mu"], line["e"], line["law"]) = (json!(mu), json!(0.8), json!(law));
            input += &format!("{line}\n");
        }
    }
    let exact = hodograph(&["solve"], &input).lines();
    for (arguments, bound) in [
        (&["--method", "exact"][..], 0.0),
        (&["--budget", "24"], 0.0),
        (&["--method", "integrate"], 1e-8),
        (&["--method", "integrate", "--tolerance", "1e-6"], 1e-4),
        (&["--method", "irs", "--tolerance", "1e-10"], 1e-8),
        (&["--method", "irs", "--steps", "1000"], 1e-3),
        (&["--method", "sum", "--steps", "1000"], 1e-3),
        (&["--method", "sum"], 0.02),
        (&["--method", "irs", "--steps", "1"], 0.5),
    ] {
        let run = hodograph(&[&["solve"], arguments].concat(), &input);
        assert_eq!(run.code, 0, "{arguments:?} {}", run.stdout);
        for (ours, exact) in run.lines().iter().zip(&exact) {
            let apart = apart(ours, exact, 1.06306701);
            assert!(apart <= bound, "{arguments:?}: {apart:e}\n{ours}\n{exact}");
            // A coarse summation may even miss where slip stops.
            assert!(bound > 0.1 || ours["path"] == exact["path"], "{arguments:?}");
        }
    }
}

#[test]
fn methods_answer_bad_lines_too_and_refuse_options_that_are_not_theirs() {
    let slides_forever =
        json!({"m": [1, 1, 0, 1, 0, 0], "v": [-1, -0.1, 1], "mu": 2, "e": 0.5, "law": "newton"});
    let run = hodograph(&["solve", "--method", "integrate"], &slides_forever.to_string());
    assert_eq!((run.code, kind(&run.line()).as_str()), (1, "unfinished"));
    for method in ["integrate", "sum", "irs"] {
        let run = hodograph(&["solve", "--method", method], &with(&[("mu", json!(-1))]).to_string());
        assert_eq!((run.code, kind(&run.line()).as_str()), (1, "negative_friction"));
    }
    for arguments in [
        &["--steps", "5"][..],
        &["--tolerance", "1e-6"],
        &["--budget", "-1"],
        &["--method", "sum", "--budget", "9"],
        &["--method", "sum", "--steps", "0"],
        &["--method", "sum", "--tolerance", "1e-6"],
        &["--method", "integrate", "--steps", "5"],
        &["--method", "integrate", "--tolerance", "0"],
        &["--method", "integrate", "--tolerance", "x"],
        &["--method", "irs", "--steps", "5", "--tolerance", "1e-6"],
    ] {
        let run = hodograph(&[&["solve"], arguments].concat(), "");
        assert_eq!(run.code, 2, "{arguments:?}");
        assert!(run.stdout.is_empty() && !run.stderr.is_empty());
    }
}

/// The command line has no clock, but it can show what a budget makes of a collision.
#[test]
fn a_budget_ends_collisions_with_an_error() {
    let model = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models/two_sleds.mech");
    let collide = ["collide", model, "--mu", "0.6", "--e", "0.8", "--law", "stronge"];
    let exact = hodograph(&collide, "");
    assert_eq!(hodograph(&[&collide[..], &["--budget", "24"]].concat(), "").stdout, exact.stdout);
    let sleds = json!({"m": [0.22510385, -0.10936656, 0.12575887, 0.23598633, 0.11584858, 0.27021211], "v": [-0.946108022, 1.06306701, 0],
        "mu": 0.6, "e": 0.8, "law": "stronge"});
    for run in [
        hodograph(&["solve", "--budget", "1"], &sleds.to_string()),
        hodograph(&[&collide[..], &["--budget", "1"]].concat(), ""),
    ] {
        assert_eq!((run.code, kind(&run.line()).as_str()), (1, "budget_exceeded"), "{}", run.stderr);
    }
}
