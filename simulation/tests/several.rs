//! Several contacts, and modes that change.

use crate::common::{Body, Line, Part, collisions, first, names, run, start, surface};
use hodograph::{Law, Mechanism, State};
use hodograph_simulation::{ContactPhase, EventKind, ImpactsAtOnce, Options, Progress};

const G: f64 = 9.81;

fn block(half: f64, height: f64) -> Body {
    // A uniform block of width 2 half and the given height, its mass centre at half the height.
    let (a, b) = (half, 0.5 * height);
    let inertia = 2.0 * (a * a + b * b) / 3.0;
    Body::new(2.0, inertia, &[Line::floor(Part::Point(-a, -b)), Line::floor(Part::Point(a, -b))])
}

/// A block falls flat, bounces on two corners, and comes to rest; the forces at its corners are half its
/// weight each.
#[test]
fn a_block_falls_flat_and_comes_to_rest() {
    let body = block(0.3, 0.2);
    let mut simulation = start(&body, &[0.0, 0.6, 0.0], &[0.0; 3], surface(0.4, 0.5, Law::Newton));
    let events = run(&mut simulation, 3.0);
    assert!((collisions(&events)[0] - (1.0 / G).sqrt()).abs() < 1e-10);
    first(&events, "rest");
    assert!((simulation.coordinates()[1] - 0.1).abs() < 1e-12, "{:?}", simulation.coordinates());
    assert!(simulation.coordinates()[2].abs() < 1e-12);
    let (forces, _) = simulation.contact_forces().unwrap();
    assert_eq!(forces.len(), 2);
    for (_, force) in forces {
        assert!((force.x - G).abs() < 1e-9 && force.y.abs() < 1e-9, "{force}");
    }
}

/// A block slides on two corners: it stops after v^2 / (2 mu g), both corners together, and pitches not.
#[test]
fn a_block_slides_on_two_corners() {
    let body = block(0.3, 0.2);
    let mut simulation = start(&body, &[0.0, 0.1, 0.0], &[1.5, 0.0, 0.0], surface(0.5, 0.5, Law::Newton));
    assert_eq!(simulation.phase(1), Some(ContactPhase::Slide));
    run(&mut simulation, 0.1);
    let (forces, unique) = simulation.contact_forces().unwrap();
    assert!(unique);
    // Friction mu m g at height h/2 below the mass centre loads the front corner.
    let (m, mu) = (2.0, 0.5);
    let shift = mu * m * G * 0.1 / 0.6;
    assert!((forces[0].1.x - (0.5 * m * G - shift)).abs() < 1e-9, "{forces:?}");
    assert!((forces[1].1.x - (0.5 * m * G + shift)).abs() < 1e-9, "{forces:?}");
    let events = run(&mut simulation, 3.0);
    let stick = first(&events, "stick");
    assert!((stick.time - 1.5 / (mu * G)).abs() < 1e-10, "{}", stick.time);
    assert!((simulation.coordinates()[0] - 1.5 * 1.5 / (2.0 * mu * G)).abs() < 1e-10);
    first(&events, "rest");
    let (_, unique) = simulation.contact_forces().unwrap();
    assert!(!unique, "two corners that stick share friction in any way");
}

/// A ladder leaves a smooth wall when its top has fallen to two thirds of its height.
#[test]
fn a_ladder_leaves_the_wall_at_two_thirds() {
    let l = 2.0;
    let mut body = Body::new(3.0, 3.0 * l * l / 12.0, &[]);
    // The ladder lies along the body's x; its foot on the floor z = 0 and its top on the wall x = 0, whose
    // normal is +x.
    let wall =
        Line { part: Part::Point(-l / 2.0, 0.0), tilt: std::f64::consts::FRAC_PI_2, offset: 0.0, belt: 0.0 };
    body.lines = vec![Line::floor(Part::Point(l / 2.0, 0.0)), wall];
    for lean in [0.1_f64, 0.3, 0.6] {
        // At angle lean from the wall: top at (0, l cos), foot at (l sin, 0); theta points from top to foot.
        let theta = -(std::f64::consts::FRAC_PI_2 - lean);
        let q = [0.5 * l * lean.sin(), 0.5 * l * lean.cos(), theta];
        let mut simulation = start(&body, &q, &[0.0; 3], surface(0.0, 0.5, Law::Newton));
        let events = run(&mut simulation, 1.5);
        let off = first(&events, "lift_off");
        assert_eq!(off.contact, Some(1));
        let height = off.coordinates[1] * 2.0;
        let expected = 2.0 / 3.0 * l * lean.cos();
        assert!((height - expected).abs() < 1e-9, "{lean}: {height} {expected}");
    }
}

