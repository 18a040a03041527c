//! Contacts of shapes whose curvature jumps, where the force jumps too: against answers in closed form.

use std::f64::consts::FRAC_1_SQRT_2;

use hodograph::Law;
use hodograph_interpreter::NumericMechanism;

use crate::many::{Ended, Start, follow, numeric, surface};

const G: f64 = 9.81;
/// Radius and height of the cone, and radius of the ball, m.
const CONE: f64 = 1.0 / 3.0;
const BALL: f64 = 0.09;

/// A ball above a cone that stands on its base.
fn ball_and_cone() -> NumericMechanism {
    numeric(
        "ball-and-cone",
        "mechanism Shed;
        parameters { m: kg = 0.7, r: m = 0.09, c: m = 1/3, g: m/s^2 = 9.81 }
        coordinates { x: m, y: m, z: m }
        speeds { u: m/s, v: m/s, w: m/s }
        points { P = O + x*N.x + y*N.y + z*N.z; }
        particles { Q { point: P, mass: m } }
        shapes { Ball { of: Q, sphere: r }, Cone { at: O, cone: [c, c], axis: N.z } }
        loads { gravity: -g*N.z; }
        kinematics { d(x)/dt = u; d(y)/dt = v; d(z)/dt = w; }
        contacts { strike { Ball on Cone } }",
    )
}

/// The motion of the ball from rest, at this distance from the axis and this height, in its plane: the times of the
/// collision and of its leaving the cone, and its place 1 s after the start.
fn expected(distance: f64, height: f64) -> (f64, f64, [f64; 2]) {
    let along = FRAC_1_SQRT_2;
    // It falls on the flank, and what of its speed is normal to it is lost.
    let collision = (2.0 * (height - (CONE + BALL / along - distance)) / G).sqrt();
    let start = G * collision * along;
    let way = (CONE + BALL * along - distance) / along;
    let end = (start * start + 2.0 * G * along * way).sqrt();
    let slides = (end - start) / (G * along);
    let (leaves, place, velocity) =
        (collision + slides, [CONE + BALL * along, BALL * along], [end * along, -end * along]);
    assert!(end * end > G * along * BALL, "the rim holds it");
    let rest = 1.0 - leaves;
    let place = [place[0] + velocity[0] * rest, place[1] + velocity[1] * rest - 0.5 * G * rest * rest];
    (collision, leaves, place)
}

fn ball_from(mechanism: &NumericMechanism, distance: f64, height: f64, turned: f64) -> Ended {
    let coordinates = vec![distance * f64::cos(turned), distance * f64::sin(turned), height];
    let start = Start { coordinates, speeds: vec![0.0; 3], inputs: Vec::new() };
    follow(mechanism, &start, surface(0.0, 0.0, Law::Newton), 1.0)
}

/// A ball slides down a cone and past the rim of its base, where the force on it jumps from pressure to traction.
#[test]
fn a_ball_leaves_a_cone_at_its_rim() {
    let mechanism = ball_and_cone();
    for turned in [0.0, 0.7] {
        for step in 0..15 {
            let distance = 0.1 + 0.02 * f64::from(step);
            let end = ball_from(&mechanism, distance, 0.6, turned);
            let (collision, leaves, place) = expected(distance, 0.6);
            let told = format!("{distance} {turned}: {:?} {:?}", end.events, end.error);
            assert!(end.error.is_none(), "{told}");
            let names: Vec<_> = end.events.iter().map(|event| event.kind.name()).collect();
            assert_eq!(names, ["collision", "contact", "lift_off"], "{told}");
            assert!((end.events[0].time - collision).abs() < 1e-11, "{told}");
            assert!((end.events[2].time - leaves).abs() < 1e-11, "{told} {leaves}");
            let x = end.coordinates[0].hypot(end.coordinates[1]);
            assert!((x - place[0]).abs() < 1e-10 && (end.coordinates[2] - place[1]).abs() < 1e-10, "{told}");
        }
    }
}

/// A body above what lies fixed: both by their shapes.
fn over_an_edge(name: &str, shapes: &str) -> NumericMechanism {
    numeric(
        name,
        &format!(
            "mechanism Edge;
            parameters {{ m: kg = 0.7, J: kg*m^2 = 0.001, r: m = 0.09, s: m = 0.04, a: m = 0.25, g: m/s^2 = 9.81 }}
            coordinates {{ x: m, y: m, z: m, q: rad }}
            speeds {{ u: m/s, v: m/s, w: m/s, o: rad/s }}
            frames {{ A = N.rotate(y, q); }}
            points {{ P = O + x*N.x + y*N.y + z*N.z; }}
            bodies {{ Q {{ frame: A, centre: P, mass: m, inertia: [J, J, J] }} }}
            {shapes}
            loads {{ gravity: -g*N.z; }}
            kinematics {{ d(x)/dt = u; d(y)/dt = v; d(z)/dt = w; d(q)/dt = o; }}
            contacts {{ strike {{ Upper on Lower }} }}"
        ),
    )
}

