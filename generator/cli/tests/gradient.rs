//! `hodograph gradient`: derivatives of motions by name, and what is said where there are none.

use crate::common::{hodograph, model, number, root};

/// A ball that is dropped from h: the times of its bounces by h, g and e in closed form.
#[test]
fn times_of_bounces_have_derivatives_by_name() {
    let path = root().join("simulation/gradients/tests/models/ball_on_plate.mech");
    let path = path.to_str().unwrap();
    let surface = ["--mu", "0", "--e", "0.5", "--law", "newton", "--parameter", "a=0"];
    let call = [&["gradient", path, "--by", "z,g,e", "--at", "0.1,0.35"], &surface[..]].concat();
    let run = hodograph(&call, "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    let (h, g, e): (f64, f64, f64) = (0.1, 9.81, 0.5);
    let first = (2.0 * h / g).sqrt();
    let events = answer["events"].as_array().unwrap();
    assert_eq!(events.len(), 2, "{answer}");
    for (event, factor, by_e) in [(&events[0], 1.0, 0.0), (&events[1], 1.0 + 2.0 * e, 2.0 * first)] {
        assert_eq!(event["event"], "collision");
        let time = factor * first;
        let close = |name: &str, exact: f64| (number(&event["t_by"][name]) - exact).abs() < 1e-12;
        assert!(close("z", time / (2.0 * h)) && close("g", -time / (2.0 * g)) && close("e", by_e), "{event}");
    }
    // While it falls z = h - g t^2 / 2.
    let falling = &answer["states"][0]["by"];
    assert!((number(&falling["z"]["q"]["z"]) - 1.0).abs() < 1e-14);
    assert!((number(&falling["g"]["q"]["z"]) + 0.005).abs() < 1e-14);
    assert!(answer["undefined"].is_null());
    let table = hodograph(&[&call[..], &["--format", "table"]].concat(), "");
    assert!(table.stdout.contains("times of events, and derivatives by"), "{}", table.stdout);
}

/// Nothing is a number where the motion is not differentiable.
#[test]
fn reasons_take_the_place_of_derivatives() {
    let path = root().join("simulation/models/measured_cube.mech");
    let path = path.to_str().unwrap();
    let call =
        ["gradient", path, "--by", "z", "--at", "0.1,0.4", "--mu", "0.2", "--e", "0.4", "--law", "poisson"];
    let run = hodograph(&call, "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    assert!(answer["states"][0]["by"].is_object() && answer["states"][1]["by"].is_null(), "{answer}");
    let message = answer["undefined"]["message"].as_str().unwrap();
    assert!(message.contains("several contacts"), "{message}");
}

#[test]
fn names_and_times_that_are_wrong_are_refused() {
    let path = model("free_box_corner");
    let surface = ["--mu", "0.3", "--e", "0.5", "--law", "newton"];
    let run = hodograph(&[&["gradient", &path, "--by", "mass", "--at", "1"], &surface[..]].concat(), "");
    assert_eq!(run.code, 1);
    let message = run.line()["error"]["message"].as_str().unwrap().to_owned();
    assert!(message.contains("`mass`") && message.contains("mu"), "{message}");
    let run = hodograph(&[&["gradient", &path, "--by", "m", "--at", "1,0.5"], &surface[..]].concat(), "");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("must rise"), "{}", run.stderr);
    let run = hodograph(&[&["gradient", &path, "--by", "m", "--at", "0.5,0.5"], &surface[..]].concat(), "");
    assert!(run.told().0 == 2 && run.stderr.contains("must rise: 0.5 is given twice"), "{}", run.stderr);
}
