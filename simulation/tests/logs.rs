//! Capsules on boxes and rectangles: a log that tips over the edge of a table, lies across it, rolls off and falls
//! (docs/theory.md, 16.11).

use crate::common::{names, run, start, surface};
use crate::many::{model, numeric};
use hodograph::Law;
use hodograph_simulation::{Event, Options, Simulation};

const G: f64 = 9.81;
const RADIUS: f64 = 0.05;
const MASS: f64 = 4.0;
const INERTIA: f64 = 0.25;

/// Rates of a rounded bar that slides without friction on a fixed edge at O: the angle q of its axis, the place s of its
/// middle along the axis from the place over the edge, and their rates. Lagrange's equations of the middle at
/// r n + s a, with a = (cos q, sin q) and n = (-sin q, cos q).
fn on_the_edge([q, s, w, v]: [f64; 4]) -> [f64; 4] {
    let turning = (-MASS * G * s * q.cos() + MASS * RADIUS * s * w * w - 2.0 * MASS * s * v * w)
        / (MASS * s * s + INERTIA);
    [w, v, turning, RADIUS * turning + s * w * w - G * q.sin()]
}

/// Runge and Kutta's method of order four.
fn integrate(mut state: [f64; 4], time: f64, steps: usize) -> [f64; 4] {
    let h = time / steps as f64;
    let moved = |s: &[f64; 4], k: &[f64; 4], h: f64| std::array::from_fn(|i| s[i] + h * k[i]);
    for _ in 0..steps {
        let a = on_the_edge(state);
        let b = on_the_edge(moved(&state, &a, 0.5 * h));
        let c = on_the_edge(moved(&state, &b, 0.5 * h));
        let d = on_the_edge(moved(&state, &c, h));
        state = std::array::from_fn(|i| state[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    state
}

/// The number of closed contacts of a log.
fn closed(simulation: &Simulation<'_>) -> usize {
    (0..22).filter(|&contact| simulation.phase(contact).is_some()).count()
}

/// A bar whose middle is beyond the edge tips at once, and slides on the edge without friction.
#[test]
fn a_bar_tips_over_an_edge() {
    let bar = model("bar_on_ledge");
    let mut simulation = start(&bar, &[0.1, RADIUS, 0.0], &[0.0; 3], surface(0.0, 0.0, Law::Newton));
    run(&mut simulation, 0.3);
    let [q, s, w, v] = integrate([0.0, 0.1, 0.0, 0.0], 0.3, 20_000);
    let (sin, cos) = q.sin_cos();
    let along = v - RADIUS * w;
    let expected = [
        s * cos - RADIUS * sin,
        s * sin + RADIUS * cos,
        q,
        along * cos - s * w * sin,
        along * sin + s * w * cos,
        w,
    ];
    let found = [simulation.coordinates(), simulation.speeds()].concat();
    assert!(q < -0.2, "{q}");
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-9, "{found:?} {expected:?}");
    }
}

/// What a log does in space that moves in a plane a bar of the same mass does in it: it tips, with friction that first
/// holds it and then does not, slides off the edge and falls.
#[test]
fn a_log_that_moves_in_a_plane_does_what_a_bar_does() {
    let (log, bar) = (model("log_on_table"), model("bar_on_ledge"));
    // mass and moment of inertia of the log: pi r^2 l and 4/3 pi r^3 with 600 kg/m^3
    let (r, l) = (RADIUS, 0.8);
    let (rod, balls) = (600.0 * std::f64::consts::PI * r * r * l, 800.0 * std::f64::consts::PI * r * r * r);
    let across = rod * (r * r / 4.0 + l * l / 12.0) + balls * (0.4 * r * r + 0.375 * l * r + l * l / 4.0);
    let bar = crate::many::with_parameters(&bar, &[("m", rod + balls), ("J", across)]);
    for (mu, e, height) in [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.5, 0.4, 0.2)] {
        let options = || surface(mu, e, Law::Newton);
        let mut in_plane = start(&bar, &[0.1, RADIUS + height, 0.0], &[0.2, 0.0, 0.0], options());
        let q = [0.1, RADIUS + height, 0.3, 1.0, 0.0, 0.0, 0.0];
        let mut in_space = start(&log, &q, &[0.2, 0.0, 0.0, 0.0, 0.0, 0.0], options());
        let mut told = [Vec::new(), Vec::new()];
        for step in 1..=40 {
            let time = 0.02 * f64::from(step);
            told[0].extend(run(&mut in_space, time));
            told[1].extend(run(&mut in_plane, time));
            let (q, u) = (in_space.coordinates(), in_space.speeds());
            let found = [q[0], q[1], 2.0 * q[6].atan2(q[3]), u[0], u[1], u[5]];
            let wanted = [in_plane.coordinates(), in_plane.speeds()].concat();
            let off = found.iter().zip(&wanted).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            if off > 1e-9 {
                println!("{:?}\n{:?}", names(&told[0]), names(&told[1]));
            }
            assert!(off < 1e-9, "mu {mu} at {time}: {off:e} {found:?} {wanted:?}");
        }
        assert!(in_plane.coordinates()[1] < -0.2, "it has not fallen: {:?}", in_plane.coordinates());
    }
}

