//! One contact: answers that are known in closed form.

use std::sync::Arc;

use crate::common::{Body, Line, Part, collisions, first, names, run, start, surface};

use hodograph::{Law, State};
use hodograph_simulation::{ContactPhase, Options, Simulation};

const G: f64 = 9.81;

fn particle() -> Body {
    Body::new(1.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))])
}

/// Every bounce of a ball, and the time at which its bounces end: t_1 (1 + e) / (1 - e).
#[test]
fn bounces_end_when_their_series_does() {
    for e in [0.3, 0.5, 0.8, 0.95] {
        let body = particle();
        let mut simulation = start(&body, &[0.0, 1.0, 0.0], &[0.0; 3], surface(0.0, e, Law::Newton));
        let fall = (2.0 / G).sqrt();
        let end = fall * (1.0 + e) / (1.0 - e);
        let events = run(&mut simulation, end + 1.0);
        let mut expected = fall;
        let mut flight = 2.0 * fall * e;
        for (k, time) in collisions(&events).iter().enumerate() {
            assert!((time - expected).abs() < 1e-10, "e = {e}, bounce {k}: {time} {expected}");
            expected += flight;
            flight *= e;
        }
        let contact = first(&events, "contact");
        assert!((contact.time - end).abs() < 1e-10, "e = {e}: {} {end}", contact.time);
        assert_eq!(first(&events, "rest").contact, None);
        assert_eq!(simulation.speeds(), [0.0; 3]);
        assert!(simulation.coordinates()[1].abs() < 1e-15);
    }
}

/// A function of the user that is no number ends the motion: it comes to no zero.
#[test]
fn event_functions_that_are_not_finite_are_refused() {
    let body = particle();
    for from in [0.0, 0.3] {
        let watched = move |time: f64, _: &[f64], _: &[f64]| if time < from { 1.0 } else { f64::NAN };
        let options = Options { events: vec![Arc::new(watched)], ..surface(0.0, 0.5, Law::Newton) };
        let state = State { time: 0.0, coordinates: &[0.0, 1.0, 0.0], speeds: &[0.0; 3], inputs: &[0.0] };
        let found = Simulation::new(&body, &state, options).and_then(|mut motion| motion.advance_to(1.0));
        let error = found.unwrap_err();
        assert!(error.to_string().contains("event function 0 is NaN"), "{error}");
    }
}

/// When the motion is looked at changes nothing.
#[test]
fn events_do_not_depend_on_output() {
    let body = particle();
    let begin = || start(&body, &[0.0, 1.0, 0.0], &[0.7, 0.0, 3.0], surface(0.2, 0.6, Law::Stronge));
    let whole = run(&mut begin(), 3.0);
    let mut often = begin();
    let mut seen = Vec::new();
    for k in 1..=3000 {
        seen.extend(run(&mut often, f64::from(k) * 1e-3));
    }
    assert_eq!(names(&whole), names(&seen));
    for (a, b) in whole.iter().zip(&seen) {
        assert_eq!(
            (a.time.to_bits(), &a.coordinates, &a.speeds),
            (b.time.to_bits(), &b.coordinates, &b.speeds)
        );
    }
    // A clone goes on as the original does.
    let mut one = begin();
    run(&mut one, 0.8);
    let mut two = one.clone();
    assert_eq!(names(&run(&mut one, 3.0)), names(&run(&mut two, 3.0)));
    assert_eq!(one.coordinates(), two.coordinates());
}

/// Ten thousand bounces without loss.
#[test]
fn elastic_bounces_keep_the_energy() {
    let body = particle();
    let mut simulation = start(&body, &[0.0, 1.0, 0.0], &[0.3, 0.0, 1.0], surface(0.0, 1.0, Law::Newton));
    let fall = (2.0 / G).sqrt();
    let before = simulation.energy().unwrap().total().unwrap();
    let events = run(&mut simulation, 20_000.5 * fall);
    assert_eq!(collisions(&events).len(), 10_000);
    let after = simulation.energy().unwrap().total().unwrap();
    assert!((after - before).abs() < 1e-12 * before, "{:e}", (after - before) / before);
    let last = collisions(&events)[9999];
    assert!((last - 19_999.0 * fall).abs() < 1e-8, "{:e}", last - 19_999.0 * fall);
}

