//! `simulate` with static friction, friction in impacts and e by the speed of approach, from options and the model.

use crate::common::{Run, hodograph, number, root};
use serde_json::Value;

fn simulate(arguments: &[&str]) -> Run {
    let model = root().join("tests/data/motion/pushed_block.mech").display().to_string();
    hodograph(&[&["simulate", &model], arguments].concat(), "")
}

fn first(run: &Run, name: &str) -> Value {
    assert_eq!(run.code, 0, "{}", run.stderr);
    let lines = run.lines();
    lines.iter().find(|line| line["event"] == name).unwrap_or_else(|| panic!("no {name}")).clone()
}

/// Slip begins where the push 3 t reaches mu_static m g, and goes on with mu m g.
#[test]
fn slip_begins_at_static_friction() {
    let weight = 2.0 * 9.81;
    let pushed = ["--until", "4", "--step", "4", "--input", "push=3*t"];
    let sized = |mu_static: f64, mu: f64, arguments: &[&str]| {
        let run = simulate(&[&pushed[..], arguments].concat());
        let begin = mu_static * weight / 3.0;
        assert!((number(&first(&run, "slip")["t"]) - begin).abs() < 1e-10, "{arguments:?}");
        let t = 4.0 - begin;
        let speed = ((mu_static - mu) * weight * t + 1.5 * t * t) / 2.0;
        let lines = run.lines();
        let found = number(&lines.last().unwrap()["u"]["u1"]);
        assert!((found - speed).abs() < 1e-9, "{arguments:?}: {found} {speed}");
        run
    };
    let run = sized(0.5, 0.3, &[]);
    assert!(
        run.stderr.contains("mu_static = 0.5, restitution = power(1, 0.25) of the model"),
        "{}",
        run.stderr
    );
    sized(0.4, 0.3, &["--mu-static", "0.4"]);
    sized(0.45, 0.2, &["--surface", "foot=0.2,0,poisson,mu_static=0.45"]);
    sized(0.25, 0.25, &["--surface", "foot=0.25,0,poisson"]);
}

/// The rebound of a fall from 0.5 m: e (v / 1 m/s)^(-1/4) of the model, or what options say.
#[test]
fn restitution_depends_on_the_speed_of_approach() {
    let v = (2.0_f64 * 9.81 * 0.5).sqrt();
    for (law, e) in [
        (None, 0.6 * v.powf(-0.25)),
        (Some("constant"), 0.6),
        (Some("threshold(3.5)"), 0.0),
        (Some("loss(10, 1)"), 1.0 - 0.4 * v / 10.0),
        (Some("table(0, 0.9, 4, 0.5)"), 0.9 - 0.1 * v),
    ] {
        let law: Vec<&str> = law.map_or(vec![], |law| vec!["--restitution", law]);
        let arguments = [&["--until", "0.4", "--step", "1", "--state", "z=0.5"], &law[..]].concat();
        let collision = first(&simulate(&arguments), "collision");
        let rebound = number(&collision["v"][0]);
        assert!((rebound - e * v).abs() < 1e-10, "{law:?}: {rebound} {}", e * v);
    }
    // A block that strikes at an angle loses mu_impact (1 + e) v of its slip.
    let slant = ["--until", "0.4", "--step", "1", "--state", "z=0.5", "--state", "u1=5"];
    let run = simulate(&[&slant[..], &["--restitution", "constant", "--mu-impact", "0.1"]].concat());
    let after = number(&first(&run, "collision")["u_after"]["u1"]);
    assert!((after - (5.0 - 0.1 * 1.6 * v)).abs() < 1e-10, "{after}");
}

#[test]
fn laws_that_are_none_are_refused() {
    for (arguments, says) in [
        (["--mu-static", "0.1"], "less than that of sliding friction, 0.3"),
        (["--mu-impact", "-1"], "friction in impacts is -1"),
        (["--restitution", "powr(1)"], "give constant, threshold(SPEED)"),
        (["--restitution", "table(2, 0.5, 1, 0.5)"], "must be finite, not negative, and rise"),
        (["--sliding", "stribeck"], "give constant or stribeck(SPEED)"),
        (["--surface", "foot=0.3,0.5,stronge,rolls=0.01"], "a surface has no `rolls`"),
        (["--surface", "foot=0.3,0.5,stronge,rolling=0.01"], "derive it anew"),
        (["--spinning", "-0.01"], "the lever arm of spinning friction is -0.01 m"),
        (["--surface", "foot=0.3,0.5,stronge,0.4"], "parts such as mu_static=0.6"),
        (["--surface", "foot=0.3,0.5,stronge,mu_static=0.5,mu_static=0.6"], "mu_static is given twice"),
    ] {
        let run = simulate(&[&["--until", "1"], &arguments[..]].concat());
        assert!(run.code != 0 && run.stderr.contains(says), "{arguments:?}: {}", run.stderr);
    }
}

/// A ball that rolls and spins comes to rest at the times of its closed forms, which the options change.
#[test]
fn rolling_and_spinning_friction_end_a_motion() {
    let model = root().join("simulation/tests/models/rolling_ball.mech").display().to_string();
    let (m, r, j, g) = (0.4, 0.11, 0.002, 9.81);
    let turn = format!("w2={}", 1.0 / r);
    let call = ["simulate", &model, "--until", "60", "--step", "60", "--state", "ux=1", "--state", &turn];
    let call = [&call[..], &["--state", "w3=10"]].concat();
    for (rolling, spinning, more) in [
        (0.002, 0.001, vec![]),
        (0.004, 0.0005, vec!["--rolling", "0.004", "--spinning", "0.0005"]),
        (0.003, 0.002, vec!["--surface", "plane=0.3,0.5,stronge,rolling=0.003,spinning=0.002"]),
    ] {
        let run = hodograph(&[&call[..], &more].concat(), "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let a = rolling / r * g / (1.0 + j / (m * r * r));
        for (event, time) in [("roll_ends", 1.0 / a), ("spin_ends", j * 10.0 / (spinning * m * g))] {
            let found = number(&first(&run, event)["t"]);
            assert!((found - time).abs() < 1e-9, "{event}: {found} {time}");
        }
    }
    // Spinning that begins tells its sense.
    let call = ["simulate", &model, "--until", "1", "--step", "1", "--input", "Mn=-0.01*t"];
    let run = hodograph(&call, "");
    let spin = first(&run, "spin");
    assert!((number(&spin["t"]) - 0.001 * m * g / 0.01).abs() < 1e-9 && spin["sense"] == -1, "{spin}");
}