/// A block on a belt, held by a spring: it sticks while the spring stretches, slips, and sticks again: a
/// closed cycle.
#[test]
fn stick_slip_on_a_belt_is_periodic() {
    let (m, k, v, mu) = (2.0, 50.0, 0.3, 0.4);
    let mut body = Body::new(m, 1.0, &[]);
    body.spring = k;
    body.lines = vec![Line { part: Part::Point(0.0, 0.0), tilt: 0.0, offset: 0.0, belt: v }];
    // Held from rotation it is not, but nothing turns it: the point is the mass centre.
    let mut simulation = start(&body, &[0.0; 3], &[v, 0.0, 0.0], surface(mu, 0.5, Law::Newton));
    let events = run(&mut simulation, 20.0);
    let slips: Vec<f64> =
        events.iter().filter(|event| event.kind.name() == "slip").map(|event| event.time).collect();
    assert!((slips[0] - mu * m * G / (k * v)).abs() < 1e-9, "{} {:?}", slips[0], names(&events));
    // One coefficient of friction: when slip begins the force is continuous, and the block moves on with the
    // belt's speed; its slip then is that of a free oscillation about mu m g / k which begins there with
    // speed v: half a turn, and it would stick again. It swings for ever.
    let omega = (k / m).sqrt();
    let about = mu * m * G / k;
    let state = (simulation.coordinates()[0] - about, simulation.speeds()[0]);
    let amplitude = (state.0 * state.0 + state.1 * state.1 / (omega * omega)).sqrt();
    assert!((amplitude - v / omega).abs() < 1e-9, "{amplitude} {} {:?}", v / omega, names(&events));
}

/// A block that rocks without slip loses at each impact what the textbook says: w2 = w1 (1 - 3/2 sin^2 a) for
/// a slender block (Housner).
#[test]
fn a_rocking_block_loses_what_housner_says() {
    // The last is a cube's section, which keeps a quarter of its angular velocity when it falls from its edge
    // on a face.
    for (b, h, tilt) in [(0.1_f64, 0.4_f64, 0.1_f64), (0.2, 0.3, 0.3), (0.2, 0.2, 0.7)] {
        let body = block(b, 2.0 * h);
        let radius = b.hypot(h);
        let alpha = (b / h).atan();
        // Turned about its right corner by theta < 0.
        let corner = [b, 0.0];
        let (s, c) = (-tilt).sin_cos();
        let q = [corner[0] + (-b * c - h * s), -b * s + h * c, -tilt];
        let mut simulation = start(&body, &q, &[0.0; 3], surface(4.0, 0.0, Law::Newton));
        assert_eq!(simulation.phase(1), Some(ContactPhase::Stick));
        let events = run(&mut simulation, 1.0);
        let impact = first(&events, "collision");
        assert_eq!(impact.contact, Some(0));
        let EventKind::Collision(struck) = &impact.kind else { panic!() };
        let last = events.iter().rfind(|event| event.time == impact.time).expect("that event");
        let (before, after) = (struck.speeds_before[2], last.speeds[2]);
        // Energy before: m g R (cos(alpha - tilt) - cos alpha) = I0 w^2 / 2 with I0 = 4/3 m R^2.
        let expected = (1.5 * G / radius * ((alpha - tilt).cos() - alpha.cos())).sqrt();
        assert!((before - expected).abs() < 1e-9, "{before} {expected}");
        let ratio = 1.0 - 1.5 * alpha.sin().powi(2);
        assert!((after / before - ratio).abs() < 1e-9, "{} {ratio}: {:?}", after / before, names(&events));
    }
}

