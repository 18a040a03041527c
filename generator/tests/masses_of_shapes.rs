//! Masses, mass centres and inertias that follow from shapes, against integrals over their slices.

use hodograph_generator::check::check;
use hodograph_generator::model::mechanism::{Mechanism, Scalar};
use hodograph_generator::numeric::{Level, State};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::shapes::{evaluator, still};

/// Five nodes of Gauss and Legendre on many parts: exact for polynomials of degree 9.
fn integral(from: f64, to: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (a, b) = (
        (5.0 - 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0,
        (5.0 + 2.0 * (10.0_f64 / 7.0).sqrt()).sqrt() / 3.0,
    );
    let (u, v) = ((322.0 + 13.0 * 70.0_f64.sqrt()) / 900.0, (322.0 - 13.0 * 70.0_f64.sqrt()) / 900.0);
    let nodes = [(0.0, 128.0 / 225.0), (a, u), (-a, u), (b, v), (-b, v)];
    let parts = 40;
    let h = (to - from) / f64::from(parts);
    let part = |i: i32| {
        let middle = from + h * (f64::from(i) + 0.5);
        nodes.iter().map(|(x, w)| 0.5 * h * w * f(middle + 0.5 * h * x)).sum::<f64>()
    };
    (0..parts).map(part).sum()
}

/// Mass, height of the mass centre, and moments of inertia about it of slices at right angles to an axis: of each its
/// area, the second moment of the area about the axis, and that about a line across.
fn of_slices(from: f64, to: f64, slice: impl Fn(f64) -> [f64; 3]) -> [f64; 4] {
    let rho = 700.0;
    let mass = rho * integral(from, to, |z| slice(z)[0]);
    let centre = rho * integral(from, to, |z| z * slice(z)[0]) / mass;
    let along = rho * integral(from, to, |z| slice(z)[1]);
    let across = rho * integral(from, to, |z| slice(z)[2] + (z - centre).powi(2) * slice(z)[0]);
    [mass, centre, along, across]
}

/// A body that moves freely, of one shape.
fn of_one(shape: &str) -> Mechanism {
    let text = format!(
        "mechanism One;
parameters {{ k: m = 0.1, rho: kg/m^3 = 700 }}
coordinates {{ q1: m, q2: m, q3: m, q4: rad, q5: rad, q6: rad }}
speeds {{ u1: m/s, u2: m/s, u3: m/s, u4: rad/s, u5: rad/s, u6: rad/s }}
frames {{ E = N.euler(xyz, q4, q5, q6); }}
points {{ P = O + q1*N.x + q2*N.y + q3*N.z; }}
bodies {{ A {{ frame: E, shape: S }} }}
shapes {{ {shape} }}
"
    );
    let source = Source::file("one.mech", text);
    let checked = check(&source);
    let said = render(&checked.diagnostics, &source);
    assert!(said.is_empty(), "{said}");
    checked.mechanism.expect("a model without errors")
}

/// Mass properties of shapes against integrals over their slices.
#[test]
fn masses_are_integrals_over_slices() {
    use std::f64::consts::{FRAC_PI_2, PI};
    let round = |r2: f64| [PI * r2, PI * r2 * r2 / 2.0, PI * r2 * r2 / 4.0];
    let ellipse = |a: f64, b: f64, s: f64| {
        [PI * a * b * s, PI * a * b * (a * a + b * b) * s * s / 4.0, PI * a * b * b * b * s * s / 4.0]
    };
    // z = r sin t takes the root out of the slices of a torus
    let torus = |t: f64| {
        let (w, dz) = (0.1 * t.cos(), 0.1 * t.cos());
        let (outer, inner) = (0.4 + w, 0.4 - w);
        let ring = |n: i32| PI * (outer.powi(n) - inner.powi(n));
        [ring(2) * dz, ring(4) / 2.0 * dz, ring(4) / 4.0 * dz]
    };
    let tube = {
        let mass = 700.0 * integral(-FRAC_PI_2, FRAC_PI_2, |t| torus(t)[0]);
        let along = 700.0 * integral(-FRAC_PI_2, FRAC_PI_2, |t| torus(t)[1]);
        let across =
            700.0 * integral(-FRAC_PI_2, FRAC_PI_2, |t| torus(t)[2] + (0.1 * t.sin()).powi(2) * torus(t)[0]);
        [mass, 0.0, along, across]
    };
    let capsule = |z: f64| round(if z.abs() < 0.3 { 0.04 } else { 0.04 - (z.abs() - 0.3).powi(2) });
    let cases = [
        ("sphere: 2*k", of_slices(-0.2, 0.2, |z| round(0.04 - z * z))),
        ("cylinder: [2*k, 6*k], axis: E.z", of_slices(-0.3, 0.3, |_| round(0.04))),
        ("capsule: [2*k, 6*k], axis: E.z", {
            // in three parts, since the radius has corners where they join
            let parts = [(-0.5, -0.3), (-0.3, 0.3), (0.3, 0.5)];
            let sum =
                |f: &dyn Fn(f64) -> f64| parts.iter().map(|(a, b)| 700.0 * integral(*a, *b, f)).sum::<f64>();
            let across = sum(&|z| capsule(z)[2] + z * z * capsule(z)[0]);
            [sum(&|z| capsule(z)[0]), 0.0, sum(&|z| capsule(z)[1]), across]
        }),
        ("cone: [2*k, 5*k], axis: E.z", of_slices(0.0, 0.5, |z| round((0.2 * (1.0 - z / 0.5)).powi(2)))),
        ("torus: [4*k, k], axis: E.z", tube),
        ("ellipsoid: [2*k, 3*k, 5*k]", of_slices(-0.5, 0.5, |z| ellipse(0.2, 0.3, 1.0 - z * z / 0.25))),
        (
            "box: [2*k, 3*k, 5*k]",
            of_slices(-0.25, 0.25, |_| {
                let (a, b) = (0.2, 0.3);
                [a * b, a * b * (a * a + b * b) / 12.0, a * b * b * b / 12.0]
            }),
        ),
    ];
    for (shape, [mass, centre, along, across]) in cases {
        let m = of_one(&format!("S {{ of: A, at: P, {shape}, density: rho }}"));
        let state = State::of(&m);
        let values = evaluator(&m, &state, still(&state));
        let number = |scalar: &Scalar| values.scalar(scalar, Level::Motion).unwrap().re;
        let body = &m.bodies[0];
        let inertia = &body.inertia.as_ref().unwrap().components;
        let at = values.position(body.centre).unwrap()[2].re;
        let found = [number(&body.mass), at, number(&inertia[2]), number(&inertia[0])];
        for (ours, theirs) in found.iter().zip([mass, centre, along, across]) {
            assert!(
                (ours - theirs).abs() < 1e-12 * mass.max(1.0),
                "{shape}: {found:?}, {mass} {centre} {along} {across}"
            );
        }
    }
}

/// Mass, mass centre from P, and second moments xx, yy, zz, xy, yz, zx about P of a polytope at P + 0.2 E.x with these
/// vertices from P.
fn of_polytope(vertices: &[[f64; 3]]) -> [f64; 10] {
    let list: Vec<String> =
        vertices.iter().map(|v| format!("P + 10*k*E.vec({}, {}, {})", v[0], v[1], v[2])).collect();
    let list = list.join(", ");
    let m = of_one(&format!("S {{ of: A, at: P + 2*k*E.x, polytope: [{list}], density: rho }}"));
    let state = State::of(&m);
    let values = evaluator(&m, &state, still(&state));
    let number = |scalar: &Scalar| values.scalar(scalar, Level::Motion).unwrap().re;
    let body = &m.bodies[0];
    let mass = number(&body.mass);
    let c = values.position(body.centre).unwrap().map(|c| c.re);
    let [xx, yy, zz, xy, yz, zx] = body.inertia.as_ref().unwrap().components.each_ref().map(number);
    let half = 0.5 * (xx + yy + zz);
    let central = [half - xx, half - yy, half - zz, -xy, -yz, -zx];
    let shift = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]].map(|[i, j]| mass * c[i] * c[j]);
    let about = [0, 1, 2, 3, 4, 5].map(|i| central[i] + shift[i]);
    [mass, mass * c[0], mass * c[1], mass * c[2], about[0], about[1], about[2], about[3], about[4], about[5]]
}