/// A block that slides on a floor stops after v^2 / (2 mu g), and then does not creep.
#[test]
fn a_sliding_block_stops() {
    for mu in [0.1, 0.5, 1.2] {
        let body = particle();
        let mut simulation = start(&body, &[0.0; 3], &[2.0, 0.0, 0.0], surface(mu, 0.5, Law::Newton));
        let events = run(&mut simulation, 100.0);
        let stick = first(&events, "stick");
        assert!((stick.time - 2.0 / (mu * G)).abs() < 1e-10, "{} {}", stick.time, 2.0 / (mu * G));
        let expected = 4.0 / (2.0 * mu * G);
        assert!((simulation.coordinates()[0] - expected).abs() < 1e-10);
        let energy = simulation.energy().unwrap();
        assert!((energy.friction + 2.0).abs() < 1e-9, "{energy:?}");
    }
}

/// On an incline: sticks exactly if tan alpha <= mu, without any creep in 1e5 s; else it slides with g (sin
/// alpha - mu cos alpha).
#[test]
fn a_block_on_an_incline_sticks_or_slides() {
    for mu in [0.2_f64, 0.7, 1.5] {
        for factor in [0.5, 0.999_999, 1.0, 1.000_001, 1.5] {
            let alpha = (mu * factor).atan();
            let mut body = particle();
            body.lines[0].tilt = alpha;
            let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], surface(mu, 0.5, Law::Newton));
            if factor <= 1.0 {
                assert_eq!(simulation.phase(0), Some(ContactPhase::Stick));
                let events = run(&mut simulation, 1e5);
                assert!(names(&events).iter().all(|name| !name.starts_with("slip")), "{:?}", names(&events));
                assert_eq!(simulation.coordinates(), [0.0; 3], "mu = {mu}, {factor}");
            } else {
                assert_eq!(simulation.phase(0), Some(ContactPhase::Slide));
                run(&mut simulation, 2.0);
                let a = G * (alpha.sin() - mu * alpha.cos());
                let moved = simulation.coordinates()[0].hypot(simulation.coordinates()[1]);
                assert!((moved - 2.0 * a).abs() < 1e-9 * (1.0 + moved), "{moved} {}", 2.0 * a);
            }
        }
    }
}

/// A ball thrown with backspin slides, turns, and rolls at last with (5 v - 2 r w) / 7.
#[test]
fn a_ball_with_backspin_rolls_at_last() {
    let (m, r, mu) = (0.4, 0.11, 0.25);
    let body = Body::new(m, 0.4 * m * r * r, &[Line::floor(Part::Rim(r))]);
    for (v, w) in [(3.0, 20.0), (1.0, 60.0), (2.0, 0.0), (0.0, 30.0)] {
        // Theta turns from x to z: backspin of a ball that moves along x is positive.
        let mut simulation = start(&body, &[0.0, r, 0.0], &[v, 0.0, w], surface(mu, 0.5, Law::Stronge));
        let events = run(&mut simulation, 10.0);
        let stick = first(&events, "stick");
        let slip: f64 = v + r * w;
        let time = 2.0 * slip / (7.0 * mu * G);
        assert!((stick.time - time).abs() < 1e-10, "{} {time}", stick.time);
        let rolls = (5.0 * v - 2.0 * r * w) / 7.0;
        assert!((simulation.speeds()[0] - rolls).abs() < 1e-10, "{} {rolls}", simulation.speeds()[0]);
        assert!((simulation.speeds()[2] + rolls / r).abs() < 1e-9);
        let path = v * time - 0.5 * mu * G * time * time + rolls * (10.0 - time);
        assert!((simulation.coordinates()[0] - path).abs() < 1e-9);
    }
}
