//! What a simulation refuses, and what it says of times at which it has been: nothing wrong is told in silence.

use std::sync::Arc;

use crate::common::{Body, Line, Part, run, start, surface};
use crate::many::numeric;

use hodograph::{Cause, Law, State};
use hodograph_simulation::{ErrorKind, ImpactsAtOnce, Options, Progress, Simulation};
use press::Press;

hodograph::mechanism!("tests/models/press.mech");

fn particle() -> Body {
    Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))])
}

#[test]
fn a_start_at_no_time_is_refused() {
    let body = particle();
    for time in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let state = State { time, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
        let found = Simulation::new(&body, &state, surface(0.0, 0.5, Law::Newton));
        let error = found.expect_err("no motion begins at no time");
        assert!(matches!(error.kind, ErrorKind::Argument { cause: Cause::NotFinite, .. }), "{error}");
        assert!(error.to_string().contains("the time of the start is"), "{error}");
    }
}

#[test]
fn tolerances_without_a_digit_are_refused() {
    let body = particle();
    for (relative, absolute) in [
        (f64::INFINITY, 1e-9),
        (1e300, 1e-9),
        (0.5, 1e-9),
        (f64::NAN, 1e-9),
        (1e-9, f64::INFINITY),
        (1e-17, 1e-9),
    ] {
        let options = Options {
            relative_tolerance: relative,
            absolute_tolerance: absolute,
            ..surface(0.0, 0.5, Law::Newton)
        };
        let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
        let error = Simulation::new(&body, &state, options).expect_err("such a tolerance means nothing");
        assert!(matches!(&error.kind, ErrorKind::BadOption(text) if text.contains("tolerance")), "{error}");
    }
}

/// A press comes down on a ball that lies on the floor: no impulses stop it, whatever the hypothesis and the order.
#[test]
fn what_prescribed_motion_leaves_no_room_is_an_error_with_its_contacts() {
    let press = Press::<f64>::default();
    for law in [Law::Newton, Law::Poisson, Law::Stronge] {
        for together in [ImpactsAtOnce::Approaching, ImpactsAtOnce::Simultaneous, ImpactsAtOnce::Sequential] {
            for (mu, e) in [(0.2, 0.3), (0.0, 0.0)] {
                let options = Options { together, ..surface(mu, e, law) };
                let mut simulation = start(&press, &[0.0, 0.1], &[0.0; 2], options);
                let error = simulation.advance_to(1.0).unwrap_err();
                assert!((error.time - 0.5).abs() < 1e-9, "{law:?} {together:?}: {error}");
                let words = "floor, press leave what lies between them no room";
                assert!(error.to_string().contains(words), "{law:?} {together:?}: {error}");
            }
        }
    }
}

/// A normal that points down, under a gap that grows upwards: what separates along one falls through the other, first by
/// less than a step can tell.
#[test]
fn a_gap_that_does_not_belong_to_its_normal_is_told_soon() {
    let stone = numeric(
        "turned",
        "mechanism Turned; parameters { m: kg = 2, g: m/s^2 = 9.81 } coordinates { x: m, y: m } speeds { ux: m/s, uy: m/s }
        points { P = O + x*N.x + y*N.y; } particles { Stone { point: P, mass: m } } loads { gravity: -g*N.y; }
        kinematics { d(x)/dt = ux; d(y)/dt = uy; } contacts { ground { point: P of Stone, normal: -N.y, gap: y } }",
    );
    for up in [0.2, 0.0, -0.1] {
        let options = surface(0.2, 0.0, Law::Newton);
        let mut simulation = start(&stone, &[0.0; 2], &[0.3, up], options);
        let error = simulation.advance_to(0.5).unwrap_err();
        assert!(matches!(error.kind, ErrorKind::GapRate { .. }) && error.time < 1e-3, "{up}: {error}");
    }
}

/// States are kept for the last step alone: an earlier time is refused, and not answered by the state of another.
#[test]
fn times_before_the_last_step_are_refused() {
    let body = particle();
    let mut simulation = start(&body, &[0.0, 1.0, 0.0], &[0.0; 3], surface(0.0, 0.5, Law::Newton));
    run(&mut simulation, 3.0);
    let before = (simulation.time(), simulation.coordinates().to_vec());
    let error = simulation.advance(0.1).expect_err("its state is not kept");
    assert!(matches!(&error.kind, ErrorKind::BadOption(text) if text.contains("not kept")), "{error}");
    assert_eq!((simulation.time(), simulation.coordinates().to_vec()), before);
    // the time at which it is, and later ones, are answered
    assert!(matches!(simulation.advance(3.0), Ok(Progress::Reached)));
    run(&mut simulation, 3.1);
    assert_eq!(simulation.time(), 3.1);
}

/// A ball that falls is not at rest, although the step that is known reaches to where it lies.
#[test]
fn a_body_is_at_rest_only_when_it_is() {
    let body = particle();
    let mut simulation = start(&body, &[0.0, 0.5, 0.0], &[0.0; 3], surface(0.3, 0.0, Law::Newton));
    let lies = (2.0 * 0.5 / 9.81_f64).sqrt();
    for k in 1..40 {
        let time = 0.01 * f64::from(k);
        run(&mut simulation, time);
        assert_eq!(simulation.is_at_rest(), time > lies, "{time}");
    }
}

/// A function of the user is seen whatever its unit.
#[test]
fn event_functions_are_seen_whatever_their_size() {
    let body = particle();
    for scale in [1.0, 1e-10, 1e-16, 1e-100, 1e100] {
        let watched = move |_: f64, q: &[f64], _: &[f64]| scale * (q[1] - 0.6);
        let options = Options { events: vec![Arc::new(watched)], ..surface(0.0, 0.5, Law::Newton) };
        let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
        let mut simulation = Simulation::new(&body, &state, options).unwrap();
        let events = run(&mut simulation, 0.4);
        assert_eq!(events.len(), 1, "{scale:e}");
        assert!((events[0].time - (0.8 / 9.81_f64).sqrt()).abs() < 1e-13, "{scale:e}: {}", events[0].time);
    }
}

/// Where a gap has no value, the error says so.
#[test]
fn a_gap_without_a_value_is_told() {
    let fall = numeric(
        "sunk",
        "mechanism Sunk;
        parameters { m: kg = 1, l: m = 1, g: m/s^2 = 9.81 }
        coordinates { y: m = 0.5 }
        speeds { v: m/s }
        points { P = O + y*N.y; }
        particles { Q { point: P, mass: m } }
        loads { gravity: -g*N.y; }
        kinematics { d(y)/dt = v; }
        contacts { strike { point: P, normal: N.y, gap: 0.1*l + sqrt(l*y) } }",
    );
    let state = State { time: 0.0, coordinates: &[0.5], speeds: &[0.0], inputs: &[] };
    let mut simulation = Simulation::new(&fall, &state, surface(0.0, 0.5, Law::Newton)).unwrap();
    let error = simulation.advance_to(1.0).expect_err("the gap has no value below the floor");
    assert!(matches!(error.kind, ErrorKind::State(_)), "{error}");
}
