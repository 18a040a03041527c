//! Conditions that end modes, and gaps that close, known to the rounding of the time or of a loop only
//! (docs/theory.md, sections 17.11 and 17.12).

use hodograph::{Law, State};
use hodograph_simulation::{Event, Options, Simulation};

use crate::common::{names, run, start, surface};
use crate::many::numeric;

/// A ball that slides over the edge of a table lifts off there, where its force jumps, whatever the time is: late in a motion
/// no step was short enough for the jump.
#[test]
fn a_ball_leaves_an_edge_at_any_time() {
    let ball = numeric(
        "late-edge",
        "mechanism Edge;
        parameters { m: kg = 1, J: kg*m^2 = 0.01, l: m = 0.5, r: m = 0.05, g: m/s^2 = 9.81 }
        coordinates { x: m, y: m = 0.6, q: rad }
        speeds { vx: m/s, vy: m/s, w: rad/s }
        frames { F = N.rotate(z, q); }
        points { G = O + x*N.x + y*N.y; }
        bodies { Ball { frame: F, centre: G, mass: m, inertia: [J, J, J] } }
        shapes { Round { of: Ball, sphere: r }, Table { at: O, rectangle: [2*l, 2*l] } }
        loads { gravity: -g*N.y; }
        kinematics { d(x)/dt = vx; d(y)/dt = vy; d(q)/dt = w; }
        contacts { edge { Round on Table } }",
    );
    for time in [0.0, 1e2, 1e3, 1e4, 1e5] {
        for speed in [0.71, 3.0, 5.0, 10.0] {
            let options = surface(0.0, 0.0, Law::Poisson);
            let (q, u) = ([0.0, 0.55, 0.0], [speed, 0.0, 0.0]);
            let state = State { time, coordinates: &q, speeds: &u, inputs: &[] };
            let mut simulation = Simulation::new(&ball, &state, options).unwrap();
            let until = 0.5 / speed + 0.1;
            let events = run(&mut simulation, time + until);
            let told: Vec<&str> = events.iter().map(|event| event.kind.name()).collect();
            assert_eq!(told, ["contact", "lift_off"], "{time} {speed}");
            assert!((events[1].time - time - 0.5 / speed).abs() < 1e-11 * time.max(1.0), "{time} {speed}");
            let fall = 0.55 - 0.5 * 9.81 * 0.01;
            assert!((simulation.coordinates()[1] - fall).abs() < 1e-11 * time.max(1.0), "{time} {speed}");
        }
    }
}

/// A slider reaches a stop with its dead centre exactly: it turns back there, with no velocity, and strikes nothing. Loops are
/// closed to rounding; a gap that rounding closes had an impulse of 1e8 N s, for the slider resists as a wall does.
#[test]
fn a_dead_centre_at_a_stop_is_no_collision() {
    let slider = numeric(
        "dead-centre",
        "mechanism Slider;
        parameters { m: kg = 1, J: kg*m^2 = 0.002, I: kg*m^2 = 0.02, l: m = 0.2, r: m = 0.6, stop: m = 0.8 }
        coordinates { a: rad, dependent b: rad = -0.3, dependent x: m = 0.6 }
        speeds { w: rad/s }
        dependent { v: rad/s, s: m/s }
        frames { A = N.rotate(z, a); B = N.rotate(z, b); }
        points {
            G = O + l/2*A.x; K of A = O + l*A.x; H = K + r/2*B.x; E of B = K + r*B.x; S = O + x*N.x;
        }
        bodies {
            Crank { frame: A, centre: G, mass: m, inertia: [J, J, J] },
            Rod { frame: B, centre: H, mass: m, inertia: [I, I, I] },
        }
        particles { Slider { point: S, mass: m } }
        kinematics { d(a)/dt = w; d(b)/dt = v; d(x)/dt = s; }
        constraints { velocity(E) = velocity(S); }
        configuration { position(E) = position(S); }
        contacts { far { point: S of Slider, normal: -N.x, gap: stop - x } }",
    );
    for angle in [0.9, 1.0, 1.05, 1.1, 1.15, 1.2, 1.25, 1.3] {
        for speed in [3.0, 4.0, 5.0] {
            let b = -(0.2 * f64::sin(angle) / 0.6).asin();
            let x = 0.2 * f64::cos(angle) + 0.6 * b.cos();
            let mut simulation = start(&slider, &[angle, b, x], &[speed], surface(0.3, 0.0, Law::Poisson));
            let events = run(&mut simulation, 5.0);
            assert!(events.is_empty(), "{angle} {speed}: {:?}", names(&events));
        }
    }
    // From the dead centre itself no force moves the slider, and it leaves the stop as it is driven.
    for speed in [-3.0, 0.1, 4.0] {
        let mut simulation = start(&slider, &[0.0, 0.0, 0.8], &[speed], surface(0.3, 0.0, Law::Poisson));
        let events = run(&mut simulation, 5.0);
        assert!(events.is_empty(), "{speed}: {:?}", names(&events));
    }
}