/// Pushed by a force that grows, a block begins to slip when the force exceeds friction, with the force
/// continuous.
#[test]
fn a_pushed_block_begins_to_slip() {
    let body = block(0.3, 0.2);
    let drive = hodograph_simulation::Drive::Continuous(std::sync::Arc::new(
        |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
            inputs[0] = 3.0 * t;
        },
    ));
    let options = Options { drive, max_step: 0.1, ..surface(0.5, 0.5, Law::Newton) };
    let mut simulation = start(&body, &[0.0, 0.1, 0.0], &[0.0; 3], options);
    let events = run(&mut simulation, 4.0);
    let slip = first(&events, "slip");
    let begins = 0.5 * 2.0 * G / 3.0;
    assert!((slip.time - begins).abs() < 1e-9, "{} {begins}", slip.time);
    let t: f64 = 4.0 - begins;
    let moved = 3.0 * t.powi(3) / (6.0 * 2.0);
    assert!((simulation.coordinates()[0] - moved).abs() < 1e-9, "{} {moved}", simulation.coordinates()[0]);
    let energy = simulation.energy().unwrap();
    assert!((energy.kinetic - energy.inputs - energy.friction).abs() < 1e-9, "{energy:?}");
}

/// What is not allowed is said.
#[test]
fn striking_together_can_end_the_simulation() {
    let body = block(0.3, 0.2);
    let options = Options { together: ImpactsAtOnce::Stop, ..surface(0.4, 0.5, Law::Newton) };
    let mut simulation = start(&body, &[0.0, 0.6, 0.0], &[0.0; 3], options);
    let error = simulation.advance_to(1.0).unwrap_err();
    assert_eq!(error.kind.name(), "struck_together");
    assert!(error.to_string().contains("c0, c1"), "{error}");
}

hodograph::mechanism!("models/cradle.mech");

/// Three balls, of which the first comes with 1 m/s, with these stiffnesses.
fn struck_cradle(stiffness: [f64; 2], surface: Options) -> Vec<hodograph_simulation::Event> {
    let balls = cradle::Cradle::<f64>::default();
    let options = Options {
        together: ImpactsAtOnce::Lzb,
        stiffness: vec![(0, stiffness[0]), (1, stiffness[1])],
        ..surface
    };
    let mut simulation = start(&balls, &[-0.2, 0.0, 0.1], &[1.0, 0.0, 0.0], options);
    let events = run(&mut simulation, 1.0);
    let energy = simulation.energy().unwrap();
    assert!((energy.kinetic - energy.impacts - 0.5).abs() < 1e-12, "{energy:?}");
    events
}

/// Springs between the balls share the impact: the answer depends on the ratio of stiffnesses, and tends to
/// one order as that grows.
#[test]
fn a_cradle_answers_by_its_stiffnesses() {
    let mut last = Vec::new();
    for stiffness in [[1.0, 1.0], [3.0, 3.0], [1e6, 1.0]] {
        let events = struck_cradle(stiffness, surface(0.0, 1.0, Law::Stronge));
        let impact = first(&events, "struck_together");
        assert!((impact.time - 0.1).abs() < 1e-12);
        let EventKind::SimultaneousCollision(struck) = &impact.kind else { panic!() };
        assert_eq!(struck.speeds_before, [1.0, 0.0, 0.0]);
        assert_eq!(struck.shares.len(), 2);
        assert!(struck.energy_change.abs() < 1e-12, "{struck:?}");
        last.push(impact.speeds.clone());
    }
    // What the closed form in the tests of `lzb` gives for equal balls, to two digits; only the ratio
    // matters.
    for (speed, known) in last[0].iter().zip([-0.13, 0.15, 0.98]) {
        assert!((speed - known).abs() < 0.006, "{last:?}");
    }
    assert!(last[0].iter().zip(&last[1]).all(|(a, b)| (a - b).abs() < 1e-12), "{last:?}");
    assert!(last[2].iter().zip([0.0, 0.0, 1.0]).all(|(a, b)| (a - b).abs() < 5e-3), "{last:?}");
}

