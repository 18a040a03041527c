//! Motions that are not differentiable have no derivative, and say why.

use hodograph::{Law, State};
use hodograph_gradients::{By, GradientError, Reason, differentiate};
use hodograph_simulation::{ContactLaw, Options, Simulation};

use crate::common::{Task, options, read};

fn cube(q: [f64; 7], u: [f64; 6]) -> Task {
    let mechanism = read("simulation/models/measured_cube.mech");
    Task { mechanism, q: q.to_vec(), u: u.to_vec(), mu: 0.2, e: 0.4, law: Law::Poisson }
}

/// Four corners strike together.
#[test]
fn a_level_cube_has_no_derivative_from_its_impact_on() {
    let task = cube([0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0], [0.0; 6]);
    let found = task.differentiate(&[By::Coordinate(2), By::Restitution(None)], &[0.1, 0.5]);
    let why = found.undefined.as_ref().unwrap();
    assert_eq!(why.reason, Reason::AtOnce);
    assert!((why.time - (2.0 * (0.3_f64 - 0.0524) / 9.81).sqrt()).abs() < 1e-12);
    assert!(found.samples[0].derivative.is_some() && found.samples[1].derivative.is_none());
    assert!(why.to_string().contains("several contacts"), "{why}");
}

/// Where there is no derivative the states are still those of the motion, also where its forces are not unique: the cube
/// comes to rest on four corners. The states and the events are those of a simulation that is asked for nothing else.
#[test]
fn states_without_derivatives_are_those_of_the_motion() {
    for q in [[0.0, 0.0, 0.3, 1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.1, 1.0, 0.02, -0.01, 0.0]] {
        let mut task = cube(q, [0.4, 0.0, 0.0, 0.0, 0.0, 0.0]);
        hodograph::Mechanism::normalise(&task.mechanism.clone(), &mut task.q).unwrap();
        let times = [0.1, 0.25, 0.5, 0.8, 2.0];
        let found = task.differentiate(&[By::Friction(None), By::Speed(0)], &times);
        assert!(found.undefined.is_some());
        let start = State { time: 0.0, coordinates: &task.q, speeds: &task.u, inputs: &[] };
        let mut motion =
            Simulation::new(&task.mechanism, &start, options(task.mu, task.e, task.law)).unwrap();
        let mut events = 0;
        for (sample, time) in found.samples.iter().zip(times) {
            events += motion.advance_to(time).unwrap().len();
            let state = [motion.coordinates(), motion.speeds()].concat();
            let off = sample.state.iter().zip(&state).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-9, "{off} at {time}: {:?} {state:?}", sample.state);
        }
        assert_eq!((found.samples.len(), found.events.len()), (times.len(), events));
    }
}

/// A corner that strikes without slip: friction acts against slip that is not there, whatever its direction.
#[test]
fn a_collision_without_slip_has_no_derivative() {
    let mut task = cube([0.0, 0.0, 0.3, 0.9, 0.2, 0.3, 0.1], [0.0; 6]);
    hodograph::Mechanism::normalise(&task.mechanism.clone(), &mut task.q).unwrap();
    let found = task.differentiate(&[By::Speed(0)], &[0.5]);
    let why = found.undefined.unwrap();
    assert_eq!(why.reason, Reason::Impact(hodograph::NonSmoothness::NoSlip));
    // Along what makes no slip there is one.
    let found = task.differentiate(&[By::Coordinate(2)], &[0.24]);
    assert!(found.undefined.is_none() && found.events.len() == 1, "{:?}", found.undefined);
}

/// A ball that stays on the plate after a plastic collision: by e there is no derivative, by its height there is one.
#[test]
fn a_plastic_collision_has_no_derivative_by_e() {
    let mechanism = read("ball_on_plate.mech");
    let state = State { time: 0.0, coordinates: &[0.1], speeds: &[0.0], inputs: &[] };
    let by = |variable| {
        differentiate(&mechanism, &state, options(0.0, 0.0, Law::Newton), &[variable], &[0.2]).unwrap()
    };
    let found = by(By::Coordinate(0));
    assert!(found.undefined.is_none() && !found.events.is_empty(), "{:?}", found.undefined);
    assert_eq!(by(By::Restitution(None)).undefined.unwrap().reason, Reason::Plastic);
}

/// The derivative by the place where a force jumps is not that without the jump: from there on there is none.
#[test]
fn a_force_that_jumps_ends_the_derivatives() {
    let mechanism = read("jump.mech");
    let state = State { time: 0.0, coordinates: &[0.0], speeds: &[4.0], inputs: &[] };
    let by = [By::named(&mechanism, "a").unwrap(), By::Speed(0)];
    let found = differentiate(&mechanism, &state, Options::default(), &by, &[0.2, 0.5]).unwrap();
    let why = found.undefined.unwrap();
    assert!(matches!(why.reason, Reason::ForceJump { .. }) && (why.time - 0.25).abs() < 1e-9, "{why:?}");
    assert!(found.samples[0].derivative.is_some() && found.samples[1].derivative.is_none());
}

/// A ball that only just reaches the plate.
#[test]
fn grazing_has_no_derivative() {
    let mut mechanism = read("ball_on_plate.mech");
    hodograph::Mechanism::set_parameter_values(&mut mechanism, &[1.0, 9.81, 0.0, 60.0]).unwrap();
    let state = State { time: 0.0, coordinates: &[0.0], speeds: &[0.0], inputs: &[] };
    let found =
        differentiate(&mechanism, &state, options(0.0, 0.5, Law::Newton), &[By::Coordinate(0)], &[0.1]);
    // It lies on the plate, which it leaves or overlaps by its height.
    let why = found.unwrap().undefined.unwrap();
    assert_eq!(why.reason, Reason::StartInContact(By::Coordinate(0)));
}

#[test]
fn what_is_not_supported_says_so() {
    let mechanism = read("ball_on_plate.mech");
    let state = State { time: 0.0, coordinates: &[0.1], speeds: &[0.0], inputs: &[] };
    let law = ContactLaw { mu_static: Some(0.5), ..ContactLaw::default() };
    let options = Options { law: Some(law), ..options(0.3, 0.5, Law::Newton) };
    let found = differentiate(&mechanism, &state, options.clone(), &[By::Coordinate(0)], &[0.1]);
    assert!(matches!(found, Err(GradientError::NotSupported(_))));
    let options = Options { law: None, ..options };
    let found = differentiate(&mechanism, &state, options.clone(), &[By::Coordinate(0)], &[0.1, 0.05]);
    assert!(matches!(found, Err(GradientError::BadRequest(_))));
    let found = differentiate(&mechanism, &state, options, &[By::Coordinate(4)], &[0.1]);
    assert!(matches!(found, Err(GradientError::BadRequest(_))));
}

#[test]
fn variables_have_names() {
    let mechanism = read("ball_on_plate.mech");
    for (name, by) in [
        ("z", By::Coordinate(0)),
        ("u", By::Speed(0)),
        ("w", By::Parameter(3)),
        ("mu", By::Friction(None)),
        ("e.table", By::Restitution(Some(0))),
    ] {
        assert_eq!(By::named(&mechanism, name), Ok(by));
        assert_eq!(by.name(&mechanism), name);
    }
    let wrong = By::named(&mechanism, "e.floor").unwrap_err();
    assert!(wrong.contains("e.table"), "{wrong}");
}