/// The top of three blocks without friction slides off, tips over the edge of the middle one and pushes it aside from then on:
/// where that began, the mode in which it stays ended, and was chosen again.
#[test]
fn a_block_that_tips_pushes_the_one_below_aside() {
    let stack = numeric(
        "slippery-stack",
        "mechanism Stack;
        part Crate() {
            parameters { shared m: kg, shared J: kg*m^2 }
            coordinates { x: m, y: m = 0.6, q: rad }
            speeds { vx: m/s, vy: m/s, w: rad/s }
            frames { B = N.rotate(z, q); }
            points { G = O + x*N.x + y*N.y; }
            bodies { Body { frame: B, centre: G, mass: m, inertia: [J, J, J] } }
            kinematics { d(x)/dt = vx; d(y)/dt = vy; d(q)/dt = w; }
        }
        parameters { m: kg = 5.4, J: kg*m^2 = 0.0585, wide: m = 0.3, high: m = 0.2, g: m/s^2 = 9.81 }
        use Crate as a();
        use Crate as b();
        use Crate as c();
        shapes {
            Floor { plane: N.y },
            One { of: a.Body, rectangle: [wide, high] },
            Two { of: b.Body, rectangle: [wide, high] },
            Three { of: c.Body, rectangle: [wide, high] },
        }
        loads { gravity: -g*N.y; }
        contacts { floor { One on Floor }, lower { Two on One }, upper { Three on Two } }",
    );
    for speed in [0.3, 0.5, 0.6, 1.0] {
        let q = [0.0, 0.1, 0.0, 0.0, 0.3, 0.0, 0.0, 0.5, 0.0];
        let u = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, speed, 0.0, 0.0];
        let mut simulation = start(&stack, &q, &u, surface(0.0, 0.3, Law::Poisson));
        run(&mut simulation, 0.15 / speed + 0.1);
        let (q, u) = (simulation.coordinates(), simulation.speeds());
        assert!(q[8] < -1e-2 && u[3] < -1e-3, "{speed}: {q:?} {u:?}");
        // All momentum along the floor is that of the start, and the lowest block has none.
        assert!((u[3] + u[6] - speed).abs() < 1e-9 && u[0].abs() < 1e-9, "{speed}: {u:?}");
    }
}

