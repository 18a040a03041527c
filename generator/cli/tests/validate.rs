//! `hodograph validate`: drops of a ball in closed form, judged by a fit to other drops.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::common::{Run, hodograph, number, root};

const G: f64 = 9.7;
const E: f64 = 0.8;

/// The height of a ball that is dropped from h and bounces.
fn height(h: f64, t: f64) -> f64 {
    let mut begin = (2.0 * h / G).sqrt();
    if t < begin {
        return h - 0.5 * G * t * t;
    }
    let mut v = E * G * begin;
    while t - begin > 2.0 * v / G {
        begin += 2.0 * v / G;
        v *= E;
    }
    v * (t - begin) - 0.5 * G * (t - begin).powi(2)
}

/// Drops from these heights, each measured too high by `off` (but for its start).
fn drops(heights: &[f64], off: f64) -> String {
    let mut data = "trajectory,t [s],z [m]\n".to_owned();
    for h in heights {
        for step in 0..30 {
            let t = 0.013 * f64::from(step);
            let off = if step == 0 { 0.0 } else { off };
            writeln!(data, "from {h},{t},{}", height(*h, t) + off).unwrap();
        }
    }
    data
}

const FITTED: [f64; 2] = [0.08, 0.15];
const OTHERS: [f64; 6] = [0.07, 0.1, 0.12, 0.16, 0.2, 0.25];

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

/// A folder with the fit `fit.json` and the data `data.csv`.
fn fitted() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let data = write(folder.path(), "drops.csv", &drops(&FITTED, 0.0));
    write(folder.path(), "data.csv", &drops(&OTHERS, 0.0));
    let model = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let call =
        ["fit", &data, model.to_str().unwrap(), "--parameters", "g,e", "--parameter", "a=0", "--mu", "0"];
    let more = ["--e", "0.7", "--law", "newton", "--error", "z=0.002", "--format", "json"];
    let run = hodograph(&[&call[..], &more].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    write(folder.path(), "fit.json", &run.stdout);
    folder
}

/// The model of the fit with an input.
fn driven() -> String {
    let model = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let text = std::fs::read_to_string(model).unwrap();
    let text = text.replace("coordinates {", "inputs { F: N = 0 }\ncoordinates {");
    text.replace("loads { gravity: -g*N.z; }", "loads { gravity: -g*N.z; force on P: F*N.z; }")
}

fn validate(folder: &Path, more: &[&str]) -> Run {
    let (fit, data) = (folder.join("fit.json"), folder.join("data.csv"));
    hodograph(&[&["validate", fit.to_str().unwrap(), data.to_str().unwrap()], more].concat(), "")
}

fn near(found: &Value, expected: f64, within: f64) {
    let found = number(found);
    assert!((found - expected).abs() <= within, "{found} instead of {expected}");
}

