//! Correct models are accepted.

use hodograph_generator::artifact::model_hash;
use hodograph_generator::diagnostics::{Diagnostic, codes};
use hodograph_generator::expand::Inline;
use hodograph_generator::{
    check::check,
    model::mechanism::{Mechanism, Variable},
    source::Source,
};

fn accept(name: &str, text: &str) -> Mechanism {
    let source = Source::file(name, text);
    let checked = check(&source);
    // a model for collisions at given instants needs no gap
    let other = |d: &&Diagnostic| d.code != codes::NO_GAP;
    let messages: Vec<String> =
        checked.diagnostics.iter().filter(other).map(|d| d.one_line(&source)).collect();
    assert!(messages.is_empty(), "{}", messages.join("\n"));
    checked.mechanism.expect("a mechanism")
}

/// The models that are shipped.
#[test]
fn shipped_models() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    for entry in std::fs::read_dir(folder).expect("models") {
        let path = entry.expect("entry").path();
        if path.extension().is_some_and(|e| e == "mech") {
            accept(&path.display().to_string(), &std::fs::read_to_string(&path).expect("text"));
        }
    }
}

const ROD: &str = "
//! A uniform rod on a pivot, whose tip strikes a wall.
mechanism RodAndWall;

parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81 }
coordinates { q1: rad = 0.3 }
speeds { u1: rad/s }

frames { B = N.rotate(z, q1); }
points {
    G = O - l/2*B.y;
    /// the end that strikes
    P = O - l*B.y;
}
bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
loads { gravity: -g*N.y; }
contacts { tip_wall { point: P of Rod, normal: -N.x } }
";

const SLEDS: &str = "
mechanism TwoSleds;
parameters {
    /// mass of each sled
    m: kg = 3, l: m = 1, k: m = 0.75, p: m = 0.5,
    gamma: rad = 0.2, delta: rad = 0.2, theta: rad = pi/3, eta: rad = 2*pi/9,
}
coordinates { q1: m, q2: m, q3: rad = pi/4, q4: m, q5: m, q6: rad = 7*pi/4 }
speeds { u1: m/s = 1, u3: rad/s = 0.1, u4: m/s = 1, u6: rad/s = 0.1 }
dependent { u2: m/s, u5: m/s }
frames {
    Abar = N;
    A = Abar.rotate(z, q3);
    Bbar = N.rotate([cos(theta), sin(theta), 0], eta);
    B = Bbar.rotate(z, q6);
    Ak = A.rotate(z, gamma);
    Bk = B.rotate(z, delta);
}
angular_velocities { A in Abar = u3*A.z; B in Bbar = u6*B.z; }
points {
    A0 = O + q1*N.x + q2*N.y;
    B0 = O + q4*Bbar.x + q5*Bbar.y;
    As = A0 + k*A.x;
    Bs = B0 + k*B.x;
    Ac = A0 + p*A.x;
    Bc = B0 + l*B.x;
}
velocities { A0 = u1*A.x + u2*A.y; B0 = u4*B.x + u5*B.y; }
bodies {
    SledA { frame: A, centre: A0, mass: m, inertia: [0, m*l^2/3, m*l^2/3] },
    SledB { frame: B, centre: B0, mass: m, inertia: [0, m*l^2/3, m*l^2/3] },
}
constraints { dot(velocity(As), Ak.y) = 0; dot(velocity(Bs), Bk.y) = 0; }
contacts { BcAc { point: Bc of SledB, against: Ac of SledA, normal: A.y } }
";

#[test]
fn a_rod() {
    let mechanism = accept("rod.mech", ROD);
    assert_eq!(mechanism.kinematics.len(), 1);
    assert_eq!(mechanism.docs, "A uniform rod on a pivot, whose tip strikes a wall.");
    assert_eq!(mechanism.points[2].docs, "the end that strikes");
}

#[test]
fn two_sleds() {
    let mechanism = accept("sleds.mech", SLEDS);
    assert_eq!(mechanism.kinematics.len(), 0);
    assert_eq!(
        mechanism.speeds.iter().map(|u| u.name.as_str()).collect::<Vec<_>>(),
        ["u1", "u3", "u4", "u6", "u2", "u5"]
    );
}