/// The top of three blocks in space with next to no friction tips over the edge of the middle one, which begins to slip on the
/// lowest one by next to nothing: the directions of its four corners follow from the state, and so do the rates of their slip.
/// By the rates along its own direction slip of two of them seemed to end at once, and steps without end were that short.
#[test]
fn slip_that_has_hardly_begun_does_not_end_at_once() {
    let stack = numeric(
        "slippery-crates",
        "mechanism Crates;
        part Crate() {
            parameters { a: m, b: m, c: m, shared rho: kg/m^3 }
            coordinates { x: m, y: m, z: m, e0: 1 = 1, e1: 1, e2: 1, e3: 1 }
            speeds { u1: m/s, u2: m/s, u3: m/s, w1: rad/s, w2: rad/s, w3: rad/s }
            frames { B = N.quaternion(e0, e1, e2, e3); }
            angular_velocities { B = w1*B.x + w2*B.y + w3*B.z; }
            points { G = O + x*N.x + y*N.y + z*N.z; }
            velocities { G = u1*N.x + u2*N.y + u3*N.z; }
            bodies { Body { frame: B, centre: G, shape: Hull } }
            shapes { Hull { of: Body, box: [a, b, c], density: rho } }
        }
        parameters { rho: kg/m^3 = 300, g: m/s^2 = 9.81 }
        use Crate as a(a: 0.5, b: 0.2, c: 0.4);
        use Crate as b(a: 0.4, b: 0.2, c: 0.3);
        use Crate as c(a: 0.3, b: 0.2, c: 0.24);
        shapes { Floor { plane: N.y } }
        loads { gravity: -g*N.y; }
        contacts { floor { a.Hull on Floor }, lower { b.Hull on a.Hull }, upper { c.Hull on b.Hull } }",
    );
    // The upper one tips over the edge of the middle one, which stands.
    let standing = |y: f64| [0.0, y, 0.0, 1.0, 0.0, 0.0, 0.0];
    let tips = [0.2557935421395874, 0.4954834529942876, 0.0, 0.9990402816092646, 0.0, 0.0, -0.0438008643988];
    let q = [standing(0.1), standing(0.3), tips].concat();
    let mut u = [0.0; 18];
    (u[12], u[13], u[17]) = (0.5315296224679099, -0.1480471735104603, -2.1379612456292514);
    let mut simulation = start(&stack, &q, &u, surface(0.02, 0.0, Law::Newton));
    run(&mut simulation, 0.0015);
    // It pushes the middle one back, which does not turn.
    let (q, u) = (simulation.coordinates(), simulation.speeds());
    assert!(q[7] < -1e-14 && u[6] < -1e-9 && (q[8] - 0.3).abs() < 1e-12, "{q:?} {u:?}");
    assert!(u[9..12].iter().all(|turn| turn.abs() < 1e-9), "{u:?}");
}

/// Two books that are pressed together are lifted at both ends: the floor carries nothing once the lift is their weight, and
/// all of it parts then. Friction there has its limit at the same time, as a double zero, whose place was taken for another.
#[test]
fn books_part_from_the_floor_when_they_are_lifted() {
    let books = numeric(
        "books",
        "mechanism Books;
        parameters {
            m: kg = 0.4, J: kg*m^2 = 0.00139, wide: m = 0.04, high: m = 0.2, g: m/s^2 = 9.81,
            press: N = 5, lift: N/s = 8,
        }
        coordinates { x: m, y: m = 0.1, q: rad, xx: m = 0.04, yy: m = 0.1, qq: rad }
        speeds { u: m/s, v: m/s, w: rad/s, uu: m/s, vv: m/s, ww: rad/s }
        frames { A = N.rotate(z, q); B = N.rotate(z, qq); }
        points {
            G = O + x*N.x + y*N.y; L of A = G - wide/2*A.x;
            H = O + xx*N.x + yy*N.y; R of B = H + wide/2*B.x;
        }
        bodies {
            One { frame: A, centre: G, mass: m, inertia: [J, J, J] },
            Two { frame: B, centre: H, mass: m, inertia: [J, J, J] },
        }
        shapes {
            Left { of: One, rectangle: [wide, high] }, Right { of: Two, rectangle: [wide, high] },
            Floor { plane: N.y },
        }
        loads {
            gravity: -g*N.y;
            force on L: press*N.x + lift/2*time*N.y;
            force on R: -press*N.x + lift/2*time*N.y;
        }
        kinematics {
            d(x)/dt = u; d(y)/dt = v; d(q)/dt = w; d(xx)/dt = uu; d(yy)/dt = vv; d(qq)/dt = ww;
        }
        contacts { between { Left on Right }, left { Left on Floor }, right { Right on Floor } }",
    );
    for longest in [f64::INFINITY, 0.05, 0.01] {
        let options = Options { max_step: longest, ..surface(0.4, 0.0, Law::Newton) };
        let mut simulation = start(&books, &[0.0, 0.1, 0.0, 0.04, 0.1, 0.0], &[0.0; 6], options);
        let events = run(&mut simulation, 1.1);
        let parts: Vec<&Event> = events.iter().filter(|event| event.kind.name() == "lift_off").collect();
        assert_eq!(parts.len(), 4, "{longest}: {:?}", names(&events));
        assert!(parts.iter().all(|event| (event.time - 0.981).abs() < 1e-9), "{:?}", names(&events));
        // What is more than the weight accelerates both: y'' = lift (t - 0.981) / (2 m).
        let late = 1.1_f64 - 0.981;
        let height = 0.1 + 8.0 * late.powi(3) / (6.0 * 0.8);
        assert!((simulation.coordinates()[1] - height).abs() < 1e-9, "{:?}", simulation.coordinates());
    }
}
