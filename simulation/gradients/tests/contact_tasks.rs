//! Three tasks with gradients in closed form, by which Y. D. Zhong, J. Han and G. O. Brikis compared simulators: "Differentiable
//! physics simulations with contacts: do they have correct gradients w.r.t. position, velocity and control?" (2022). A ball
//! bounces once; a ball is thrown against the ground and a wall, to hit a target; a ball is pushed against another one.

use hodograph::{Law, Mechanism, State};
use hodograph_gradients::{Adjoint, By, MotionGradient, differentiate};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Drive, Options, Samples};
use nalgebra::{DVector, Matrix2, Vector2};

use crate::common::{compare, options, read};

/// Without friction and losses, with inputs in a table.
fn driven(period: f64, values: Vec<Vec<f64>>) -> Options {
    Options {
        drive: Drive::Table(Samples { period, values: values.into() }),
        ..options(0.0, 1.0, Law::Newton)
    }
}

/// Forwards and backwards.
fn both(
    mechanism: &InterpretedMechanism,
    state: &State<'_>,
    options: &Options,
    by: &[By],
    until: f64,
) -> MotionGradient {
    let found = differentiate(mechanism, state, options.clone(), by, &[until]).unwrap();
    assert!(found.undefined.is_none(), "{:?}", found.undefined);
    compare(&found, &Adjoint::new(mechanism, state, options.clone(), by, &[until]).unwrap());
    found
}

/// Without gravity the height after the bounce is -(z + v T) and what the force adds, turned back.
#[test]
fn a_ball_bounces_once() {
    let mut mechanism = read("pushed_ball.mech");
    mechanism.set_parameter_values(&[1.0, 0.0, 50.0]).unwrap();
    let (period, until) = (1.0 / 480.0, 1.0);
    let options = driven(period, vec![vec![0.0, 0.0]; 480]);
    let start = State { time: 0.0, coordinates: &[0.0, 1.0], speeds: &[1.0, -2.0], inputs: &[0.0; 2] };
    let rows = [0, 100, 300];
    let mut by = vec![By::Coordinate(0), By::Coordinate(1), By::Speed(0), By::Speed(1)];
    by.extend(rows.map(|row| By::Sample { input: 1, row }));
    let found = both(&mechanism, &start, &options, &by, until);
    let height = found.samples[0].derivative.as_ref().unwrap().row(1).transpose();
    // Before the bounce, at 1/2 s, a push v dt acts for the rest of the time and is turned back; after it, it is not.
    let push = |row: usize| {
        let acts = period * (until - period * (row as f64 + 0.5));
        if row < 240 { -acts } else { acts }
    };
    let exact = DVector::from_iterator(7, [0.0, -1.0, 0.0, -until].into_iter().chain(rows.map(push)));
    assert!((&height - &exact).amax() < 1e-13, "{height}");
}

/// Newton's method with these gradients finds the throw that hits a target, after the ground and the wall, in a few steps.
#[test]
fn a_throw_hits_its_target_by_ground_and_wall() {
    let mechanism = read("pushed_ball.mech");
    let (g, wall, until, z) = (9.81_f64, 1.0, 0.9, 0.6_f64);
    let options = options(0.0, 1.0, Law::Newton);
    let end = |v: &Vector2<f64>| {
        let speeds = [v.x, v.y];
        let start = State { time: 0.0, coordinates: &[0.0, z], speeds: &speeds, inputs: &[0.0; 2] };
        let found = both(&mechanism, &start, &options, &[By::Speed(0), By::Speed(1)], until);
        let names: Vec<_> = found.events.iter().map(|event| event.event.contact).collect();
        assert!(names.contains(&Some(0)) && names.contains(&Some(1)), "{names:?}");
        let by = found.samples[0].derivative.as_ref().unwrap();
        let state = &found.samples[0].state;
        // In closed form: s is the speed at the ground, tau the time since.
        let s = (v.y * v.y + 2.0 * g * z).sqrt();
        let tau = until - (v.y + s) / g;
        let slope = v.y / s * tau - (s - g * tau) * (1.0 + v.y / s) / g;
        let exact = Matrix2::new(-until, 0.0, 0.0, slope);
        let matrix = Matrix2::from_fn(|row, column| by[(row, column)]);
        assert!((matrix - exact).amax() < 1e-12, "{matrix}{exact}");
        assert!((state[0] - (2.0 * wall - v.x * until)).abs() < 1e-12);
        (Vector2::new(state[0], state[1]), matrix)
    };
    let target = Vector2::new(0.65, 0.55);
    let mut v = Vector2::new(1.2, 0.3);
    let mut off = f64::INFINITY;
    for step in 0..8 {
        let (there, matrix) = end(&v);
        off = (there - target).norm();
        println!("{step}: {off:e}");
        if off < 1e-12 {
            break;
        }
        v -= matrix.try_inverse().unwrap() * (there - target);
    }
    assert!(off < 1e-12, "{off:e}");
}

/// A ball is pushed against another one, which goes on with its speed: where it ends, by each sample of the push.
#[test]
fn a_ball_is_pushed_against_another_one() {
    let mechanism = read("pushed_balls.mech");
    let (period, until, count) = (1.0 / 48.0, 1.0, 48_usize);
    let push: Vec<f64> = (0..count).map(|k| 1.5 * (0.3 * k as f64).cos()).collect();
    let options = driven(period, push.iter().map(|f| vec![*f]).collect());
    let start = State { time: 0.0, coordinates: &[0.0, 0.6], speeds: &[0.8, 0.0], inputs: &[0.0] };
    let by: Vec<By> = (0..count).map(|row| By::Sample { input: 0, row }).collect();
    let found = both(&mechanism, &start, &options, &by, until);
    // The first ball on its own, up to the time at which it has come by 0.5.
    let (mut t, mut x, mut v, mut k) = (0.0, 0.0_f64, 0.8_f64, 0);
    while x + v * period + 0.5 * push[k] * period * period < 0.5 {
        x += v * period + 0.5 * push[k] * period * period;
        v += push[k] * period;
        t += period;
        k += 1;
    }
    let part = (-v + (v * v + 2.0 * push[k] * (0.5 - x)).sqrt()) / push[k];
    let (struck, speed) = (t + part, v + push[k] * part);
    let end = 0.6 + speed * (until - struck);
    assert!((found.samples[0].state[1] - end).abs() < 1e-13, "{} {end}", found.samples[0].state[1]);
    let own = found.samples[0].derivative.as_ref().unwrap().row(1).transpose();
    for row in 0..count {
        // A sample that acts before the impact changes place and speed there, and with the place the time.
        let acts = (struck - period * row as f64).clamp(0.0, period);
        let place = acts * (struck - period * row as f64 - 0.5 * acts);
        let later = -place / speed;
        let faster = acts + push[k] * later;
        let exact = faster * (until - struck) - speed * later;
        assert!((own[row] - exact).abs() < 1e-13, "{row}: {} {exact}", own[row]);
    }
    assert!(own[0] > 1e-3 && own[count - 1] == 0.0);
}
