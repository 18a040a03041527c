//! Motions whose derivatives are known in closed form.

use hodograph::Law;
use hodograph_gradients::By;
use nalgebra::{DMatrix, DVector};

use crate::common::{Task, read};

fn rows(rows: &[&[f64]]) -> DMatrix<f64> {
    DMatrix::from_row_slice(rows.len(), rows[0].len(), &rows.concat())
}

fn vector(numbers: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(numbers)
}

fn close(found: &DMatrix<f64>, exact: &DMatrix<f64>, tolerance: f64) {
    let off = (found - exact).amax() / exact.amax();
    assert!(off < tolerance, "{found}{exact}off by {off:e}");
}

/// Two balls of the same mass exchange their velocities: the right one goes on where the left one would have been.
#[test]
fn two_balls_change_places() {
    let task = Task {
        mechanism: read("two_balls.mech"),
        q: vec![0.0, 0.5],
        u: vec![1.0, 0.0],
        mu: 0.0,
        e: 1.0,
        law: Law::Newton,
    };
    let by = [By::Coordinate(0), By::Coordinate(1), By::Speed(0), By::Speed(1)];
    let found = task.differentiate(&by, &[1.0]);
    let exact =
        rows(&[&[0.0, 1.0, 0.0, 1.0], &[1.0, 0.0, 1.0, 0.0], &[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, 1.0, 0.0]]);
    close(found.samples[0].derivative.as_ref().unwrap(), &exact, 1e-14);
    // They touch at t = (x2 - x1 - d) / (u1 - u2).
    let time = found.events[0].time.as_ref().unwrap();
    assert!((time - vector(&[-1.0, 1.0, -0.4, 0.4])).amax() < 1e-14, "{time}");
}

/// The times t_k = t_1 (1 + 2 e + .. + 2 e^k) of the bounces of a ball that is dropped from h, t_1 = (2 h / g)^(1/2), and
/// the speeds e^k g t_1 after them.
#[test]
fn a_ball_bounces_twenty_times() {
    let mut mechanism = read("ball_on_plate.mech");
    hodograph::Mechanism::set_parameter_values(&mut mechanism, &[1.0, 9.81, 0.0, 60.0]).unwrap();
    let (h, g, e) = (0.1, 9.81, 0.9_f64);
    let task = Task { mechanism, q: vec![h], u: vec![0.0], mu: 0.0, e, law: Law::Poisson };
    let first = (2.0 * h / g).sqrt();
    let sum = |k: i32| 1.0 + 2.0 * (1..=k).map(|j| e.powi(j)).sum::<f64>();
    let slope = |k: i32| 2.0 * (1..=k).map(|j| f64::from(j) * e.powi(j - 1)).sum::<f64>();
    let until = first * (sum(19) + e.powi(20));
    let found = task.differentiate(&[By::Coordinate(0), By::Parameter(1), By::Restitution(None)], &[until]);
    assert!(found.undefined.is_none() && found.events.len() == 20, "{:?}", found.undefined);
    for (event, k) in found.events.iter().zip(0..) {
        let time = event.time.as_ref().unwrap();
        let exact = vector(&[first * sum(k) / (2.0 * h), -first * sum(k) / (2.0 * g), first * slope(k)]);
        assert!((time - &exact).amax() < 1e-12 * exact.amax(), "{k}: {}", time - exact);
        let speed = e.powi(k + 1) * g * first;
        let exact = vector(&[speed / (2.0 * h), speed / (2.0 * g), f64::from(k + 1) * e.powi(k) * g * first]);
        let after = event.after.as_ref().unwrap().row(1).transpose();
        assert!((&after - &exact).amax() < 1e-12 * exact.amax(), "{k}: {}", after - exact);
    }
    // Half a bounce later it is at the top: its height is e^40 h.
    let end = found.samples[0].derivative.as_ref().unwrap();
    let time = |column: usize| match column {
        0 => until / (2.0 * h),
        1 => -until / (2.0 * g),
        _ => first * (slope(19) + 20.0 * e.powi(19)),
    };
    // z = v tau - g tau^2 / 2 with tau = until - t_20: at the top z does not change with tau.
    let exact = rows(&[&[e.powi(40), 0.0, 40.0 * e.powi(39) * h], &[g * time(0), g * time(1), g * time(2)]]);
    close(end, &exact, 1e-11);
}

