//! `hodograph contacts`: problems of real simulations, and the contract of its JSON lines.

use crate::common::{data, hodograph, kind, number, numbers};
use serde_json::{Value, json};

fn case() -> Value {
    json!({"name": "one", "contacts": 1, "mu": [0.5], "q": [-1, 0, 0.1], "w": [[0, 0, [1, 0, 0, 0, 1, 0, 0, 0, 1]]]})
}

fn with(change: &[(&str, Value)]) -> String {
    let mut case = case();
    for (name, value) in change {
        case[*name] = value.clone();
    }
    case.to_string()
}

/// Signorini's and Coulomb's laws of forces and velocities, relative to the greatest ones; W is applied here once more.
fn violation(problem: &Value, answer: &Value) -> f64 {
    let (mu, q) = (numbers(&problem["mu"]), numbers(&problem["q"]));
    let (force, velocity) = (numbers(&answer["force"]), numbers(&answer["velocity"]));
    let mut v = q.clone();
    for block in problem["w"].as_array().unwrap() {
        let place = |at: usize| 3 * block[at].as_u64().unwrap() as usize;
        let entries = numbers(&block[2]);
        for (at, entry) in entries.iter().enumerate() {
            v[place(0) + at / 3] += entry * force[place(1) + at % 3];
        }
    }
    let largest = |values: &[f64]| values.iter().fold(1e-300_f64, |most, value| most.max(value.abs()));
    let (forces, speeds) = (largest(&force), largest(&q).max(largest(&v)));
    let mut worst = 0.0_f64;
    for (i, mu) in mu.iter().enumerate() {
        let (r, v, said) = (&force[3 * i..3 * i + 3], &v[3 * i..3 * i + 3], &velocity[3 * i..3 * i + 3]);
        let rounding = v.iter().zip(said).map(|(v, said)| (v - said).abs()).fold(0.0, f64::max);
        let (friction, slip) = (r[1].hypot(r[2]), v[1].hypot(v[2]));
        let power = r[1] * v[1] + r[2] * v[2] + mu * r[0] * slip;
        worst = worst
            .max(rounding / speeds)
            .max(-r[0] / forces)
            .max(-v[0] / speeds)
            .max((r[0] / forces).min(v[0] / speeds))
            .max((friction - mu * r[0]) / forces)
            .max(power.abs() / (forces * speeds));
    }
    worst
}

#[test]
fn problems_of_real_simulations_are_solved() {
    let text = data("friction/problems.jsonl");
    let run = hodograph(&["contacts"], &text);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let problems: Vec<Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let answers = run.lines();
    assert_eq!(answers.len(), problems.len());
    assert_eq!(problems.len(), 16);
    for (problem, answer) in problems.iter().zip(&answers) {
        let name = &problem["name"];
        assert_eq!(&answer["name"], name);
        assert!(number(&answer["residual"]) <= 1e-13, "{name}: {}", answer["residual"]);
        let worst = violation(problem, answer);
        assert!(worst <= 1e-12, "{name}: {worst}");
        let said = answer["solutions"].as_str().unwrap();
        let few = problem["contacts"].as_u64().unwrap() <= 4;
        assert!(
            if few { ["unique", "several"].contains(&said) } else { said == "unknown" },
            "{name}: {said}"
        );
    }
}

#[test]
fn a_file_is_read_as_standard_input_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("problems.jsonl");
    let text = format!("{}\n\n{}\n", case(), with(&[("mu", json!([0.05]))]));
    std::fs::write(&path, &text).unwrap();
    let path = path.display().to_string();
    let (read, given, dash) = (
        hodograph(&["contacts", &path], ""),
        hodograph(&["contacts"], &text),
        hodograph(&["contacts", "-"], &text),
    );
    assert_eq!(read.code, 0);
    assert!(read.stdout == given.stdout && given.stdout == dash.stdout);
    let answers = read.lines();
    assert_eq!(
        answers[0],
        json!({"name": "one", "force": [1.0, 0.0, -0.1], "velocity": [0.0, 0.0, 0.0], "residual": 0.0, "solutions": "unique"})
    );
    // Less friction than holds it: it slips.
    assert!((numbers(&answers[1]["force"])[2] + 0.05).abs() < 1e-15);
    assert!((numbers(&answers[1]["velocity"])[2] - 0.05).abs() < 1e-15);
    for wrong in ["no/such/file", folder.path().to_str().unwrap()] {
        let run = hodograph(&["contacts", wrong], "");
        assert!(run.told().0 == 2 && run.stderr.contains("cannot read"), "{wrong}: {}", run.stderr);
    }
}

#[test]
fn all_solutions_are_listed_on_request() {
    // Friction holds the contact, or it begins to slip, or it parts: W couples the normal and t (Painleve).
    let two =
        json!({"contacts": 1, "mu": [2], "q": [0.5, 1, 0], "w": [[0, 0, [1, 0.9, 0, 0.9, 1, 0, 0, 0, 1]]]});
    let run = hodograph(&["contacts", "--all"], &two.to_string());
    assert_eq!(run.code, 0, "{}", run.stdout);
    let answers = run.lines();
    assert!(answers.len() == 3, "{}", run.stdout);
    for answer in &answers {
        assert_eq!(answer["solutions"], "several");
        assert!(violation(&two, answer) < 1e-14, "{answer}");
        assert!(answer.get("name").is_none());
    }
    let one = hodograph(&["contacts"], &two.to_string()).line();
    assert_eq!(one["solutions"], "several");
    let many = json!({"contacts": 5, "mu": [1, 1, 1, 1, 1], "q": vec![0; 15], "w": []});
    assert_eq!(hodograph(&["contacts", "--all"], &many.to_string()).error_kind(), "unsolved");
}

