//! Bodies in three dimensions on real contacts: a cube on its edge, three balls in a row, a rattleback that
//! reverses.

use crate::common::{first, first_collision, names, run, start, surface};
use cradle::Cradle;
use hodograph::{Contacts, Law, Mechanism, State};
use hodograph_models::rattleback;
use hodograph_simulation::{ContactPhase, Options};
use rattleback_on_floor::RattlebackOnFloor;
use tumbling_box::TumblingBox;

hodograph::mechanism!("models/cradle.mech");
hodograph::mechanism!("models/rattleback_on_floor.mech");
hodograph::mechanism!("models/tumbling_box.mech");

const G: f64 = 9.81;

/// A cube of side 2 a.
fn cube(a: f64) -> TumblingBox<f64> {
    let mut body = TumblingBox::<f64>::default();
    body.set_parameter_values(&[2.0, a, a, a, G]).unwrap();
    body
}

/// Turned about B.y so far that it stands on the edge of c2 and c4.
fn on_edge(a: f64, angle: f64) -> Vec<f64> {
    let height = a * (angle.sin() + angle.cos());
    vec![0.0, 0.0, height, (0.5 * angle).cos(), 0.0, (0.5 * angle).sin(), 0.0]
}

/// A cube that falls from its edge without slip meets the ground with w^2 = 3 g (cos d - cos 45) / (2 R), R =
/// a sqrt 2. What two corners that strike at once do next is not determined by rigid bodies; it comes to
/// rest, and its energy is accounted for.
#[test]
fn a_cube_falls_from_its_edge() {
    let a = 0.2;
    let body = cube(a);
    for lean in [0.02_f64, 0.1, 0.4] {
        let q = on_edge(a, std::f64::consts::FRAC_PI_4 - lean);
        let mut simulation = start(&body, &q, &[0.0; 6], surface(3.0, 0.0, Law::Poisson));
        assert_eq!(simulation.phase(1), Some(ContactPhase::Stick));
        let events = run(&mut simulation, 3.0);
        let (strike, before) = first_collision(&events);
        let last = events.iter().rfind(|event| event.time == strike.time).expect("that event");
        let radius = a * 2.0_f64.sqrt();
        let w = (1.5 * G / radius * (lean.cos() - 0.5_f64.sqrt())).sqrt();
        assert!(
            (before[4].abs() - w).abs() < 1e-9 && before[3].abs() < 1e-12,
            "{lean}: {before:?} {w} {:?}",
            names(&events)
        );
        assert!(last.speeds[4].abs() < w);
        first(&events, "rest");
        let energy = simulation.energy().unwrap();
        let start = 2.0 * G * radius * lean.cos();
        let account = (energy.total().unwrap() - energy.friction - energy.impacts - start) / start;
        assert!(account.abs() < 1e-10, "{lean}: {account:e}");
        assert!((simulation.coordinates()[2] - a).abs() < 1e-11);
    }
}

/// Balanced on its edge it stays, for no torque turns it.
#[test]
fn a_cube_balances_on_its_edge() {
    let a = 0.2;
    let body = cube(a);
    let q = on_edge(a, std::f64::consts::FRAC_PI_4);
    let mut simulation = start(&body, &q, &[0.0; 6], surface(0.5, 0.0, Law::Poisson));
    let events = run(&mut simulation, 1e3);
    assert_eq!(simulation.coordinates(), q, "{:?}", names(&events));
    first(&events, "rest");
}

/// What one impact after the other gives for balls in a row, by hand.
fn row(masses: [f64; 3], e: f64, speeds: [f64; 3]) -> [f64; 3] {
    let mut u = speeds;
    for _ in 0..100_000 {
        let approach = [u[0] - u[1], u[1] - u[2]];
        let i = usize::from(approach[1] > approach[0]);
        if approach[i] < 1e-13 {
            break;
        }
        let (m, n) = (masses[i], masses[i + 1]);
        let impulse = (1.0 + e) * approach[i] * m * n / (m + n);
        u[i] -= impulse / m;
        u[i + 1] += impulse / n;
    }
    u
}

