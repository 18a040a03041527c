//! `hodograph eval` and `hodograph collide`: states, names, completed loops, and what is wrong with them.

use crate::common::{Run, hodograph, model, number, numbers};
use serde_json::{Value, json};

fn eval(name: &str, state: &Value) -> Run {
    hodograph(&["eval", &model(name), "--state", "-"], &state.to_string())
}

fn message(run: &Run) -> String {
    run.line()["error"]["message"].as_str().unwrap().to_owned()
}

#[test]
fn what_is_missing_takes_the_files_value() {
    let run = hodograph(&["eval", &model("two_sleds")], "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    assert_eq!(answer["speeds"], json!(["u1", "u3", "u4", "u6"]));
    assert_eq!(number(&answer["q"]["q3"]), std::f64::consts::FRAC_PI_4);
    assert_eq!(answer["contacts"]["BcAc"]["gap"], Value::Null);
    let v = numbers(&answer["contacts"]["BcAc"]["v"]);
    assert!((v[0] + 0.946108022).abs() < 1e-9 && (v[1] - 1.06306701).abs() < 1e-9 && v[2] == 0.0);
    assert_eq!(eval("two_sleds", &json!({})).line(), answer);
    assert_eq!(eval("two_sleds", &json!({"u": {"u1": 1}, "q": {}, "t": 5})).line(), answer);
}

#[test]
fn fields_come_in_the_order_of_the_contract() {
    let run = hodograph(&["eval", &model("two_sleds")], "");
    let names = [
        "speeds",
        "q",
        "mass_matrix",
        "forcing",
        "udot",
        "qdot",
        "dependent",
        "kinetic_energy",
        "contacts",
        "gap",
        "normal",
        "tangent",
        "binormal",
        "velocity",
        "V",
        "remainder",
        "reduced",
        "v",
    ];
    let places: Vec<usize> =
        names.iter().map(|name| run.stdout.rfind(&format!("\"{name}\":")).unwrap()).collect();
    assert!(places.is_sorted(), "{places:?}");
}

#[test]
fn a_name_may_stand_under_parameters_or_inputs() {
    let one = eval("two_sleds", &json!({"inputs": {"m": 2}}));
    assert_eq!(one.line(), eval("two_sleds", &json!({"parameters": {"m": 2}})).line());
    assert_ne!(one.line(), eval("two_sleds", &json!({})).line());
}

#[test]
fn wrong_states_are_named() {
    for (state, kind, part) in [
        (json!({"q": {"q33": 1}}), "unknown_name", "did you mean `q3`?"),
        (json!({"q": {"u1": 1}}), "unknown_name", "`u1` is a speed: give it under `u`"),
        (json!({"u": {"q1": 1}}), "unknown_name", "`q1` is a coordinate: give it under `q`"),
        (json!({"u": {"u2": 1}}), "unknown_name", "`u2` is a dependent speed"),
        (json!({"u": {"m": 1}}), "unknown_name", "give it under `parameters`"),
        (json!({"parameters": {"gama": 1}}), "unknown_name", "did you mean `gamma`?"),
        (json!({"params": {"m": 1}}), "unknown_name", "a state has no field `params`"),
        (json!({"q": {"q1": "1"}}), "bad_json", "`q.q1` must be a number, not a string"),
        (json!({"q": [1]}), "bad_json", "`q` must be an object"),
        (json!([]), "bad_json", "the state must be an object"),
        (json!({"t": null}), "bad_json", "`t` must be a number"),
        (json!({"parameters": {"m": 1}, "inputs": {"m": 1}}), "bad_json", "give it once"),
    ] {
        let run = eval("two_sleds", &state);
        assert_eq!(run.error_kind(), kind, "{state}");
        assert!(message(&run).contains(part), "{state}: {}", message(&run));
    }
    for (text, kind) in
        [("{", "bad_json"), ("{\"t\":1e999}", "not_finite"), ("{\"q\":{\"q1\":NaN}}", "not_finite")]
    {
        let run = hodograph(&["eval", &model("two_sleds"), "--state", "-"], text);
        assert_eq!(run.error_kind(), kind, "{text}");
    }
}

/// Numbers by name that are none have the kind of their mistake, and a cure that is one.
#[test]
fn wrong_numbers_are_named() {
    for (option, text, kind, part) in [
        ("--state", "q1=", "bad_json", "a number is missing"),
        ("--state", "q1=2*", "bad_json", "cannot be read"),
        ("--state", "q1=l", "unknown_name", "`l` is unknown: a number may have"),
        ("--state", "q1=foo(1)", "unknown_name", "there is no function `foo`"),
        ("--state", "q.1=0.3", "unknown_name", "`q.1`: did you mean `q1`?"),
        ("--state", "q1=0.3;u1=1", "bad_json", "commas stand between numbers"),
        ("--state", "q1=max(0,t-1)", "bad_json", "it depends on the time t"),
        ("--state", "q1=1/0", "not_finite", "it must be finite"),
        ("--parameter", "q1=0.5", "unknown_name", "give it as --state q1=0.5"),
        ("--parameter", "u1=1", "unknown_name", "`u1` is a speed, no parameter: give it as --state u1=1"),
        ("--parameter", "u2=1", "unknown_name", "`u2` is a dependent speed"),
        ("--parameter", "gama=1", "unknown_name", "did you mean `gamma`?"),
    ] {
        let run = hodograph(&["eval", &model("two_sleds"), option, text], "");
        assert_eq!(run.error_kind(), kind, "{text}");
        assert!(
            message(&run).contains(part) && !message(&run).contains("input is"),
            "{text}: {}",
            message(&run)
        );
    }
}

#[test]
fn loops_are_completed_from_a_guess() {
    // The file's own values are consistent to their last digits, and stay.
    let kept = eval("four_bar", &json!({"q": {"q2": 0.36082749096}})).line();
    assert_eq!(number(&kept["q"]["q2"]), 0.36082749096);
    let moved = eval("four_bar", &json!({"q": {"q1": 1.0724}})).line();
    // From the reference: another state of the same linkage.
    assert!((number(&moved["q"]["q2"]) - 0.4330623236109516).abs() < 1e-13);
    assert!((number(&moved["q"]["q3"]) - 1.6215628182394223).abs() < 1e-13);
    // The other way to assemble it.
    let below = eval("four_bar", &json!({"q": {"q1": 1.0724, "q2": -1.5, "q3": -2.5}})).line();
    assert!(number(&below["q"]["q2"]) < 0.0);
    let apart = eval("four_bar", &json!({"parameters": {"d": 3}}));
    assert_eq!(apart.error_kind(), "inconsistent_state");
    assert!(message(&apart).contains("near the guess q2 = 0.36"), "{}", message(&apart));
    assert!(message(&apart).contains("residual"), "{}", message(&apart));
}

#[test]
fn singular_states_are_said_not_computed() {
    // The pole of the angles of a pendulum on a ball joint.
    let run = eval("spherical_pendulum", &json!({"q": {"q2": 0}}));
    assert_eq!(run.error_kind(), "singular_state");
    let run = eval("two_sleds", &json!({"u": {"u1": 1e308, "u3": 1e308}}));
    assert_eq!(run.error_kind(), "singular_state");
}

/// The message names what cannot be found, and where.
#[test]
fn singular_states_are_said_where() {
    let pole = std::f64::consts::FRAC_PI_2;
    for (name, state, what, place) in [
        ("free_box_corner", json!({"q": {"q5": pole}}), "the rate of q4, q6 at this q5", "(q5 = 1.57"),
        ("ball_joint_body", json!({"q": {"q2": 0}}), "the rate of q1, q3 at this q2", "(q2 = 0,"),
        ("spherical_pendulum", json!({"q": {"q2": 0}}), "the rate of q1 at this q2", "(q2 = 0,"),
        ("slender_rod_5dof", json!({"q": {"q5": pole}}), "the rate of q4 at this q5", "(q5 = 1.57"),
        ("rolling_disc", json!({"q": {"q2": pole}}), "the rate of q1, q3 at this q2", "(q2 = 1.57"),
        ("rattleback", json!({"q": {"q2": pole}}), "the rate of q1, q3 at this q2", "(q2 = 1.57"),
    ] {
        let run = eval(name, &state);
        assert_eq!(run.error_kind(), "singular_state");
        assert!(message(&run).contains(what) && message(&run).contains(place), "{name}: {}", message(&run));
    }
}

/// Where a linkage folds, its completed coordinates are known to the root of the rounding error only: no
/// number follows from them. A little beside all do.
#[test]
fn folded_linkages_are_singular() {
    let folded = [
        ("four_bar", json!({"d": 1.2, "l3": 0.7}), std::f64::consts::PI, -1.0),
        ("slider_crank", json!({"l1": 0.8, "l2": 0.5}), 0.625f64.asin(), -1.0),
    ];
    for (name, parameters, q1, side) in folded {
        let at = |q1: f64| eval(name, &json!({"parameters": parameters, "q": {"q1": q1}}));
        for q1 in [q1, q1 + side * 1e-16, q1 + side * 1e-15] {
            let run = at(q1);
            assert_eq!(run.error_kind(), "singular_state", "{name} at {q1}");
            assert!(message(&run).contains("dead centre where q2 = "), "{}", message(&run));
        }
        for distance in [1e-3, 1e-2] {
            let run = at(q1 + side * distance);
            assert_eq!(run.code, 0, "{name}: {}", run.stdout);
            for value in run.line()["udot"].as_object().unwrap().values() {
                assert!(number(value).abs() < 1e6, "{name}: {}", run.stdout);
            }
        }
    }
}

/// A loop that is closed by its velocities alone stays open if it begins so: that is said, with the distance.
#[test]
fn open_loops_are_reported() {
    let text = std::fs::read_to_string(model("four_bar")).unwrap();
    let (before, after) = text.split_once("configuration {").unwrap();
    let after = after.split_once('}').unwrap().1;
    let text = format!("{before}{after}").replace("dependent q", "q");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("four_bar.mech");
    for equation in ["velocity(EB) = velocity(EC)", "velocity(EB, EC) = 0", "0 = velocity(EB) - velocity(EC)"]
    {
        std::fs::write(&path, text.replace("velocity(EB) = velocity(EC)", equation)).unwrap();
        let at = |state: &str| hodograph(&["eval", path.to_str().unwrap(), "--state", state], "");
        let closed = at("{}");
        assert_eq!(closed.code, 0, "{}{}", closed.stdout, closed.stderr);
        // Two programs of the same mechanism: equal up to rounding.
        let (found, expected) =
            (closed.line()["udot"].clone(), eval("four_bar", &json!({})).line()["udot"].clone());
        for name in ["u1", "u2", "u3"] {
            let (found, expected) = (found[name].as_f64().unwrap(), expected[name].as_f64().unwrap());
            assert!((found - expected).abs() <= 1e-13 * expected.abs(), "{name}: {found}, {expected}");
        }
        let open = at(r#"{"q":{"q1":1.0}}"#);
        assert_eq!(open.error_kind(), "inconsistent_state");
        let said = message(&open);
        assert!(said.contains("EB is off EC by [0.1") || said.contains("EC is off EB by [-0.1"), "{said}");
    }
}

fn collide(name: &str, more: &[&str]) -> Run {
    hodograph(&[&["collide", &model(name)], more].concat(), "")
}

#[test]
fn collide_gives_the_papers_outcome() {
    let run = collide("two_sleds", &["--contact", "BcAc", "--mu", "0.6", "--e", "0.8", "--law", "stronge"]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let answer = run.line();
    let near = |found: &Value, expected: f64| (number(found) - expected).abs() < 1e-7;
    assert!(near(&answer["impulse"][0], 7.013981068) && near(&answer["v"][0], 0.5115321742), "{answer}");
    assert!(near(&answer["v"][1], -0.2088974513) && near(&answer["v"][2], 0.2119217875), "{answer}");
    assert_eq!(answer["path"], json!(["sliding"]));
    let names: Vec<&String> = answer["u_after"].as_object().unwrap().keys().collect();
    assert_eq!(names.len(), 6);
    // The energy before and after, evaluated.
    let energy = |u: &Value| number(&eval("two_sleds", &json!({"u": u})).line()["kinetic_energy"]);
    let mut after = answer["u_after"].clone();
    let dependent = ["u2", "u5"].map(|name| number(&after.as_object_mut().unwrap().remove(name).unwrap()));
    let change = energy(&after) - energy(&json!({}));
    assert!((change - number(&answer["kinetic_energy_change"])).abs() < 1e-12);
    assert!((number(&answer["dE"]) - number(&answer["kinetic_energy_change"])).abs() < 1e-15);
    // The dependent speeds still satisfy the constraints.
    let again = eval("two_sleds", &json!({"u": after})).line();
    for (name, speed) in ["u2", "u5"].iter().zip(dependent) {
        assert!((number(&again["dependent"][name]) - speed).abs() < 1e-14);
    }
}

#[test]
fn prescribed_motion_works_too() {
    let state = json!({"t": 0.3, "q": {"q1": 0.4, "q2": -0.3}, "u": {"u1": -2, "u2": 1.5}});
    let name = "shaken_pendulum_moving_plate";
    let evaluated = eval(name, &state).line();
    let approaches = number(&evaluated["contacts"]["tip_plate"]["v"][0]) < 0.0;
    let state =
        if approaches { state } else { json!({"t": 0.3, "q": state["q"], "u": {"u1": 2, "u2": -1.5}}) };
    let run =
        collide(name, &["--mu", "0.3", "--e", "0.7", "--law", "poisson", "--state", &state.to_string()]);
    assert_eq!(run.code, 0, "{}{}", run.stdout, run.stderr);
    let answer = run.line();
    let energy =
        |u: &Value| number(&eval(name, &json!({"t": 0.3, "q": state["q"], "u": u})).line()["kinetic_energy"]);
    let change = energy(&answer["u_after"]) - energy(&state["u"]);
    assert!(
        (change - number(&answer["kinetic_energy_change"])).abs() < 1e-12 * change.abs().max(1.0),
        "{answer}"
    );
    assert_ne!(answer["dE"], answer["kinetic_energy_change"]);
}

#[test]
fn wrong_collisions_are_named() {
    let good = ["--mu", "0.6", "--e", "0.8", "--law", "newton"];
    let with = |index: usize, value: &'static str| {
        let mut call = good.to_vec();
        call[index] = value;
        call
    };
    for (call, kind) in [
        (with(1, "-1"), "negative_friction"),
        (with(1, "NaN"), "not_finite"),
        (with(3, "1.2"), "restitution_out_of_range"),
        (with(5, "hertz"), "unknown_law"),
        ([&good[..], &["--contact", "AcBc"]].concat(), "unknown_name"),
        ([&good[..], &["--state", r#"{"u":{"u1":-1,"u4":-1,"u3":0,"u6":0}}"#]].concat(), "not_approaching"),
    ] {
        assert_eq!(collide("two_sleds", &call).error_kind(), kind, "{call:?}");
    }
    assert_eq!(collide("rolling_disc", &good).error_kind(), "unknown_name", "two contacts, none chosen");
    assert_eq!(collide("two_sleds", &["--mu", "0.6"]).code, 2);
    assert_eq!(collide("no_such_model", &good).code, 2);
    assert_eq!(collide("two_sleds", &[&good[..], &["--state", "no such file"]].concat()).code, 2);
}

#[test]
fn without_slip_t_lies_along_an_axis() {
    // The slider of the crank can only approach along the normal: N.x is within 30 degrees of it, so t is
    // N.y.
    let contact = eval("slider_crank", &json!({})).line()["contacts"]["slider_wall"].clone();
    assert_eq!(contact["tangent"], json!([0.0, 1.0, 0.0]));
    assert_eq!(numbers(&contact["v"])[1..], [0.0, 0.0]);
}

/// So are dimensions that no shape has.
#[test]
fn impossible_dimensions_are_said_to_be() {
    let model = model("../simulation/models/log_on_table");
    let run = hodograph(&["eval", &model, "--state", "-"], r#"{"parameters":{"a":-1}}"#);
    assert_eq!(run.error_kind(), "impossible_size");
    let words = "of `Table` is not positive: with these parameters it is -2 m";
    assert!(run.stdout.contains(words), "{}", run.stdout);
}

/// Parameters that no body has are named as the cause, not the state.
#[test]
fn impossible_masses_are_said_to_be() {
    for command in ["eval", "collide"] {
        let model = model("two_sleds");
        let mut arguments = vec![command, model.as_str(), "--state", "-"];
        if command == "collide" {
            arguments.extend(["--contact", "BcAc", "--mu", "0.6", "--e", "0.8", "--law", "stronge"]);
        }
        for mass in ["-3", "0"] {
            let run = hodograph(&arguments, &format!(r#"{{"parameters":{{"m":{mass}}}}}"#));
            assert_eq!(run.error_kind(), "impossible_mass");
            let words = format!("the mass of `SledA` is not positive: with these parameters it is {mass}");
            assert!(run.stdout.contains(&words), "{}", run.stdout);
        }
    }
    // the mass matrix would be positive definite all the same
    let run = hodograph(
        &["eval", model("planar_double_pendulum").as_str(), "--state", "-"],
        r#"{"parameters":{"m2":-0.01}}"#,
    );
    assert_eq!(run.error_kind(), "impossible_mass");
}
