//! A table on four feet with four corners each: sixteen contacts at once, of which three would do.

use crate::common::{first, names, run, start, surface};
use hodograph::{Contacts, Law, State};
use hodograph_simulation::{ContactPhase, Simulation};
use table::Table;

hodograph::mechanism!("tests/models/table.mech");

const G: f64 = 9.81;

/// The mass centre at this height, turned by these angles about B.x and then B.y.
fn placed(height: f64, about_x: f64, about_y: f64) -> Vec<f64> {
    let (cx, sx, cy, sy) =
        ((0.5 * about_x).cos(), (0.5 * about_x).sin(), (0.5 * about_y).cos(), (0.5 * about_y).sin());
    vec![0.0, 0.0, height, cx * cy, sx * cy, cx * sy, sx * sy]
}

/// How many contacts are in this phase. All others are open without a gap: they touch and carry nothing, for
/// fewer than sixteen are enough.
fn touching(simulation: &Simulation<'_>, phase: ContactPhase) -> usize {
    let phases: Vec<_> = (0..16).map(|contact| simulation.phase(contact)).collect();
    let state = State {
        time: simulation.time(),
        coordinates: simulation.coordinates(),
        speeds: simulation.speeds(),
        inputs: &[],
    };
    for (contact, found) in phases.iter().enumerate() {
        let gap = Table::<f64>::default().gap(contact, &state).unwrap().unwrap();
        assert!(
            gap.abs() < 1e-10 && [Some(phase), Some(ContactPhase::Open)].contains(found),
            "{gap:e} {phases:?}"
        );
    }
    phases.iter().filter(|found| **found == Some(phase)).count()
}

/// Sixteen sliding corners stop the table after v^2 / (2 mu g), all at the same time; nothing tilts and
/// nothing turns.
#[test]
fn it_slides_on_all_corners_and_stops() {
    let body = Table::<f64>::default();
    let (mu, v) = (0.4, [1.2, -0.9]);
    let speeds = [v[0], v[1], 0.0, 0.0, 0.0, 0.0];
    let mut simulation = start(&body, &placed(0.7, 0.0, 0.0), &speeds, surface(mu, 0.3, Law::Poisson));
    assert!(touching(&simulation, ContactPhase::Slide) >= 3);
    let (forces, unique) = simulation.contact_forces().unwrap();
    let sum = forces.iter().map(|(_, force)| force.x).sum::<f64>();
    assert!(
        (sum - 12.0 * G).abs() < 1e-9 && !unique && forces.iter().all(|(_, force)| force.x >= 0.0),
        "{forces:?}"
    );
    let events = run(&mut simulation, 3.0);
    let rest = first(&events, "rest");
    let speed = 1.5;
    assert!((rest.time - speed / (mu * G)).abs() < 1e-9, "{} {:?}", rest.time, names(&events));
    let q = simulation.coordinates();
    let way = speed / (2.0 * mu * G);
    assert!((q[0] - v[0] * way).abs() < 1e-9 && (q[1] - v[1] * way).abs() < 1e-9, "{q:?}");
    assert!((q[2] - 0.7).abs() < 1e-12 && (q[3] - 1.0).abs() < 1e-12, "{q:?}");
}

/// Dropped flat or tilted, with and without bounces, it ends at rest on all four feet, and its energy is
/// accounted for.
#[test]
fn it_comes_to_rest_on_its_feet() {
    let body = Table::<f64>::default();
    for (height, about_x, about_y, e) in [(0.71, 0.0, 0.0, 0.3), (0.75, 0.03, 0.05, 0.0)] {
        let case = format!("{height} {about_x} {about_y} {e}");
        let q = placed(height, about_x, about_y);
        let mut simulation = start(&body, &q, &[0.0; 6], surface(0.6, e, Law::Poisson));
        let before = simulation.energy().unwrap();
        let events = run(&mut simulation, 5.0);
        first(&events, "rest");
        let q = simulation.coordinates();
        assert!((q[2] - 0.7).abs() < 1e-9, "{case}: {q:?}");
        assert!(touching(&simulation, ContactPhase::Stick) >= 3, "{case}: {q:?} {:?}", names(&events));
        let after = simulation.energy().unwrap();
        let off = (after.total().unwrap() - before.total().unwrap() - after.impacts - after.friction)
            / before.total().unwrap();
        assert!(off.abs() < 1e-9 && after.impacts < 0.0, "{case}: {off:e}");
        println!("{case}: {} events, off by {off:.1e}", events.len());
    }
}

/// It stands for 100 s exactly where it is.
#[test]
fn it_stands_still() {
    let body = Table::<f64>::default();
    let mut simulation = start(&body, &placed(0.7, 0.0, 0.0), &[0.0; 6], surface(0.5, 0.0, Law::Newton));
    let events = run(&mut simulation, 100.0);
    assert!(
        events.iter().all(|event| event.time == 0.0 && ["contact", "rest"].contains(&event.kind.name())),
        "{:?}",
        names(&events)
    );
    assert_eq!(simulation.coordinates(), placed(0.7, 0.0, 0.0));
}