/// A block, and both parts into which an oblique plane cuts it.
#[test]
fn masses_of_polytopes_add_up() {
    let [a, b, c] = [0.1, 0.15, 0.25];
    let corners = [[a, b], [-a, b], [-a, -b], [a, -b]];
    let level = |z: f64| corners.map(|[x, y]| [x + 0.02, y, z]).to_vec();
    let cut: Vec<[f64; 3]> = corners.map(|[x, y]| [x + 0.02, y, 0.05 + 0.3 * x + 0.4 * y]).to_vec();
    let of = |lower: &[[f64; 3]], upper: &[[f64; 3]]| of_polytope(&[lower, upper].concat());
    let (whole, below, above) = (of(&level(-c), &level(c)), of(&level(-c), &cut), of(&cut, &level(c)));
    let mass = 700.0 * 8.0 * a * b * c;
    let expected = [
        mass,
        0.02 * mass,
        0.0,
        0.0,
        mass * (a * a / 3.0 + 0.02 * 0.02),
        mass * b * b / 3.0,
        mass * c * c / 3.0,
        0.0,
        0.0,
        0.0,
    ];
    for i in 0..10 {
        assert!((whole[i] - expected[i]).abs() < 1e-13 * mass, "{i}: {whole:?} {expected:?}");
        assert!((below[i] + above[i] - whole[i]).abs() < 1e-13 * mass, "{i}: {below:?} {above:?} {whole:?}");
    }
    // the parts are oblique: their products of inertia are not zero
    assert!(below[7..].iter().all(|product| product.abs() > 1e-6), "{below:?}");
}
