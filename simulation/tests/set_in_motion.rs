//! Mechanisms that loads which depend on time or on inputs set in motion.

use hodograph::Law;
use hodograph_interpreter::NumericMechanism;
use hodograph_simulation::{Progress, Simulation};

use crate::many::{Start, numeric, surface};

/// The states at these times, and the names of the events.
fn states(mechanism: &NumericMechanism, start: &Start, times: &[f64]) -> (Vec<Vec<f64>>, Vec<String>) {
    let mut simulation = Simulation::new(mechanism, &start.state(), surface(0.5, 0.0, Law::Newton)).unwrap();
    let (mut states, mut names) = (Vec::new(), Vec::new());
    for &time in times {
        while let Progress::Event(event) = simulation.advance(time).unwrap() {
            names.push(event.kind.name().to_owned());
        }
        states.push([simulation.coordinates(), simulation.speeds()].concat());
    }
    (states, names)
}

/// A block lies on the floor, and a cart moves on a rail of its own: s = A / (m w) (t - sin(w t) / w). All rates vanish at
/// the start, which is no rest.
#[test]
fn a_force_that_begins_at_zero_moves_at_once() {
    let mechanism = numeric(
        "driven-cart",
        "mechanism Two;
        parameters { m: kg = 1, g: m/s^2 = 9.81, A: N = 1, w: rad/s = 2 }
        coordinates { x: m, y: m, s: m }
        speeds { ux: m/s, uy: m/s, us: m/s }
        points { P = O + x*N.x + y*N.y; Q = O + s*N.z; }
        particles { Block { point: P, mass: m }, Cart { point: Q, mass: m } }
        loads { gravity: -g*N.y; force on Q: A*sin(w*time)*N.z; }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; d(s)/dt = us; }
        contacts { floor { point: P, normal: N.y, gap: y } }",
    );
    let start = Start { coordinates: vec![0.0; 3], speeds: vec![0.0; 3], inputs: Vec::new() };
    let times: Vec<f64> = (1..=20).map(|i| 0.05 * f64::from(i)).collect();
    let (states, names) = states(&mechanism, &start, &times);
    assert_eq!(names, ["contact"]);
    for (time, state) in times.iter().zip(&states) {
        let expected = 0.5 * time - 0.25 * (2.0 * time).sin();
        assert!((state[2] - expected).abs() < 1e-12, "{time}: {state:?} {expected}");
    }
}

/// A force that grows tips a block that was at rest on two feet: the states between steps are those of these times, and do not
/// depend on which others are asked for.
#[test]
fn what_was_at_rest_tips() {
    let mechanism = numeric(
        "tipped-block",
        "mechanism Tip;
        parameters { m: kg = 2, J: kg*m^2 = 0.08, a: m = 0.2, b: m = 0.3, k: N/s = 3, g: m/s^2 = 9.81 }
        coordinates { x: m, y: m = 0.3, q: rad }
        speeds { ux: m/s, uy: m/s, w: rad/s }
        frames { B = N.rotate(z, q); }
        points {
            G = O + x*N.x + y*N.y;
            Top of B = G + b*B.y;
            L of B = G - a*B.x - b*B.y;
            R of B = G + a*B.x - b*B.y;
        }
        bodies { Block { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
        loads { gravity: -g*N.y; force on Top: k*time*N.x; }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; d(q)/dt = w; }
        contacts {
            l { point: L of Block, normal: N.y, gap: dot(position(L), N.y), surface: { mu: 5, e: 0, law: newton } },
            r { point: R of Block, normal: N.y, gap: dot(position(R), N.y), surface: { mu: 5, e: 0, law: newton } },
        }",
    );
    let start = Start { coordinates: vec![0.0, 0.3, 0.0], speeds: vec![0.0; 3], inputs: Vec::new() };
    let follow = |times: &[f64]| {
        let options = hodograph_simulation::Options::default();
        let mut simulation = Simulation::new(&mechanism, &start.state(), options).unwrap();
        let mut events = Vec::new();
        let mut states = Vec::new();
        for &time in times {
            while let Progress::Event(event) = simulation.advance(time).unwrap() {
                events.push((event.kind.name(), event.time));
            }
            states.push([simulation.coordinates(), simulation.speeds()].concat());
        }
        (states, events)
    };
    // It tips where the moment about the foot on the right vanishes: k t (2 b) = m g a.
    let tips = 2.0 * 9.81 * 0.2 / (3.0 * 0.6);
    let times: Vec<f64> = (0..40).map(|i| 2.0 + 0.02 * f64::from(i)).collect();
    let (states, events) = follow(&times);
    let lifted = events.iter().find(|(name, _)| *name == "lift_off").unwrap();
    assert!((lifted.1 - tips).abs() < 1e-9, "{events:?} {tips}");
    for (time, state) in times.iter().zip(&states) {
        let (alone, _) = follow(&[*time]);
        for (a, b) in state.iter().zip(&alone[0]) {
            assert!((a - b).abs() < 1e-10, "{time}: {state:?} {alone:?}");
        }
        // It turns about the right foot: I q'' = m g (a cos - b sin) - k t 2 b cos, which is -k (t - tips) 2 b at first.
        let after = time - tips;
        if after > 1e-3 {
            let first = -3.0 * 0.6 * after.powi(3) / 6.0 / (0.08 + 2.0 * (0.04 + 0.09));
            assert!((state[2] / first - 1.0).abs() < 3.0 * after * after, "{time}: {} {first}", state[2]);
        } else {
            assert!(state[2].abs() < 1e-12, "{time}: {state:?}");
        }
    }
}

/// An input that divides a load has no value of zero; the motion does not need one.
#[test]
fn an_input_may_divide() {
    let mechanism = numeric(
        "geared-cart",
        "mechanism Geared;
        parameters { m: kg = 2, k: N = 3 }
        inputs { ratio: 1 = 2 }
        coordinates { x: m }
        speeds { u: m/s }
        points { P = O + x*N.x; }
        particles { Cart { point: P, mass: m } }
        loads { force on P: k/ratio*N.x; }
        kinematics { d(x)/dt = u; }",
    );
    let start = Start { coordinates: vec![0.0], speeds: vec![0.0], inputs: vec![2.0] };
    let (states, _) = states(&mechanism, &start, &[1.0]);
    assert!((states[0][0] - 0.375).abs() < 1e-12, "{states:?}");
}
