//! `simulate`: times of events, contact that lasts, and what is refused.

mod common;

use common::{Run, hodograph, number, root};
use serde_json::Value;

fn model(name: &str) -> String {
    root().join(format!("tests/data/motion/{name}.mech")).display().to_string()
}

fn simulate(name: &str, arguments: &[&str]) -> Run {
    hodograph(&[&["simulate", &model(name)], arguments].concat(), "")
}

fn events<'a>(lines: &'a [Value], name: &str) -> Vec<&'a Value> {
    lines.iter().filter(|line| line["event"] == name).collect()
}

const BALL: [&str; 6] = ["--mu", "0", "--e", "0.5", "--law", "newton"];

/// The first hit of a ball that falls 1 m, whatever the step; the end of its bounces; rest.
#[test]
fn hits_do_not_depend_on_the_step() {
    let fall = (2.0_f64 / 9.81).sqrt();
    let mut all = Vec::new();
    for step in ["1", "0.013", "10"] {
        let run = simulate("bouncing_ball", &[&["--until", "10", "--step", step], &BALL[..]].concat());
        assert_eq!(run.code, 0, "{}", run.stderr);
        let lines = run.lines();
        let times: Vec<f64> = events(&lines, "collision").iter().map(|line| number(&line["t"])).collect();
        assert!((times[0] - fall).abs() < 1e-11, "{}", times[0]);
        assert!((times[1] - 2.0 * fall).abs() < 1e-11, "{}", times[1]);
        let first = events(&lines, "collision")[0];
        assert!((number(&first["v"][0]) - 0.5 * 9.81 * fall).abs() < 1e-10, "{first}");
        let contact = events(&lines, "contact")[0];
        assert!((number(&contact["t"]) - 3.0 * fall).abs() < 1e-10, "{contact}");
        assert_eq!(events(&lines, "rest").len(), 1);
        let last = lines.last().unwrap();
        assert_eq!((number(&last["t"]), number(&last["u"]["v"])), (10.0, 0.0));
        all.push(times);
    }
    assert_eq!(all[0], all[1]);
    assert_eq!(all[0], all[2]);
}

/// A ball thrown up strikes the ceiling within the first step and comes back: nothing inside a step is missed.
#[test]
fn hits_inside_a_step_are_found() {
    let run = simulate("ceiling", &[&["--until", "2", "--step", "1"], &BALL[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    let hit = (5.0 - (25.0_f64 - 2.0 * 9.81 * 1.2).sqrt()) / 9.81;
    let collisions = events(&lines, "collision");
    assert_eq!(collisions.len(), 1);
    assert!((number(&collisions[0]["t"]) - hit).abs() < 1e-11, "{}", collisions[0]);
}

/// A block on an incline does not creep; pulled by a force that grows it begins to slip when friction is used up, and stops when it ends.
#[test]
fn a_block_sticks_and_slips() {
    let surface = ["--mu", "0.5", "--e", "0", "--law", "poisson"];
    let run = simulate("incline", &[&["--until", "100000", "--step", "25000"], &surface[..]].concat());
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    assert_eq!(events(&lines, "rest").len(), 1);
    for line in &lines {
        assert_eq!([&line["q"]["x"], &line["q"]["y"]].map(number), [0.0, 0.0], "{line}");
    }
    // Downhill: F = -3 t adds to gravity.
    let pulled =
        simulate("incline", &[&["--until", "4", "--step", "1", "--input", "F=-3*t"], &surface[..]].concat());
    assert_eq!(pulled.code, 0, "{}", pulled.stderr);
    let lines = pulled.lines();
    let slip = events(&lines, "slip")[0];
    let expected = 2.0 * 9.81 * (0.5 * 0.3_f64.cos() - 0.3_f64.sin()) / 3.0;
    assert!((number(&slip["t"]) - expected).abs() < 1e-9, "{slip} {expected}");
    let t: f64 = 4.0 - expected;
    let moved = number(&lines.last().unwrap()["q"]["x"]);
    assert!((moved + t.powi(3) / 4.0).abs() < 1e-8, "{moved}");
}

#[test]
fn surfaces_are_asked_for_and_checked_before_the_start() {
    let none = simulate("bouncing_ball", &["--until", "1"]);
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("contact floor has no surface"), "{}", none.stderr);
    let own =
        simulate("bouncing_ball", &["--until", "0.1", "--step", "0.1", "--surface", "floor=0,0.5,newton"]);
    assert_eq!((own.code, own.lines().len()), (0, 2), "{}", own.stderr);
    let unknown = simulate("bouncing_ball", &["--until", "1", "--surface", "flor=0,0.5,newton"]);
    assert_eq!(unknown.error_kind(), "unknown_name");
    let much = simulate("bouncing_ball", &["--until", "0.1", "--mu", "0", "--e", "2", "--law", "newton"]);
    assert_eq!(much.error_kind(), "restitution_out_of_range");
    let back = simulate("bouncing_ball", &[&["--until", "-1"], &BALL[..]].concat());
    assert_eq!(back.code, 2);
    assert!(back.stderr.contains("before the start"), "{}", back.stderr);
    let free = hodograph(
        &["simulate", &common::model("shaken_pendulum_moving_plate"), "--until", "0.1", "--step", "0.1"],
        "",
    );
    assert!(free.code == 0 || free.stderr.contains("has no surface"), "{}", free.stderr);
}

#[test]
fn rows_and_figures_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let figure = folder.path().join("ball.svg").display().to_string();
    let call = [&["--until", "1", "--step", "0.1", "--format", "csv", "--plot", &figure], &BALL[..]].concat();
    let run = simulate("bouncing_ball", &call);
    assert_eq!(run.code, 0, "{}", run.stderr);
    let mut rows = run.stdout.lines();
    assert_eq!(rows.next(), Some("t,event,contact,z,v"));
    assert!(rows.clone().all(|row| row.split(',').count() == 5));
    assert!(rows.any(|row| row.contains(",collision,floor,")));
    let drawn = std::fs::read_to_string(&figure).unwrap();
    assert!(drawn.starts_with("<svg") || drawn.contains("<svg"), "{drawn:.80}");
}
