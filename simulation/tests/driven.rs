//! Inputs that stand in velocities: belts and commanded speeds that are functions of time.

use std::sync::Arc;

use crate::common::{first, names, run};
use driven_belt::DrivenBelt;
use driven_cart::DrivenCart;
use driven_lift::DrivenLift;
use hodograph::{ComponentKind, Contacts, State};
use hodograph_simulation::{Drive, ErrorKind, EventKind, Options, Progress, Simulation, SimulationError};

hodograph::mechanism!("tests/models/driven_belt.mech");
hodograph::mechanism!("tests/models/driven_cart.mech");
hodograph::mechanism!("tests/models/driven_lift.mech");

const G: f64 = 9.81;
/// The belt: friction and stiffness per mass, 1/s^2 and m/s^2.
const MU: f64 = 0.3;
const STIFF: f64 = 25.0;

/// A motion from the state of the model with these inputs.
fn begin<'m>(body: &'m dyn Contacts<f64>, inputs: &[f64], drive: Drive) -> Simulation<'m> {
    let count = |kind| body.count(kind);
    let mut q = vec![0.0; count(ComponentKind::Coordinate)];
    let mut u = vec![0.0; count(ComponentKind::Speed)];
    let mut own = vec![0.0; count(ComponentKind::Input)];
    body.initial_state(&mut q, &mut u, &mut own).unwrap();
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs };
    Simulation::new(body, &state, Options { drive, ..Options::default() }).unwrap()
}

/// Inputs as functions of time.
fn driven<const N: usize>(function: impl Fn(f64) -> [f64; N] + Send + Sync + 'static) -> Drive {
    Drive::Continuous(Arc::new(move |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        inputs.copy_from_slice(&function(t));
    }))
}

/// The error that ends a motion before this time.
fn refusal(simulation: &mut Simulation<'_>, until: f64) -> SimulationError {
    loop {
        match simulation.advance(until) {
            Ok(Progress::Event(_)) => {}
            Ok(Progress::Reached) => panic!("no error until {until}"),
            Err(error) => return error,
        }
    }
}

/// A block is taken along by a belt whose speed is a constant function, whatever it is in the start state: the motion is
/// that of the belt with this speed, and the block has it when it begins to stick.
#[test]
fn a_belt_has_the_speed_that_drives_it() {
    let belt = DrivenBelt::default();
    let speed = 0.3;
    let held = |speed| {
        let mut simulation = begin(&belt, &[speed], Drive::Held);
        let events = run(&mut simulation, 0.2);
        (events.iter().map(|event| event.time).collect::<Vec<_>>(), simulation.speeds().to_vec())
    };
    for start in [0.5, 0.3, 7.0, 0.0] {
        let mut simulation = begin(&belt, &[start], driven(move |_| [speed]));
        let events = run(&mut simulation, 0.2);
        let stick = first(&events, "stick");
        let amplitude = MU * G / STIFF.sqrt();
        assert!(
            (stick.time - (speed / amplitude).asin() / STIFF.sqrt()).abs() < 1e-11,
            "{:?}",
            names(&events)
        );
        assert!((stick.speeds[0] - speed).abs() < 1e-12);
        let times = events.iter().map(|event| event.time).collect::<Vec<_>>();
        assert_eq!((times, simulation.speeds().to_vec()), held(speed), "start {start}");
        assert_eq!(simulation.inputs(), [speed]);
    }
}

/// A block slides on a belt that becomes faster, and its friction is what it is; when it would stick, the rate of the
/// belt's speed would be needed, which is not known: an error that says so.
#[test]
fn a_block_cannot_stick_to_a_belt_of_unknown_acceleration() {
    let belt = DrivenBelt::default();
    let mut simulation = begin(&belt, &[1.0], driven(|t| [1.0 + t]));
    run(&mut simulation, 0.1);
    let expected = MU * G / STIFF.sqrt() * (STIFF.sqrt() * 0.1).sin();
    assert!((simulation.speeds()[0] - expected).abs() < 1e-12);
    let mut simulation = begin(&belt, &[0.0], driven(|t| [2.0 * t]));
    let error = refusal(&mut simulation, 1.0);
    assert!(
        matches!(&error.kind, ErrorKind::BadInput(message) if message.contains("the input s")),
        "{error}"
    );
    assert_eq!(error.contact, Some("belt".to_owned()));
}