/// Initial values may use parameters and each other; a contact may be closed at the start; rounded quaternions
/// get the length 1.
#[test]
fn initial_values() {
    let mechanism = accept(
        "initial.mech",
        "mechanism Initial; parameters { m: kg = 1, h: m = 2, fixed a: deg = 30, w: rad/s = 3, r: mm = 50 }
        coordinates { q3: m = h*cos(q5) + r, q5: rad = a/2, q4: deg = 2*a - q5, z: m = touching(floor, 0.5),
            s: mm = 3*z + 2*r, e0: 1 = 0.7071067, e1: 1, e2: 1 = 0.7071068, e3: 1 }
        speeds { v: m/s = w*h, w3: m/s, w5: rad/s = 2*w, w4: deg/s = w5, ws: mm/s, wx: rad/s, wy: rad/s, wz: rad/s }
        frames { A = N.rotate(z, q5); B = A.rotate(x, q4); C = N.quaternion(e0, e1, e2, e3); }
        angular_velocities { C = wx*C.x + wy*C.y + wz*C.z; }
        points { P = O + z*N.z + q3*N.x; Q = P + r*N.y + s*N.z; }
        bodies { Box { frame: B, centre: P, mass: m, inertia: [m*r^2, m*r^2, m*r^2] },
            Ball { frame: C, centre: Q, mass: m, inertia: [m*r^2, m*r^2, m*r^2] } }
        kinematics { d(z)/dt = v; d(q3)/dt = w3; d(q5)/dt = w5; d(q4)/dt = w4; d(s)/dt = ws; }
        contacts { floor { point: P of Box, normal: N.z, gap: dot(position(P), N.z) - r } }",
    );
    let value = |list: &[Variable], name: &str| {
        list.iter()
            .find(|quantity| quantity.name == name)
            .and_then(|quantity| quantity.value)
            .expect("a value")
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-14 * b.abs(), "{a} {b}");
    let q = |name| value(&mechanism.coordinates, name);
    near(q("q5"), std::f64::consts::PI / 12.0);
    near(q("q3"), 2.0 * (std::f64::consts::PI / 12.0).cos() + 0.05);
    near(q("q4"), 45.0);
    near(q("z"), 0.05);
    near(q("s"), 250.0);
    near(q("e0").powi(2) + q("e2").powi(2), 1.0);
    near(value(&mechanism.speeds, "v"), 6.0);
    near(value(&mechanism.speeds, "w4"), 6.0_f64.to_degrees());
}

/// Units decide nothing: lengths in picometres beside metres, in terametres beside others, dependent ones too.
#[test]
fn units_of_all_sizes() {
    let ball = "mechanism BallPm; parameters { m: kg = 1, g: m/s^2 = 10 } inputs { F: N = 0 }
        coordinates { z: m = 1, x: pm = 0 } speeds { w: m/s, u: pm/s } points { P = O + z*N.z + x*N.x; }
        particles { B { point: P, mass: m } } loads { gravity: -g*N.z; force on P: F*N.x; }
        kinematics { d(z)/dt = w; d(x)/dt = u; }
        contacts { floor { point: P of B, normal: N.z, gap: dot(position(P), N.z) } }";
    accept("ball.mech", ball);
    accept("ball.mech", &ball.replace("pm", "Tm"));
    accept("ball.mech", &ball.replace("pm", "fm").replace("z: m", "z: Tm").replace("w: m", "w: Tm"));
    let geared = "mechanism Geared; parameters { m: kg = 1 }
        coordinates { z: m = 1, dependent x: Tm = 0, y: pm = 1, dependent v: pm = 2 }
        speeds { uz: m/s, uy: pm/s } dependent { ux: Tm/s, uv: pm/s }
        points { P = O + z*N.z + x*N.x; Q = O + y*N.x + v*N.y; }
        particles { B { point: P, mass: m }, C { point: Q, mass: m } }
        kinematics { d(z)/dt = uz; d(x)/dt = ux; d(y)/dt = uy; d(v)/dt = uv; }
        constraints { ux = 2*uz; uv = 2*uy; } configuration { x = 2*z; v = 2*y; }";
    accept("geared.mech", geared);
}

#[test]
fn inline_and_file_agree() {
    for text in [ROD, SLEDS] {
        let stream: proc_macro2::TokenStream = text.parse().expect("Rust tokens");
        let inline = Inline::new("here", stream).source;
        let file = Source::file("x.mech", text);
        assert_eq!(model_hash(&inline), model_hash(&file));
        let other = Source::file("x.mech", text.replace('\n', "\r\n").replace("    ", "\t// a comment\n"));
        assert_eq!(model_hash(&other), model_hash(&file));
        assert!(check(&inline).mechanism.is_some());
    }
}
