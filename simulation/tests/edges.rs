//! Starts and questions at the edge of what is allowed: none may hang, panic, or give what is not so.

use crate::common::{Body, Line, Part, collisions, first, names, run, start, surface};
use crate::many::{Start, follow, model};
use hodograph::{Cause, Contacts, Law, State, Surface};
use hodograph_simulation::{ContactPhase, Drive, Options, Progress, Simulation};

const G: f64 = 9.81;

fn particle() -> Body {
    Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))])
}

/// Times that are no times, and times whose states are not kept.
#[test]
fn times_asked_for_are_checked() {
    let body = particle();
    let mut simulation = start(&body, &[0.0, 1.0, 0.0], &[0.0; 3], surface(0.1, 0.5, Law::Newton));
    assert!(matches!(simulation.advance(0.0), Ok(Progress::Reached)));
    let bad = [
        (-1.0, "not kept"),
        (f64::NAN, "must be finite"),
        (f64::INFINITY, "must be finite"),
        (f64::NEG_INFINITY, "must be finite"),
    ];
    for (bad, what) in bad {
        let error = simulation.advance(bad).unwrap_err();
        assert_eq!(error.kind.name(), "bad_option");
        assert!(error.to_string().contains(what), "{error}");
        assert_eq!((simulation.time(), simulation.coordinates()[1]), (0.0, 1.0));
    }
    // Refused questions change nothing.
    let events = run(&mut simulation, 2.0);
    assert!((collisions(&events)[0] - (2.0 / G).sqrt()).abs() < 1e-12);
}

/// Starts at, a little above and a little below the surface.
#[test]
fn starts_that_touch() {
    let body = particle();
    for gap in [0.0, 5e-10, -5e-10] {
        let mut simulation = start(&body, &[0.0, gap, 0.0], &[1.0, 0.0, 0.0], surface(0.3, 0.5, Law::Newton));
        assert_eq!(simulation.phase(0), Some(ContactPhase::Slide), "{gap:e}");
        let events = run(&mut simulation, 1.0);
        assert!((first(&events, "stick").time - 1.0 / (0.3 * G)).abs() < 1e-9, "{gap:e}");
        assert!(simulation.coordinates()[1].abs() < 1e-15, "{gap:e}");
        assert!(collisions(&events).is_empty());
        // One that approaches collides at once, one that leaves leaves.
        let mut simulation =
            start(&body, &[0.0, gap, 0.0], &[0.0, -1.0, 0.0], surface(0.3, 0.5, Law::Newton));
        let events = run(&mut simulation, 0.05);
        assert!((collisions(&events)[0] - gap.max(0.0)).abs() < 1e-12, "{gap:e}: {:?}", names(&events));
        let mut simulation = start(&body, &[0.0, gap, 0.0], &[0.0, 1.0, 0.0], surface(0.3, 0.5, Law::Newton));
        let events = run(&mut simulation, 0.3);
        assert!((collisions(&events)[0] - 2.0 / G).abs() < 1e-8, "{gap:e}: {:?}", names(&events));
    }
    let state = State { time: 0.0, coordinates: &[0.0, -1e-6, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    let error = Simulation::new(&body, &state, surface(0.3, 0.5, Law::Newton)).unwrap_err();
    assert_eq!((error.kind.name(), error.contact.as_deref()), ("overlap", Some("c0")));
}

/// Without weight nothing presses: a body that touches stays or slides on without force, and one that is
/// pulled leaves at once.
#[test]
fn contact_without_weight() {
    let mut body = particle();
    body.gravity = [0.0, 0.0];
    let mut simulation = start(&body, &[0.0; 3], &[1.0, 0.0, 0.0], surface(0.5, 0.5, Law::Newton));
    run(&mut simulation, 10.0);
    assert!((simulation.coordinates()[0] - 10.0).abs() < 1e-12 && simulation.coordinates()[1].abs() < 1e-12);
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], surface(0.5, 0.5, Law::Newton));
    run(&mut simulation, 10.0);
    assert_eq!(simulation.coordinates(), [0.0; 3]);
    body.gravity = [0.0, 2.0];
    let mut simulation = start(&body, &[0.0; 3], &[1.0, 0.0, 0.0], surface(0.5, 0.5, Law::Newton));
    run(&mut simulation, 1.0);
    assert!((simulation.coordinates()[1] - 1.0).abs() < 1e-12);
}

