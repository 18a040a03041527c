//! The same motion in millimetres, grams and milliseconds has the same events.

use crate::many::{Ended, Start, follow, model, surface, with_parameters};
use hodograph::{ComponentKind, Law, Mechanism};
use hodograph_interpreter::{InterpretedMechanism, NumericMechanism};
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
    let folder = std::env::temp_dir().join(format!("hodograph-units-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut motions: Vec<Ended> = Vec::new();
    for (unit, metres) in [("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("pm", 1e-12), ("km", 1e3)] {
        let path = folder.join(format!("{unit}.mech"));
        std::fs::write(&path, rocking(unit, metres)).unwrap();
        let block = NumericMechanism::read(&path).unwrap();
        let start =
            Start { coordinates: vec![0.0, 0.55 / metres, 1e-4], speeds: vec![0.0; 3], inputs: Vec::new() };
        motions.push(follow(&block, &start, surface(0.7, 0.3, Law::Poisson), 1.0));
    }
    std::fs::remove_dir_all(&folder).unwrap();
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
