//! Derivatives against differences of motions.

use hodograph::{Law, State, Surface};
use hodograph_gradients::{Adjoint, By, differentiate};
use hodograph_simulation::{Options, Simulation};
use nalgebra::DVector;

use crate::common::{Task, compare, read};

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

/// A ladder slides down a wall and leaves it: its mass does not matter, and what rounding leaves of that is no error.
#[test]
fn a_mass_that_does_not_matter() {
    let task = Task {
        mechanism: read("tests/data/many_contacts/ladder.mech"),
        q: vec![0.8_f64.cos(), 0.8_f64.sin(), 0.8],
        u: vec![0.5 * 0.8_f64.sin(), -0.5 * 0.8_f64.cos(), -0.5],
        mu: 0.2,
        e: 0.0,
        law: Law::Newton,
    };
    let found = task.forwards(&[By::Parameter(0)], &[0.3, 0.6]);
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    assert!(found.events.iter().any(|event| event.event.kind.name() == "lift_off"));
    for sample in &found.samples {
        let derivative = sample.derivative.as_ref().unwrap();
        assert!(derivative.amax() < 1e-9, "{derivative}");
    }
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

/// The centre of a rod strikes a stop, which turns the slip of its tip: the tip jams and suffers an impact without
/// collision, bounces and comes to rest on the floor.
#[test]
fn a_stop_makes_a_rod_jam() {
    let mechanism = read("rod_with_stop.mech");
    // mu and e of the tip, e of the stop, u1, w, g and m.
    let values = [1.6, 0.3, 0.9, 3.0, 0.05, 9.81, 1.0];
    let setup = |values: &[f64; 7]| {
        let [mu, e, stop, _, w, g, m] = *values;
        let mut mechanism = mechanism.clone();
        hodograph::Mechanism::set_parameter_values(&mut mechanism, &[m, 1.0, g, w]).unwrap();
        let surface = |mu: f64, e: f64| Surface { mu, e, law: Law::Poisson };
        let surfaces = vec![(0, surface(mu, e)), (1, surface(0.0, stop))];
        (mechanism, Options { surfaces, ..Options::default() })
    };
    let (z, q) = (2.0 / 5.0_f64.sqrt(), 2.0_f64.atan());
    let end = |values: [f64; 7], until: f64| {
        let (mechanism, options) = setup(&values);
        let start =
            State { time: 0.0, coordinates: &[0.0, z, q], speeds: &[values[3], 0.0, 0.0], inputs: &[] };
        let mut simulation = Simulation::new(&mechanism, &start, options).unwrap();
        simulation.advance_to(until).unwrap();
        DVector::from_vec([simulation.coordinates(), simulation.speeds()].concat())
    };
    let by = [
        By::Friction(Some(0)),
        By::Restitution(Some(0)),
        By::Restitution(Some(1)),
        By::Speed(0),
        By::Parameter(3),
        By::Parameter(2),
        By::Parameter(0),
    ];
    let (mechanism, options) = setup(&values);
    let start = State { time: 0.0, coordinates: &[0.0, z, q], speeds: &[3.0, 0.0, 0.0], inputs: &[] };
    // In flight after the impact without collision; and after the first bounce.
    let times = [0.09, 0.115];
    let forwards = differentiate(&mechanism, &start, options.clone(), &by, &times).unwrap();
    compare(&forwards, &Adjoint::new(&mechanism, &start, options, &by, &times).unwrap());
    let names: Vec<&str> = forwards.events.iter().map(|event| event.event.kind.name()).collect();
    assert_eq!(names, ["contact", "collision", "impact_without_collision", "collision"]);
    assert!(forwards.undefined.is_none(), "{:?}", forwards.undefined);
    for sample in &forwards.samples {
        let exact = sample.derivative.as_ref().unwrap();
        for column in 0..by.len() {
            let central = |h: f64| {
                let at = |h: f64| {
                    let mut values = values;
                    values[column] += h;
                    end(values, sample.time)
                };
                (at(h) - at(-h)) / (2.0 * h)
            };
            let (coarse, fine) = (central(2e-4), central(1e-4));
            let differences = (&fine * 4.0 - coarse) / 3.0;
            let off = (exact.column(column) - &differences).amax() / (1.0 + differences.amax());
            assert!(off < 1e-8, "{column} at {}: {off:e}", sample.time);
        }
    }
}
