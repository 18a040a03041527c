//! What a new user does first: a model from `new`, numbers by name, tables, completions, pages of `man`,
//! mistakes for editors, and `check --watch`.

use std::fs;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{hodograph, model, number, tool};
use serde_json::Value;

fn place(folder: &tempfile::TempDir, name: &str) -> String {
    folder.path().join(name).display().to_string()
}

/// The new model has no mistake, is not written over, and its contact closes.
#[cfg(feature = "derive")]
#[test]
fn a_new_model_collides() {
    let folder = tempfile::tempdir().unwrap();
    let (name, path) = (place(&folder, "my_pendulum"), place(&folder, "my_pendulum.mech"));
    let made = hodograph(&["new", &name], "");
    assert_eq!(made.told().0, 0, "{}", made.stderr);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("mechanism MyPendulum;"), "{text}");
    let checked = hodograph(&["check", &path], "");
    assert_eq!((checked.code, checked.stdout.as_str()), (0, ""));
    let again = hodograph(&["new", &name], "");
    assert!(again.told().0 == 1 && again.stderr.contains("exists"), "{}", again.stderr);
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let page = place(&folder, "my_pendulum.html");
    // what the command leaves open is said: the surface stands in the model, and the motion ends at 10 s
    let run = hodograph(&["simulate", &path, "--html", &page, "--format", "table"], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    for part in ["q1 [rad]", "Events", "tip_wall", "impacts", "10 collisions; still in motion at t = 10 s."] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
    for part in ["tip_wall: mu = 0.3, e = 0.7, law = stronge of the model", "until t = 10 s"] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
    let shown = fs::read_to_string(&page).unwrap();
    for part in
        ["Model, parameters and surfaces", "mechanism MyPendulum;", "restitution", "distance of the wall"]
    {
        assert!(shown.contains(part), "{part}");
    }
    for wrong in ["3x", "a b", "a-b", "", "ä"] {
        assert_eq!(hodograph(&["new", wrong], "").told().0, 2, "{wrong}");
    }
}

/// The model of shapes has no mistake either, and its crate comes to rest on the floor.
#[cfg(feature = "derive")]
#[test]
fn a_new_crate_comes_to_rest() {
    let folder = tempfile::tempdir().unwrap();
    let (name, path) = (place(&folder, "my_crate"), place(&folder, "my_crate.mech"));
    let made = hodograph(&["new", &name, "--template", "crate"], "");
    assert_eq!(made.told().0, 0, "{}", made.stderr);
    let checked = hodograph(&["check", &path], "");
    assert_eq!((checked.code, checked.stdout.as_str()), (0, ""));
    let run = hodograph(&["simulate", &path, "--format", "table"], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.stdout.contains("at rest from t ="), "{}", run.stdout);
}

