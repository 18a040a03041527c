//! Inputs that are sampled: held between samples, at the exact times, and refused where they are no numbers.

use std::sync::{Arc, Mutex};

use crate::common::{Body, Line, Part, first, run, start, surface};
use hodograph::{Law, State};
use hodograph_simulation::{Drive, Options, Progress, Simulation};

const G: f64 = 9.81;

fn block() -> Body {
    Body::new(2.0, 1.0, &[Line::floor(Part::Point(0.0, 0.0))])
}

fn sampled(
    period: f64,
    controller: impl FnMut(f64, &[f64], &[f64], &mut [f64]) + Clone + Send + 'static,
) -> Drive {
    Drive::Sampled { period, controller: Box::new(controller) }
}

/// A controller that returns NaN, or infinity: the error has the time and the input's name, and what came
/// before can be had.
#[test]
fn an_input_that_is_no_number_is_an_error() {
    for bad in [f64::NAN, f64::INFINITY] {
        let drive = sampled(0.125, move |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
            inputs[0] = if t < 0.7 { 40.0 } else { bad };
        });
        let body = block();
        let options = Options { drive, ..surface(0.5, 0.5, Law::Newton) };
        let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], options);
        // Slip from the start on; what is before the error is not lost, not even by a call that runs into it.
        let a = 40.0 / 2.0 - 0.5 * G;
        let error = loop {
            match simulation.advance(2.0) {
                Ok(Progress::Event(event)) => assert_eq!(event.kind.name(), "contact"),
                Ok(Progress::Reached) => panic!("no error"),
                Err(error) => break error,
            }
        };
        assert_eq!((error.time, error.kind.name()), (0.75, "bad_input"));
        assert!(error.to_string().contains("at t = 0.75: the input F is "), "{error}");
        assert!(matches!(simulation.advance(0.75), Ok(Progress::Reached)));
        assert_eq!(simulation.time(), 0.75);
        assert!((simulation.coordinates()[0] - 0.5 * a * 0.75 * 0.75).abs() < 1e-10);
        // The error stays.
        assert_eq!(simulation.advance(0.8).unwrap_err(), error);
        assert_eq!(simulation.time(), 0.75);
    }
    // At the first sample there is no motion yet.
    let body = block();
    let drive = sampled(0.125, |_, _: &[f64], _: &[f64], inputs: &mut [f64]| inputs[0] = f64::NAN);
    let options = Options { drive, ..surface(0.5, 0.5, Law::Newton) };
    let state = State { time: 0.0, coordinates: &[0.0; 3], speeds: &[0.0; 3], inputs: &[0.0] };
    let error = Simulation::new(&body, &state, options).unwrap_err();
    assert_eq!((error.time, error.kind.name()), (0.0, "bad_input"));
}

/// The controller is called at k T exactly, with the state then, once each, however the motion is looked at;
/// inputs are held in between.
#[test]
fn samples_are_taken_at_their_times() {
    let period = 0.1;
    let calls: Arc<Mutex<Vec<(f64, f64, f64)>>> = Arc::default();
    let seen = Arc::clone(&calls);
    // Pushed to and fro by three times the friction.
    let push = move |t: f64| if ((t / period).round() as i64) % 4 < 2 { 30.0 } else { -30.0 };
    let drive = sampled(period, move |t, q: &[f64], u: &[f64], inputs: &mut [f64]| {
        seen.lock().unwrap().push((t, q[0], u[0]));
        inputs[0] = push(t);
    });
    let body = block();
    let options = Options { drive, ..surface(0.5, 0.5, Law::Newton) };
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], options);
    let mut looked = Vec::new();
    for k in 1..=57 {
        run(&mut simulation, 0.037 * f64::from(k));
        looked.push((simulation.time(), simulation.coordinates()[0], simulation.speeds()[0]));
    }
    let calls = calls.lock().unwrap().clone();
    for (k, call) in calls.iter().enumerate() {
        assert_eq!(call.0, k as f64 * period, "sample {k}");
    }
    // By hand: in each period constant acceleration, with a turn of slip where the velocity vanishes.
    let (mut x, mut v) = (0.0, 0.0);
    let exact = |x: f64, v: f64, force: f64, mut dt: f64| -> (f64, f64) {
        let (mut x, mut v) = (x, v);
        if v * force < 0.0 {
            let a = force / 2.0 + 0.5 * G * force.signum();
            let stop = -v / a;
            if stop >= dt {
                return (x + v * dt + 0.5 * a * dt * dt, v + a * dt);
            }
            x += 0.5 * v * stop;
            v = 0.0;
            dt -= stop;
        }
        let a = force / 2.0 - 0.5 * G * force.signum();
        (x + v * dt + 0.5 * a * dt * dt, v + a * dt)
    };
    for call in &calls {
        assert!((call.1 - x).abs() < 1e-10 && (call.2 - v).abs() < 1e-10, "{call:?} {x} {v}");
        for (time, at, speed) in &looked {
            if *time >= call.0 && *time < call.0 + period {
                let (x, v) = exact(x, v, push(call.0), time - call.0);
                assert!((at - x).abs() < 1e-10 && (speed - v).abs() < 1e-10, "{time}: {at} {x}");
            }
        }
        (x, v) = exact(x, v, push(call.0), period);
    }
}

/// A sample that releases a block: it begins to slip at that sample, not before.
#[test]
fn a_sample_makes_a_block_slip_at_once() {
    let drive = sampled(0.25, |t, _: &[f64], _: &[f64], inputs: &mut [f64]| {
        inputs[0] = if t < 0.9 { 9.8 } else { 9.82 };
    });
    let body = block();
    let options = Options { drive, ..surface(0.5, 0.5, Law::Newton) };
    let mut simulation = start(&body, &[0.0; 3], &[0.0; 3], options);
    let events = run(&mut simulation, 2.0);
    assert_eq!(first(&events, "slip").time, 1.0);
    let moved = 0.5 * (0.01 / 2.0);
    assert!((simulation.coordinates()[0] - moved).abs() < 1e-12, "{}", simulation.coordinates()[0]);
}
