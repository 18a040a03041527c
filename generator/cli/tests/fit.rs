//! `hodograph fit`: values from measured motions in a CSV file, and what is wrong with such a file.

use std::fmt::Write as _;

use crate::common::{Run, hodograph, number, root};

/// Heights of a ball that is dropped from h and bounces with e, in closed form.
fn heights(h: f64, g: f64, e: f64, times: impl Iterator<Item = f64>) -> Vec<(f64, f64)> {
    let height = |t: f64| {
        let mut begin = (2.0 * h / g).sqrt();
        if t < begin {
            return h - 0.5 * g * t * t;
        }
        let mut v = e * g * begin;
        while t - begin > 2.0 * v / g {
            begin += 2.0 * v / g;
            v *= e;
        }
        let since = t - begin;
        v * since - 0.5 * g * since * since
    };
    times.map(|t| (t, height(t))).collect()
}

fn fit(data: &str, more: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("drops.csv");
    std::fs::write(&file, data).unwrap();
    let path = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let call = ["fit", file.to_str().unwrap(), path.to_str().unwrap(), "--parameter", "a=0"];
    hodograph(&[&call[..], &["--mu", "0", "--e", "0.7", "--law", "newton"], more].concat(), "")
}

fn drops() -> String {
    let mut data = "trajectory,t [s],z [m]\n".to_owned();
    for (name, h) in [("low", 0.08), ("high", 0.15)] {
        for (t, z) in heights(h, 9.7, 0.8, (0..30).map(|step| 0.013 * f64::from(step))) {
            writeln!(data, "{name},{t},{z}").unwrap();
        }
    }
    data
}

