//! Lines that meet flush: the point of contact is undefined, and the motion ends there with the account of its energy
//! right (docs/theory.md, section 17.16).

use hodograph::Law;
use hodograph_simulation::{EventKind, Options, Progress, Simulation};

use crate::common::{run, start, surface};
use crate::many::numeric;

/// Kinetic and potential energy, and the same less what impacts and friction have changed.
fn energies(simulation: &Simulation<'_>) -> [f64; 2] {
    let account = simulation.energy().unwrap();
    let all = account.kinetic + account.potential.unwrap();
    [all, all - account.impacts - account.friction]
}

/// The events of a motion that ends with `singular`.
fn until_singular(simulation: &mut Simulation<'_>) {
    let mut last = None;
    while !simulation.has_ended() {
        match simulation.advance(1.0).unwrap() {
            Progress::Event(event) => last = Some(event.kind),
            Progress::Reached => break,
        }
    }
    assert!(matches!(last, Some(EventKind::Singular)), "{last:?}");
}

/// A capsule falls on one that lies on the floor, and turns on it through parallel: the place of contact would run to the other
/// end within 1e-10 s. A part of the energy was lost there, without a word.
#[test]
fn capsules_that_turn_through_parallel_end_with_their_energy() {
    let capsules = numeric(
        "capsules",
        "mechanism Capsules;
        part Log() {
            parameters { shared m: kg, shared J: kg*m^2 }
            coordinates { x: m, y: m, q: rad }
            speeds { vx: m/s, vy: m/s, w: rad/s }
            frames { B = N.rotate(z, q); }
            points { G = O + x*N.x + y*N.y; }
            bodies { Body { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
            kinematics { d(x)/dt = vx; d(y)/dt = vy; d(q)/dt = w; }
        }
        parameters { m: kg = 1, J: kg*m^2 = 0.008125, r: m = 0.05, l: m = 0.2, g: m/s^2 = 9.81 }
        use Log as a();
        use Log as b();
        shapes {
            Floor { plane: N.y },
            One { of: a.Body, capsule: [r, l], axis: a.B.x },
            Two { of: b.Body, capsule: [r, l], axis: b.B.x },
        }
        loads { gravity: -g*N.y; }
        contacts { a_floor { One on Floor }, b_floor { Two on Floor }, a_b { One on Two } }",
    );
    for (turning, mu) in
        [(2.0, 0.5), (0.0, 0.0), (-5.0, 0.2), (2.0, 1.0), (-2.0, 0.8), (1.0, 0.3), (-5.0, 1.0)]
    {
        let q = [0.0, 0.05, 0.0, 0.0, 0.3, std::f64::consts::FRAC_PI_4];
        let u = [0.0, 0.0, 0.0, 0.0, 0.0, turning];
        let mut simulation = start(&capsules, &q, &u, surface(mu, 0.0, Law::Newton));
        let [before, _] = energies(&simulation);
        until_singular(&mut simulation);
        let [_, accounted] = energies(&simulation);
        assert!((accounted - before).abs() < 1e-9, "{turning} {mu}: {:e} J", accounted - before);
        let [one, two] = [2, 5].map(|place| simulation.coordinates()[place]);
        assert!((two - one).abs() < 1e-6, "{turning} {mu}: {one} {two}");
    }
}

/// A point that is struck is where it is, however coarse the tolerance is: only rounding makes it undefined. A pendulum that
/// has turned 200 times strikes its wall.
#[test]
fn coarse_tolerances_leave_the_point_that_is_struck() {
    let pendulum = numeric(
        "pendulum",
        "mechanism Pendulum;
        parameters { m: kg = 1, l: m = 0.5, g: m/s^2 = 9.81, w: m = 0.2 }
        coordinates { q: rad }
        speeds { u: rad/s }
        frames { B = N.rotate(z, q); }
        points { G = O - l/2*B.y; P = O - l*B.y; }
        bodies { Rod { frame: B, centre: G, mass: m, inertia: [m*l^2/12, 0, m*l^2/12] } }
        loads { gravity: -g*N.y; }
        contacts { tip { point: P of Rod, normal: -N.x, gap: w - dot(position(P), N.x) } }",
    );
    for tolerance in [1e-2, 1e-3, 1e-6, 1e-12] {
        let options = Options { relative_tolerance: tolerance, ..surface(0.3, 0.7, Law::Stronge) };
        let q = [0.3 + 400.0 * std::f64::consts::PI];
        let mut simulation = start(&pendulum, &q, &[6.0], options);
        let events = run(&mut simulation, 0.1);
        let names: Vec<&str> = events.iter().map(|event| event.kind.name()).collect();
        assert_eq!(names, ["collision"], "{tolerance:e}");
    }
}