/// Newton's cradle: three balls, two of which touch. Elastic and equal, the last goes off with all the
/// momentum.
#[test]
fn three_balls_in_a_row() {
    let mut body = Cradle::<f64>::default();
    for (masses, e) in
        [([1.0, 1.0, 1.0], 1.0), ([1.0, 1.0, 1.0], 0.7), ([1.0, 3.0, 0.5], 1.0), ([2.0, 0.4, 1.0], 0.9)]
    {
        body.set_parameter_values(&[masses[0], masses[1], masses[2], 0.1]).unwrap();
        let mut simulation = start(&body, &[-0.2, 0.0, 0.1], &[1.0, 0.0, 0.0], surface(0.0, e, Law::Newton));
        let events = run(&mut simulation, 0.11);
        let expected = row(masses, e, [1.0, 0.0, 0.0]);
        assert!((first(&events, "collision").time - 0.1).abs() < 1e-13);
        for (speed, expected) in simulation.speeds().iter().zip(expected) {
            assert!(
                (speed - expected).abs() < 1e-9,
                "{masses:?} {e}: {:?} {expected:?}",
                simulation.speeds()
            );
        }
        let momentum: f64 = simulation.speeds().iter().zip(masses).map(|(u, m)| u * m).sum();
        assert!((momentum - masses[0]).abs() < 1e-13);
        if masses == [1.0; 3] && e == 1.0 {
            assert!(simulation.speeds().iter().zip([0.0, 0.0, 1.0]).all(|(u, e)| (u - e).abs() < 1e-15));
        }
    }
}

/// The rattleback on a real contact reverses its spin as the constrained model does, whose motion it shares
/// while it sticks.
#[test]
fn a_rattleback_reverses_on_a_real_contact() {
    let rolling = rattleback::Rattleback::<f64>::default();
    let free = RattlebackOnFloor::<f64>::default();
    let (mut q, mut u) = (rattleback::Coordinates::default(), rattleback::Speeds::default());
    (q.q2, q.q3) = (0.01, 0.02);
    (u.u1, u.u2, u.u3) = (0.1, 0.2, -5.0);
    // The height at which it touches.
    for _ in 0..3 {
        q.q6 -= rolling.configuration_residual(&q).unwrap()[0];
    }
    let v = rolling.velocity_g(&q, &u).unwrap();
    let six = [q.q1, q.q2, q.q3, q.q4, q.q5, q.q6];
    let exact = |mu| Options {
        relative_tolerance: 1e-14,
        absolute_tolerance: 1e-14,
        ..surface(mu, 0.0, Law::Newton)
    };
    let mut constrained = start(&rolling, &six, &[u.u1, u.u2, u.u3], exact(0.0));
    let all = [u.u1, u.u2, u.u3, v.x, v.y, v.z];
    let mut real = start(&free, &six, &all, exact(3.0));
    assert_eq!(real.phase(0), Some(ContactPhase::Stick));
    let (mut worst, mut spins) = (0.0_f64, Vec::new());
    for k in 1..=40 {
        let t = 0.1 * f64::from(k);
        run(&mut constrained, t);
        let events = run(&mut real, t);
        assert!(events.iter().all(|event| event.kind.name() == "contact"), "{:?}", names(&events));
        let q = constrained.coordinates().iter().zip(real.coordinates());
        let u = constrained.speeds().iter().zip(real.speeds());
        for (a, b) in q.chain(u) {
            worst = worst.max((a - b).abs());
        }
        spins.push(real.speeds()[2]);
    }
    println!("a rattleback reverses: apart from the rolling model by {worst:.1e} after 4 s");
    assert!(spins[0] < -4.0 && spins.iter().any(|spin| *spin > 1.0), "{spins:?}");
    assert!(worst < 5e-10, "{worst:e}");
    let state = State { time: 0.0, coordinates: real.coordinates(), speeds: real.speeds(), inputs: &[] };
    assert!(free.gap(0, &state).unwrap().unwrap().abs() < 1e-12);
}
