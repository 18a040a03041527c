//! Blocks and crates of one size: corners that meet corners, and faces that end where others do (docs/theory.md, 16.9).

use hodograph::Law;
use hodograph_simulation::{EventKind, Simulation};

use crate::common::{run, start, surface};
use crate::many::{model, with_parameters};

/// Side of the bodies, m.
const SIDE: f64 = 0.3;

/// Two equal bodies, in a plane and in space.
fn pairs(side: f64) -> [(&'static str, impl hodograph::Contacts<f64>); 2] {
    let sides: Vec<(String, f64)> = ["lower", "upper"]
        .into_iter()
        .flat_map(|body| ["a", "b", "c"].map(|axis| (format!("{body}_{axis}"), side)))
        .collect();
    let sides: Vec<(&str, f64)> = sides.iter().map(|(name, side)| (name.as_str(), *side)).collect();
    ["two_blocks", "two_crates"].map(|name| (name, with_parameters(&model(name), &sides)))
}

/// The coordinates of two bodies that are not turned, from the places of their centres; and their speeds.
fn state(name: &str, places: [[f64; 2]; 2], velocities: [[f64; 2]; 2]) -> (Vec<f64>, Vec<f64>) {
    let whole = |[x, y]: [f64; 2], turned: &[f64]| [&[x, y][..], turned].concat();
    let (at, rest): (&[f64], &[f64]) = match name {
        "two_blocks" => (&[0.0], &[0.0]),
        _ => (&[0.0, 1.0, 0.0, 0.0, 0.0], &[0.0; 4]),
    };
    (places.map(|place| whole(place, at)).concat(), velocities.map(|velocity| whole(velocity, rest)).concat())
}

/// The velocities of the centres along x, and all other speeds.
fn velocities(simulation: &Simulation<'_>) -> ([f64; 2], Vec<f64>) {
    let u = simulation.speeds();
    let half = u.len() / 2;
    let rest = (0..u.len()).filter(|place| place % half != 0).map(|place| u[place]).collect();
    ([u[0], u[half]], rest)
}

/// A body slides on the floor into another of its height: all corners of the faces meet at once, when the gap is
/// closed and not later, and the impact is that of two points.
#[test]
fn bodies_of_one_height_collide_when_they_meet() {
    for (name, pair) in pairs(SIDE) {
        for (e, mu, law) in [(0.0, 0.0, Law::Newton), (0.5, 0.0, Law::Poisson), (0.5, 0.0, Law::Stronge)] {
            for gap in [0.05, 0.0813, 0.31] {
                let floor = 0.5 * SIDE;
                let (q, u) = state(name, [[0.0, floor], [SIDE + gap, floor]], [[0.0, 0.0], [-1.0, 0.0]]);
                let mut simulation = start(&pair, &q, &u, surface(mu, e, law));
                let events = run(&mut simulation, gap + 0.2);
                let hit = |kind: &EventKind| matches!(kind.name(), "collision" | "struck_together");
                let struck = events.iter().find(|event| hit(&event.kind)).unwrap();
                assert!((struck.time - gap).abs() < 1e-10, "{name} {gap}: {}", struck.time);
                let ([one, other], rest) = velocities(&simulation);
                let after = [-0.5 * (1.0 + e), -0.5 * (1.0 - e)];
                assert!((one - after[0]).abs() < 1e-10 && (other - after[1]).abs() < 1e-10, "{one} {other}");
                assert!(rest.iter().all(|speed| speed.abs() < 1e-10), "{name} {e}: {rest:?}");
            }
        }
    }
}

/// In free fall two bodies lie on each other and slide apart, without friction: nothing changes their velocities, also where
/// faces end at corners of the other body. The velocities were held along the normal of the next face.
#[test]
fn faces_that_slide_apart_do_not_push() {
    for (name, pair) in pairs(0.4) {
        for k in 0..40 {
            let from = f64::from(k) * 0.013;
            let (q, u) = state(name, [[from, 0.5 + 3.0], [0.1, 0.9 + 3.0]], [[1.0, 0.0], [-1.0, 0.0]]);
            let mut simulation = start(&pair, &q, &u, surface(0.0, 0.0, Law::Newton));
            let events = run(&mut simulation, 0.5);
            assert!(!simulation.has_ended(), "{name} {k}: {events:?}");
            let ([one, other], rest) = velocities(&simulation);
            assert!((one - 1.0).abs() < 1e-12 && (other + 1.0).abs() < 1e-12, "{name} {k}: {one} {other}");
            // both fall
            let falls = rest.iter().filter(|speed| (*speed + 9.81 * 0.5).abs() < 1e-10).count();
            let still = rest.iter().filter(|speed| speed.abs() < 1e-12).count();
            assert!(falls == 2 && falls + still == rest.len(), "{name} {k}: {rest:?}");
        }
    }
}
