//! `hodograph orbit`: periodic motions, their multipliers, and branches of them.

use crate::common::{hodograph, number, root};

fn path(name: &str) -> String {
    root().join("simulation/gradients/tests/models").join(name).to_str().unwrap().to_owned()
}

/// The wheel of `hodograph_gradients`' tests: multiplier eta^2, eta = (J + m l^2 cos 2 alpha) / (J + m l^2).
#[test]
fn a_rimless_wheel_has_its_multiplier() {
    let path = path("rimless_wheel.mech");
    let (l, alpha, inertia) = (1.0_f64, std::f64::consts::FRAC_PI_8, 0.1);
    let eta: f64 = (inertia + l * (2.0 * alpha).cos()) / (inertia + l);
    let rate = 1.3;
    let state = format!(
        "z={},q={},ux={},uz={},u={rate}",
        alpha.cos(),
        -alpha,
        rate * alpha.cos(),
        rate * alpha.sin()
    );
    let call = ["orbit", &path, "--return", "collision:second", "--reset", "x,z,q", "--state", &state];
    let surface = ["--mu", "2", "--e", "0", "--law", "poisson"];
    let run = hodograph(&[&call[..], &surface[..]].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let motion = &run.line()["motions"][0];
    assert!((number(&motion["multipliers"][0][0]) - eta * eta).abs() < 1e-10, "{motion}");
    assert!(motion["stable"] == true && motion["events"][1]["contact"] == "second", "{motion}");
    let divided = hodograph(&[&call[..], &surface[..], &["--segments", "3"]].concat(), "");
    let other = &divided.line()["motions"][0];
    assert!((number(&other["period"]) - number(&motion["period"])).abs() < 1e-10, "{other}");
    let none = hodograph(&[&call[..], &surface[..], &["--segments", "0"]].concat(), "");
    assert!(none.code == 2 && none.stderr.contains("at least one segment"), "{}", none.stderr);
    // an error of the search is an object in JSON, and a sentence beside a table
    let waits = [&call[..], &surface[..], &["--longest", "0.01"]].concat();
    assert_eq!(hodograph(&waits, "").error_kind(), "not_found");
    let told = hodograph(&[&waits[..], &["--format", "table"]].concat(), "");
    assert!(told.code == 1 && told.stderr.contains("does not return within 0.01 s"), "{}", told.stderr);
    let table = hodograph(&[&call[..], &surface[..], &["--format", "table"]].concat(), "");
    assert!(table.stdout.contains("multipliers") && table.stdout.contains("yes"), "{}", table.stdout);
    let wrong = ["orbit", &path, "--return", "bounce:second", "--state", &state];
    let run = hodograph(&[&wrong[..], &surface[..]].concat(), "");
    assert!(run.code == 2 && run.stderr.contains("lift_off"), "{}", run.stderr);
}

/// Counts are whole numbers, and given once.
#[test]
fn what_ends_a_period_is_read_with_care() {
    let path = path("rimless_wheel.mech");
    for (text, why) in [
        ("collision:second:-1", "the count is -1"),
        ("collision:second:0", "the count is 0"),
        ("collision:second:1.5", "the count is 1.5"),
        ("collision:second:2:3", "give one contact and one count"),
        ("collision:fourth", "there is no contact `fourth`"),
    ] {
        let run =
            hodograph(&["orbit", &path, "--return", text, "--mu", "2", "--e", "0", "--law", "poisson"], "");
        assert!(run.told().0 == 2 && run.stderr.contains(why), "{text}: {}", run.stderr);
    }
    let call = ["orbit", &path, "--return", "collision:second", "--follow", "q=0..1"];
    let run = hodograph(&[&call[..], &["--mu", "2", "--e", "0", "--law", "poisson"]].concat(), "");
    assert_eq!(run.error_kind(), "unknown_name");
}

/// A branch ends at the end of its range, beyond which there may be no motion: e is at most 1.
#[test]
fn a_branch_ends_at_the_end_of_its_range() {
    let path = path("ball_on_plate.mech");
    for (range, end) in [("mu=0.3..0", 0.0), ("e=0.7..0.75", 0.75)] {
        let call = ["orbit", &path, "--period", "2*pi/60", "--follow", range, "--parameter", "a=0.002"];
        let more = ["--state", "t=0.05,z=0.0139,u=0.14", "--mu", "0", "--e", "0.7", "--law", "newton"];
        let run = hodograph(&[&call[..], &more].concat(), "");
        assert_eq!(run.code, 0, "{}", run.stderr);
        let answer = run.line();
        let last = answer["motions"].as_array().unwrap().last().unwrap();
        assert!(answer.get("ended").is_none() && number(&last["value"]) == end, "{answer}");
        assert!(number(&last["residual"]) < 1e-9, "{last}");
    }
}

/// The locked motion of a ball on a plate doubles its period where (1 + e)^2 a w^2 sin(phi) = 2 g (1 + e^2).
#[test]
fn a_branch_doubles_its_period() {
    let path = path("ball_on_plate.mech");
    let (g, w, e) = (9.81_f64, 60.0_f64, 0.7_f64);
    let plate = std::f64::consts::PI * g / w * (1.0 - e) / (1.0 + e);
    let at = (2.0 * g * (1.0 + e * e) / ((1.0 + e).powi(2) * w * w)).hypot(plate / w);
    let call = ["orbit", &path, "--period", "2*pi/60", "--follow", "a=0.002..0.0035"];
    let state = ["--state", "t=0.05,z=0.0139,u=0.14"];
    let surface = ["--mu", "0", "--e", "0.7", "--law", "newton"];
    let run = hodograph(&[&call[..], &state[..], &surface[..]].concat(), "");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let answer = run.line();
    let change = &answer["changes"][0];
    assert_eq!(change["change"], "period_doubling", "{answer}");
    assert!((number(&change["value"]) - at).abs() < 1e-10, "{change}");
    assert!(answer["motions"].as_array().unwrap().len() > 10);
}

/// The legs of a compass change with every step.
#[test]
fn a_compass_walks_as_its_legs_change() {
    let path = path("compass_walker.mech");
    let call = ["orbit", &path, "--return", "collision:second", "--reset", "x"];
    let surface = ["--mu", "2", "--e", "0", "--law", "poisson"];
    let exchange = |names: &str| hodograph(&[&call[..], &["--exchange", names], &surface[..]].concat(), "");
    let run = exchange("q1=q2,q2=q1,u1=u2,u2=u1");
    assert_eq!(run.code, 0, "{}", run.stderr);
    let motion = &run.line()["motions"][0];
    assert!((number(&motion["period"]) - 0.734_346_391_159).abs() < 1e-10, "{motion}");
    assert!((number(&motion["multipliers"][2][0]) - 0.131_572_624).abs() < 1e-8, "{motion}");
    for (names, why) in [("q1", "give TO=FROM"), ("q1=-q7", "no coordinate or independent speed `q7`")] {
        let run = exchange(names);
        assert!(run.code == 2 && run.stderr.contains(why), "{}", run.stderr);
    }
}