#[test]
fn a_right_fit_predicts_what_a_wrong_prediction_misses() {
    let folder = fitted();
    let at = |name: &str| folder.path().join(name).display().to_string();
    // another prediction, 3 mm too high: 1.5 in units of 2 mm
    let other = write(folder.path(), "other.csv", &drops(&OTHERS, 0.003));
    let (page, own) = (at("page.html"), at("own.csv"));
    let more =
        ["--against", &other, "--within", "z=0.001", "--noise", "z=0.0002", "--floor", "--html", &page];
    let run = validate(folder.path(), &[&more[..], &["--predictions", &own, "--format", "json"]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    assert!(number(&answer["error"]["mean"]) < 1e-5 && number(&answer["floor"]["mean"]) < 1e-5, "{answer}");
    near(&answer["units"]["z"], 0.002, 0.0);
    for (part, value) in answer["against"]["quantiles"].as_object().unwrap() {
        assert!((number(value) - 1.5).abs() < 1e-9, "{part} {value}");
    }
    let difference = &answer["difference"];
    near(&difference["mean"], -1.5, 1e-5);
    assert_eq!((&difference["nearer"], &difference["count"]), (&6.into(), &6.into()));
    // all six have one sign: 2 of 2^6
    near(&difference["p"], 2.0 / 64.0, 1e-15);
    assert_eq!(difference["p_is_exact"], true);
    assert_eq!((&answer["right"]["right"], &answer["against_right"]["right"]), (&6.into(), &0.into()));
    // that nothing moves errs by the way of each ball
    for (one, h) in answer["trajectories"].as_array().unwrap().iter().zip(OTHERS) {
        let squares = (1..30).map(|step| ((height(h, 0.013 * f64::from(step)) - h) / 0.002).powi(2));
        near(&one["at_rest"], (squares.sum::<f64>() / 29.0).sqrt(), 1e-9);
        assert_eq!(one["name"], format!("from {h}"));
    }
    // a tenth of the unit, once at the start and once at each sample, and more after impacts
    let noise = number(&answer["noise"]["mean"]);
    assert!(noise > 0.08 && noise < 0.5, "{noise}");
    assert_eq!(answer["convergence"].as_array().unwrap().len(), 2);
    assert!(
        answer["convergence"].as_array().unwrap().iter().all(|one| number(&one["greatest_change"]) < 1e-3)
    );
    assert_eq!(answer["fitted_on"], serde_json::json!([]));
    // its own predictions, given back, are as near
    let run = validate(folder.path(), &["--against", &own, "--format", "json"]);
    let answer = run.line();
    assert_eq!(
        (number(&answer["difference"]["mean"]), number(&answer["difference"]["p"])),
        (0.0, 1.0),
        "{answer}"
    );

    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains(hodograph_generator::page::STYLE.trim()));
    assert!(page.contains(hodograph_animation::STYLE.trim()));
    assert!(!page.contains("http") && !page.contains("NaN") && !page.contains("inf"));
    // the distribution, the pairs, and z of three motions
    assert_eq!(page.matches("<figure>").count(), 5);
    for words in [
        "this prediction",
        "nothing moves",
        "noise alone",
        "best values of each",
        "greatest error",
        "Wilcoxon",
    ] {
        assert!(page.contains(words), "{words}");
    }
    let table = validate(folder.path(), &["--against", &other, "--format", "table"]).stdout;
    assert!(table.contains("this prediction") && table.contains("Wilcoxon's p 3.12e-2 (exact)"), "{table}");
}

/// Motions of the fit are named: to predict them is no test.
#[test]
fn motions_of_the_fit_are_told() {
    let folder = fitted();
    write(folder.path(), "data.csv", &drops(&[FITTED[0], OTHERS[1]], 0.0));
    let answer = validate(folder.path(), &["--format", "json"]).line();
    assert_eq!(answer["fitted_on"], serde_json::json!(["from 0.08"]));
    assert!(answer["right"].is_null() && answer.get("difference").is_none());
}

/// Neither a fit nor its judgement follows inputs yet: both say so where the answer would stand.
#[test]
fn inputs_are_an_error_object() {
    let folder = fitted();
    let driven = write(folder.path(), "driven.mech", &driven());
    let run = validate(folder.path(), &["--model", &driven, "--format", "json"]);
    assert_eq!(run.error_kind(), "failed_motion");
    let data = folder.path().join("data.csv").display().to_string();
    let call = ["fit", &data, &driven, "--parameters", "g", "--parameter", "a=0", "--format"];
    let json = hodograph(&[&call[..], &["json"]].concat(), "");
    assert_eq!(json.error_kind(), "failed_motion");
    let told = hodograph(&[&call[..], &["table"]].concat(), "");
    assert!(told.told().0 == 1 && told.stderr.contains("with inputs are not fitted yet"), "{}", told.stderr);
}

#[test]
fn wrong_files_are_refused() {
    let folder = fitted();
    let other = write(folder.path(), "other.csv", &drops(&OTHERS[..5], 0.0));
    let run = validate(folder.path(), &["--against", &other]);
    assert!(run.code == 2 && run.stderr.contains("trajectory from 0.25 is missing"), "{}", run.stderr);
    let late = drops(&OTHERS, 0.0).replace(",0.013,", ",0.0131,");
    let other = write(folder.path(), "other.csv", &late);
    let run = validate(folder.path(), &["--against", &other]);
    assert!(run.code == 2 && run.stderr.contains("has other times than the data"), "{}", run.stderr);
    for (option, value, words) in [
        ("--within", "y=1", "no column `y`"),
        ("--noise", "z=-1", "a positive number"),
        ("--within", "z", "give NAME=NUMBER"),
    ] {
        let run = validate(folder.path(), &[option, value]);
        assert!(run.code == 2 && run.stderr.contains(words), "{option} {value}: {}", run.stderr);
    }
    let data = folder.path().join("data.csv").display().to_string();
    for option in ["--html", "--predictions"] {
        let run = validate(folder.path(), &[option, &data]);
        assert!(run.code == 2 && run.stderr.contains("would overwrite"), "{}", run.stderr);
    }
    // the model and the state that the fit names are read too
    let model = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let own = folder.path().join("own.mech").display().to_string();
    std::fs::copy(&model, &own).unwrap();
    let start = write(folder.path(), "start.json", "{}");
    let text = std::fs::read_to_string(folder.path().join("fit.json")).unwrap();
    let mut fit: Value = serde_json::from_str(&text).unwrap();
    fit["model"] = own.as_str().into();
    fit["options"].as_array_mut().unwrap().push(format!("--state={start}").into());
    write(folder.path(), "fit.json", &fit.to_string());
    let derivation = folder.path().join("own.derivation").display().to_string();
    for (option, path) in
        [("--predictions", &own), ("--html", &own), ("--html", &derivation), ("--html", &start)]
    {
        let run = validate(folder.path(), &[option, path]);
        assert!(run.code == 2 && run.stderr.contains("would overwrite"), "{option} {path}: {}", run.stderr);
    }
    assert_eq!(std::fs::read(&own).unwrap(), std::fs::read(&model).unwrap());
    assert_eq!(std::fs::read_to_string(&start).unwrap(), "{}");
    let run = validate(folder.path(), &["--seed", "2"]);
    assert!(run.code == 2 && run.stderr.contains("--seed is of --noise alone"), "{}", run.stderr);
    fit["units"]["z"] = 0.into();
    write(folder.path(), "fit.json", &fit.to_string());
    let run = validate(folder.path(), &[]);
    assert!(run.code == 2 && run.stderr.contains("the unit of z is 0"), "{}", run.stderr);
    write(folder.path(), "fit.json", "{}");
    let run = validate(folder.path(), &[]);
    assert!(run.code == 2 && run.stderr.contains("no answer of `hodograph fit"), "{}", run.stderr);
}