#[test]
fn bad_lines_are_answered_and_the_next_is_solved() {
    let block = |i: Value, j: Value, n: usize| json!([[i, j, vec![1.0; n]]]);
    let cases = [
        ("{".to_owned(), "bad_json"),
        ("[]".to_owned(), "bad_json"),
        ("{}".to_owned(), "missing_field"),
        (with(&[("contacts", json!(2))]), "bad_json"),
        (with(&[("contacts", json!(-1))]), "bad_json"),
        (with(&[("contacts", json!(1.5))]), "bad_json"),
        (with(&[("contacts", json!(1e12))]), "bad_json"),
        (with(&[("contacts", json!("one"))]), "bad_json"),
        (with(&[("mu", json!([-0.1]))]), "negative_friction"),
        (with(&[("mu", json!([]))]), "bad_json"),
        (with(&[("q", json!([1, 2]))]), "bad_json"),
        (with(&[("q", json!([1, 2, null]))]), "bad_json"),
        (with(&[("w", json!({}))]), "bad_json"),
        (with(&[("w", json!([[0, 0]]))]), "bad_json"),
        (with(&[("w", block(json!(0), json!(1), 9))]), "bad_json"),
        (with(&[("w", block(json!(0.5), json!(0), 9))]), "bad_json"),
        (with(&[("w", block(json!(0), json!(0), 8))]), "bad_json"),
        (with(&[("w", json!([[0, 0, [-1, 0, 0, 0, 1, 0, 0, 0, 1]]]))]), "not_positive_semidefinite"),
        (with(&[("name", json!(7))]), "bad_json"),
        (with(&[("w", json!([[0, 0, [1, 0.5, 0, -0.5, 1, 0, 0, 0, 1]]]))]), "not_positive_semidefinite"),
        (with(&[("w", json!([[0, 0, [1, 2, 0, 2, 1, 0, 0, 0, 1]]]))]), "not_positive_semidefinite"),
        // each pair of entries is possible, and all together are not
        (
            with(&[("w", json!([[0, 0, [1, 0.9, 0.9, 0.9, 1, -0.9, 0.9, -0.9, 1]]]))]),
            "not_positive_semidefinite",
        ),
        // the block 0, 1 is given, and its transpose is not
        (
            with(&[
                ("contacts", json!(2)),
                ("mu", json!([0.5, 0.5])),
                ("q", json!([-1, 0, 0.1, -1, 0, 0.1])),
                (
                    "w",
                    json!([
                        [0, 0, [1, 0, 0, 0, 1, 0, 0, 0, 1]],
                        [1, 1, [1, 0, 0, 0, 1, 0, 0, 0, 1]],
                        [0, 1, [0.5, 0, 0, 0, 0.5, 0, 0, 0, 0.5]]
                    ]),
                ),
            ]),
            "not_positive_semidefinite",
        ),
        (case().to_string().replace("0.1]", "1e999]"), "not_finite"),
        (case().to_string().replace("\"mu\"", "\"my\""), "missing_field"),
        (with(&[("slip", json!([[0, 0]]))]), "bad_json"),
        (with(&[("slip", json!([]))]), "bad_json"),
        (with(&[("slip", json!([3]))]), "bad_json"),
        // Nothing moves the contact away from what it approaches.
        (with(&[("w", json!([]))]), "unsolved"),
        // It slips, and friction presses it down by more than the normal force lifts it.
        (
            with(&[
                ("w", json!([[0, 0, [1, 0.9, 0, 0.9, 1, 0, 0, 0, 1]]])),
                ("mu", json!([2])),
                ("slip", json!([[1, 0]])),
            ]),
            "jam",
        ),
    ];
    let mut text: String = cases.iter().map(|(line, _)| format!("{line}\n")).collect();
    text.push_str(&case().to_string());
    let run = hodograph(&["contacts"], &text);
    assert_eq!(run.code, 1, "{}", run.stderr);
    let answers = run.lines();
    assert_eq!(answers.len(), cases.len() + 1);
    for ((line, expected), answer) in cases.iter().zip(&answers) {
        assert_eq!(kind(answer), *expected, "{line}\n{answer}");
    }
    assert_eq!(answers.last().unwrap()["force"], json!([1.0, 0.0, -0.1]));
    assert!(!run.stderr.contains("panicked"));
}

#[test]
fn a_given_direction_of_slip_is_kept() {
    let line = with(&[("slip", json!([[0, 2.0]])), ("q", json!([-1, 0.3, 0.2]))]);
    let answer = hodograph(&["contacts"], &line).line();
    assert_eq!(answer["force"], json!([1.0, 0.0, -0.5]));
    let empty = json!({"contacts": 0, "mu": [], "q": [], "w": []});
    let answer = hodograph(&["contacts"], &empty.to_string()).line();
    assert_eq!(answer, json!({"force": [], "velocity": [], "residual": 0.0, "solutions": "unique"}));
}