/// A puck that slides in a plane: it stops after s / (mu g), half that time times its velocity away. In space no function
/// changes its sign where slip ends.
#[test]
fn a_puck_comes_to_rest() {
    let mut mechanism = read("simulation/tests/models/puck_on_incline.mech");
    hodograph::Mechanism::set_parameter_values(&mut mechanism, &[2.0, 9.81, 0.0]).unwrap();
    let (g, mu, v) = (9.81, 0.3, [0.6_f64, -0.8_f64]);
    let task = Task { mechanism, q: vec![0.0; 3], u: vec![v[0], v[1], 0.0], mu, e: 0.0, law: Law::Newton };
    let by = [By::Speed(0), By::Speed(1), By::Friction(None), By::Parameter(1), By::Coordinate(0)];
    let found = task.differentiate(&by, &[0.2, 1.0]);
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    let stick = found.events.iter().find(|event| event.event.kind.name() == "stick").unwrap();
    let end = 1.0 / (mu * g);
    let exact = vector(&[v[0] * end, v[1] * end, -end / mu, -end / g, 0.0]);
    let time = stick.time.as_ref().unwrap();
    assert!((time - &exact).amax() < 1e-9, "{}", time - exact);
    // x = v s / (2 mu g)
    let c = 0.5 * end;
    let row = |i: usize, j: usize| if i == j { c * (1.0 + v[i] * v[j]) } else { c * v[i] * v[j] };
    let mut exact = DMatrix::zeros(6, 5);
    for i in 0..2 {
        for j in 0..2 {
            exact[(i, j)] = row(i, j);
        }
        exact[(i, 2)] = -c * v[i] / mu;
        exact[(i, 3)] = -c * v[i] / g;
    }
    exact[(0, 4)] = 1.0;
    close(found.samples[1].derivative.as_ref().unwrap(), &exact, 1e-9);
    // While it slides: v (1 - mu g t / s), with s = 1.
    let t = 0.2;
    let (d, f) = (mu * g * t, v);
    let sliding = found.samples[0].derivative.as_ref().unwrap();
    for i in 0..2 {
        for j in 0..2 {
            let own = if i == j { 1.0 - d } else { 0.0 };
            assert!((sliding[(3 + i, j)] - (own + d * f[i] * f[j])).abs() < 1e-11);
        }
        assert!((sliding[(3 + i, 2)] + g * t * f[i]).abs() < 1e-11);
    }
}

/// A block between a spring and a wall turns 9 times, each time 2 mu m g / k nearer to where it sticks: its amplitudes are
/// x - 2 j mu m g / k, half a period apart.
#[test]
fn a_block_turns_until_it_sticks() {
    let task = Task {
        mechanism: read("block_on_spring.mech"),
        q: vec![0.5, 0.0],
        u: vec![0.0; 2],
        mu: 0.06,
        e: 0.0,
        law: Law::Newton,
    };
    let (m, k, g, mu, x) = (2.0_f64, 50.0, 9.81, 0.06, 0.5_f64);
    let by = [By::Coordinate(0), By::Friction(None), By::Parameter(0), By::Parameter(1), By::Parameter(2)];
    let found = task.differentiate(&by, &[8.0]);
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    let step = 2.0 * mu * m * g / k;
    // It sticks where abs(x) <= mu m g / k = step / 2.
    let turns = ((x - step / 2.0) / step).ceil();
    let sign = if (turns as usize).is_multiple_of(2) { 1.0 } else { -1.0 };
    let c = sign * turns * step;
    let exact = rows(&[&[sign, -c / mu, -c / m, c / k, -c / g]]);
    let end = found.samples[0].derivative.as_ref().unwrap().row(0).into_owned();
    let off = (DMatrix::from_row_slice(1, 5, end.transpose().as_slice()) - &exact).amax();
    assert!(turns == 11.0 && off < 1e-9, "{turns} turns, off by {off:e}: {end} {exact}");
    let half = std::f64::consts::PI * (m / k).sqrt();
    let last = found.events.iter().rfind(|event| event.time.is_some()).unwrap();
    assert!((last.event.time - turns * half).abs() < 1e-9);
    let time = last.time.as_ref().unwrap();
    let exact = vector(&[0.0, 0.0, turns * half / (2.0 * m), -turns * half / (2.0 * k), 0.0]);
    assert!((time - &exact).amax() < 1e-7 * exact.amax(), "{time}{exact}");
}
