//! Rolling balls, stated in every way that the language allows. The vector equation says nothing along one
//! direction, which the derivation must find.

use crate::common::{Run, hodograph, number, numbers};
use hodograph_generator::check::check;
use hodograph_generator::numeric::{self, State};
use hodograph_generator::source::Source;
use serde_json::Value;

/// A uniform ball on the plane `{plane}.x, {plane}.y`.
fn on_plane(plane: &str, tilt: &str, orientation: &str, along: &str) -> String {
    let (coordinates, frame) = match orientation {
        "quaternion" => {
            ("e0: 1 = 0.8, e1: 1 = 0.4, e2: 1 = -0.2, e3: 1 = 0.4", "N.quaternion(e0, e1, e2, e3)")
        }
        "euler" => ("a: rad = 0.4, b: rad = 0.5, c: rad = 0.6", "N.euler(zxz, a, b, c)"),
        other => panic!("{other}"),
    };
    format!(
        "mechanism Ball;
        parameters {{ m: kg = 1, r: m = 0.2, J: kg*m^2 = 0.016, g: m/s^2 = 9.81, tilt: rad = {tilt} }}
        coordinates {{ x: m = 0.3, y: m = 0.1, {coordinates} }}
        speeds {{ w1: rad/s = 0.3, w2: rad/s = 0.2, w3: rad/s = 0.1 }}
        dependent {{ vx: m/s, vy: m/s }}
        frames {{ Plane = N.rotate(x, tilt); B = {frame}; }}
        angular_velocities {{ B = w1*{along}.x + w2*{along}.y + w3*{along}.z; }}
        points {{ G = O + x*{plane}.x + y*{plane}.y + r*{plane}.z; C of B = G - r*{plane}.z; }}
        velocities {{ G = vx*{plane}.x + vy*{plane}.y; }}
        bodies {{ Ball {{ frame: B, centre: G, mass: m, inertia: [J, J, J] }} }}
        loads {{ gravity: -g*N.z; }}
        constraints {{ velocity(C) = 0; }}"
    )
}

/// A uniform ball in a spherical bowl, or in a tube along N.x; `F.z` points from it to the middle.
fn in_hollow(tube: bool, along: &str) -> String {
    let (q2, u2, frames, arm) = if tube {
        ("m", "m/s", "F = N.rotate(x, q1);", "q2*N.x")
    } else {
        ("rad", "rad/s", "A = N.rotate(x, q1); F = A.rotate(y, q2);", "0")
    };
    format!(
        "mechanism Ball;
        parameters {{ m: kg = 1, r: m = 0.2, R: m = 1, J: kg*m^2 = 0.016, g: m/s^2 = 9.81 }}
        coordinates {{ q1: rad = 0.3, q2: {q2} = 0.4, e0: 1 = 0.8, e1: 1 = 0.4, e2: 1 = -0.2, e3: 1 = 0.4 }}
        speeds {{ w1: rad/s = 0.3, w2: rad/s = 0.2, w3: rad/s = 0.1 }}
        dependent {{ u1: rad/s, u2: {u2} }}
        frames {{ {frames} B = N.quaternion(e0, e1, e2, e3); }}
        angular_velocities {{ B = w1*{along}.x + w2*{along}.y + w3*{along}.z; }}
        points {{ G = O + {arm} - (R - r)*F.z; C of B = G - r*F.z; }}
        bodies {{ Ball {{ frame: B, centre: G, mass: m, inertia: [J, J, J] }} }}
        loads {{ gravity: -g*N.z; }}
        constraints {{ velocity(C) = 0; }}"
    )
}

fn eval(text: &str) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ball.mech");
    std::fs::write(&path, text).unwrap();
    hodograph(&["eval", path.to_str().unwrap()], "")
}

/// The numbers of the derived equations, which must be those of the numeric evaluation.
fn evaluated(text: &str) -> Value {
    let run = eval(text);
    assert_eq!(run.code, 0, "{text}\n{}", run.stderr);
    let answer = run.line();
    let mechanism = check(&Source::file("ball.mech", text)).mechanism.unwrap();
    let expected = numeric::evaluate(&mechanism, &State::of(&mechanism)).unwrap();
    for (found, expected) in [
        (numbers(&answer["mass_matrix"]), expected.mass_matrix.concat()),
        (numbers(&answer["forcing"]), expected.forcing),
    ] {
        assert!(
            crate::common::difference(&found, &expected, 1e-3) < 1e-12,
            "{text}\n{found:?}\n{expected:?}"
        );
    }
    answer
}

#[test]
fn on_a_plane() {
    for (plane, tilt, sine) in [("N", "0", 0.0), ("Plane", "0.3", 0.3f64.sin())] {
        for orientation in ["quaternion", "euler"] {
            for along in ["N", "B", "Plane"] {
                let answer = evaluated(&on_plane(plane, tilt, orientation, along));
                // down the plane, which is tilted about x: 5/7 g sin(tilt)
                let (x, y) = (number(&answer["udot"]["vx"]), number(&answer["udot"]["vy"]));
                let expected = -5.0 / 7.0 * 9.81 * sine;
                assert!(
                    x.abs() < 1e-13 && (y - expected).abs() < 1e-13,
                    "{plane} {orientation} {along}: {x} {y}"
                );
            }
        }
    }
}

