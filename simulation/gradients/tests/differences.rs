//! Derivatives against differences of motions.

use hodograph::Law;
use hodograph_gradients::By;

use crate::common::{Task, read};

/// A rod in a plane falls on its tip, slides, sticks, tumbles and bounces on both ends.
#[test]
fn a_rod_tumbles_through_twenty_events() {
    let task = Task {
        mechanism: read("simulation/models/painleve_rod.mech"),
        q: vec![0.0, 1.3, 0.7],
        u: vec![1.5, 0.0, 2.0],
        mu: 0.1,
        e: 0.92,
        law: Law::Poisson,
    };
    let by = [
        (By::Coordinate(1), 1e-4),
        (By::Coordinate(2), 1e-4),
        (By::Speed(0), 1e-4),
        (By::Speed(2), 1e-4),
        (By::Friction(None), 1e-4),
        (By::Restitution(None), 1e-4),
        (By::Parameter(1), 1e-4),
        (By::Parameter(2), 1e-3),
    ];
    let compared = task.compare(&by, 2.7);
    println!("{compared:?}");
    assert!(compared.events == 8 && compared.state < 1e-9 && compared.times < 1e-9, "{compared:?}");
    // Derivatives grow with every event, and with them the error of differences.
    let compared = task.compare(&by, 4.7);
    println!("{compared:?}");
    assert!(compared.events == 22 && compared.state < 3e-9 && compared.times < 3e-9, "{compared:?}");
}

/// A cube is tossed onto a table: impacts with friction in space.
#[test]
fn a_cube_is_tossed() {
    let task = Task {
        mechanism: read("simulation/models/measured_cube.mech"),
        q: vec![0.0, 0.0, 0.25, 0.8, 0.3, -0.4, 0.3],
        u: vec![0.7, -0.4, -0.3, 3.0, -5.0, 4.0],
        mu: 0.18,
        e: 0.35,
        law: Law::Stronge,
    };
    let mut task = task;
    hodograph::Mechanism::normalise(&task.mechanism.clone(), &mut task.q).unwrap();
    let by = [
        (By::Coordinate(2), 1e-4),
        (By::Coordinate(4), 1e-4),
        (By::Speed(0), 1e-4),
        (By::Speed(4), 1e-4),
        (By::Friction(None), 1e-5),
        (By::Restitution(None), 1e-5),
        (By::Parameter(1), 1e-5),
        (By::Parameter(2), 1e-7),
    ];
    let compared = task.compare(&by, 0.245);
    println!("{compared:?}");
    assert!(compared.events >= 3 && compared.state < 1e-7 && compared.times < 1e-7, "{compared:?}");
}

/// A ball bounces two hundred times on a plate that oscillates, locked to it.
#[test]
fn a_ball_bounces_two_hundred_times_on_a_plate() {
    let task = Task {
        mechanism: read("ball_on_plate.mech"),
        q: vec![0.0068],
        u: vec![-0.397],
        mu: 0.0,
        e: 0.7,
        law: Law::Newton,
    };
    let by = [
        (By::Restitution(None), 1e-4),
        (By::Parameter(1), 1e-3),
        (By::Parameter(2), 1e-6),
        (By::Parameter(3), 1e-5),
    ];
    let compared = task.compare(&by, 21.0);
    println!("{compared:?}");
    assert!(compared.events >= 200 && compared.state < 3e-8 && compared.times < 3e-8, "{compared:?}");
}
