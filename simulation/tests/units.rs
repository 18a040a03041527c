//! The same motion in millimetres, grams and milliseconds has the same events.

use crate::many::{Ended, Start, follow, model, numeric, surface, with_parameters};
use hodograph::{ComponentKind, Law, Mechanism};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;

/// How many of the small units one of these is: lengths, masses and times are a thousand times the number.
fn factor(unit: &str) -> f64 {
    match unit {
        "kg" | "m" | "N*m" => 1e3,
        "1" | "" | "rad" | "m/s" | "N" => 1.0,
        "rad/s" | "m/s^2" => 1e-3,
        other => panic!("no factor for {other}"),
    }
}

fn factors(mechanism: &InterpretedMechanism, kind: ComponentKind) -> Vec<f64> {
    (0..mechanism.count(kind)).map(|i| factor(mechanism.component(kind, i).unwrap().unit)).collect()
}

/// The motion in SI units and in small ones.
fn both(name: &str, change: &[(&str, f64)], (mu, e): (f64, f64), until: f64) -> [Ended; 2] {
    let mechanism = model(name);
    let mut start = Start::of(&mechanism);
    for (name, value) in change {
        start.set(&mechanism, name, *value);
    }
    let parameters: Vec<(String, f64)> = (0..mechanism.count(ComponentKind::Parameter))
        .map(|i| {
            let component = mechanism.component(ComponentKind::Parameter, i).unwrap();
            (component.name.to_owned(), mechanism.all_parameters()[i] * factor(component.unit))
        })
        .collect();
    let parameters: Vec<(&str, f64)> =
        parameters.iter().map(|(name, value)| (name.as_str(), *value)).collect();
    let small = with_parameters(&mechanism, &parameters);
    let scaled = |values: &[f64], kind| -> Vec<f64> {
        values.iter().zip(factors(&mechanism, kind)).map(|(value, factor)| value * factor).collect()
    };
    let there = Start {
        coordinates: scaled(&start.coordinates, ComponentKind::Coordinate),
        speeds: scaled(&start.speeds, ComponentKind::Speed),
        inputs: scaled(&start.inputs, ComponentKind::Input),
    };
    let options = |absolute| Options { absolute_tolerance: absolute, ..surface(mu, e, Law::Poisson) };
    [
        follow(&mechanism, &start, options(1e-12), until),
        // The tolerance is one of lengths too.
        follow(&small, &there, options(1e-9), 1e3 * until),
    ]
}

