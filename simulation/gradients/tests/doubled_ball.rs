//! A ball on an oscillating plate in numbers of twice the digits: two hundred bounces, beside which derivatives are held.

use hodograph::{Law, State};
use hodograph_gradients::{By, differentiate};
use hodograph_simulation::Options;

use crate::common::{options, read};
use crate::doubled_hopper::{Number, number};

/// 2 pi as the sum of two numbers.
const TURN: [f64; 2] = [std::f64::consts::TAU, 2.449_293_598_294_706_4e-16];
/// Terms of the series of sine and cosine up to pi / 16.
const TERMS: usize = 24;

/// Sine and cosine.
fn sin_cos(x: Number) -> (Number, Number) {
    let turns = number((x.rounded() / TURN[0]).round());
    let reduced = (x - turns * number(TURN[0]) - turns * number(TURN[1])) / number(16.0);
    let (mut sine, mut cosine, mut term) = (number(0.0), number(1.0), number(1.0));
    for order in 1..=TERMS {
        term = term * reduced / number(order as f64);
        let signed = if order % 4 >= 2 { -term } else { term };
        if order % 2 == 1 { sine = sine + signed } else { cosine = cosine + signed }
    }
    for _ in 0..4 {
        (sine, cosine) = (number(2.0) * sine * cosine, cosine * cosine - sine * sine);
    }
    (sine, cosine)
}

/// e, g, a and w.
type Constants = [Number; 4];

/// Height and speed at a time after the start at t = 0, and the times of the impacts.
fn motion([e, g, a, w]: Constants, start: [f64; 2], until: f64) -> ([Number; 2], Vec<Number>) {
    let (mut t, mut z, mut v) = (number(0.0), number(start[0]), number(start[1]));
    let mut impacts = Vec::new();
    let scan = 0.02 * TURN[0] / w.rounded();
    loop {
        let height = |tau: Number| z + v * tau - g * tau * tau / number(2.0);
        let gap = |tau: Number| height(tau) - a * sin_cos(w * (t + tau)).0;
        let mut tau = number(scan);
        while gap(tau).rounded() > 0.0 && (t + tau).rounded() < until {
            tau = tau + number(scan);
        }
        if gap(tau).rounded() > 0.0 {
            let rest = number(until) - t;
            return ([height(rest), v - g * rest], impacts);
        }
        for _ in 0..12 {
            let slope = v - g * tau - a * w * sin_cos(w * (t + tau)).1;
            tau = tau - gap(tau) / slope;
        }
        if (t + tau).rounded() > until {
            let rest = number(until) - t;
            return ([height(rest), v - g * rest], impacts);
        }
        let plate = a * w * sin_cos(w * (t + tau)).1;
        (z, v) = (height(tau), plate + e * (plate - (v - g * tau)));
        t = t + tau;
        impacts.push(t);
    }
}

#[test]
fn two_hundred_bounces_beside_doubled_digits() {
    let mechanism = read("ball_on_plate.mech");
    let (constants, start, until) = ([0.7, 9.81, 0.002, 60.0], [0.0068, -0.397], 21.0);
    let by = [By::Restitution(None), By::Parameter(1), By::Parameter(2), By::Parameter(3)];
    let state = State { time: 0.0, coordinates: &start[..1], speeds: &start[1..], inputs: &[] };
    let precise = Options {
        relative_tolerance: 1e-13,
        absolute_tolerance: 1e-15,
        ..options(0.0, constants[0], Law::Newton)
    };
    let found = differentiate(&mechanism, &state, precise, &by, &[until]).unwrap();
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    let derivative = found.samples[0].derivative.as_ref().unwrap();
    let (_, impacts) = motion(constants.map(number), start, until);
    assert!(impacts.len() >= 200 && impacts.len() == found.events.len(), "{}", impacts.len());
    let mut worst = [0.0_f64; 2];
    for column in 0..4 {
        let h = number(1e-10 * constants[column]);
        let moved = |h: Number| {
            let mut constants = constants.map(number);
            constants[column] = constants[column] + h;
            motion(constants, start, until)
        };
        let ((ahead, later), (behind, sooner)) = (moved(h), moved(-h));
        let slope = |a: Number, b: Number| ((a - b) / (h + h)).rounded();
        let states: Vec<f64> = ahead.iter().zip(&behind).map(|(a, b)| slope(*a, *b)).collect();
        let times: Vec<f64> = later.iter().zip(&sooner).map(|(a, b)| slope(*a, *b)).collect();
        let size = |numbers: &[f64]| numbers.iter().fold(0.0_f64, |size, number| size.max(number.abs()));
        for (row, exact) in states.iter().enumerate() {
            worst[0] = worst[0].max((derivative[(row, column)] - exact).abs() / size(&states));
        }
        for (event, exact) in found.events.iter().zip(&times) {
            let time = event.time.as_ref().unwrap()[column];
            worst[1] = worst[1].max((time - exact).abs() / size(&times));
        }
    }
    println!("{} bounces: derivatives of the state {:e}, of times {:e}", impacts.len(), worst[0], worst[1]);
    assert!(worst[0] < 1e-8 && worst[1] < 1e-8, "{worst:?}");
}