#[test]
fn gravity_and_restitution_are_found_and_the_mass_is_not() {
    let run = fit(&drops(), &["--parameters", "g,e,m"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    assert!((number(&answer["values"]["g"]) - 9.7).abs() < 1e-8, "{answer}");
    assert!((number(&answer["values"]["e"]) - 0.8).abs() < 1e-9, "{answer}");
    assert!(
        answer["errors"]["m"].is_null() && number(&answer["undetermined"][0]["m"]).abs() > 0.99,
        "{answer}"
    );
    assert_eq!(answer["trajectories"], 2);
    assert_eq!(answer["differences"], 58);
    // What `simulate` then takes.
    let arguments: Vec<&str> =
        answer["arguments"].as_array().unwrap().iter().map(|a| a.as_str().unwrap()).collect();
    let path = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let call =
        ["simulate", path.to_str().unwrap(), "--until", "0.1", "--parameter", "a=0", "--format", "csv"];
    let run = hodograph(&[&call[..], &arguments].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let table = fit(&drops(), &["--parameters", "g,e,m", "--bootstrap", "3", "--format", "table"]);
    assert!(
        table.stdout.contains("bootstrap") && table.stdout.contains("not determined"),
        "{}",
        table.stdout
    );
}

/// Start speeds without a column are found from the flight, and several starts tell their minima.
#[test]
fn starts_are_fitted_to_flight() {
    let more = ["--parameters", "e", "--parameter", "g=9.7", "--state", "u=0.3"];
    let run =
        fit(&drops(), &[&more[..], &["--flight", "0.1", "--starts", "3", "--horizons", "0.2"]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    assert!((number(&answer["values"]["e"]) - 0.8).abs() < 1e-8, "{answer}");
    assert!(answer["minima"].as_array().unwrap().len() > 1 && number(&answer["flight"]) == 0.1, "{answer}");
    for start in answer["start_states"].as_array().unwrap() {
        assert!(number(&start["u"]["u"]).abs() < 1e-9 && number(&start["errors"]["u"]) < 1e-9, "{start}");
    }
    // Gravity decides what the flight tells: both are found.
    let both = fit(&drops(), &["--parameters", "g,e", "--state", "u=0.3", "--flight", "0.1"]);
    assert_eq!(both.code, 0, "{}", both.stderr);
    let answer = both.line();
    for (name, value) in [("g", 9.7), ("e", 0.8)] {
        assert!((number(&answer["values"][name]) - value).abs() < 1e-7, "{answer}");
    }
    let long = fit(&drops(), &[&more[..], &["--flight", "0.3"]].concat());
    assert!(long.code == 2 && long.stderr.contains("shorter flight"), "{}", long.stderr);
}

/// A drop that was measured wrongly, by a decimetre in some rows, decides nothing with a cap, and little after Huber.
#[test]
fn wrong_rows_do_not_decide_with_robust_losses() {
    let mut data = drops();
    for (t, z) in heights(0.12, 9.7, 0.8, (0..30).map(|step| 0.013 * f64::from(step))) {
        writeln!(data, "wrong,{t},{}", if t > 0.3 { z + 0.1 } else { z }).unwrap();
    }
    let off = |more: &[&str]| {
        let run = fit(&data, &[&["--parameters", "g,e", "--error", "z=0.001"], more].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let answer = run.line();
        let off = (number(&answer["values"]["e"]) - 0.8).abs() + (number(&answer["values"]["g"]) - 9.7).abs();
        (off, answer["outliers"].as_u64())
    };
    let (square, huber, cap) = (off(&[]), off(&["--huber", "3"]), off(&["--cap", "3"]));
    assert_eq!((square.1, huber.1, cap.1), (None, Some(6), Some(6)));
    assert!(huber.0 < 0.3 * square.0 && cap.0 < 1e-6, "{square:?} {huber:?} {cap:?}");
    for option in ["--cap", "--huber"] {
        let refused = fit(&data, &["--parameters", "e", option, "0"]);
        let words = format!("{option} 0: the number of errors must be positive");
        assert!(refused.code == 2 && refused.stderr.contains(&words), "{}", refused.stderr);
    }
}

/// One difference for one value is met exactly: it tells no error of it. One sample tells no spread.
#[test]
fn errors_need_more_differences_than_values() {
    let one = "t,z\n0,0.15\n0.05,0.138\n";
    let answer = fit(one, &["--parameters", "g"]).line();
    assert!((number(&answer["values"]["g"]) - 9.6).abs() < 1e-9 && answer["differences"] == 1, "{answer}");
    assert!(answer["errors"]["g"].is_null(), "{answer}");
    let flown = fit(one, &["--parameters", "g", "--flight", "0.06"]).line();
    assert!(flown["start_states"][0]["errors"]["z"].is_null(), "{flown}");
    let two = fit("t,z\n0,0.15\n0.05,0.138\n0.06,0.1327\n", &["--parameters", "g"]).line();
    assert!(number(&two["errors"]["g"]) > 0.0, "{two}");
    let spread = fit(&drops(), &["--parameters", "g", "--bootstrap", "1"]);
    assert!(spread.told().0 == 2 && spread.stderr.contains("--bootstrap 1: one sample"), "{}", spread.stderr);
    let lonely = fit(&drops(), &["--parameters", "g", "--seed", "3"]);
    assert!(lonely.told().0 == 2 && lonely.stderr.contains("--seed is of --starts"), "{}", lonely.stderr);
}

/// What cannot be fitted is not offered, and differences whose squares are no numbers are an error.
#[test]
fn what_cannot_be_fitted_is_an_error_object() {
    for name in ["nope", "z", "u"] {
        let run = fit(&drops(), &["--parameters", name, "--format", "json"]);
        assert_eq!(run.error_kind(), "unknown_name");
        let message = run.line()["error"]["message"].as_str().unwrap().to_owned();
        let (_, offered) = message.split_once(": there are ").unwrap();
        assert_eq!(offered, "m, g, a, w, mu, e, mu.table, e.table", "{message}");
    }
    let far = fit("t,z\n0,1e300\n0.1,0.1\n", &["--parameters", "g", "--format", "json"]);
    assert_eq!(far.error_kind(), "not_finite");
}

#[test]
fn data_that_are_wrong_are_refused_at_their_place() {
    for (data, words) in [
        ("t,z\n0,0.1\n0.1,x\n", "line 3: `x` in the column `z`"),
        ("t,z\n0,\n0.1,0.1\n", "line 2: a cell is empty in the first row of trajectory 1"),
        ("t,z\n0,0.1\n0,0.1\n", "line 3: the time 0 does not follow 0"),
        ("t,z [mm]\n0,100\n0.1,90\n", "the model counts it in m"),
        ("t,height\n0,0.1\n0.1,0.09\n", "the column `height`"),
        ("z\n0.1\n0.09\n", "no column `t`"),
        ("t,z\n0,0.1\n", "one row"),
        ("t,z,z\n0,0.1,0.1\n", "occurs twice"),
        ("t,z\n0,0.1\n0.1\n", "line 3: it has 1 cells, and the head 2"),
        ("t\n0\n1\n", "no column holds"),
        ("trajectory,t,z\na,0,0.1\na,0.1,0.1\nb,0,0.1\nb,0.1,0.1\na,0,0.1\n", "has rows in two places"),
        (
            "trajectory,t,z\na,0,0.1\nb,0,0.1\na,0.1,0.1\nb,0.1,0.1\n",
            "line 4: trajectory a has rows in two places",
        ),
    ] {
        let run = fit(data, &["--parameters", "e"]);
        assert_eq!(run.code, 2, "{data}: {}", run.stderr);
        assert!(run.stderr.contains(words), "{data}: {}", run.stderr);
    }
    let run = fit(&drops(), &["--parameters", "e,e.table"]);
    assert!(run.code == 2 && run.stderr.contains("e of all contacts and of one of them"), "{}", run.stderr);
    let run = fit(&drops(), &["--parameters", "e", "--error", "u=0.1"]);
    assert!(run.code == 2 && run.stderr.contains("no column `u`"), "{}", run.stderr);
}
