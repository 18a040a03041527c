//! Discs that fall flat: the motion of the lowest point ends where that is no longer one point.

use crate::many::{Start, follow, model, numeric, surface};
use hodograph::Law;
use hodograph_simulation::{ErrorKind, EventKind, Simulation};

const G: f64 = 9.81;
const RADIUS: f64 = 0.05;
const MASS: f64 = 0.1;

/// A disc inclined by an angle that precesses about the vertical through its centre at rest, and rolls:
/// Omega^2 = 4 g / (r sin).
fn precessing(angle: f64, share: f64) -> Start {
    let disc = model("euler_disc");
    let mut start = Start::of(&disc);
    start.set(&disc, "e0", (0.5 * angle).cos());
    start.set(&disc, "e1", (0.5 * angle).sin());
    start.set(&disc, "z", RADIUS * angle.sin());
    start.set(&disc, "wy", share * (4.0 * G * angle.sin() / RADIUS).sqrt());
    start
}

/// Rims of shapes that fall flat: the lowest point of a rim is known to all digits until it is no longer one point.
#[test]
fn rims_of_shapes_fall_flat() {
    let (radius, angle) = (0.2_f64, 0.3_f64);
    let inclined = radius * angle.sin();
    for (shape, height) in [
        ("disc: r", inclined),
        ("cylinder: [r, l]", inclined + 0.05 * angle.cos()),
        ("torus: [r, h]", inclined + 0.02),
        ("cone: [r, l]", inclined),
    ] {
        let mechanism = numeric(
            &format!("rim-{}", &shape[..4]),
            &format!(
                "mechanism Rim;
                parameters {{
                    m: kg = 1, r: m = 0.2, l: m = 0.1, h: m = 0.02, J1: kg*m^2 = 0.012, J3: kg*m^2 = 0.02,
                    g: m/s^2 = 9.81,
                }}
                coordinates {{ x: m, y: m, z: m, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }}
                speeds {{ vx: m/s, vy: m/s, vz: m/s, w1: rad/s, w2: rad/s, w3: rad/s }}
                frames {{ B = N.quaternion(e0, e1, e2, e3); }}
                angular_velocities {{ B = w1*B.x + w2*B.y + w3*B.z; }}
                points {{ G = O + x*N.x + y*N.y + z*N.z; }}
                velocities {{ G = vx*N.x + vy*N.y + vz*N.z; }}
                bodies {{ Body {{ frame: B, centre: G, mass: m, inertia: [J1, J1, J3] }} }}
                shapes {{ S {{ of: Body, {shape}, axis: B.z }}, L {{ plane: N.z }} }}
                loads {{ gravity: -g*N.z; }}
                kinematics {{ d(x)/dt = vx; d(y)/dt = vy; d(z)/dt = vz; }}
                contacts {{ c {{ S on L }} }}"
            ),
        );
        for mu in [0.0, 0.4] {
            let (sin, cos) = (0.5 * angle).sin_cos();
            let start = Start {
                coordinates: vec![0.0, 0.0, height, cos, sin, 0.0, 0.0],
                speeds: vec![0.0; 6],
                inputs: Vec::new(),
            };
            let ends = [1e-12, 1e-9].map(|tolerance| {
                let mut options = surface(mu, 0.0, Law::Newton);
                (options.relative_tolerance, options.absolute_tolerance) = (tolerance, tolerance);
                follow(&mechanism, &start, options, 1.0)
            });
            for end in &ends {
                assert_eq!(end.outcome(), "singular", "{shape} {mu}: {:?} {:?}", end.error, end.names());
            }
            let [exact, near] = ends.map(|end| end.time);
            assert!((exact - near).abs() < 1e-6, "{shape} {mu}: {exact} {near}");
        }
    }
}

/// Without spin the disc turns about its lowest point like a pendulum and falls flat with the energy of its
/// height; the motion ends there, and says so.
#[test]
fn a_disc_falls_flat() {
    let disc = model("euler_disc");
    for (angle, mu) in [(0.3_f64, 1e3), (0.3, 0.3), (0.05, 1e3), (1.2, 1e3)] {
        let mut start = precessing(angle, 0.0);
        // Turned about the vertical, so that no coordinate vanishes.
        start.set(&disc, "e0", (0.5 * angle).cos() * 0.4_f64.cos());
        start.set(&disc, "e1", (0.5 * angle).sin() * 0.4_f64.cos());
        start.set(&disc, "e2", (0.5 * angle).sin() * 0.4_f64.sin());
        start.set(&disc, "e3", (0.5 * angle).cos() * 0.4_f64.sin());
        let end = follow(&disc, &start, surface(mu, 0.0, Law::Poisson), 2.0);
        assert_eq!(end.outcome(), "singular", "{angle} {mu}: {:?} {:?}", end.error, end.names());
        let height = end.coordinates[2];
        assert!(height.abs() < 1e-9 * RADIUS, "{angle} {mu}: {height:e}");
        assert!(end.account.abs() < 1e-10 * MASS * G * RADIUS, "{angle} {mu}: {:e}", end.account);
        if mu > 1.0 && angle < 1.0 {
            // From higher up it may lift off. Else it turns about a point of its rim: (5/4) m r^2 w^2 / 2 = m g r sin, w' = g cos / (5/4 r).
            let speed = (end.speeds[3].powi(2) + end.speeds[4].powi(2)).sqrt();
            let wanted = (2.0 * G * angle.sin() / (1.25 * RADIUS)).sqrt();
            assert!((speed / wanted - 1.0).abs() < 1e-6, "{angle}: {speed} {wanted}");
        }
    }
}