/// At the angle of friction and a billionth beside it.
#[test]
fn inclines_next_to_the_angle_of_friction() {
    for mu in [0.1_f64, 0.6, 1.3] {
        for off in [-1e-9, 0.0, 1e-9] {
            let alpha = (mu * (1.0 + off)).atan();
            let mut body = particle();
            body.lines[0].tilt = alpha;
            let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], surface(mu, 0.5, Law::Newton));
            run(&mut simulation, 100.0);
            let moved = simulation.coordinates()[0].hypot(simulation.coordinates()[1]);
            if off > 0.0 {
                assert_eq!(simulation.phase(0), Some(ContactPhase::Slide));
                let expected = 0.5 * G * mu * off * alpha.cos() * 1e4;
                assert!((moved / expected - 1.0).abs() < 1e-5, "{mu}: {moved:e} {expected:e}");
            } else {
                assert_eq!(moved, 0.0, "{mu} {off:e}");
            }
        }
    }
}

/// A body that just reaches a ceiling, or misses it by little, or strikes it by little.
#[test]
fn touches_that_graze() {
    let mut body = particle();
    body.lines[0].tilt = std::f64::consts::PI;
    body.lines[0].offset = -1.0;
    for off in [-1e-9, -1e-13, 0.0, 1e-13, 1e-9, 1e-6] {
        let v = (2.0 * G * (1.0 + off)).sqrt();
        let mut simulation = start(&body, &[0.0; 3], &[0.0, v, 0.0], surface(0.0, 1.0, Law::Newton));
        let events = run(&mut simulation, v / G * 2.0);
        // CollisionRecord or not, an elastic graze comes back with the same speed, sooner by the time it would have
        // been above.
        let above = if off > 0.0 { 2.0 * (2.0 * off / G).sqrt() } else { 0.0 };
        let z = simulation.coordinates()[1];
        assert!((z + v * above).abs() < 2e-6 * v, "{off:e}: {z:e} {:?}", names(&events));
        if off >= 1e-9 || off <= -1e-9 {
            assert_eq!(collisions(&events).len(), usize::from(off > 0.0), "{off:e}");
            assert!(
                (z + v * above + 0.5 * G * above * above).abs() < 1e-9 + 2.0 * off.abs(),
                "{off:e}: {z:e}"
            );
        }
    }
}

/// Late starts: times are as exact as a double can say.
#[test]
fn motions_may_begin_late() {
    let body = particle();
    for begin in [-50.0, 1e3, 1e6] {
        let state =
            State { time: begin, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.3, 0.0, 0.0], inputs: &[0.0] };
        let mut simulation = Simulation::new(&body, &state, surface(0.2, 0.5, Law::Newton)).unwrap();
        let fall = (2.0 / G).sqrt();
        let events = run(&mut simulation, begin + 3.0);
        let error = (collisions(&events)[0] - begin - fall).abs();
        assert!(error < 1e-12 + 2.0 * f64::EPSILON * begin.abs(), "{begin}: {error:e}");
        let error = (first(&events, "contact").time - begin - 3.0 * fall).abs();
        assert!(error < 1e-10 + 100.0 * f64::EPSILON * begin.abs(), "{begin}: {error:e}");
        first(&events, "rest");
    }
}

/// Bodies of a millimetre and of a kilometre, a milligram and a thousand tonnes.
#[test]
fn sizes_and_masses_of_all_kinds() {
    for (length, mass) in [(1e-3, 1e-6), (1e3, 1e6), (1.0, 1e-6), (1.0, 1e6)] {
        let (half, b) = (0.3 * length, 0.1 * length);
        let inertia = mass * (half * half + b * b) / 3.0;
        let body = Body::new(
            mass,
            inertia,
            &[Line::floor(Part::Point(-half, -b)), Line::floor(Part::Point(half, -b))],
        );
        let drop = 0.5 * length;
        let mut simulation = start(&body, &[0.0, b + drop, 0.0], &[0.0; 3], surface(0.4, 0.3, Law::Stronge));
        let fall = (2.0 * drop / G).sqrt();
        let events = run(&mut simulation, 10.0 * fall);
        assert!((collisions(&events)[0] - fall).abs() < 1e-10 * fall.max(1.0), "{length} {mass}");
        first(&events, "rest");
        assert!((simulation.coordinates()[1] - b).abs() < 1e-11 * length.max(1.0), "{length} {mass}");
        assert!(simulation.coordinates()[2].abs() < 1e-9, "{length} {mass}");
        let energy = simulation.energy().unwrap();
        let before = mass * G * (b + drop);
        let account = (energy.total().unwrap() - energy.friction - energy.impacts - before) / before;
        assert!(account.abs() < 1e-8, "{length} {mass}: {account:e}");
    }
}