/// A cart whose commanded speed grows strikes a block: it has the speed of that time, and the block leaves with it and
/// the part e of the approach.
#[test]
fn a_cart_strikes_with_its_commanded_speed() {
    let cart = DrivenCart::default();
    let mut simulation = begin(&cart, &[7.0, 0.0], driven(|t| [1.0 + 0.5 * t, 0.0]));
    let events = run(&mut simulation, 1.0);
    let hit = first(&events, "collision");
    assert!((hit.time - (8.0_f64.sqrt() - 2.0)).abs() < 1e-12, "{}", hit.time);
    let commanded = 2.0_f64.sqrt();
    assert!((hit.speeds[0] - 1.5 * commanded).abs() < 1e-12, "{:?}", hit.speeds);
    let EventKind::Collision(record) = &hit.kind else { panic!("{:?}", hit.kind) };
    // half of m times the change of u^2
    assert!((record.outcome.energy_change - 2.25 * 2.0).abs() < 1e-11, "{}", record.outcome.energy_change);
    let kinetic = simulation.energy().unwrap().kinetic;
    let [u, w] = [simulation.speeds()[0], simulation.speeds()[2]];
    // m u^2, M U^2, and the bob, whose cart stands
    let by_hand = 0.5 * (2.0 * u * u + 5.0 * 1.5 * 1.5 + 0.16 * w * w);
    assert!((kinetic - by_hand).abs() < 1e-12 * by_hand, "{kinetic} {by_hand}");
}

/// A commanded speed that accelerates a pendulum may not change smoothly, for its rate is not known.
#[test]
fn a_commanded_speed_that_accelerates_others_may_not_change() {
    let cart = DrivenCart::default();
    let mut simulation = begin(&cart, &[1.0, 0.0], driven(|t| [1.0, 0.1 * t]));
    let error = refusal(&mut simulation, 1.0);
    assert!(
        matches!(&error.kind, ErrorKind::BadInput(message) if message.contains("the input r")),
        "{error}"
    );
    let mut simulation = begin(&cart, &[1.0, 0.0], driven(|_| [1.0, 0.3]));
    run(&mut simulation, 0.5);
}

/// The account of energy is that of the time that was asked for, not of the end of the step beyond it.
#[test]
fn energies_are_those_of_the_time_that_is_asked_for() {
    let belt = DrivenBelt::default();
    let mut simulation = begin(&belt, &[0.5], Drive::Held);
    for step in 1..=20 {
        let time = 0.01 * f64::from(step);
        run(&mut simulation, time);
        let (energy, u, x) =
            (simulation.energy().unwrap(), simulation.speeds()[0], simulation.coordinates()[0]);
        assert_eq!(simulation.time(), time);
        assert!((energy.kinetic - u * u).abs() < 1e-14, "{time}: {} {}", energy.kinetic, u * u);
        // the block slides: friction takes its force times the slip
        let slip = 0.5 * time - x;
        assert!((energy.friction + MU * 2.0 * G * slip).abs() < 1e-12, "{time}: {}", energy.friction);
    }
}

/// A particle falls on a lift that rises at 0.1 m/s, and rises with it. Without its velocity the lift would rise into the
/// particle, and where its speed changes, the force on the particle is not known: errors.
#[test]
fn a_particle_rises_with_a_lift() {
    let lift = DrivenLift::default();
    let mut simulation = begin(&lift, &[0.0, 0.0], driven(|t| [0.1 * t, 0.1]));
    let events = run(&mut simulation, 1.0);
    // 0.5 - g t^2 / 2 = 0.1 t
    let time = ((0.01 + 2.0 * G * 0.5_f64).sqrt() - 0.1) / G;
    assert!((first(&events, "collision").time - time).abs() < 1e-12);
    assert!(
        (simulation.coordinates()[0] - 0.1).abs() < 1e-12 && (simulation.speeds()[0] - 0.1).abs() < 1e-12
    );
    let mut simulation = begin(&lift, &[0.0, 0.0], driven(|t| [0.2, 0.0 * t]));
    run(&mut simulation, 1.0);
    assert!((simulation.coordinates()[0] - 0.2).abs() < 1e-12);
    for heights in [|t: f64| 0.1 * t, |t: f64| 0.1 * (20.0 * t).sin()] {
        let mut simulation = begin(&lift, &[0.0, 0.0], driven(move |t| [heights(t), 0.0]));
        let error = refusal(&mut simulation, 1.0);
        assert!(matches!(error.kind, ErrorKind::GapRate { .. }), "{error}");
    }
    let mut simulation = begin(&lift, &[0.0, 0.0], driven(|t| [0.1 * t * t, 0.2 * t]));
    let error = refusal(&mut simulation, 1.0);
    assert!(matches!(error.kind, ErrorKind::BadInput(_)), "{error}");
}
