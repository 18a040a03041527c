//! Pairs of shapes that are apart are not looked at, and no event is left out (docs/theory.md, sections 16.14 and 17.20).

use hodograph::{Contacts, Law};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_random::Random;
use hodograph_simulation::Event;

use crate::common::counted::Counted;
use crate::common::{run, start, surface};
use crate::many::model;

/// A motion from a state: its events, its end, and how many gaps and clearances were computed.
fn motion(
    mechanism: &dyn Contacts<f64>,
    [q, u]: [&[f64]; 2],
    until: f64,
    tells_pairs: bool,
) -> (Vec<Event>, Vec<f64>, [usize; 2]) {
    let counted = Counted::new(mechanism, tells_pairs);
    let mut simulation = start(&counted, q, u, surface(0.5, 0.2, Law::Newton));
    let events = run(&mut simulation, until);
    let end = [simulation.coordinates(), simulation.speeds()].concat();
    drop(simulation);
    (events, end, [counted.gaps.get(), counted.clearances.get()])
}

/// The same motion with pairs and without: the same events, and the part of gaps that is left to compute.
fn compare(name: &str, mechanism: &dyn Contacts<f64>, state: [&[f64]; 2], until: f64) -> f64 {
    let (events, end, [gaps, clearances]) = motion(mechanism, state, until, true);
    let (all, other_end, [all_gaps, none]) = motion(mechanism, state, until, false);
    assert_eq!(none, 0);
    println!("{name}: {} events, {gaps} gaps and {clearances} clearances, {all_gaps} gaps", events.len());
    let short = |events: &[Event]| -> Vec<(&str, Option<usize>)> {
        events.iter().map(|event| (event.kind.name(), event.contact)).collect()
    };
    assert_eq!(short(&events), short(&all), "{name}");
    for (one, other) in events.iter().zip(&all) {
        assert!((one.time - other.time).abs() < 1e-9, "{name}: {} {}", one.time, other.time);
    }
    for (one, other) in end.iter().zip(&other_end) {
        assert!((one - other).abs() < 1e-7, "{name}: {one} {other}");
    }
    (gaps + clearances) as f64 / all_gaps as f64
}

/// A crate is thrown onto another in space. While they are apart, one number is computed for each pair in place of 8 or 52.
#[test]
fn a_crate_is_thrown_onto_another() {
    let crates = model("two_crates");
    let q = [0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0, 0.02, 1.2, 0.01, 1.0, 0.0, 0.0, 0.0];
    let mut u = [0.0; 12];
    (u[6], u[9], u[11]) = (0.1, 2.0, 1.0);
    let share = compare("in flight", &crates, [&q, &u], 0.25);
    assert!(share < 0.1, "{share}");
    let share = compare("until they have met", &crates, [&q, &u], 0.6);
    assert!(share < 0.9, "{share}");
}

/// Four bricks of which each may strike each.
fn column() -> InterpretedMechanism {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/models/column.mech");
    InterpretedMechanism::read(path.as_ref()).unwrap()
}

/// A column of four bricks of which each may strike each: neighbours touch, the others do not come near.
#[test]
fn a_column_costs_what_touches() {
    let column = column();
    let mut random = Random::named("column");
    for number in 0..5 {
        let (mut q, mut u) = ([0.0; 12], [0.0; 12]);
        for i in 0..4 {
            (q[3 * i], q[3 * i + 1]) = (0.02 * random.number(), 0.06 + 0.17 * i as f64);
            (u[3 * i], u[3 * i + 2]) = (0.1 * random.number(), random.number());
        }
        let share = compare(&format!("column {number}"), &column, [&q, &u], 0.4);
        assert!(share < 0.8, "{share}");
    }
}

/// Bricks that are thrown at each other: what is far away may be what is struck next.
#[test]
fn thrown_bricks_meet() {
    let column = column();
    let mut random = Random::named("bricks");
    let (mut shares, mut events) = (0.0, 0);
    for number in 0..20 {
        let (mut q, mut u) = ([0.0; 12], [0.0; 12]);
        for i in 0..4 {
            let [x, y] = [[-1.0, 0.5], [1.0, 0.6], [-2.0, 0.9], [2.0, 1.0]][i];
            (q[3 * i], q[3 * i + 1], q[3 * i + 2]) = (x, y, random.number());
            let fast = 4.0 + 4.0 * random.number();
            (u[3 * i], u[3 * i + 1], u[3 * i + 2]) = (-x.signum() * fast, 2.0, 4.0 * random.number());
        }
        shares += compare(&format!("bricks {number}"), &column, [&q, &u], 0.35) / 20.0;
        events += motion(&column, [&q, &u], 0.35, true).0.len();
    }
    println!("{shares} of the gaps, {events} events");
    assert!(shares < 0.5 && events > 40, "{shares} {events}");
}