/// A state that is asked for within the step in which slip ends is the one at that time: the end of slip, which is
/// followed separately, had taken the place of the step before it.
#[test]
fn states_before_the_end_of_slip_are_those_of_their_time() {
    let log = model("log_on_table");
    let q = [0.1, RADIUS, 0.3, 1.0, 0.0, 0.0, 0.0];
    let at = |time: f64, longest: f64| {
        let options = Options { max_step: longest, ..surface(0.3, 0.0, Law::Newton) };
        let mut simulation = start(&log, &q, &[0.2, 0.0, 0.0, 0.0, 0.0, 0.0], options);
        let events = run(&mut simulation, time);
        let is_stick = |event: &Event| event.kind.name() == "stick";
        ([simulation.coordinates(), simulation.speeds()].concat(), events.iter().any(is_stick))
    };
    assert!(at(0.0653, f64::INFINITY).1 && !at(0.0652, f64::INFINITY).1);
    for time in [0.056, 0.06, 0.0652] {
        let (free, short) = (at(time, f64::INFINITY).0, at(time, 1e-3).0);
        let off = free.iter().zip(&short).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
        assert!(off < 1e-10, "{time}: {off:e} {free:?} {short:?}");
    }
}

/// A log that is dropped flat across a corner of the table rests on both of its edges, and moves straight down to it.
#[test]
fn a_log_dropped_across_a_corner_rests_on_both_edges() {
    let log = model("log_on_table");
    // over the edge x = 0 and the edge z = 1, in the direction x + z; its middle is above the table
    let eighth = (std::f64::consts::PI / 8.0).sin_cos();
    let q = [-0.1, 0.3, 0.9, eighth.1, 0.0, -eighth.0, 0.0];
    for e in [0.0, 0.3] {
        let mut simulation = start(&log, &q, &[0.0; 6], surface(0.5, e, Law::Poisson));
        let events = run(&mut simulation, 2.0);
        let strikes = |name: &str| ["collision", "struck_together"].contains(&name);
        assert!(events.iter().any(|event| strikes(event.kind.name())), "{:?}", names(&events));
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        assert!(u.iter().all(|u| u.abs() < 1e-9), "{u:?}");
        assert!((q[1] - RADIUS).abs() < 1e-9 && (q[0] + 0.1).abs() < 1e-6, "{q:?}");
        assert!(closed(&simulation) >= 2, "{}", closed(&simulation));
    }
}

/// A log that rolls on the table along an edge comes to the end of what carries it: it turns over the edge, or over a
/// corner, without an impact.
#[test]
fn a_log_rolls_over_an_edge_as_a_ball_does() {
    let log = model("log_on_table");
    // the axis along z, so that it rolls in x; half of it is beyond the corner at z = 1
    let quarter = (std::f64::consts::PI / 4.0).sin_cos();
    for middle in [0.0, 0.8] {
        let q = [-0.1, RADIUS, middle, quarter.1, 0.0, quarter.0, 0.0];
        // rolling: the speed of the middle over the radius, about -N.z; B.x is along -N.z
        let (speed, mu) = (0.2, 1.0);
        let u = [speed, 0.0, 0.0, speed / RADIUS, 0.0, 0.0];
        let mut simulation = start(&log, &q, &u, surface(mu, 0.0, Law::Newton));
        let events = run(&mut simulation, 0.75);
        assert!(simulation.coordinates()[1] < RADIUS - 0.001, "{:?}", simulation.coordinates());
        let before = events.iter().take_while(|event| event.time < 0.74);
        for event in before {
            assert!(!event.kind.name().contains("collision"), "{middle}: {:?}", names(&events));
        }
        // it turns about its axis alone
        let u = simulation.speeds();
        assert!(u[2].abs() < 1e-9 && u[4].abs() < 1e-9 && u[5].abs() < 1e-9, "{u:?}");
    }
}

/// A log upright in the corner of two walls and a floor rolls over the floor along a wall: nothing presses it against that
/// wall, beside which a force at its two ends would jam with the floor.
#[test]
fn contacts_that_are_not_pressed_do_not_jam() {
    let log = numeric(
        "log",
        "mechanism Log;
        parameters { m: kg = 1, J: kg*m^2 = 0.01, J2: kg*m^2 = 0.004, r: m = 0.1, l: m = 0.3, g: m/s^2 = 9.81 }
        coordinates { x: m, y: m, z: m, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }
        speeds { vx: m/s, vy: m/s, vz: m/s, w1: rad/s, w2: rad/s, w3: rad/s }
        frames { B = N.quaternion(e0, e1, e2, e3); }
        angular_velocities { B = w1*B.x + w2*B.y + w3*B.z; }
        points { G = O + x*N.x + y*N.y + z*N.z; }
        velocities { G = vx*N.x + vy*N.y + vz*N.z; }
        bodies { Log { frame: B, centre: G, mass: m, inertia: [J, J, J2] } }
        shapes { Floor { plane: N.z }, West { plane: N.x }, South { plane: N.y }, Hull { of: Log, capsule: [r, l], axis: B.z } }
        loads { gravity: -g*N.z; }
        contacts { floor { Hull on Floor }, west { Hull on West }, south { Hull on South } }",
    );
    for (mu, turning) in [(0.3, [1.0, 0.0]), (0.8, [1.0, 0.0]), (0.3, [0.0, -1.0]), (0.8, [0.0, -1.0])] {
        let u = [0.0, 0.0, 0.0, turning[0], turning[1], 0.0];
        let q = [0.1, 0.1, 0.25, 1.0, 0.0, 0.0, 0.0];
        let mut simulation = start(&log, &q, &u, surface(mu, 0.0, Law::Newton));
        let energy = |simulation: &Simulation<'_>| {
            let account = simulation.energy().unwrap();
            account.kinetic + account.potential.unwrap() - account.impacts - account.friction
        };
        let before = energy(&simulation);
        run(&mut simulation, 1.0);
        assert!((energy(&simulation) - before).abs() < 1e-9, "{mu} {turning:?}");
    }
}