/// A block that falls flat keeps level, and comes to rest.
#[test]
fn a_block_that_falls_flat_answers_at_once() {
    let body = block(0.3, 0.2);
    let options = Options { together: ImpactsAtOnce::Lzb, ..surface(0.0, 0.5, Law::Stronge) };
    let mut simulation = start(&body, &[0.0, 0.6, 0.0], &[0.0; 3], options);
    let events = run(&mut simulation, 3.0);
    let impact = first(&events, "struck_together");
    let fall = (1.0 / G).sqrt();
    assert!((impact.time - fall).abs() < 1e-10);
    assert!((impact.speeds[1] - 0.5 * G * fall).abs() < 1e-9 && impact.speeds[2].abs() < 1e-12);
    first(&events, "rest");
}

/// What the theory does not cover is refused by name.
#[test]
fn striking_together_by_stiffness_is_refused_with_friction() {
    let body = block(0.3, 0.2);
    let refused = |options: Options| {
        let options = Options { together: ImpactsAtOnce::Lzb, ..options };
        let mut simulation = start(&body, &[0.0, 0.6, 0.0], &[0.0; 3], options);
        let error = simulation.advance_to(1.0).unwrap_err();
        assert_eq!(error.kind.name(), "lzb_not_covered");
        error.to_string()
    };
    assert!(refused(surface(0.3, 0.5, Law::Stronge)).contains("mu = 0.3"));
    assert!(refused(surface(0.0, 0.5, Law::Newton)).contains("law stronge"));
    let state =
        hodograph::State { time: 0.0, coordinates: &[0.0, 0.6, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    for (stiffness, what) in [
        ((0, 0.0), "stiffness is 0"),
        ((1, f64::NAN), "stiffness is NaN"),
        ((7, 1.0), "there is no contact with the number 7"),
    ] {
        let options = Options { stiffness: vec![stiffness], ..surface(0.0, 0.5, Law::Stronge) };
        let error = hodograph_simulation::Simulation::new(&body, &state, options).unwrap_err();
        assert!(error.to_string().contains(what), "{error}");
    }
}

/// On a belt the works of the contacts are not the change of kinetic energy, (24).
#[test]
fn the_energy_of_an_impact_of_two_contacts_on_a_belt_is_that_of_the_speeds() {
    let mut body =
        Body::new(1.0, 0.4, &[Line::floor(Part::Point(-0.5, -0.2)), Line::floor(Part::Point(0.7, -0.2))]);
    body.lines.iter_mut().for_each(|line| line.belt = 2.0);
    let (q, u) = ([0.0, 0.2, 0.0], [0.5, -1.0, 0.0]);
    let mut simulation = start(&body, &q, &u, surface(0.3, 0.5, Law::Newton));
    let event = match simulation.advance(1e-6).unwrap() {
        Progress::Event(event) => event,
        Progress::Reached => panic!("nothing strikes"),
    };
    let EventKind::SimultaneousCollision(struck) = &event.kind else { panic!("{event:?}") };
    let kinetic = |speeds: &[f64]| {
        let state = State { time: 0.0, coordinates: &q, speeds, inputs: &[0.0] };
        body.kinetic_energy(&state).unwrap()
    };
    let change = kinetic(&event.speeds) - kinetic(&struck.speeds_before);
    let works: f64 = struck.shares.iter().map(|share| share.work).sum();
    assert!((struck.energy_change - change).abs() < 1e-12, "{change} {struck:?}");
    assert!((works - change).abs() > 0.1, "the belt takes nothing: {works} {change}");
}