/// How a body slides over an edge.
struct Way {
    /// cosine and sine of the direction across the edge
    direction: [f64; 2],
    /// the height of the face, and that of the middle of the body above it, m
    face: f64,
    reach: f64,
    /// how far beside the middle of the edge it begins, m, and how fast it moves along the edge, m/s
    beside: f64,
}

/// Slides bodies over an edge 0.25 m away from the middle: where the face ends under one the force falls to that of a
/// pendulum upside down, and it leaves the edge where that vanishes, or at once.
fn slides_over_an_edge(mechanism: &NumericMechanism, way: &Way) {
    let &Way { direction: [c, s], face, reach, beside } = way;
    let edge = 0.25;
    let turned = |across: f64, along: f64| [across * c - along * s, across * s + along * c];
    for (step, speed) in [0.2, 0.54, 0.8, 1.1, 1.58].into_iter().enumerate() {
        let (along, y) = if step % 2 == 0 { (0.0, 0.2 * beside) } else { (beside, -beside) };
        let ([x0, y0], [u, v]) = (turned(0.1, y), turned(speed, along));
        let start = Start {
            coordinates: vec![x0, y0, face + reach, 0.0],
            speeds: vec![u, v, 0.0, 0.0],
            inputs: Vec::new(),
        };
        let end = follow(mechanism, &start, surface(0.0, 0.0, Law::Newton), 1.8);
        let told = format!("{speed} {along}: {:?} {:?}", end.names(), end.error);
        assert!(end.error.is_none(), "{told}");
        let left = end.events.iter().find(|event| event.kind.name() == "lift_off").expect(&told);
        let [x, y_there] = [left.coordinates[0], left.coordinates[1]];
        let [x, y_there] = [x * c + y_there * s, y_there * c - x * s];
        if speed * speed >= G * reach {
            let arrives = (edge - 0.1) / speed;
            assert!((left.time - arrives).abs() < 1e-11, "{told} {arrives}");
        } else {
            // m v^2 / r = m g cos, and v^2 is that at the edge and what the fall adds
            let cosine = (speed * speed / (G * reach) + 2.0) / 3.0;
            let place = [edge + reach * (1.0 - cosine * cosine).sqrt(), face + reach * cosine];
            assert!((x - place[0]).abs() < 1e-8, "{told} {place:?}");
            assert!((left.coordinates[2] - place[1]).abs() < 1e-8, "{told} {place:?}");
        }
        assert!((y_there - y - along * left.time).abs() < 1e-10, "{told}");
    }
}

#[test]
fn a_ball_leaves_the_edge_of_a_polytope() {
    let block = "shapes {
        Upper { of: Q, sphere: r },
        Lower { at: O, polytope: [
            O + a*N.x + a*N.y, O + a*N.x - a*N.y, O - a*N.x + a*N.y, O - a*N.x - a*N.y,
            O + a*N.x + a*N.y - a*N.z, O + a*N.x - a*N.y - a*N.z, O - a*N.x + a*N.y - a*N.z, O - a*N.x - a*N.y - a*N.z
        ] }
    }";
    let way = Way { direction: [1.0, 0.0], face: 0.0, reach: BALL, beside: 0.05 };
    slides_over_an_edge(&over_an_edge("ball-and-polytope", block), &way);
}

#[test]
fn a_ball_leaves_the_edge_of_a_box() {
    let block = "shapes { Upper { of: Q, sphere: r }, Lower { at: O, box: [2*a, 2*a, 2*a] } }";
    let way = Way { direction: [1.0, 0.0], face: 0.25, reach: BALL, beside: 0.05 };
    slides_over_an_edge(&over_an_edge("ball-and-box", block), &way);
}

/// A bar slides across a rail and over its end.
#[test]
fn a_capsule_leaves_the_end_of_another() {
    let crossed = "shapes {
        Upper { of: Q, capsule: [s, a], axis: A.y },
        Lower { at: O, capsule: [r, 2*a], axis: N.x }
    }";
    let way = Way { direction: [1.0, 0.0], face: 0.0, reach: BALL + 0.04, beside: 0.05 };
    slides_over_an_edge(&over_an_edge("crossed-capsules", crossed), &way);
}

/// A ball slides along the ridge of a roof and past the vertex at its end, where three edges are equally near but for
/// rounding.
#[test]
fn a_ball_leaves_the_end_of_a_ridge() {
    let corners = [(1, 0), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1)];
    for [c, s] in [[0.6, 0.8], [-0.28, 0.96]] {
        let vertex = |(along, beside): (i32, i32)| {
            let (along, side) = (f64::from(along), f64::from(beside));
            let (x, y) = (along * c - side * s, along * s + side * c);
            format!("O + ({x:?})*a*N.x + ({y:?})*a*N.y - {}*a*N.z", beside.abs())
        };
        let vertices = corners.map(vertex).join(", ");
        let roof =
            format!("shapes {{ Upper {{ of: Q, sphere: r }}, Lower {{ at: O, polytope: [{vertices}] }} }}");
        let way = Way { direction: [c, s], face: 0.0, reach: BALL, beside: 0.0 };
        slides_over_an_edge(&over_an_edge("ball-and-roof", &roof), &way);
    }
}
