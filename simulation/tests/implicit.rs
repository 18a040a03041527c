//! Round shapes on implicit surfaces and on hills (docs/theory.md, 16.15).

use crate::common::{run, start, surface};
use crate::many::with_parameters;
use hodograph::Law;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Simulation;

const G: f64 = 9.81;

/// A model of the gallery.
fn shipped(name: &str) -> InterpretedMechanism {
    let path = format!("{}/../models/shapes/{name}.mech", env!("CARGO_MANIFEST_DIR"));
    InterpretedMechanism::read(path.as_ref()).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// By Runge and Kutta's method of order four.
fn after(rates: impl Fn([f64; 4]) -> [f64; 4], mut state: [f64; 4], time: f64) -> [f64; 4] {
    let steps = 20_000;
    let h = time / f64::from(steps);
    let moved = |s: [f64; 4], k: [f64; 4], h: f64| [0, 1, 2, 3].map(|i| s[i] + h * k[i]);
    for _ in 0..steps {
        let a = rates(state);
        let b = rates(moved(state, a, 0.5 * h));
        let c = rates(moved(state, b, 0.5 * h));
        let d = rates(moved(state, c, h));
        state = [0, 1, 2, 3].map(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    state
}

/// Without friction the middle of a marble in a channel moves as a point on the torus that is narrower by its radius.
#[test]
fn a_marble_in_a_channel_slides_as_a_point_on_a_torus() {
    let machine = shipped("marble_in_channel");
    let (ring, narrow) = (0.5, 0.12 - 0.03);
    // angles around the axis and around the channel, and their rates
    let rates = |[_, turn, around, rate]: [f64; 4]| {
        let (sin, cos) = turn.sin_cos();
        let away = ring + narrow * cos;
        let turned = -(away * sin * around * around + G * cos) / narrow;
        [around, rate, 2.0 * narrow * sin * rate * around / away, turned]
    };
    let first = [0.3, -1.2, 3.0, 2.0];
    let place = |[angle, turn, around, rate]: [f64; 4]| {
        let ((s, c), (sin, cos)) = (angle.sin_cos(), turn.sin_cos());
        let (away, out) = (ring + narrow * cos, -narrow * sin * rate);
        let at = [away * c, away * s, narrow * sin];
        (at, [out * c - away * s * around, out * s + away * c * around, narrow * cos * rate])
    };
    let (at, speed) = place(first);
    let q = [at[0], at[1], at[2], 1.0, 0.0, 0.0, 0.0];
    let u = [speed[0], speed[1], speed[2], 0.0, 0.0, 0.0];
    let mut simulation = start(&machine, &q, &u, surface(0.0, 0.0, Law::Newton));
    for step in 1..=5 {
        let time = 0.4 * f64::from(step);
        run(&mut simulation, time);
        assert!(simulation.phase(0).is_some(), "it is on the wall at {time}");
        let (at, speed) = place(after(rates, first, time));
        for i in 0..3 {
            let (q, u) = (simulation.coordinates()[i], simulation.speeds()[i]);
            assert!((q - at[i]).abs() < 1e-9, "{time}: {q} {}", at[i]);
            assert!((u - speed[i]).abs() < 1e-8, "{time}: {u} {}", speed[i]);
        }
    }
}

/// A ring without a radius is a hollow sphere: the marble falls, strikes, slips and rolls in it as in a bowl, whose contact
/// has a closed form.
#[test]
fn a_channel_without_a_ring_is_a_bowl() {
    let (r, c) = (0.1, 0.8);
    let own = [("R", 0.0), ("c", c), ("r", r), ("rho", 900.0)];
    let channel = with_parameters(&shipped("marble_in_channel"), &own);
    let bowl = shipped("ball_in_bowl");
    let q = [0.3, 0.1, 0.1, 1.0, 0.0, 0.0, 0.0];
    let u = [0.4, 0.5, 0.0, 1.0, -2.0, 3.0];
    let [mut a, mut b] =
        [&channel, &bowl].map(|machine| start(machine, &q, &u, surface(0.3, 0.5, Law::Poisson)));
    let (events, other) = (run(&mut a, 2.0), run(&mut b, 2.0));
    assert!(events.len() > 10 && events.len() == other.len(), "{} {}", events.len(), other.len());
    for (event, other) in events.iter().zip(&other) {
        assert!((event.time - other.time).abs() < 1e-9, "{event:?} {other:?}");
    }
    for (own, other) in a.coordinates().iter().zip(b.coordinates()) {
        assert!((own - other).abs() < 1e-8, "{own} {other}");
    }
}

/// A tyre that rolls upright along a hill is a wheel of the radius of its tread: its middle has the path at that distance
/// from the ground, and its energy is that of a mass larger by J/radius^2.
#[test]
fn an_upright_tyre_rolls_as_a_wheel_does() {
    let machine = shipped("tyre_on_hills");
    let (radius, h, k, m, inertia) = (0.3, 0.08, 3.0, 3.0, 0.2);
    let heavy = m / (m + inertia / (radius * radius));
    let ground = |x: f64| {
        let (sin, cos) = (k * x).sin_cos();
        let (slope, bend): (f64, f64) = (h * k * cos, -h * k * k * sin);
        (h * sin, slope, slope.hypot(1.0), bend)
    };
    let rates = |[x, v, ..]: [f64; 4]| {
        let (_, slope, s, bend) = ground(x);
        [v / (s - radius * bend / (s * s)), -heavy * G * slope / s, 0.0, 0.0]
    };
    let first = [0.2, 1.5, 0.0, 0.0];
    let middle = |x: f64| {
        let (level, slope, s, _) = ground(x);
        ([x - radius * slope / s, level + radius / s], [1.0 / s, slope / s])
    };
    let (at, along) = middle(first[0]);
    let q = [at[0], 0.0, at[1], 1.0, 0.0, 0.0, 0.0];
    let u = [first[1] * along[0], 0.0, first[1] * along[1], 0.0, first[1] / radius, 0.0];
    let mut simulation = start(&machine, &q, &u, surface(0.9, 0.0, Law::Newton));
    for step in 1..=5 {
        let time = 0.3 * f64::from(step);
        run(&mut simulation, time);
        let state = after(rates, first, time);
        let (at, along) = middle(state[0]);
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        for (i, own) in [0, 2].into_iter().enumerate() {
            assert!((q[own] - at[i]).abs() < 1e-9, "{time}: {} {}", q[own], at[i]);
            assert!((u[own] - state[1] * along[i]).abs() < 1e-8, "{time}: {}", u[own]);
        }
        assert!(q[1].abs() < 1e-9 && (u[4] - state[1] / radius).abs() < 1e-8, "{time}: {q:?} {u:?}");
    }
}

/// A tyre that is thrown on hills keeps its account of energy, whatever it does.
#[test]
fn tyres_on_hills_keep_their_energy() {
    let machine = shipped("tyre_on_hills");
    let (mut events, mut flat) = (0, 0);
    for throw in 0..20 {
        let turn = 0.3 * f64::from(throw);
        let (sin, cos) = (0.3 * turn.sin()).sin_cos();
        let q = [turn, 0.02 * turn, 0.6, cos, sin, 0.0, 0.0];
        let u = [1.0 + turn.sin(), 0.3, 0.0, 0.3 * turn.cos(), 5.0, 0.5];
        let mut simulation = start(&machine, &q, &u, surface(0.6, 0.4, Law::Poisson));
        let unworked = |simulation: &Simulation<'_>| {
            let account = simulation.energy().unwrap();
            account.total().unwrap() - account.friction - account.impacts - account.inputs
        };
        let before = unworked(&simulation);
        loop {
            match simulation.advance(1.0) {
                Ok(hodograph_simulation::Progress::Event(_)) => events += 1,
                Ok(hodograph_simulation::Progress::Reached) => break,
                // it has fallen over: a rim that lies flat touches everywhere
                Err(error) => {
                    println!("{throw}: {error} at {}", simulation.time());
                    flat += 1;
                    break;
                }
            }
        }
        let off = unworked(&simulation) - before;
        assert!(off.abs() < 1e-9, "{throw}: {off:e}");
    }
    println!("20 throws with {events} events, {flat} of which fell over");
    assert!(events > 40 && flat < 10, "{events} {flat}");
}