/// Perfectly elastic and perfectly plastic impacts with and without friction, and a ball at rest that is
/// pulled away and let go by a continuous input.
#[test]
fn a_body_is_lifted_and_let_go() {
    // Its line is a wall, and the input pulls it off and pushes it back: F = sin t, positive is away from the
    // wall x = 0.
    let mut body = particle();
    body.gravity = [0.0, 0.0];
    body.lines[0].tilt = std::f64::consts::FRAC_PI_2;
    let drive = Drive::Continuous(std::sync::Arc::new(|t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        inputs[0] = -f64::cos(t);
    }));
    let options = Options { drive, max_step: 0.5, ..surface(0.0, 0.0, Law::Newton) };
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], options);
    let events = run(&mut simulation, 8.0);
    // -cos t presses until pi / 2; then x' = 1 - sin t, x = t - pi/2 + cos t until it comes back, never: x'
    // >= 0.
    let off = first(&events, "lift_off");
    assert!((off.time - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{}", off.time);
    assert!(collisions(&events).is_empty(), "{:?}", names(&events));
    let x = 8.0 - std::f64::consts::FRAC_PI_2 + f64::cos(8.0);
    assert!((simulation.coordinates()[0] - x).abs() < 1e-9, "{} {x}", simulation.coordinates()[0]);
}

/// Surfaces at their limits.
#[test]
fn surfaces_at_their_limits() {
    let body = particle();
    for (mu, e) in [(0.0, 0.0), (0.0, 1.0), (1e6, 0.0), (1e6, 1.0), (0.5, 0.999)] {
        for law in [Law::Newton, Law::Poisson, Law::Stronge] {
            let mut simulation = start(&body, &[0.0, 0.2, 0.0], &[0.4, 0.0, 0.0], surface(mu, e, law));
            let before = simulation.energy().unwrap().total().unwrap();
            run(&mut simulation, 5.0);
            let energy = simulation.energy().unwrap();
            let account = energy.total().unwrap() - energy.friction - energy.impacts - before;
            assert!(account.abs() < 1e-10 * before, "{mu} {e} {law:?}: {account:e}");
            assert!(energy.impacts <= 1e-13 * before && energy.friction <= 0.0);
        }
    }
    let state = State { time: 0.0, coordinates: &[0.0; 3], speeds: &[0.0; 3], inputs: &[0.0] };
    for (mu, e, cause) in [
        (-0.1, 0.5, Cause::NegativeFriction),
        (f64::NAN, 0.5, Cause::NotFinite),
        (f64::INFINITY, 0.5, Cause::NotFinite),
        (0.5, -0.1, Cause::RestitutionOutOfRange),
        (0.5, 1.1, Cause::RestitutionOutOfRange),
        (0.5, f64::NAN, Cause::NotFinite),
    ] {
        let surface = Surface { mu, e, law: Law::Newton };
        let options = Options { surface: Some(surface), ..Options::default() };
        let body: &dyn Contacts<f64> = &body;
        assert_eq!(Simulation::new(body, &state, options).unwrap_err().kind.name(), cause.name());
    }
}

/// A push of a millisecond acts in full although no step is bounded: its times are told. Times that do not
/// rise are refused.
#[test]
fn pushes_whose_times_are_told_are_not_stepped_over() {
    let mut body = particle();
    body.gravity = [0.0, 0.0];
    let push = |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        inputs[0] = 2000.0 * (1.0 - f64::abs(t - 3.0001) / 0.0005).max(0.0);
    };
    let options = |breaks: &[f64]| Options {
        drive: Drive::Continuous(std::sync::Arc::new(push)),
        breaks: breaks.to_vec(),
        ..surface(0.0, 0.0, Law::Newton)
    };
    let mut simulation =
        start(&body, &[0.0, 1.0, 0.0], &[0.0; 3], options(&[-1.0, 2.9996, 3.0001, 3.0006, 9.0]));
    run(&mut simulation, 8.0);
    let speed = simulation.speeds()[0];
    assert!((speed - 1.0).abs() < 1e-10, "{speed}");
    let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    for bad in [&[1.0, 1.0][..], &[2.0, 1.0], &[f64::NAN], &[0.0, f64::INFINITY]] {
        let error = Simulation::new(&body, &state, options(bad)).unwrap_err();
        assert_eq!(error.kind.name(), "bad_option", "{bad:?}");
        assert!(error.to_string().contains("finite and rise"), "{error}");
    }
}