/// After its end a motion has no later state, and those of its last step remain.
#[test]
fn a_motion_that_has_ended_says_so() {
    let disc = model("euler_disc");
    let start = precessing(0.3, 0.0);
    let mut simulation = Simulation::new(&disc, &start.state(), surface(1e3, 0.0, Law::Poisson)).unwrap();
    let events = simulation.advance_to(1.0).unwrap();
    let last = events.last().unwrap();
    assert!(matches!(last.kind, EventKind::Singular), "{last:?}");
    assert_eq!((last.contact, simulation.time()), (Some(0), last.time));
    let error = simulation.advance(1.0).unwrap_err();
    assert_eq!((error.kind, error.contact.as_deref()), (ErrorKind::Singular, Some("rim")));
    assert_eq!(simulation.advance(0.5 * last.time).unwrap_err().kind.name(), "bad_option");
    assert!(simulation.advance(last.time).is_ok());
    assert_eq!(simulation.time(), last.time);
}

/// Without loss the disc goes on precessing with its centre at rest, at Omega^2 = 4 g / (r sin).
#[test]
fn a_disc_precesses_steadily() {
    let disc = model("euler_disc");
    let angle = 0.1_f64;
    let start = precessing(angle, 1.0);
    let lasts = 0.25;
    let end = follow(&disc, &start, surface(1.0, 0.0, Law::Poisson), lasts);
    assert_eq!(end.outcome(), "moves", "{:?} {:?}", end.error, end.names());
    assert!((end.coordinates[2] / start.coordinates[2] - 1.0).abs() < 1e-8, "{:?}", end.coordinates);
    let [e0, e1, e2, e3] = [3, 4, 5, 6].map(|i| end.coordinates[i]);
    // The axis of the disc, D.z along N.x and N.y, was along -N.y.
    let axis = [2.0 * (e0 * e2 + e1 * e3), 2.0 * (e2 * e3 - e0 * e1)];
    let turned = axis[0].atan2(-axis[1]);
    let turns = lasts * (4.0 * G / (RADIUS * angle.sin())).sqrt();
    let off = (turned.abs() - turns).rem_euclid(std::f64::consts::TAU);
    let other = (turned.abs() + turns).rem_euclid(std::f64::consts::TAU);
    let least = [off, other].map(|a| a.min(std::f64::consts::TAU - a)).into_iter().fold(9.0, f64::min);
    assert!(least < 1e-6, "{turned} {turns}: {least}");
}

/// Euler's disc: a torque of constant size against the rotation takes its energy. The disc rolls faster and
/// faster until it lies flat, after a finite time that tends to 3 (sin (r / g) / 4)^1/2 / mu, mu = torque over
/// m g r, as mu does to zero.
#[test]
fn eulers_disc_comes_to_its_finite_end() {
    let disc = model("euler_disc");
    let angle = 0.1_f64;
    let energy = 1.5 * MASS * G * RADIUS * angle.sin();
    let mut late = f64::INFINITY;
    for rolling in [0.2, 0.1, 0.05] {
        let mut start = precessing(angle, 1.0);
        start.set(&disc, "resist", rolling * MASS * G * RADIUS);
        let end = follow(&disc, &start, surface(1.0, 0.0, Law::Poisson), 3.0);
        assert_eq!(end.outcome(), "singular", "{rolling}: {:?} {:?}", end.error, end.names());
        assert!((end.before / energy - 1.0).abs() < 1e-12);
        assert!(end.coordinates[2] < 1e-9 * RADIUS, "{rolling}: {:?}", end.coordinates);
        assert!(end.account.abs() < 1e-10 * energy, "{rolling}: {:e}", end.account);
        let adiabatic = 3.0 * (0.25 * angle * RADIUS / G).sqrt() / rolling;
        let ratio = end.time / adiabatic;
        assert!(ratio > 1.0 && ratio - 1.0 < late && ratio < 1.6, "{rolling}: {ratio}");
        late = ratio - 1.0;
    }
}