/// The model, changes of its start, mu, and the time until which it is followed.
type Case = (&'static str, &'static [(&'static str, f64)], f64, f64);

#[test]
fn events_do_not_depend_on_units() {
    let cases: [Case; 4] = [
        ("crate", &[("u1", 1.0)], 0.3, 1.0),
        ("groove_drop", &[("wx", 3.0)], 0.4, 0.6),
        ("box_on_incline", &[("z", 0.2), ("e1", 0.02), ("ux", 0.5)], 0.6, 0.5),
        ("euler_disc", &[], 0.3, 0.5),
    ];
    for (name, change, mu, until) in cases {
        compare(name, &both(name, change, (mu, 0.0), until), 1e-6);
    }
}

/// Where domino 3 stands beside the others, which strike each other plastically, rounding of their impulses had let it
/// rattle.
#[test]
fn dominoes_do_not_depend_on_units() {
    for mu in [0.1, 0.2, 0.3, 0.45, 0.6, 0.8] {
        for e in [0.0, 0.2, 0.5] {
            compare("domino3", &both("domino3", &[], (mu, e), 0.35), 1e-6);
        }
    }
}

/// The kinds and contacts of the events.
fn list(end: &Ended) -> Vec<(&'static str, Option<usize>)> {
    end.events.iter().map(|event| (event.kind.name(), event.contact)).collect()
}

/// Both have the same events at the same times.
fn compare(name: &str, [one, other]: &[Ended; 2], within: f64) {
    assert!(one.error.is_none() && other.error.is_none(), "{name}: {:?} {:?}", one.error, other.error);
    assert!(!one.events.is_empty());
    assert_eq!(list(one), list(other), "{name}: {:?} {:?}", one.names(), other.names());
    for (a, b) in one.events.iter().zip(&other.events) {
        // How near to its singular point a motion is followed depends on the tolerance of angles.
        let close = if a.kind.name() == "singular" { 1e-5 } else { within };
        assert!((1e-3 * b.time - a.time).abs() < close, "{name}: {} {} {}", a.kind.name(), a.time, b.time);
    }
}

/// A block that is dropped on two feet, one of which strikes a little before the other, with its place in `unit`.
fn rocking(unit: &str, metres: f64) -> String {
    format!(
        "mechanism Block;
        parameters {{ m: kg = 2, a: mm = 200, b: mm = 500, J: kg*m^2 = 0.2, g: m/s^2 = 9.81 }}
        coordinates {{ x: {unit}, y: {unit} = {y:e}, q: rad = 1e-4 }}
        speeds {{ ux: m/s, uy: m/s, w: rad/s }}
        frames {{ B = N.rotate(z, q); }}
        points {{ G = O + x*N.x + y*N.y; L = G - a*B.x - b*B.y; R = G + a*B.x - b*B.y; }}
        velocities {{ G = ux*N.x + uy*N.y; }}
        bodies {{ Block {{ frame: B, centre: G, mass: m, inertia: [J, J, J] }} }}
        loads {{ gravity: -g*N.y; }}
        kinematics {{ d(q)/dt = w; }}
        contacts {{
            left {{ point: L of Block, normal: N.y, gap: dot(position(L), N.y) }},
            right {{ point: R of Block, normal: N.y, gap: dot(position(R), N.y) }}
        }}",
        y = 0.55 / metres
    )
}

/// Whether two contacts are struck together does not depend on the unit of a coordinate.
#[test]
fn rocking_does_not_depend_on_the_unit_of_places() {
    let mut motions: Vec<Ended> = Vec::new();
    for (unit, metres) in [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("pm", 1e-12), ("km", 1e3)] {
        let block = numeric(&format!("block-{unit}"), &rocking(unit, metres));
        let start =
            Start { coordinates: vec![0.0, 0.55 / metres, 1e-4], speeds: vec![0.0; 3], inputs: Vec::new() };
        motions.push(follow(&block, &start, surface(0.7, 0.3, Law::Poisson), 1.0));
    }
    let [one, others @ ..] = &motions[..] else { unreachable!() };
    assert!(one.events.len() > 20 && one.error.is_none(), "{:?}", one.names());
    for other in others {
        assert!(other.error.is_none(), "{:?}", other.error);
        assert_eq!(list(one), list(other));
        for (a, b) in one.events.iter().zip(&other.events) {
            assert!((a.time - b.time).abs() < 1e-9, "{} {} {}", a.kind.name(), a.time, b.time);
        }
    }
}

/// A particle on a plate that shakes leaves it and strikes it again at times that do not depend on how slowly it approached
/// at the start: that is no scale of the motion.
#[test]
fn an_approach_of_rounding_is_no_scale() {
    let (amplitude, rate, g) = (0.1_f64, 12.0_f64, 9.81_f64);
    let shaken = numeric(
        "shaken",
        "mechanism Shaken;
        parameters { m: kg = 2, A: m = 0.1, w: rad/s = 12, g: m/s^2 = 9.81 }
        coordinates { y: m }
        speeds { v: m/s }
        definitions { plate = A*sin(w*time); }
        points { P = O + y*N.y; }
        particles { Q { point: P, mass: m } }
        loads { gravity: -g*N.y; }
        kinematics { d(y)/dt = v; }
        contacts { strike { point: P, against: velocity d(plate)/dt*N.y, normal: N.y, gap: y - plate } }",
    );
    let leaves = (g / (amplitude * rate * rate)).asin() / rate;
    let (y, v) = (amplitude * (rate * leaves).sin(), amplitude * rate * (rate * leaves).cos());
    let gap = |t: f64| y + v * t - 0.5 * g * t * t - amplitude * (rate * (leaves + t)).sin();
    let (mut early, mut late) = (0.1, 0.4);
    assert!(gap(early) > 0.0 && gap(late) < 0.0);
    for _ in 0..100 {
        let middle = 0.5 * (early + late);
        if gap(middle) > 0.0 { early = middle } else { late = middle }
    }
    for approach in [0.0, 1e-16, 3e-16, 1e-12, 1e-9, 1e-6, 1e-5, 1e-4] {
        let start =
            Start { coordinates: vec![0.0], speeds: vec![amplitude * rate - approach], inputs: Vec::new() };
        let end = follow(&shaken, &start, surface(0.0, 0.0, Law::Newton), 0.4);
        assert!(end.error.is_none(), "{approach:e}: {:?}", end.error);
        let time =
            |kind: &str| end.events.iter().rfind(|event| event.kind.name() == kind).map(|event| event.time);
        let near = |found: Option<f64>, time: f64| found.is_some_and(|found| (found - time).abs() < 1e-11);
        assert!(near(time("lift_off"), leaves), "{approach:e}: {:?}", end.names());
        assert!(near(time("collision"), leaves + early), "{approach:e}: {:?}", end.names());
    }
}

/// A rod that tumbles onto a floor and bounces on both its ends, with its angle and its angular speed in these units.
fn tumbling(angle: &str, speed: &str) -> String {
    format!(
        "mechanism Rod;
        parameters {{ m: kg = 2, a: m = 0.4, J: kg*m^2 = 0.1, g: m/s^2 = 9.81 }}
        coordinates {{ x: m, y: m = 1, q: {angle} }}
        speeds {{ ux: m/s, uy: m/s, w: {speed} }}
        frames {{ B = N.rotate(z, q); }}
        points {{ G = O + x*N.x + y*N.y; L = G - a*B.x; R = G + a*B.x; }}
        velocities {{ G = ux*N.x + uy*N.y; }}
        bodies {{ Rod {{ frame: B, centre: G, mass: m, inertia: [J, J, J] }} }}
        loads {{ gravity: -g*N.y; }}
        kinematics {{ d(q)/dt = w; }}
        contacts {{
            left {{ point: L of Rod, normal: N.y, gap: dot(position(L), N.y) }},
            right {{ point: R of Rod, normal: N.y, gap: dot(position(R), N.y) }}
        }}"
    )
}

/// The units of angles change neither the events nor, where a step is cut into pieces by the angle in it, the work.
#[test]
fn events_do_not_depend_on_the_unit_of_angles() {
    use std::f64::consts::PI;
    let mut motions: Vec<(Ended, f64)> = Vec::new();
    let units = [
        ("rad", "rad/s", 1.0, 1.0),
        ("deg", "deg/s", PI / 180.0, PI / 180.0),
        ("rev", "rev/min", 2.0 * PI, PI / 30.0),
        ("mrad", "rad/ms", 1e-3, 1e3),
    ];
    for (angle, speed, radian, rate) in units {
        let rod = numeric(&format!("rod-{angle}"), &tumbling(angle, speed));
        let start = Start {
            coordinates: vec![0.0, 1.0, 0.2 / radian],
            speeds: vec![0.3, 0.0, 12.0 / rate],
            inputs: Vec::new(),
        };
        let end = follow(&rod, &start, surface(0.2, 0.3, Law::Poisson), 1.5);
        assert!(end.error.is_none(), "{angle}: {:?}", end.error);
        let turned = end.coordinates[2] * radian;
        motions.push((end, turned));
    }
    let [(one, turned), others @ ..] = &motions[..] else { unreachable!() };
    assert!(one.events.len() > 4, "{:?}", one.names());
    for (other, angle) in others {
        assert_eq!(list(one), list(other));
        for (a, b) in one.events.iter().zip(&other.events) {
            assert!((a.time - b.time).abs() < 1e-8, "{} {} {}", a.kind.name(), a.time, b.time);
        }
        assert!((angle - turned).abs() < 1e-6, "{angle} {turned}");
    }
}