/// A pull that rises from t = 0.5 on, slowly or steeply, drags a resting particle when it exceeds friction:
/// then v = k (t - t1)^2 / (2 m).
#[test]
fn a_steep_pull_begins_to_slip_once() {
    let mut body = particle();
    body.mass = 2.0;
    for (rate, told) in
        [1.0, 30.0, 1e3, 1e5, 1e6, 1e7, 1e9].into_iter().flat_map(|rate| [(rate, true), (rate, false)])
    {
        let pull = move |t: f64, _: &[f64], _: &[f64], inputs: &mut [f64]| {
            inputs[0] = rate * (t - 0.5).max(0.0);
        };
        let options = Options {
            drive: Drive::Continuous(std::sync::Arc::new(pull)),
            breaks: if told { vec![0.5] } else { Vec::new() },
            ..surface(0.5, 0.0, Law::Newton)
        };
        let mut simulation = start(&body, &[0.0, 0.0, 0.0], &[0.0; 3], options);
        let (mass, limit) = (body.mass, 0.5 * body.mass * 9.81);
        let begins = 0.5 + limit / rate;
        let end = begins + 0.1;
        let events = run(&mut simulation, end);
        let slips: Vec<f64> =
            events.iter().filter(|event| event.kind.name() == "slip").map(|event| event.time).collect();
        assert!(
            slips.len() == 1 && (slips[0] - begins).abs() < 1e-9,
            "{rate:e} {told}: {slips:?} {begins} {:?}",
            names(&events)
        );
        let speed = simulation.speeds()[0];
        let expected = 0.5 * rate * 0.01 / mass;
        assert!((speed / expected - 1.0).abs() < 1e-6, "{rate:e} {told}: {speed} {expected}");
    }
}

/// A particle that is far away along the floor strikes it on time: its gap is not rounded for that.
#[test]
fn far_places_do_not_round_the_gap() {
    let body = particle();
    let fall = (2.0 / G).sqrt();
    for x in [1e5, 1e10, 1e16] {
        let mut simulation = start(&body, &[x, 1.0, 0.0], &[0.0; 3], surface(0.2, 0.5, Law::Newton));
        let events = run(&mut simulation, 0.6);
        assert!((collisions(&events)[0] - fall).abs() < 1e-12, "{x:e}: {:?}", names(&events));
    }
}

/// A particle that is fast along the floor strikes it on time too.
#[test]
fn speeds_along_the_floor_do_not_hide_it() {
    let body = particle();
    let fall = (2.0 / G).sqrt();
    for speed in [1e3, 1e5] {
        let mut simulation =
            start(&body, &[0.0, 1.0, 0.0], &[speed, 0.0, 0.0], surface(0.0, 0.5, Law::Newton));
        let events = run(&mut simulation, 0.6);
        assert!((collisions(&events)[0] - fall).abs() < 1e-12, "{speed:e}: {:?}", names(&events));
    }
}

/// No step is short enough for a tolerance below the rounding of its numbers: refused.
#[test]
fn tolerances_below_rounding_are_refused() {
    let body = particle();
    let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
    for tolerance in [1e-22, 1e-30] {
        let options = Options { relative_tolerance: tolerance, ..surface(0.2, 0.5, Law::Newton) };
        let error = Simulation::new(&body, &state, options).unwrap_err();
        assert!(error.to_string().contains("the least tolerance is 1e-16"), "{error}");
    }
}

/// The rollers of this model drive along the horizontal, also where the plank is inclined: its gap has another rate than its
/// normal velocity there.
#[test]
fn a_gap_that_does_not_belong_to_the_normal_is_named() {
    let plank = model("plank_rollers");
    let mut start = Start::of(&plank);
    for (name, value) in [("zb", 0.15), ("qb", -0.2), ("uzb", -0.5)] {
        start.set(&plank, name, value);
    }
    let end = follow(&plank, &start, surface(0.5, 0.3, Law::Stronge), 1.0);
    let error = end.error.expect("the gap is another one");
    assert_eq!(error.kind.name(), "gap_rate", "{error}");
    assert!(error.to_string().contains("does not belong to the normal"), "{error}");
}
