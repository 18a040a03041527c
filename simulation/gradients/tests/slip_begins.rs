//! Slip in space that begins from zero: its direction settles ever faster towards its beginning.

use hodograph::Law;
use hodograph_gradients::By;
use nalgebra::{DMatrix, DVector};

use crate::common::{Task, read};

/// A puck that is pushed with a t along x and b + c t^2 along y.
fn pushed(values: [f64; 5], mu: f64) -> Task {
    let mut mechanism = read("pushed_puck.mech");
    hodograph::Mechanism::set_parameter_values(&mut mechanism, &values).unwrap();
    Task { mechanism, q: vec![0.0; 3], u: vec![0.0; 3], mu, e: 0.0, law: Law::Newton }
}

/// The exponential integral E_1(x) times e^x, for x > 1, by its continued fraction 1/(x + 1 - 1/(x + 3 - 4/(x + 5 - ..))).
fn scaled_exponential_integral(x: f64) -> f64 {
    let below = (1..400).rev().fold(0.0, |below, k| {
        let k = f64::from(k);
        k * k / (x + 2.0 * k + 1.0 - below)
    });
    1.0 / (x + 1.0 - below)
}

/// Pushed with a t along x, a puck slips from t_e = mu m g / a on: with tau = t - t_e its speed is a tau^2 / (2 m). A small
/// force b across turns it, m v' = b - c m v / tau^2 with c = 2 t_e: v = b (tau - c e^(c / tau) E_1(c / tau)) / m, whose series in
/// powers of tau converges nowhere.
#[test]
fn a_puck_is_pushed_until_it_slips() {
    let (m, g, a, mu) = (2.0, 9.81, 4.0, 0.3);
    let task = pushed([m, g, a, 0.0, 0.0], mu);
    let by = [By::Friction(None), By::Parameter(0), By::Parameter(1), By::Parameter(2), By::Parameter(3)];
    let begins = mu * m * g / a;
    let times = [begins + 1e-3, begins + 0.1, begins + 1.0];
    let found = task.differentiate(&by, &times);
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    let slip = found.events.iter().find(|event| event.event.kind.name() == "slip").unwrap();
    let exact = DVector::from_vec(vec![begins / mu, begins / m, begins / g, -begins / a, 0.0]);
    assert!((slip.time.as_ref().unwrap() - &exact).amax() < 1e-11 * exact.amax());
    let c = 2.0 * begins;
    let across =
        |tau: f64| if tau > 0.0 { (tau - c * scaled_exponential_integral(c / tau)) / m } else { 0.0 };
    for sample in &found.samples {
        let tau = sample.time - begins;
        // Simpson's rule for the way across
        let step = tau / 2000.0;
        let weight = |i: i32| {
            if i == 0 || i == 2000 {
                1.0
            } else if i % 2 == 1 {
                4.0
            } else {
                2.0
            }
        };
        let way: f64 = (0..=2000).map(|i| weight(i) * across(f64::from(i) * step)).sum::<f64>() * step / 3.0;
        let (square, cube) = (tau * tau / 2.0, tau * tau * tau / 6.0);
        let mut exact = DMatrix::zeros(6, 5);
        // by the time at which slip begins, and directly
        for (column, direct) in [0.0, -a / (m * m), 0.0, 1.0 / m].into_iter().enumerate() {
            let later = slip.time.as_ref().unwrap()[column];
            exact[(0, column)] = direct * cube - a / m * square * later;
            exact[(3, column)] = direct * square - a / m * tau * later;
        }
        (exact[(1, 4)], exact[(4, 4)]) = (way, across(tau));
        let by = sample.derivative.as_ref().unwrap();
        for column in 0..5 {
            let off = (by.column(column) - exact.column(column)).amax() / exact.column(column).amax();
            println!("{tau} {column} {off:e}");
            assert!(
                off < 1e-9,
                "{column} after {tau} s: {off:e} {}{}",
                by.column(column),
                exact.column(column)
            );
        }
    }
}

/// The push turns while the puck slips.
#[test]
fn a_puck_is_pushed_in_a_direction_that_turns() {
    let task = pushed([2.0, 9.81, 4.0, 1.5, 0.9], 0.3);
    let by = [
        (By::Friction(None), 1e-3),
        (By::Parameter(0), 1e-3),
        (By::Parameter(1), 1e-3),
        (By::Parameter(2), 1e-3),
        (By::Parameter(3), 1e-3),
        (By::Parameter(4), 1e-3),
    ];
    for until in [1.6, 2.5] {
        let compared = task.compare(&by, until);
        println!("{compared:?}");
        assert!(compared.events == 3 && compared.state < 1e-8 && compared.times < 1e-8, "{compared:?}");
    }
}

/// A box falls on a corner, which bounces, sticks and begins to slip in space while the box tumbles on.
#[test]
fn a_corner_begins_to_slip() {
    let mut task = Task {
        mechanism: read("simulation/models/tumbling_box.mech"),
        q: vec![0.0, 0.0, 0.69669, 0.96422, 0.31651, -0.84716, -0.1191],
        u: vec![0.5469, 0.1949, 1.978, -6.3844, -6.2887, -7.6351],
        mu: 0.46345,
        e: 0.0405,
        law: Law::Poisson,
    };
    hodograph::Mechanism::normalise(&task.mechanism.clone(), &mut task.q).unwrap();
    let compared = task.compare(&of_box(), 1.1);
    println!("{compared:?}");
    // The times of its slowest bounces are known to fewer digits in a difference.
    assert!(compared.events > 10 && compared.state < 2e-8, "{compared:?}");
}

/// A corner of a box bounces, slips and sticks: the direction in which its slip ends settles much faster than slip falls.
#[test]
fn a_corner_stops_in_a_direction_that_settles_fast() {
    let mut task = Task {
        mechanism: read("simulation/models/tumbling_box.mech"),
        q: vec![0.0, 0.0, 0.46972098, -0.095288, 0.682727, -0.151583, -0.250838],
        u: vec![1.3656226, -0.1476119, -1.9781008, -7.6533346, -4.1343669, -0.338506],
        mu: 0.5689046,
        e: 0.2413992,
        law: Law::Poisson,
    };
    hodograph::Mechanism::normalise(&task.mechanism.clone(), &mut task.q).unwrap();
    let compared = task.compare(&of_box(), 0.62);
    println!("{compared:?}");
    assert!(compared.events == 31 && compared.state < 1e-6, "{compared:?}");
}

/// Variables of the box with steps of differences.
fn of_box() -> [(By, f64); 7] {
    [
        (By::Friction(None), 1e-5),
        (By::Restitution(None), 1e-5),
        (By::Speed(0), 1e-5),
        (By::Speed(4), 1e-5),
        (By::Coordinate(2), 1e-5),
        (By::Parameter(1), 1e-5),
        (By::Parameter(4), 1e-4),
    ]
}
