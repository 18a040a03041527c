//! Loops with more constraints than they need: accepted where all agree wherever the loop is closed, whatever
//! the parameters; refused otherwise. `generator/cli/tests/unusual.rs` compares their numbers with the
//! numeric evaluation that uses all constraints.

use std::path::Path;

use hodograph_generator::check::{Checked, check};
use hodograph_generator::diagnostics::codes;
use hodograph_generator::source::Source;

fn model(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/unusual").join(name);
    std::fs::read_to_string(path).unwrap()
}

fn checked(text: &str) -> (Checked, Source) {
    let source = Source::file("model.mech", text);
    (check(&source), source)
}

#[track_caller]
fn chosen(text: &str) -> usize {
    let (checked, source) = checked(text);
    let said: Vec<String> =
        checked.diagnostics.iter().filter(|d| d.code != codes::NO_GAP).map(|d| d.one_line(&source)).collect();
    assert!(said.is_empty(), "{said:?}");
    checked.mechanism.unwrap().determining_constraints.map_or(0, |chosen| chosen.len())
}

#[track_caller]
fn refused(text: &str) {
    let (checked, _) = checked(text);
    let codes: Vec<&str> = checked.diagnostics.iter().map(|d| d.code.0).collect();
    assert!(checked.mechanism.is_none() && codes == ["E070"], "{codes:?}");
}

#[test]
fn as_many_are_chosen_as_there_are_dependent_speeds() {
    assert_eq!(chosen(&model("bennett_linkage.mech")), 2);
    assert_eq!(chosen(&model("plate_on_three_cranks.mech")), 3);
    // Whatever else is stated twice.
    let twice = model("bennett_linkage.mech")
        .replace("velocity(P3) = 0;", "velocity(P3) = 0; dot(velocity(P3), Rocker.y) = 0;");
    assert_eq!(chosen(&twice), 2);
}

#[test]
fn loops_with_as_many_constraints_as_they_need_choose_none() {
    for name in ["watt_linkage.mech", "loop_by_velocities.mech", "scotch_yoke.mech"] {
        assert_eq!(chosen(&model(name)), 0, "{name}");
    }
}

#[test]
fn constraints_that_contradict_each_other_are_refused() {
    let bennett = model("bennett_linkage.mech");
    // Not the condition under which the linkage moves.
    refused(&bennett.replace("asin(b*sin(alpha)/a)", "asin(0.9*b*sin(alpha)/a)"));
    // A crank of another length.
    let plate = model("plate_on_three_cranks.mech");
    refused(&plate.replace("2*s*N.x + r*C.x", "2*s*N.x + 1.1*r*C.x"));
}

#[test]
fn what_holds_for_the_stated_parameters_alone_is_refused() {
    let bennett = model("bennett_linkage.mech");
    let free = bennett
        .replace(
            "c: N*m*s/rad = 0.02,",
            &format!("c: N*m*s/rad = 0.02, beta: rad = {:?},", (0.4_f64 * 0.55_f64.sin() / 0.25).asin()),
        )
        .replace("definitions { beta: rad = asin(b*sin(alpha)/a); }", "");
    refused(&free);
    assert_eq!(
        chosen(
            &free
                .replace("beta: rad", "fixed beta: rad")
                .replace("alpha: rad", "fixed alpha: rad")
                .replace(" a: m", " fixed a: m")
                .replace(" b: m", " fixed b: m")
        ),
        2
    );
}

#[test]
fn a_constraint_stated_twice_everywhere_is_a_mistake() {
    let twice = "mechanism Sled;
parameters { m: kg = 1, J: kg*m^2 = 0.5, a: m = 0.3 }
coordinates { q1: m, q2: m, q3: rad }
speeds { u1: m/s, u3: rad/s }
dependent { u2: m/s }
frames { B = N.rotate(z, q3); }
points { G = O + q1*N.x + q2*N.y; K = G - a*B.x; }
velocities { G = u1*B.x + u2*B.y; }
bodies { Body { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
constraints { dot(velocity(K), B.y) = 0; 2*dot(velocity(K), B.y) = 0; }";
    refused(twice);
}
