//! What a model states beside its equations reaches the commands: surfaces, initial values that follow from
//! others, quaternions; and what only the text of a model lacks is said by `check` alone.
#![cfg(feature = "derive")]

use crate::common::hodograph;

const BALL: &str = "mechanism Ball;
parameters { m: kg = 1, r: mm = 50, h: m = 2, w: rad/s = 3, spare: 1 = 1 }
coordinates { x: m = h*cos(a), a: rad = pi/3, z: m = touching(floor, 1), e0: 1 = 0.7071067, e1: 1, e2: 1 = 0.7071068, e3: 1 }
speeds { u: m/s = w*h, v: rad/s, s: m/s = -2, w1: rad/s, w2: rad/s, w3: rad/s }
frames { B = N.quaternion(e0, e1, e2, e3); T = N.rotate(z, a); }
angular_velocities { B = w1*B.x + w2*B.y + w3*B.z; }
points { P = O + x*N.x + z*N.z; }
bodies {
    Sphere { frame: B, centre: P, mass: m, inertia: [m*r^2, m*r^2, m*r^2] },
    Top { frame: T, centre: O, mass: m, inertia: [m*r^2, m*r^2, m*r^2] },
}
kinematics { d(x)/dt = u; d(a)/dt = v; d(z)/dt = s; }
contacts {
    floor { point: P of Sphere, normal: N.z, gap: z - r, surface: { mu: 0, e: 1/2, law: newton } },
    wall { point: P of Sphere, normal: N.x },
}
";

#[test]
fn what_the_model_states_is_taken_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.mech");
    std::fs::write(&path, BALL).unwrap();
    let model = path.to_str().unwrap();
    assert_eq!(hodograph(&["derive", model], "").code, 0);
    let near = |value: &serde_json::Value, expected: f64| {
        let value = value.as_f64().unwrap();
        assert!((value - expected).abs() <= 1e-12, "{value} {expected}");
    };

    let eval = hodograph(&["eval", model], "");
    assert!(!eval.stderr.contains("warning"), "{}", eval.stderr);
    let answer = eval.line();
    near(&answer["q"]["x"], 1.0);
    near(&answer["q"]["z"], 0.05);
    near(&answer["contacts"]["floor"]["gap"], 0.0);
    near(&answer["qdot"]["x"], 6.0);
    // what is given stays, and what follows is evaluated anew
    let state = r#"{"parameters":{"h":4,"r":100},"q":{"a":0}}"#;
    let answer = hodograph(&["eval", model, "--state", state], "").line();
    near(&answer["q"]["x"], 4.0);
    near(&answer["q"]["z"], 0.1);
    near(&answer["qdot"]["x"], 12.0);
    near(
        &hodograph(&["eval", model, "--state", r#"{"q":{"z":3}}"#], "").line()["contacts"]["floor"]["gap"],
        2.95,
    );

    let own = hodograph(&["collide", model, "--contact", "floor"], "");
    assert!(own.stderr.contains("mu = 0, e = 0.5, law = newton of the model"), "{}", own.stderr);
    near(&own.line()["u_after"]["s"], 1.0);
    let given = hodograph(&["collide", model, "--contact", "floor", "--e", "1"], "");
    assert!(given.stderr.contains("mu = 0, law = newton of the model"), "{}", given.stderr);
    near(&given.line()["u_after"]["s"], 2.0);
    let none = hodograph(&["collide", model, "--contact", "wall"], "");
    assert_eq!(none.code, 2);
    assert!(none.stderr.contains("contact wall has no surface"), "{}", none.stderr);
    let moved = hodograph(&["simulate", model, "--until", "0.1", "--step", "0.1"], "");
    assert_eq!(moved.code, 0, "{}", moved.stderr);
    assert!(
        moved.stderr.contains("contact floor: mu = 0, e = 0.5, law = newton of the model"),
        "{}",
        moved.stderr
    );

    // rounding is mended, a mistake is not
    let quaternion = |e0: &str| {
        let state = format!(r#"{{"q":{{"e0":{e0},"e1":0,"e2":0,"e3":0}}}}"#);
        hodograph(&["eval", model, "--state", &state], "")
    };
    assert_eq!(quaternion("0.9999995").code, 0);
    assert_eq!(quaternion("0.99999").code, 1);

    let check = hodograph(&["check", model], "");
    assert!(check.stdout.contains("W001") && check.stdout.contains("W014"), "{}", check.stdout);
}

#[test]
fn a_code_that_does_not_exist_is_named() {
    for (code, says) in [("E987", "there is no code E987"), ("W4711", "there is no code W4711")] {
        let run = hodograph(&["explain", code], "");
        assert_eq!(run.code, 2);
        assert!(run.stderr.contains(says), "{}", run.stderr);
    }
    assert_eq!(hodograph(&["explain", "E62"], "").stdout, hodograph(&["explain", "E062"], "").stdout);
}