#[test]
fn in_a_bowl_and_in_a_tube() {
    for tube in [false, true] {
        for along in ["F", "N", "B"] {
            evaluated(&in_hollow(tube, along));
        }
    }
}

/// A ball that rolls on a ball that rolls on the ground, and a roller on a fixed one.
#[test]
fn on_each_other() {
    for along in ["N", "Small", "F"] {
        evaluated(&format!(
            "mechanism Balls;
            parameters {{ m: kg = 1, R: m = 1, r: m = 0.2, J: kg*m^2 = 0.02, JR: kg*m^2 = 2, M: kg = 5, g: m/s^2 = 9.81 }}
            coordinates {{
                x: m, y: m, a: rad = 0.1, b: rad = 0.2,
                e0: 1 = 0.8, e1: 1 = 0.4, e2: 1 = -0.2, e3: 1 = 0.4, f0: 1 = 0.4, f1: 1 = 0.8, f2: 1 = 0.2, f3: 1 = -0.4,
            }}
            speeds {{ w1: rad/s = 1, w2: rad/s = 2, w3: rad/s = 3, s1: rad/s = 4, s2: rad/s = 5, s3: rad/s = 6 }}
            dependent {{ vx: m/s, vy: m/s, ua: rad/s, ub: rad/s }}
            frames {{
                F1 = N.rotate(x, a); F = F1.rotate(y, b);
                Big = N.quaternion(e0, e1, e2, e3); Small = N.quaternion(f0, f1, f2, f3);
            }}
            angular_velocities {{
                Big = w1*N.x + w2*N.y + w3*Big.z;
                Small = s1*{along}.x + s2*{along}.y + s3*{along}.z;
            }}
            points {{
                G = O + x*N.x + y*N.y + R*N.z; K of Big = G - R*N.z;
                H = G + (R + r)*F.z; CB of Big = G + R*F.z; CS of Small = H - r*F.z;
            }}
            velocities {{ G = vx*N.x + vy*N.y; }}
            bodies {{
                B1 {{ frame: Big, centre: G, mass: M, inertia: [JR, JR, JR] }},
                B2 {{ frame: Small, centre: H, mass: m, inertia: [J, J, J] }},
            }}
            loads {{ gravity: -g*N.z; }}
            kinematics {{ d(a)/dt = ua; d(b)/dt = ub; }}
            constraints {{ velocity(K) = 0; velocity(CB) = velocity(CS); }}"
        ));
    }
    let answer = evaluated(
        "mechanism Roller;
        parameters { m: kg = 1, R: m = 1, r: m = 0.2, g: m/s^2 = 9.81 }
        coordinates { th: rad = 0.2, ph: rad }
        speeds { w: rad/s = 1 }
        dependent { s: rad/s }
        frames { A = N.rotate(z, th); B = N.rotate(z, ph); }
        points { G = O + (R + r)*A.y; C of B = G - r*A.y; }
        bodies { Roll { frame: B, centre: G, mass: m, inertia: [m*r^2/4, m*r^2/4, m*r^2/2] } }
        loads { gravity: -g*N.y; }
        kinematics { d(th)/dt = w; d(ph)/dt = s; }
        constraints { velocity(C) = 0; }",
    );
    // a roller falls from another: 3/2 (R + r) th'' = g sin(th)
    let expected = 9.81 * 0.2f64.sin() / (1.5 * 1.2);
    assert!((number(&answer["udot"]["w"]) - expected).abs() < 1e-13, "{answer}");
}

/// Where no frame has the direction along which nothing is said, the error says so, at its place and with its
/// code.
#[test]
fn on_a_surface_without_frames() {
    let vectors = "definitions { n = unit(N.vec(-2*x/R, -2*y/R, 1)); }";
    let text = in_hollow(false, "N")
        .replace("q1: rad = 0.3, q2: rad = 0.4", "x: m = 0.3, y: m = 0.2")
        .replace("u1: rad/s, u2: rad/s", "vx: m/s, vy: m/s")
        .replace("frames { A = N.rotate(x, q1); F = A.rotate(y, q2);", &format!("{vectors} frames {{"))
        .replace("0 - (R - r)*F.z", "x*N.x + y*N.y + (x^2 + y^2)/R*N.z + r*n")
        .replace("G - r*F.z", "G - r*n")
        .replace("constraints", "kinematics { d(x)/dt = vx; d(y)/dt = vy; } constraints");
    let found = check(&Source::file("ball.mech", &text)).diagnostics;
    assert!(found.iter().any(|mistake| mistake.code.0 == "E070"), "check says nothing: {found:?}");
    let run = eval(&text);
    assert_ne!(run.code, 0, "{}", run.stdout);
    for part in ["error[E070]", "^^^^^^^^^^^^^^^", "velocity(C) = 0", "state the others one by one"] {
        assert!(run.stderr.contains(part), "{}", run.stderr);
    }
    // The way out that it names.
    let stated = "dot(velocity(C), N.x + 2*x/R*N.z) = 0; dot(velocity(C), N.y + 2*y/R*N.z) = 0;";
    evaluated(&text.replace("velocity(C) = 0;", stated));
}
