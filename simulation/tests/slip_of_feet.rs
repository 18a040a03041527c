//! Slip in space that begins at several feet of one body together, from zero: once, at the limit of friction.

use hodograph::Law;
use hodograph_interpreter::NumericMechanism;
use hodograph_simulation::{Progress, Simulation};
use nalgebra::{Matrix3, Vector2, Vector3};

use crate::many::{Start, numeric, surface};

const G: f64 = 9.81;
const MASS: f64 = 2.0;
const SPIN: f64 = 0.1;
const HEIGHT: f64 = 0.25;
const MU: f64 = 0.3;
const FEET: [[f64; 2]; 3] = [[0.3, 0.0], [-0.1, 0.2], [-0.2, -0.2]];
/// Where the force acts, at floor level, and how fast it grows.
const PUSHED: [f64; 2] = [0.1, 0.1];
const GROWS: f64 = 3.0;

fn tripod() -> NumericMechanism {
    numeric(
        "pushed-tripod",
        "mechanism Tripod;
        parameters { m: kg = 2, J1: kg*m^2 = 0.05, J2: kg*m^2 = 0.07, J3: kg*m^2 = 0.1, g: m/s^2 = 9.81, l: m = 1 }
        inputs { kx: N/s, ky: N/s }
        coordinates { x: m, y: m, z: m = 0.25, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }
        speeds { ux: m/s, uy: m/s, uz: m/s, w1: rad/s, w2: rad/s, w3: rad/s }
        frames { B = N.quaternion(e0, e1, e2, e3); }
        angular_velocities { B = w1*B.x + w2*B.y + w3*B.z; }
        points {
            G = O + x*N.x + y*N.y + z*N.z;
            Q of B = G + 0.1*l*B.x + 0.1*l*B.y - 0.25*l*B.z;
            P0 of B = G + 0.3*l*B.x - 0.25*l*B.z;
            P1 of B = G - 0.1*l*B.x + 0.2*l*B.y - 0.25*l*B.z;
            P2 of B = G - 0.2*l*B.x - 0.2*l*B.y - 0.25*l*B.z;
        }
        velocities { G = ux*N.x + uy*N.y + uz*N.z; }
        bodies { Bd { frame: B, centre: G, mass: m, inertia: [J1, J2, J3] } }
        loads { gravity: -g*N.z; force on Q: kx*time*N.x + ky*time*N.y; }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; d(z)/dt = uz; }
        contacts {
            c0 { point: P0 of Bd, normal: N.z, gap: dot(position(P0), N.z) },
            c1 { point: P1 of Bd, normal: N.z, gap: dot(position(P1), N.z) },
            c2 { point: P2 of Bd, normal: N.z, gap: dot(position(P2), N.z) },
        }",
    )
}

/// Rates of x, y, the angle and their speeds of the body that slides upright on its feet: the normal forces balance weight and
/// moments about the horizontal axes, with friction against slip.
fn sliding(s: &[f64; 6], time: f64, push: [f64; 2]) -> [f64; 6] {
    let [_, _, angle, vx, vy, w] = *s;
    let (sin, cos) = angle.sin_cos();
    let turned = |[a, b]: [f64; 2]| [a * cos - b * sin, a * sin + b * cos];
    let force = push.map(|k| k * time);
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let mut friction = [[0.0; 2]; 3];
    let arm = turned(PUSHED);
    for (i, foot) in FEET.iter().enumerate() {
        let r = turned(*foot);
        let slip = Vector2::new(vx - w * r[1], vy + w * r[0]).normalize();
        friction[i] = [-MU * slip.x, -MU * slip.y];
        // moments r x F about the x- and y-axis, with r_z = -HEIGHT
        matrix.set_column(
            i,
            &Vector3::new(1.0, r[1] + HEIGHT * friction[i][1], -HEIGHT * friction[i][0] - r[0]),
        );
    }
    right.x = MASS * G;
    right.y = -HEIGHT * force[1];
    right.z = HEIGHT * force[0];
    let normal = matrix.lu().solve(&right).unwrap();
    let (mut sum, mut moment) = (force, arm[0] * force[1] - arm[1] * force[0]);
    for (i, foot) in FEET.iter().enumerate() {
        let (r, f) = (turned(*foot), friction[i].map(|part| part * normal[i]));
        sum = [sum[0] + f[0], sum[1] + f[1]];
        moment += r[0] * f[1] - r[1] * f[0];
    }
    [vx, vy, w, sum[0] / MASS, sum[1] / MASS, moment / SPIN]
}

/// Runge and Kutta's method of order four.
fn integrate(mut s: [f64; 6], (from, to): (f64, f64), push: [f64; 2], steps: usize) -> [f64; 6] {
    let h = (to - from) / steps as f64;
    let moved = |s: &[f64; 6], k: &[f64; 6], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    for step in 0..steps {
        let t = from + h * step as f64;
        let a = sliding(&s, t, push);
        let b = sliding(&moved(&s, &a, 0.5 * h), t + 0.5 * h, push);
        let c = sliding(&moved(&s, &b, 0.5 * h), t + 0.5 * h, push);
        let d = sliding(&moved(&s, &c, h), t + h, push);
        s = std::array::from_fn(|i| s[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    s
}

/// A body on three feet, pushed by a force that grows: the feet begin to slip, together or after the body has turned about one
/// of them, each once; and the motion afterwards is that of a body which slides upright.
#[test]
fn a_pushed_tripod_begins_to_slip_once() {
    let mechanism = tripod();
    let mut compared = 0;
    for step in 0..7 {
        let angle = std::f64::consts::TAU / 7.0 * f64::from(step);
        let push = [GROWS * angle.cos(), GROWS * angle.sin()];
        let start = Start {
            coordinates: vec![0.0, 0.0, HEIGHT, 1.0, 0.0, 0.0, 0.0],
            speeds: vec![0.0; 6],
            inputs: push.to_vec(),
        };
        let mut simulation =
            Simulation::new(&mechanism, &start.state(), surface(MU, 0.0, Law::Newton)).unwrap();
        let planar = |simulation: &Simulation<'_>| {
            let (q, u) = (simulation.coordinates(), simulation.speeds());
            [q[0], q[1], 2.0 * q[6].atan2(q[3]), u[0], u[1], u[5]]
        };
        let mut slips = Vec::new();
        let mut follow = |simulation: &mut Simulation<'_>, until: f64| {
            loop {
                match simulation.advance(until) {
                    Ok(Progress::Event(event)) if event.kind.name() == "slip" => {
                        slips.push((event.time, event.contact));
                    }
                    Ok(Progress::Event(event)) => {
                        assert!(["contact", "rest"].contains(&event.kind.name()), "{step}: {event:?}");
                    }
                    Ok(Progress::Reached) => break,
                    Err(error) => panic!("{step}: {error}"),
                }
            }
            slips.clone()
        };
        let found = follow(&mut simulation, 2.05);
        let mut feet: Vec<_> = found.iter().map(|(_, contact)| contact.unwrap()).collect();
        feet.sort_unstable();
        assert!(feet.windows(2).all(|pair| pair[0] < pair[1]), "{step}: {found:?}");
        // About one of the feet the body may turn for longer.
        if feet.len() < 3 {
            continue;
        }
        compared += 1;
        let first = planar(&simulation);
        follow(&mut simulation, 2.3);
        let (last, expected) = (planar(&simulation), integrate(first, (2.05, 2.3), push, 4000));
        for (a, b) in last.iter().zip(&expected) {
            assert!((a - b).abs() < 1e-8, "{step}: {last:?} {expected:?}");
        }
    }
    assert!(compared > 4, "{compared}");
}