/// Without `--until` a motion ends where all is at rest, 10 s after its start at the latest.
#[cfg(feature = "derive")]
#[test]
fn motions_end_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let path = place(&folder, "ball.mech");
    let ball = "mechanism Ball; parameters { m: kg = 1, g: m/s^2 = 9.81 } inputs { F: N = 0 } coordinates { z: m = 0.3 } \
                speeds { v: m/s } points { P = O + z*N.z; } particles { Ball { point: P, mass: m } } \
                loads { gravity: -g*N.z; force on P: F*N.z; } kinematics { d(z)/dt = v; } \
                contacts { floor { point: P, normal: N.z, gap: z, surface: { e: 0.5 } } }";
    fs::write(&path, ball).unwrap();
    let last = |more: &[&str]| {
        let run = hodograph(&[&["simulate", &path, "--format", "json"], more].concat(), "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let lines: Vec<Value> = run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
        let times = lines.iter().filter_map(|line| line["t"].as_f64());
        times.fold(f64::NEG_INFINITY, f64::max)
    };
    // it comes to rest after sqrt(2 h/g) (1 + e)/(1 - e) = 0.742 s
    let rests = (0.6_f64 / 9.81).sqrt() * 3.0;
    let ended = last(&[]);
    assert!(ended > rests && ended < rests + 0.2, "{ended}");
    assert_eq!(last(&["--until", "2"]), 2.0);
    // what depends on time may begin to move again, and a start is counted from
    assert_eq!(last(&["--input", "F = 0*t"]), 10.0);
    assert_eq!(last(&["--state", r#"{"t":3}"#, "--input", "F = 20*sin(t)"]), 13.0);
}

/// What begins slowly is not at rest: a rod that stands on its end falls, however nearly upright it starts.
#[cfg(feature = "derive")]
#[test]
fn motions_that_begin_slowly_do_not_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = place(&folder, "rod.mech");
    let rod = "mechanism Rod; parameters { m: kg = 1, l: m = 0.3, g: m/s^2 = 9.81 } coordinates { q: rad = 0 } \
               speeds { w: rad/s } frames { B = N.rotate(z, q); } points { P = O + l*B.y; } \
               particles { Bob { point: P, mass: m } } loads { gravity: -g*N.y; } kinematics { d(q)/dt = w; }";
    fs::write(&path, rod).unwrap();
    for (angle, falls) in [("1e-10", true), ("1e-14", true), ("0", false)] {
        let run = hodograph(&["simulate", &path, "--format", "json", "--state", &format!("q={angle}")], "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let turned = run.stdout.lines().filter_map(|line| {
            let line: Value = serde_json::from_str(line).ok()?;
            line["q"]["q"].as_f64()
        });
        assert_eq!(turned.fold(0.0, f64::max) > 1.0, falls, "{angle}");
    }
}

/// The README shows the model that `new` writes, without its comments; the one of CONTRIBUTING.md is the same.
#[test]
fn the_readme_shows_the_new_model() {
    let bare = |text: &str| -> String {
        let lines = text.lines().map(|line| line.split("//").next().unwrap_or_default());
        let letters: String = lines.collect::<String>().split_whitespace().collect();
        letters.replace(",}", "}")
    };
    let written = bare(include_str!("../src/commands/new/pendulum.mech"));
    for page in ["README.md", "CONTRIBUTING.md"] {
        let text = fs::read_to_string(crate::common::root().join(page)).unwrap();
        let block = text.split("```text\n").find(|block| block.contains("mechanism Pendulum;")).unwrap();
        assert_eq!(bare(block.split("```").next().unwrap()), written, "{page}");
    }
}

/// Numbers by name are those of the JSON state, in any order and with expressions.
#[test]
fn states_are_given_by_name() {
    let model = model("two_sleds");
    let eval = |more: &[&str]| hodograph(&[&["eval", &model], more].concat(), "");
    let whole = eval(&["--state", r#"{"parameters":{"m":2},"q":{"q3":0.5},"u":{"u1":2,"u4":1}}"#]).line();
    assert_eq!((number(&whole["q"]["q3"]), number(&whole["udot"]["u1"]).is_finite()), (0.5, true), "{whole}");
    assert_ne!(eval(&["--state", "q3=0.5,u1=2,u4=1"]).line(), whole);
    for more in [
        &["--state", "q3=0.5,u1=2,u4=1", "--parameter", "m=2"][..],
        &["--state", "u1=4/2", "--parameter", "m=2", "--state", "u4=cos(0), q3 = 1/2"],
        &["--state", r#"{"q":{"q3":7},"u":{"u1":2,"u4":1}}"#, "--state", "q3=0.5", "--parameter", "m=2"],
    ] {
        assert_eq!(eval(more).line(), whole, "{more:?}");
    }
    for (more, kind) in [
        (&["--state", "q9=1"][..], "unknown_name"),
        (&["--parameter", "q3=1"][..], "unknown_name"),
        (&["--state", "q3=two"][..], "unknown_name"),
        (&["--state", "q3=1/0"][..], "not_finite"),
        (&["--state", "q3=t"][..], "bad_json"),
        (&["--state", "u2=1"][..], "unknown_name"),
    ] {
        assert_eq!(eval(more).error_kind(), kind, "{more:?}");
    }
    for more in [&["--state", "q3=1,q3=2"][..], &["--state", "q3=1,4"], &["--state", "{}", "--state", "{}"]] {
        assert_eq!(eval(more).told().0, 2, "{more:?}");
    }
    for (given, told) in [("q3=", "a number is missing"), ("q3=2*", "found the end")] {
        let message = eval(&["--state", given]).line()["error"]["message"].to_string();
        assert!(message.contains(told) && !message.contains(';'), "{message}");
    }
    let singular =
        hodograph(&["eval", &crate::common::model("planar_double_pendulum"), "--parameter", "l2=0"], "");
    let message = singular.line()["error"]["message"].to_string();
    assert!(message.contains("change the parameters: l2 is 0"), "{message}");
}

/// The tables of `eval` and `collide` have the numbers of the JSON, and errors are told beside them.
#[test]
fn tables_say_what_the_objects_say() {
    let model = model("two_sleds");
    let surface = ["--mu", "0.6", "--e", "0.8", "--law", "stronge"];
    for call in [&["eval", &model][..], &[&["collide", &model][..], &surface].concat()] {
        let object = hodograph(call, "").line();
        let run = hodograph(&[call, &["--format", "table"]].concat(), "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let read: Vec<f64> = run
            .stdout
            .split_whitespace()
            .filter_map(|word| word.trim_end_matches([',', ';']).parse().ok())
            .collect();
        let mut wanted = Vec::new();
        leaves(&object, &mut wanted);
        for number in wanted {
            let near = |found: &f64| (found - number).abs() <= 5.1e-6 * number.abs() + 1e-300;
            // Partial velocities are not in the tables: they are V of the objects.
            assert!(read.iter().any(near), "{number} is not in\n{}", run.stdout);
        }
    }
    let wrong = ["collide", &model, "--mu", "-1", "--e", "0.8", "--law", "stronge"];
    assert_eq!(hodograph(&wrong, "").error_kind(), "negative_friction");
    let told = hodograph(&[&wrong[..], &["--format", "table"]].concat(), "");
    assert_eq!(told.told(), (1, "error: the coefficient of friction is -1: it must not be negative"));
    for command in ["collide", "simulate"] {
        for (option, value) in [("--mu", "nan"), ("--e", "inf")] {
            let asked = [command, &model, option, value, "--law", "stronge", "--format", "table"];
            let run = hodograph(&asked, "");
            assert!(
                run.stderr.contains(&format!("{option} is ")) && run.code == 1,
                "{command} {option}: {}",
                run.stderr
            );
            assert!(run.stderr.contains("it must be finite"), "{}", run.stderr);
        }
    }
}

/// All numbers of an object but those of fields that tables leave out.
fn leaves(value: &Value, out: &mut Vec<f64>) {
    match value {
        Value::Number(_) => out.push(number(value)),
        Value::Array(items) => items.iter().for_each(|item| leaves(item, out)),
        Value::Object(fields) => fields
            .iter()
            .filter(|(name, _)| !["V", "remainder", "velocity"].contains(&name.as_str()))
            .for_each(|(_, item)| leaves(item, out)),
        _ => {}
    }
}

#[test]
fn shells_and_man_know_the_tool() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = hodograph(&["completions", shell], "");
        assert_eq!(script.code, 0, "{}", script.stderr);
        for word in ["simulate", "--tolerance", "completions"] {
            let word = if shell == "fish" { word.trim_start_matches("--") } else { word };
            assert!(script.stdout.contains(word), "{shell}: {word}");
        }
        assert!(!script.stdout.contains("derive-worker"), "{shell}");
    }
    let folder = tempfile::tempdir().unwrap();
    let pages = place(&folder, "man1");
    let written = hodograph(&["man", &pages], "");
    assert_eq!(written.told(), (0, ""));
    let help = hodograph(&["--help"], "").stdout;
    let commands = help.split("Commands:").nth(1).unwrap().split("Options:").next().unwrap();
    let names = commands.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    for name in names.filter_map(|line| line.split_whitespace().next()).filter(|&name| name != "help") {
        let page = fs::read_to_string(format!("{pages}/hodograph-{name}.1")).unwrap();
        assert!(page.contains(".SH NAME") && page.contains(".SH OPTIONS"), "{name}");
    }
}

const WRONG: &str =
    "mechanism Rod;\ncoordinates { q1: rad }\nspeeds { u1: rad/s }\nframes { B = N.rotate(z, qq); }\n";

/// Mistakes as objects and as SARIF have the code, the place and the cure that the text has.
#[test]
fn mistakes_are_written_for_programs() {
    let folder = tempfile::tempdir().unwrap();
    let path = place(&folder, "a rod.mech");
    fs::write(&path, WRONG).unwrap();
    let text = hodograph(&["check", &path], "");
    assert!(text.stdout.contains("error[E020]"), "{}", text.stdout);
    let objects = hodograph(&["check", "--format", "json", &path], "");
    assert_eq!(objects.code, 1);
    let lines = objects.lines();
    let found = lines.iter().find(|line| line["code"] == "E020").unwrap();
    assert_eq!((number(&found["line"]), number(&found["column"])), (4.0, 26.0), "{found}");
    assert_eq!((number(&found["end_line"]), number(&found["end_column"])), (4.0, 28.0), "{found}");
    assert_eq!(found["severity"], "error");
    assert!(found["message"].as_str().unwrap().contains("qq"), "{found}");
    let log = hodograph(&["check", "--format", "sarif", &path], "");
    assert_eq!(log.code, 1);
    let log = log.line();
    assert_eq!(log["version"], "2.1.0");
    let run = &log["runs"][0];
    let results = run["results"].as_array().unwrap();
    assert_eq!(results.len(), lines.len());
    let result = results.iter().find(|result| result["ruleId"] == "E020").unwrap();
    assert_eq!(result["level"], "error");
    let at = &result["locations"][0]["physicalLocation"];
    assert_eq!(at["region"]["startLine"], 4);
    assert!(at["artifactLocation"]["uri"].as_str().unwrap().ends_with("a%20rod.mech"), "{at}");
    for result in results {
        let known = run["tool"]["driver"]["rules"].as_array().unwrap();
        assert!(known.iter().any(|rule| rule["id"] == result["ruleId"]), "{result}");
    }
    let fine = hodograph(&["check", "--format", "sarif", &model("slender_rod_5dof")], "");
    assert_eq!((fine.code, fine.line()["runs"][0]["results"].as_array().unwrap().len()), (0, 0));
}

/// A change of a model is checked when it is saved.
#[test]
fn changes_are_checked_as_they_are_saved() {
    let folder = tempfile::tempdir().unwrap();
    let path = place(&folder, "rod.mech");
    fs::write(&path, WRONG).unwrap();
    let mut child = Command::new(tool())
        .args(["check", "--watch", &path])
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (sender, receiver) = std::sync::mpsc::channel();
    let stderr = BufReader::new(child.stderr.take().unwrap());
    std::thread::spawn(move || {
        stderr.lines().map_while(Result::ok).for_each(|line| drop(sender.send(line)));
    });
    let wait = |what: &str| {
        let end = Instant::now() + Duration::from_secs(60);
        loop {
            let left = end.saturating_duration_since(Instant::now());
            match receiver.recv_timeout(left) {
                Ok(line) if line.contains(what) => return true,
                Ok(_) => {}
                Err(_) => return false,
            }
        }
    };
    let first = wait("1 model checked, 1 with errors");
    fs::copy(model("two_sleds"), &path).unwrap();
    let second = wait("1 model checked, 0 with errors");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(first && second, "{first} {second}");
}
