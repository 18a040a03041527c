//! Errors of predictions: against closed forms of a ball that bounces on a plate at rest.

use hodograph::Law;
use hodograph_gradients::validation::{Measure, Noise, floor, noise_replicate, predict};
use hodograph_gradients::{By, Trajectory, with_values};
use hodograph_interpreter::InterpretedMechanism;
use nalgebra::DMatrix;

use crate::common::{options, read};

const G: f64 = 9.81;

/// The ball, above a plate that rests.
fn ball() -> InterpretedMechanism {
    let ball = read("simulation/gradients/tests/models/ball_on_plate.mech");
    let a = By::named(&ball, "a").unwrap();
    with_values(&ball, &options(0.0, 0.5, Law::Newton), &[a], &[0.0]).unwrap().0
}

/// The height of a ball that is dropped from h, until its second impact.
fn height(h: f64, e: f64, t: f64) -> f64 {
    let first = (2.0 * h / G).sqrt();
    let since = t - first;
    if since < 0.0 { h - 0.5 * G * t * t } else { e * G * first * since - 0.5 * G * since * since }
}

fn drop_from(h: f64, e: f64, steps: usize) -> Trajectory {
    let times: Vec<f64> = (1..=steps).map(|step| 0.01 * step as f64).collect();
    let samples = DMatrix::from_fn(steps, 1, |row, _| height(h, e, times[row]));
    Trajectory { name: format!("{h}"), start: 0.0, state: vec![h, 0.0], times, samples }
}

const MEASURE: Measure<'static> = Measure { measured: &[0], units: &[0.002] };

#[test]
fn a_prediction_is_the_motion_and_its_error_the_root_of_the_mean_square() {
    let drop = drop_from(0.2, 0.6, 30);
    let right = predict(&ball(), &options(0.0, 0.6, Law::Newton), MEASURE, &drop).unwrap();
    assert!((&right - &drop.samples).amax() < 1e-12);
    assert!(MEASURE.error(&drop.samples, &right) < 1e-9);
    // a constant difference of 3 mm in units of 2 mm; half of the samples missing change nothing
    let mut off = right.add_scalar(0.003);
    assert!((MEASURE.error(&drop.samples, &off) - 1.5).abs() < 1e-9);
    let mut some = drop.samples.clone();
    (0..15).for_each(|row| some[(2 * row, 0)] = f64::NAN);
    assert!((MEASURE.error(&some, &off) - 1.5).abs() < 1e-9);
    // of 4 differences 3, 0, 0, 0
    off = right.clone();
    off[(5, 0)] += 0.006;
    assert!((MEASURE.error(&drop.samples.rows(4, 4).into(), &off.rows(4, 4).into()) - 1.5).abs() < 1e-9);
    some.fill(f64::NAN);
    assert!(MEASURE.error(&some, &right).is_nan());
    // at rest it stays at its start
    let rest = MEASURE.at_rest(&drop);
    assert!(rest.nrows() == 30 && rest.iter().all(|z| *z == 0.2));
}

/// One restitution for two balls errs; each by itself has its own, and nothing is left.
#[test]
fn the_floor_is_what_the_best_values_of_one_motion_leave() {
    let (ball, options) = (ball(), options(0.0, 0.6, Law::Newton));
    for e in [0.55, 0.65] {
        let drop = drop_from(0.2, e, 30);
        let common = MEASURE.error(&drop.samples, &predict(&ball, &options, MEASURE, &drop).unwrap());
        assert!(common > 1.0, "{common}");
        let own = floor(&ball, &options, MEASURE, &[By::Restitution(None)], &drop).unwrap();
        assert!(own < 1e-6, "{own}");
    }
    // what e cannot explain stays: a wave at the samples, less its part along the derivative
    let mut drop = drop_from(0.2, 0.6, 30);
    (0..30).for_each(|row| drop.samples[(row, 0)] += 0.002 * (row as f64 * 1.9).sin());
    let wave = ((0..30).map(|row| (row as f64 * 1.9).sin().powi(2)).sum::<f64>() / 30.0).sqrt();
    let own = floor(&ball, &options, MEASURE, &[By::Restitution(None)], &drop).unwrap();
    assert!(own < wave && own > 0.9 * wave, "{own} {wave}");
}

/// In flight the error of the start height stays as it is: of the squared differences the mean is that of two
/// errors of measurement. An impact multiplies it.
#[test]
fn noise_alone_makes_the_errors_of_the_closed_form() {
    let (ball, options) = (ball(), options(0.0, 0.6, Law::Newton));
    let (error, count) = (2e-4, 400);
    let flight = drop_from(0.2, 0.6, 15);
    let measure = Measure { measured: &[0], units: &[error] };
    let mut noise = Noise::new(7);
    let mut square = |trajectory: &Trajectory| {
        let all = (0..count).map(|_| {
            noise_replicate(&ball, &options, measure, (trajectory, &[error]), &mut noise).unwrap().powi(2)
        });
        all.sum::<f64>() / f64::from(count)
    };
    // 1 from the start, with a standard error of sqrt(2/count), and 1 from the samples
    let found = square(&flight);
    assert!((found - 2.0).abs() < 4.0 * (2.0 / f64::from(count)).sqrt(), "{found}");
    // after the impact z = e v (t - t1) - g (t - t1)^2/2 with v = g t1, so that
    // dz/dh = (e g (t - 2 t1) + g (t - t1))/(g t1)
    let bounced = drop_from(0.2, 0.6, 35);
    let first = (0.4_f64 / G).sqrt();
    let by = |t: f64| if t < first { 1.0 } else { (0.6 * (t - 2.0 * first) + (t - first)) / first };
    let expected = 1.0 + bounced.times.iter().map(|t| by(*t).powi(2)).sum::<f64>() / 35.0;
    let found = square(&bounced);
    let spread = 4.0 * (2.0 / f64::from(count)).sqrt() * (expected - 1.0) + 0.02;
    assert!((found - expected).abs() < spread, "{found} {expected}");
}

#[test]
fn the_noise_is_normal() {
    let mut noise = Noise::new(3);
    let all: Vec<f64> = (0..200_000).map(|_| noise.normal()).collect();
    let n = all.len() as f64;
    let moment = |power: i32| all.iter().map(|x| x.powi(power)).sum::<f64>() / n;
    // 0, 1, 0, 3, with standard errors of sqrt(1, 2, 15, 96)/sqrt(n)
    for (power, expected, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
        let found = moment(power);
        assert!((found - expected).abs() < 4.0 * (variance / n).sqrt(), "{power}: {found}");
    }
    let beyond = all.iter().filter(|x| x.abs() > 1.959_964).count() as f64 / n;
    assert!((beyond - 0.05).abs() < 0.002, "{beyond}");
}
