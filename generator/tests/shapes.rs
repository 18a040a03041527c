//! Contacts of shapes against nearest points that are found in another way, at random poses of two bodies.
//!
//! The closed forms are in `model/lower/shapes/closed_forms.rs`. Here nearest points are told by what they
//! must be: a point of the surface at which the outward normal is opposite to that of the plane, or the
//! projection of a centre on a solid, found region by region. The rate of the gap must be n . v with the
//! velocities of the material points, and rates of normals and points those of central differences.

use hodograph_generator::check::check;
use hodograph_generator::model::mechanism::{Contact, Kind, Mechanism};
use hodograph_generator::numeric::hyper_dual::HyperDual;
use hodograph_generator::numeric::views::{cross3, dot3, norm3, sub3};
use hodograph_generator::numeric::{Evaluator, Failure, Level, State, Views};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;
use hodograph_random::Random;

pub type V = [f64; 3];

const POSES: usize = 10_000;

/// Two free bodies, A with the first shape and B with the second.
pub fn model(shapes: &str, contact: &str) -> Mechanism {
    let text = format!(
        "mechanism Two;
parameters {{ m: kg = 1, J: kg*m^2 = 0.1, k: m = 0.1 }}
coordinates {{ q1: m, q2: m, q3: m = 5, q4: rad, q5: rad, q6: rad, q7: m, q8: m, q9: m, q10: rad, q11: rad, q12: rad }}
speeds {{ u1: m/s, u2: m/s, u3: m/s, u4: rad/s, u5: rad/s, u6: rad/s,
    u7: m/s, u8: m/s, u9: m/s, u10: rad/s, u11: rad/s, u12: rad/s }}
frames {{ E = N.euler(xyz, q4, q5, q6); F = N.euler(xyz, q10, q11, q12); }}
points {{ G = O + q1*N.x + q2*N.y + q3*N.z; H = O + q7*N.x + q8*N.y + q9*N.z; }}
bodies {{ A {{ frame: E, centre: G, mass: m, inertia: [J, J, J] }}, B {{ frame: F, centre: H, mass: m, inertia: [J, J, J] }} }}
shapes {{ {shapes} }}
contacts {{ touch {{ {contact} }} }}
"
    );
    let source = Source::file("two.mech", text);
    let checked = check(&source);
    let said = render(&checked.diagnostics, &source);
    checked.mechanism.unwrap_or_else(|| panic!("{said}"))
}

pub fn random_state(random: &mut Random, m: &Mechanism) -> State {
    let mut state = State::of(m);
    for (q, variable) in state.coordinates.iter_mut().zip(&m.coordinates) {
        *q = random.number() * if variable.unit == "m" { 1.0 } else { 3.0 };
    }
    state.speeds.iter_mut().for_each(|u| *u = 2.0 * random.number());
    state
}

/// What the model says of a contact at a state.
#[derive(Clone, Copy, Debug)]
pub struct Said {
    pub point: V,
    pub normal: V,
    pub gap: f64,
}

/// The place and the axes of the two bodies.
pub struct Pose {
    pub at: [V; 2],
    pub axes: [[V; 3]; 2],
}

pub fn evaluator<'m>(m: &'m Mechanism, state: &'m State, coordinates: Vec<HyperDual>) -> Evaluator<'m> {
    let speeds = state.speeds.iter().map(|u| HyperDual::constant(*u)).collect();
    Evaluator::new(m, &state.parameters, &state.inputs, HyperDual::ZERO, coordinates, speeds)
}

pub fn still(state: &State) -> Vec<HyperDual> {
    state.coordinates.iter().map(|q| HyperDual::constant(*q)).collect()
}

/// `None` where a direction is lost, which is said by name: a centre within a solid.
pub fn said(m: &Mechanism, state: &State) -> Option<Vec<Said>> {
    let values = evaluator(m, state, still(state));
    let of = |contact: &Contact| -> Result<Said, Failure> {
        Ok(Said {
            point: values.position(contact.point)?.map(|c| c.re),
            normal: values.vector(&contact.normal, Level::Geometry)?.map(|c| c.re),
            gap: values.scalar(contact.gap.as_ref().unwrap(), Level::Geometry)?.re,
        })
    };
    match m.contacts.iter().map(of).collect() {
        Ok(said) => Some(said),
        Err(Failure::DivisionByZero(_)) => None,
        Err(other) => panic!("{other:?}"),
    }
}

pub fn pose(m: &Mechanism, state: &State) -> Pose {
    let values = evaluator(m, state, still(state));
    let of = |body: usize| {
        let body = &m.bodies[body];
        let matrix = values.orientation(body.frame.unwrap()).unwrap();
        let axes = [0, 1, 2].map(|axis| [0, 1, 2].map(|row| matrix[row][axis].re));
        (values.position(body.centre).unwrap().map(|c| c.re), axes)
    };
    let (a, b) = (of(0), of(1));
    Pose { at: [a.0, b.0], axes: [a.1, b.1] }
}

pub fn plus(a: V, b: V, s: f64) -> V {
    [0, 1, 2].map(|i| a[i] + s * b[i])
}

pub fn scaled(a: V, s: f64) -> V {
    a.map(|x| s * x)
}

/// Components along axes.
pub fn along(v: V, axes: &[V; 3]) -> V {
    [0, 1, 2].map(|i| dot3(v, axes[i]))
}

pub fn back(v: V, axes: &[V; 3]) -> V {
    [0, 1, 2].map(|k| (0..3).map(|i| v[i] * axes[i][k]).sum())
}

/// Looks at random poses: `looks` compares what is said with what must be, and gives the largest difference.
/// Where it gives none the pose does not count. The rates are compared for all.
pub fn compare(name: &str, m: &Mechanism, looks: impl Fn(&[Said], &Pose) -> Option<f64>) {
    let mut random = Random::named(name);
    let (mut worst, mut worst_rate, mut worst_difference, mut seen) = (0.0_f64, 0.0_f64, 0.0_f64, 0);
    while seen < POSES {
        let state = random_state(&mut random, m);
        let Some(found) = said(m, &state) else { continue };
        let Some(off) = looks(&found, &pose(m, &state)) else { continue };
        worst = worst.max(off);
        for one in &found {
            worst = worst.max((norm3(one.normal) - 1.0).abs());
        }
        seen += 1;
        if seen % 20 != 0 {
            continue;
        }
        // dg/dt = n . v, with the velocities of the material points
        let views = Views::at(m, &state).unwrap();
        let scale = 1.0 + state.speeds.iter().fold(0.0_f64, |s, u| s.max(u.abs()));
        for (contact, one) in m.contacts.iter().zip(&found) {
            let rate = views.now.scalar(contact.gap.as_ref().unwrap(), Level::Geometry).unwrap().e1;
            let velocity = views.now.contact_velocity(contact).unwrap().map(|c| c.re);
            worst_rate = worst_rate.max((rate - dot3(velocity, one.normal)).abs() / scale);
        }
        if seen % 100 != 0 {
            continue;
        }
        // rates of point and normal along one direction of all coordinates, by differences of order 4
        let direction: Vec<f64> = state.coordinates.iter().map(|_| random.number()).collect();
        let moved = |h: f64| {
            let mut state = state.clone();
            state.coordinates.iter_mut().zip(&direction).for_each(|(q, d)| *q += h * d);
            said(m, &state)
        };
        let h = 1e-3;
        let around: Option<Vec<Vec<Said>>> =
            [-2.0, -1.0, 1.0, 2.0].into_iter().map(|k| moved(k * h)).collect();
        let Some(around) = around else { continue };
        let coordinates = state.coordinates.iter().zip(&direction);
        let coordinates = coordinates.map(|(q, d)| HyperDual { re: *q, e1: *d, ..HyperDual::ZERO }).collect();
        let values = evaluator(m, &state, coordinates);
        for (i, contact) in m.contacts.iter().enumerate() {
            let weights = [1.0, -8.0, 8.0, -1.0];
            let rate = |of: &dyn Fn(&Said) -> f64| -> f64 {
                around.iter().zip(weights).map(|(said, w)| w * of(&said[i])).sum::<f64>() / (12.0 * h)
            };
            // near a border of regions the fourth derivative jumps
            let curved: f64 = around.iter().zip([1.0, -4.0, -4.0, 1.0]).map(|(s, w)| w * s[i].gap).sum();
            let smooth = (curved + 6.0 * found[i].gap).abs() < 1e-9;
            let point = values.position(contact.point).unwrap();
            let normal = values.vector(&contact.normal, Level::Geometry).unwrap();
            for axis in 0..3 {
                let off = (rate(&|s| s.point[axis]) - point[axis].e1).abs();
                let tilt = (rate(&|s| s.normal[axis]) - normal[axis].e1).abs();
                if smooth {
                    worst_difference = worst_difference.max(off.max(tilt));
                }
            }
        }
    }
    println!(
        "{name}: {worst:.1e} beside nearest points, {worst_rate:.1e} of rates, {worst_difference:.1e} beside differences"
    );
    assert!(worst < 1e-12, "{name}: {worst:e}");
    assert!(worst_rate < 1e-12, "{name}: {worst_rate:e}");
    assert!(worst_difference < 1e-6, "{name}: {worst_difference:e}");
}

/// The plane of B: its normal F.y, through H + 0.3 F.y.
const PLANE: &str = "P { of: B, at: H + 3*k*F.y, plane: F.y }";

fn plane(pose: &Pose) -> (V, V) {
    let n = pose.axes[1][1];
    (plus(pose.at[1], n, 0.3), n)
}

/// The gap is that of the point, and the normal the plane's.
fn off_plane(one: &Said, pose: &Pose) -> f64 {
    let (o, n) = plane(pose);
    norm3(sub3(one.normal, n)).max((dot3(sub3(one.point, o), n) - one.gap).abs())
}

/// A circle with the centre c, the axis a and the radius R: p is its point that is lowest along n.
fn off_circle(p: V, c: V, a: V, radius: f64, n: V) -> f64 {
    let arm = sub3(p, c);
    let tangent = cross3(a, scaled(arm, 1.0 / radius));
    let low = if dot3(arm, n) < 0.0 { 0.0 } else { 1.0 };
    let off = [(norm3(arm) - radius).abs(), dot3(arm, a).abs(), dot3(tangent, n).abs(), low];
    off.into_iter().fold(0.0, f64::max)
}

#[test]
fn spheres_and_capsules_on_planes() {
    let m = model(
        &format!("S {{ of: A, at: G + k*E.x, sphere: 0.2*k }}, {PLANE}").replace("0.2*k", "2*k"),
        "S on P",
    );
    compare("sphere on plane", &m, |said, pose| {
        let [one] = said else { panic!() };
        let c = plus(pose.at[0], pose.axes[0][0], 0.1);
        let lowest = plus(c, plane(pose).1, -0.2);
        Some(off_plane(one, pose).max(norm3(sub3(one.point, lowest))))
    });
    let m = model(&format!("S {{ of: A, capsule: [2*k, 6*k], axis: E.z }}, {PLANE}"), "S on P");
    compare("capsule on plane", &m, |said, pose| {
        let [a, b] = said else { panic!() };
        let n = plane(pose).1;
        let ends = [0.3, -0.3].map(|s| plus(pose.at[0], pose.axes[0][2], s));
        let off = [(a, ends[0]), (b, ends[1])]
            .map(|(one, end)| off_plane(one, pose).max(norm3(sub3(one.point, plus(end, n, -0.2)))));
        Some(off[0].max(off[1]))
    });
}

#[test]
fn rims_on_planes() {
    let m = model(&format!("S {{ of: A, disc: 2*k, axis: E.z }}, {PLANE}"), "S on P");
    let flat = |pose: &Pose| norm3(cross3(pose.axes[0][2], plane(pose).1)) < 0.02;
    compare("disc on plane", &m, |said, pose| {
        let [one] = said else { panic!() };
        let off = off_circle(one.point, pose.at[0], pose.axes[0][2], 0.2, plane(pose).1);
        (!flat(pose)).then(|| off_plane(one, pose).max(off))
    });
    let m = model(&format!("S {{ of: A, torus: [4*k, k], axis: E.z }}, {PLANE}"), "S on P");
    compare("torus on plane", &m, |said, pose| {
        let [one] = said else { panic!() };
        let n = plane(pose).1;
        // the tube is thickest along -n, around a point of the circle
        let off = off_circle(plus(one.point, n, 0.1), pose.at[0], pose.axes[0][2], 0.4, n);
        (!flat(pose)).then(|| off_plane(one, pose).max(off))
    });
    let m = model(&format!("S {{ of: A, cylinder: [2*k, 6*k], axis: E.z }}, {PLANE}"), "S on P");
    compare("cylinder on plane", &m, |said, pose| {
        let [a, b] = said else { panic!() };
        let (n, axis) = (plane(pose).1, pose.axes[0][2]);
        let rims = [(a, 0.3), (b, -0.3)].map(|(one, s)| {
            off_circle(one.point, plus(pose.at[0], axis, s), axis, 0.2, n).max(off_plane(one, pose))
        });
        (!flat(pose)).then(|| rims[0].max(rims[1]))
    });
    let m = model(&format!("S {{ of: A, cone: [2*k, 5*k], axis: E.z }}, {PLANE}"), "S on P");
    compare("cone on plane", &m, |said, pose| {
        let [rim, apex] = said else { panic!() };
        let (n, axis) = (plane(pose).1, pose.axes[0][2]);
        let off = off_circle(rim.point, pose.at[0], axis, 0.2, n).max(off_plane(rim, pose));
        let top = norm3(sub3(apex.point, plus(pose.at[0], axis, 0.5))).max(off_plane(apex, pose));
        (!flat(pose)).then(|| off.max(top))
    });
}

#[test]
fn ellipsoids_and_corners_on_planes() {
    let m = model(&format!("S {{ of: A, ellipsoid: [2*k, 3*k, 5*k] }}, {PLANE}"), "S on P");
    compare("ellipsoid on plane", &m, |said, pose| {
        let [one] = said else { panic!() };
        let p = along(sub3(one.point, pose.at[0]), &pose.axes[0]);
        let sizes = [0.2, 0.3, 0.5];
        let value: f64 = (0..3).map(|i| (p[i] / sizes[i]).powi(2)).sum();
        let gradient = [0, 1, 2].map(|i| p[i] / sizes[i].powi(2));
        let outward = back(scaled(gradient, 1.0 / norm3(gradient)), &pose.axes[0]);
        let against = norm3(plus(outward, plane(pose).1, 1.0));
        Some(off_plane(one, pose).max((value - 1.0).abs()).max(against))
    });
    let m = model(&format!("S {{ of: A, box: [2*k, 4*k, 6*k] }}, {PLANE}"), "S on P");
    compare("box on plane", &m, |said, pose| {
        let mut left: Vec<V> = Vec::new();
        for signs in 0..8 {
            let side = |i: usize, half: f64| if signs >> i & 1 == 0 { half } else { -half };
            let corner = [side(0, 0.1), side(1, 0.2), side(2, 0.3)];
            left.push(plus(pose.at[0], back(corner, &pose.axes[0]), 1.0));
        }
        let mut worst = 0.0_f64;
        for one in said {
            // every corner once
            let distance = |corner: &V| norm3(sub3(one.point, *corner));
            let nearest = (0..left.len()).min_by(|a, b| distance(&left[*a]).total_cmp(&distance(&left[*b])));
            let corner = left.remove(nearest.unwrap());
            worst = worst.max(distance(&corner)).max(off_plane(one, pose));
        }
        assert!(left.is_empty());
        Some(worst)
    });
    let m =
        model(&format!("S {{ of: A, polytope: [G, G + k*E.x, G + 2*k*E.y - k*E.z] }}, {PLANE}"), "S on P");
    compare("polytope on plane", &m, |said, pose| {
        let at = [[0.0; 3], [0.1, 0.0, 0.0], [0.0, 0.2, -0.1]];
        let off = said.iter().zip(at).map(|(one, v)| {
            let vertex = plus(pose.at[0], back(v, &pose.axes[0]), 1.0);
            norm3(sub3(one.point, vertex)).max(off_plane(one, pose))
        });
        Some(off.fold(0.0, f64::max))
    });
}

/// The point of a solid that is nearest to c, along the axes of B, region by region; `None` within it.
fn projection(kind: Kind, c: V) -> Option<(V, f64)> {
    match kind {
        Kind::Sphere => Some(([0.0; 3], 0.4)),
        Kind::Capsule => {
            // above, beside or below the segment
            let z = c[2].clamp(-0.3, 0.3);
            Some(([0.0, 0.0, z], 0.2))
        }
        Kind::Cylinder => {
            let out = c[0].hypot(c[1]);
            let cap = if c[2] > 0.0 { 0.3 } else { -0.3 };
            let rim = [0.2 * c[0] / out, 0.2 * c[1] / out];
            match (out > 0.2, c[2].abs() > 0.3) {
                (false, false) => None,
                (false, true) => Some(([c[0], c[1], cap], 0.0)),
                (true, false) => Some(([rim[0], rim[1], c[2]], 0.0)),
                (true, true) => Some(([rim[0], rim[1], cap], 0.0)),
            }
        }
        Kind::Cone => {
            // of radius 0.2 and height 0.5, by the places on its profile: rim, apex, between them, and base
            let (out, z) = (c[0].hypot(c[1]), c[2]);
            let share = ((0.2 - out) * 0.2 + z * 0.5) / (0.04 + 0.25);
            let mut places = vec![[0.2, 0.0], [0.0, 0.5]];
            places.extend((0.0..=1.0).contains(&share).then_some([0.2 * (1.0 - share), 0.5 * share]));
            places.extend((out < 0.2).then_some([out, 0.0]));
            let far = |p: &[f64; 2]| (p[0] - out).hypot(p[1] - z);
            let best = places.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
            let within = z > 0.0 && out < 0.2 * (1.0 - z / 0.5);
            (!within && out > 1e-6).then(|| ([best[0] * c[0] / out, best[0] * c[1] / out, best[1]], 0.0))
        }
        Kind::Box => {
            // the nearest of all points of faces, edges and corners that lie beside c
            let half = [0.2, 0.3, 0.4];
            let outside = (0..3).any(|i| c[i].abs() > half[i]);
            let mut best: Option<V> = None;
            for region in 0..27_usize {
                let part = [region % 3, region / 3 % 3, region / 9];
                let p = [0, 1, 2].map(|i| [-half[i], c[i], half[i]][part[i]]);
                let within = (0..3).all(|i| p[i].abs() <= half[i]);
                let nearer = best.is_none_or(|b| norm3(sub3(p, c)) < norm3(sub3(b, c)));
                if within && nearer && part != [1, 1, 1] {
                    best = Some(p);
                }
            }
            best.filter(|_| outside).map(|p| (p, 0.0))
        }
        Kind::Disc | Kind::Torus => {
            // Newton's method for the angle, from the best of many
            let d = |t: f64| norm3(sub3([0.4 * t.cos(), 0.4 * t.sin(), 0.0], c));
            let start = (0..64).map(|i| f64::from(i) / 10.0).min_by(|a, b| d(*a).total_cmp(&d(*b)))?;
            let mut t = start;
            for _ in 0..20 {
                let slope = c[0] * t.sin() - c[1] * t.cos();
                t -= slope / (c[0] * t.cos() + c[1] * t.sin());
            }
            let thick = if kind == Kind::Torus { 0.1 } else { 0.0 };
            (c[0].hypot(c[1]) > 0.05).then_some(([0.4 * t.cos(), 0.4 * t.sin(), 0.0], thick))
        }
        _ => None,
    }
}

#[test]
fn spheres_on_solids() {
    let solids = [
        ("sphere", Kind::Sphere, "sphere: 4*k"),
        ("capsule", Kind::Capsule, "capsule: [2*k, 6*k], axis: F.z"),
        ("cylinder", Kind::Cylinder, "cylinder: [2*k, 6*k], axis: F.z"),
        ("cone", Kind::Cone, "cone: [2*k, 5*k], axis: F.z"),
        ("box", Kind::Box, "box: [4*k, 6*k, 8*k]"),
        ("disc", Kind::Disc, "disc: 4*k, axis: F.z"),
        ("torus", Kind::Torus, "torus: [4*k, k], axis: F.z"),
    ];
    for (name, kind, solid) in solids {
        let m = model(&format!("S {{ of: A, sphere: k }}, T {{ of: B, {solid} }}"), "S on T");
        compare(&format!("sphere on {name}"), &m, |said, pose| {
            let [one] = said else { panic!() };
            let c = along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]);
            let (nearest, thick) = projection(kind, c)?;
            let away = sub3(c, nearest);
            // where the centre is next to the surface the direction is lost
            if norm3(away) < 0.02 {
                return None;
            }
            let n = back(scaled(away, 1.0 / norm3(away)), &pose.axes[1]);
            let point = plus(pose.at[0], n, -0.1);
            let gap = norm3(away) - thick - 0.1;
            // directions from a distance d are known to rounding of the places over d
            let direction = norm3(sub3(one.normal, n)) * norm3(away);
            Some((one.gap - gap).abs().max(norm3(sub3(one.point, point)) * norm3(away)).max(direction))
        });
    }
}

/// The nearest points of two segments from the middles a_0 and b_0 along unit vectors, and sin^2 of their angle: of
/// all ends with the other segment, and of the insides, the pair that is nearest.
pub fn of_segments([a_0, a]: [V; 2], h: f64, [b_0, b]: [V; 2], k: f64) -> (V, V, f64) {
    let held =
        |from: V, along: V, half: f64, p: V| plus(from, along, dot3(sub3(p, from), along).clamp(-half, half));
    let mut pairs = Vec::new();
    for sign in [-1.0, 1.0] {
        let (end, other) = (plus(a_0, a, sign * h), plus(b_0, b, sign * k));
        pairs.push((end, held(b_0, b, k, end)));
        pairs.push((held(a_0, a, h, other), other));
    }
    // the lines are nearest along their common normal: volumes of parallelepipeds
    let (normal, d) = (cross3(a, b), sub3(b_0, a_0));
    let apart = dot3(normal, normal);
    let (s, t) = (dot3(cross3(d, b), normal) / apart, dot3(cross3(d, a), normal) / apart);
    if s.abs() < h && t.abs() < k {
        pairs.push((plus(a_0, a, s), plus(b_0, b, t)));
    }
    let nearest =
        pairs.into_iter().min_by(|(p, q), (r, s)| norm3(sub3(*p, *q)).total_cmp(&norm3(sub3(*r, *s))));
    let (p, q) = nearest.unwrap();
    (p, q, apart)
}

#[test]
fn capsules_on_capsules() {
    let shapes = "S { of: A, capsule: [k, 8*k], axis: E.x }, T { of: B, capsule: [2*k, 12*k], axis: F.z }";
    let m = model(shapes, "S on T");
    let look = |said: &[Said], pose: &Pose| {
        let [one] = said else { panic!() };
        let (p, q, apart) =
            of_segments([pose.at[0], pose.axes[0][0]], 0.4, [pose.at[1], pose.axes[1][2]], 0.6);
        let w = sub3(p, q);
        if norm3(w) < 0.02 {
            return None;
        }
        let n = scaled(w, 1.0 / norm3(w));
        // places along axes are known to rounding over the square of the angle between them
        let known = norm3(w) * apart.min(1.0);
        let off = norm3(sub3(one.normal, n)).max(norm3(sub3(one.point, plus(p, n, -0.1))));
        Some((one.gap - (norm3(w) - 0.3)).abs().max(off * known))
    };
    compare("capsule on capsule", &m, look);
    // parallel, and nearly so: the distance of the axes, at one of their common places
    let mut state = State::of(&m);
    for tilt in [0.0, 1e-14, 1e-10, 1e-7, 1e-5] {
        for along in [-0.9, -0.3, 0.0, 0.2, 0.7] {
            state.coordinates.iter_mut().for_each(|q| *q = 0.0);
            // the first lies along x, the second along its z, turned to x
            (state.coordinates[0], state.coordinates[1]) = (along, 0.5);
            state.coordinates[10] = std::f64::consts::FRAC_PI_2 + tilt;
            let found = said(&m, &state).unwrap();
            let pose = pose(&m, &state);
            let (p, q, _) =
                of_segments([pose.at[0], pose.axes[0][0]], 0.4, [pose.at[1], pose.axes[1][2]], 0.6);
            let gap = norm3(sub3(p, q)) - 0.3;
            assert!((found[0].gap - gap).abs() < 1e-12, "{tilt:e} {along}: {} {gap}", found[0].gap);
            assert!((norm3(found[0].normal) - 1.0).abs() < 1e-12);
        }
    }
    // axes that cross have no direction
    state.coordinates.iter_mut().for_each(|q| *q = 0.0);
    assert!(said(&m, &state).is_none());
}

/// Whether a segment passes through a box: clipped by its three pairs of faces something is left.
fn pierces([c, a]: [V; 2], h: f64, half: V) -> bool {
    let (mut from, mut to) = (-h, h);
    for i in 0..3 {
        let mut at = [(-half[i] - c[i]) / a[i], (half[i] - c[i]) / a[i]];
        at.sort_by(f64::total_cmp);
        from = at[0].max(from);
        to = at[1].min(to);
    }
    from < to
}

/// The nearest points of a segment and a box about the origin: of the ends with the box, and of the segment with each
/// edge; with the square of the sine of the angle that tells how well they are known.
fn of_segment_and_box([c, a]: [V; 2], h: f64, half: V) -> (V, V, f64) {
    let mut pairs: Vec<(V, V, f64)> = Vec::new();
    for sign in [-1.0, 1.0] {
        let end = plus(c, a, sign * h);
        pairs.push((end, [0, 1, 2].map(|i| end[i].clamp(-half[i], half[i])), 1.0));
    }
    for i in 0..3 {
        for number in 0..4 {
            let mut middle = [0.0; 3];
            for (bit, axis) in [(i + 1) % 3, (i + 2) % 3].into_iter().enumerate() {
                middle[axis] = if number >> bit & 1 == 0 { half[axis] } else { -half[axis] };
            }
            let along = [0, 1, 2].map(|k| f64::from(u8::from(k == i)));
            pairs.push(of_segments([c, a], h, [middle, along], half[i]));
        }
    }
    let distance = |(p, q, _): &(V, V, f64)| norm3(sub3(*p, *q));
    pairs.into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other))).unwrap()
}

/// The contact with the least gap of those that are valid: elsewhere a gap is only positive.
pub fn nearest_valid(m: &Mechanism, state: &State, found: &[Said]) -> usize {
    let values = evaluator(m, state, still(state));
    let is_valid = |contact: &Contact| {
        contact.validity.as_ref().is_none_or(|of| values.scalar(of, Level::Geometry).unwrap().re >= 0.0)
    };
    let valid = (0..found.len()).filter(|&i| is_valid(&m.contacts[i]));
    valid.min_by(|a, b| found[*a].gap.total_cmp(&found[*b].gap)).unwrap()
}

/// Of all contacts of a capsule (radius 0.1, half length 0.5) with a body of so many edges the nearest tells the distance;
/// each that is valid has a gap whose rate is the normal velocity. The nearest points of a segment, given in the body's
/// frame, and the body are found by `nearest`; `None` where the segment passes through.
pub fn compare_capsules(
    name: &str,
    m: &Mechanism,
    edges: usize,
    nearest: impl Fn([V; 2]) -> Option<(V, V, f64)>,
) {
    let mut random = Random::named(name);
    let (mut worst, mut worst_rate, mut through) = (0.0_f64, 0.0_f64, 0);
    // poses in which the nearest contact is of an end, an edge and a vertex
    let mut seen = [0; 3];
    while seen.iter().sum::<usize>() < POSES {
        let state = random_state(&mut random, m);
        let pose = pose(m, &state);
        let segment =
            [along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]), along(pose.axes[0][0], &pose.axes[1])];
        let Some((p, q, apart)) = nearest(segment) else {
            // an end within the body has no direction, which is an error
            through += 1;
            assert!(said(m, &state).is_none_or(|found| found.iter().any(|one| one.gap < 0.0)), "{state:?}");
            continue;
        };
        let distance = norm3(sub3(p, q));
        let found = said(m, &state).unwrap();
        // bodies that overlap are refused, and are known by a contact that is
        assert_eq!(distance > 0.1, found.iter().all(|one| one.gap > 0.0), "{distance} {state:?}");
        if distance < 0.1 {
            continue;
        }
        let nearest = nearest_valid(m, &state, &found);
        seen[usize::from(nearest >= 2) + usize::from(nearest >= 2 + edges)] += 1;
        worst = worst.max((found[nearest].gap - (distance - 0.1)).abs());
        let n = back(scaled(sub3(p, q), 1.0 / distance), &pose.axes[1]);
        let on = plus(plus(pose.at[1], back(p, &pose.axes[1]), 1.0), n, -0.1);
        let known = distance * apart.min(1.0);
        worst = worst.max(norm3(sub3(found[nearest].normal, n)) * known);
        worst = worst.max(norm3(sub3(found[nearest].point, on)) * known);
        let views = Views::at(m, &state).unwrap();
        let scale = 1.0 + state.speeds.iter().fold(0.0_f64, |s, u| s.max(u.abs()));
        for (contact, one) in m.contacts.iter().zip(&found) {
            let scalar =
                |of: &Option<_>| of.as_ref().map(|of| views.now.scalar(of, Level::Geometry).unwrap());
            if scalar(&contact.validity).is_some_and(|validity| validity.re < 1e-9) {
                continue;
            }
            // one that is valid is no nearer than the nearest
            assert!(one.gap >= distance - 0.1 - 1e-12, "{state:?}");
            let rate = scalar(&contact.gap).unwrap().e1;
            let velocity = views.now.contact_velocity(contact).unwrap().map(|c| c.re);
            let off = (rate - dot3(velocity, one.normal)).abs() / scale;
            worst_rate = worst_rate.max(off * known.min(1.0));
        }
    }
    println!(
        "{name}: {seen:?}, {through} through: {worst:.1e} beside nearest points, {worst_rate:.1e} of rates"
    );
    assert!(worst < 1e-12 && worst_rate < 1e-12, "{name}: {worst:e} {worst_rate:e}");
    assert!(seen.iter().all(|&count| count > 500), "{name}: {seen:?}");
}

/// The contacts of a capsule on a box: two ends, twelve edges, eight vertices.
#[test]
fn capsules_on_boxes() {
    let shapes = "S { of: A, capsule: [k, 10*k], axis: E.x }, T { of: B, box: [4*k, 6*k, 8*k] }";
    let m = model(shapes, "S on T");
    assert_eq!(m.contacts.len(), 22);
    let half = [0.2, 0.3, 0.4];
    compare_capsules("capsule on box", &m, 12, |segment| {
        (!pierces(segment, 0.5, half)).then(|| of_segment_and_box(segment, 0.5, half))
    });
}

/// A capsule that lies flat on a face and beyond both of its edges has a contact at each, also where it is tilted by
/// rounding; along an edge it has one at each vertex, or at each end.
#[test]
fn capsules_that_lie_on_boxes_are_carried_at_both_ends() {
    let shapes = "S { of: A, capsule: [k, 10*k], axis: E.x }, T { of: B, box: [4*k, 6*k, 8*k] }";
    let m = model(shapes, "S on T");
    let mut state = State::of(&m);
    let mut carried = |x: f64, y: f64, z: f64, turned: f64, tilt: f64| {
        state.coordinates.iter_mut().for_each(|q| *q = 0.0);
        // the capsule's axis is turned about z, then tilted
        (state.coordinates[0], state.coordinates[1], state.coordinates[2]) = (x, y, z);
        (state.coordinates[4], state.coordinates[5]) = (tilt, turned);
        // the middle of the box is at the origin
        let found = said(&m, &state).unwrap();
        let near = found.iter().filter(|one| one.gap.abs() < 1e-12);
        let mut places: Vec<[i64; 2]> =
            near.map(|one| [0, 1].map(|i| (one.point[i] * 1e6).round() as i64)).collect();
        places.sort_unstable();
        places.dedup();
        places
    };
    for tilt in [0.0, 1e-15, -1e-15] {
        // over both edges along y, 0.4 apart
        assert_eq!(carried(0.0, 0.1, 0.5, 0.0, tilt), [[-200_000, 100_000], [200_000, 100_000]]);
        // one end on the face, the other beyond it
        assert_eq!(carried(0.4, 0.1, 0.5, 0.0, tilt), [[-100_000, 100_000], [200_000, 100_000]]);
        // on an edge along x
        assert_eq!(carried(0.0, 0.3, 0.5, 0.0, tilt), [[-200_000, 300_000], [200_000, 300_000]]);
        assert_eq!(carried(0.4, 0.3, 0.5, 0.0, tilt), [[-100_000, 300_000], [200_000, 300_000]]);
    }
    // diagonally over two vertices
    let turned = 1.5_f64.atan();
    assert_eq!(carried(0.0, 0.0, 0.5, turned, 0.0), [[-200_000, -300_000], [200_000, 300_000]]);
}

/// In a plane of motion: the same distance as from a box that is long across it.
#[test]
fn capsules_on_rectangles() {
    let text = |solid: &str| {
        format!(
            "mechanism Flat;
parameters {{ m: kg = 1, J: kg*m^2 = 0.1, k: m = 0.1 }}
coordinates {{ x: m, y: m = 5, q: rad }}
speeds {{ u: m/s, v: m/s, w: rad/s }}
frames {{ E = N.rotate(z, q); }}
points {{ G = O + x*N.x + y*N.y; }}
bodies {{ A {{ frame: E, centre: G, mass: m, inertia: [J, J, J] }} }}
shapes {{ S {{ of: A, capsule: [k, 10*k], axis: E.x }}, T {{ {solid} }} }}
kinematics {{ d(x)/dt = u; d(y)/dt = v; d(q)/dt = w; }}
contacts {{ touch {{ S on T }} }}
"
        )
    };
    let read = |solid: &str| {
        let source = Source::file("flat.mech", text(solid));
        let checked = check(&source);
        let said = render(&checked.diagnostics, &source);
        checked.mechanism.unwrap_or_else(|| panic!("{said}"))
    };
    let (flat, long) = (read("rectangle: [4*k, 6*k]"), read("box: [4*k, 6*k, 80*k]"));
    assert_eq!(flat.contacts.len(), 6);
    let mut random = Random::named("capsule on rectangle");
    let (mut worst, mut seen) = (0.0_f64, [0; 2]);
    for _ in 0..POSES {
        let state = random_state(&mut random, &flat);
        let [Some(one), Some(other)] = [said(&flat, &state), said(&long, &state)] else { continue };
        let apart = [&one, &other].map(|said| said.iter().all(|one| one.gap > 0.0));
        assert_eq!(apart[0], apart[1], "{state:?}");
        if !apart[0] {
            continue;
        }
        let (a, b) = (nearest_valid(&flat, &state, &one), nearest_valid(&long, &state, &other));
        seen[usize::from(a >= 2)] += 1;
        worst = worst.max((one[a].gap - other[b].gap).abs());
        worst = worst.max(norm3(sub3(one[a].normal, other[b].normal)) * (other[b].gap + 0.1));
    }
    println!("{seen:?}: {worst:.1e}");
    assert!(worst < 1e-12 && seen.iter().all(|&count| count > 500), "{seen:?} {worst:e}");
}

#[test]
fn spheres_within_solids() {
    let solids = [
        ("sphere", Kind::Sphere, "sphere: 4*k", 0.4),
        ("capsule", Kind::Capsule, "capsule: [2*k, 6*k], axis: F.z", 0.2),
        ("cylinder", Kind::Cylinder, "cylinder: [2*k, 6*k], axis: F.z", 0.2),
    ];
    for (name, kind, solid, radius) in solids {
        let m = model(&format!("S {{ of: A, sphere: k }}, T {{ of: B, {solid} }}"), "S in T");
        compare(&format!("sphere in {name}"), &m, |said, pose| {
            let [one] = said else { panic!() };
            let c = along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]);
            let middle = match kind {
                Kind::Cylinder => [0.0, 0.0, c[2]],
                _ => projection(kind, c)?.0,
            };
            let out = sub3(c, middle);
            if norm3(out) < 0.02 {
                return None;
            }
            let n = back(scaled(out, -1.0 / norm3(out)), &pose.axes[1]);
            let off = norm3(sub3(one.normal, n)) + norm3(sub3(one.point, plus(pose.at[0], n, -0.1)));
            Some((one.gap - (radius - 0.1 - norm3(out))).abs().max(off * norm3(out)))
        });
    }
    let m = model("S { of: A, sphere: k }, T { of: B, box: [4*k, 6*k, 8*k] }", "S in T");
    compare("sphere in box", &m, |said, pose| {
        let c = along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]);
        let half = [0.2, 0.3, 0.4];
        let off = said.iter().enumerate().map(|(i, one)| {
            let (axis, sign) = (i / 2, if i % 2 == 0 { 1.0 } else { -1.0 });
            let gap = half[axis] - sign * c[axis] - 0.1;
            (one.gap - gap).abs().max(norm3(plus(one.normal, pose.axes[1][axis], sign)))
        });
        Some(off.fold(0.0, f64::max))
    });
}

/// Vertices on waves: where the gap is 0 they are on the surface, the normal is that of the surface, and the
/// rate of the gap is n . v.
#[test]
fn vertices_on_heights() {
    for (shape, planar) in
        [("surface: k*sin(3*x/k/10)*cos(2*y/k/10)", false), ("curve: k*sin(3*x/k/10)^2", true)]
    {
        let m = model(&format!("S {{ of: A, polytope: [G + k*E.x] }}, W {{ of: B, {shape} }}"), "S on W");
        let height = |x: f64, y: f64| {
            if planar { 0.1 * (3.0 * x).sin().powi(2) } else { 0.1 * (3.0 * x).sin() * (2.0 * y).cos() }
        };
        let slope = |x: f64, y: f64| {
            if planar {
                [0.6 * (3.0 * x).sin() * (3.0 * x).cos(), 0.0]
            } else {
                [0.3 * (3.0 * x).cos() * (2.0 * y).cos(), -0.2 * (3.0 * x).sin() * (2.0 * y).sin()]
            }
        };
        let mut random = Random::new(7);
        let (mut worst, mut worst_rate) = (0.0_f64, 0.0_f64);
        for _ in 0..POSES {
            let mut state = random_state(&mut random, &m);
            let pose = pose(&m, &state);
            let vertex = plus(pose.at[0], pose.axes[0][0], 0.1);
            // move A so that the vertex is on the surface
            let mut d = along(sub3(vertex, pose.at[1]), &pose.axes[1]);
            let up = if planar { 1 } else { 2 };
            let lift = height(d[0], d[1]) - d[up];
            d[up] += lift;
            for i in 0..3 {
                state.coordinates[i] += lift * pose.axes[1][up][i];
            }
            let one = said(&m, &state).unwrap()[0];
            let [sx, sy] = slope(d[0], d[1]);
            let n = if planar { [-sx, 1.0, 0.0] } else { [-sx, -sy, 1.0] };
            let n = back(scaled(n, 1.0 / norm3(n)), &pose.axes[1]);
            worst = worst.max(one.gap.abs()).max(norm3(sub3(one.normal, n)));
            let views = Views::at(&m, &state).unwrap();
            let rate = views.now.scalar(m.contacts[0].gap.as_ref().unwrap(), Level::Geometry).unwrap().e1;
            let velocity = views.now.contact_velocity(&m.contacts[0]).unwrap().map(|c| c.re);
            worst_rate = worst_rate.max((rate - dot3(velocity, one.normal)).abs());
        }
        println!("vertex on {shape}: {worst:.1e}, rates {worst_rate:.1e}");
        assert!(worst < 1e-12 && worst_rate < 1e-12, "{worst:e} {worst_rate:e}");
    }
}

/// Where a direction is lost the answer is an error by name, and no number.
#[test]
fn lost_directions_are_errors() {
    let cases = [
        ("disc flat on a plane", "S { of: A, disc: 2*k, axis: E.y }, P { of: B, plane: F.y }", "S on P"),
        (
            "torus flat on a plane",
            "S { of: A, torus: [2*k, k], axis: E.y }, P { of: B, plane: F.y }",
            "S on P",
        ),
        (
            "cylinder on its end",
            "S { of: A, cylinder: [2*k, k], axis: E.y }, P { of: B, plane: F.y }",
            "S on P",
        ),
        ("cone on its base", "S { of: A, cone: [2*k, k], axis: E.y }, P { of: B, plane: F.y }", "S on P"),
        ("centre on centre", "S { of: A, sphere: k }, T { of: B, sphere: k }", "S on T"),
        ("in the middle of a bowl", "S { of: A, sphere: k }, T { of: B, sphere: 3*k }", "S in T"),
        (
            "on the axis of a pipe",
            "S { of: A, sphere: k }, T { of: B, cylinder: [3*k, k], axis: F.x }",
            "S in T",
        ),
        (
            "on the axis of a capsule",
            "S { of: A, sphere: k }, T { of: B, capsule: [k, k], axis: F.x }",
            "S on T",
        ),
        (
            "on the axis of a torus",
            "S { of: A, sphere: k }, T { of: B, torus: [3*k, k], axis: F.x }",
            "S on T",
        ),
        ("within a box", "S { of: A, sphere: k }, T { of: B, box: [k, k, k] }", "S on T"),
    ];
    for (name, shapes, contact) in cases {
        let m = model(shapes, contact);
        let mut state = State::of(&m);
        state.coordinates.iter_mut().for_each(|q| *q = 0.0);
        assert!(said(&m, &state).is_none(), "{name}: {:?}", said(&m, &state));
        // a little beside it there are numbers
        state.coordinates[..6].iter_mut().for_each(|q| *q = 1e-9);
        for one in said(&m, &state).into_iter().flatten() {
            assert!(one.gap.is_finite() && (norm3(one.normal) - 1.0).abs() < 1e-9, "{name}: {one:?}");
        }
    }
    // the edge between side and cap of a cylinder, the corner of a box, the end of a capsule: no direction is lost
    for solid in [
        "cylinder: [k, 2*k], axis: F.z",
        "box: [2*k, 2*k, 2*k]",
        "capsule: [k, 2*k], axis: F.z",
        "cone: [k, 2*k], axis: F.z",
    ] {
        let m = model(&format!("S {{ of: A, sphere: k }}, T {{ of: B, {solid} }}"), "S on T");
        let mut state = State::of(&m);
        state.coordinates.iter_mut().for_each(|q| *q = 0.0);
        for place in [[0.0, 0.0, 0.5], [0.0, 0.0, -0.5], [0.3, 0.3, 0.1], [0.5, 0.0, 0.1], [0.5, 0.0, 0.0]] {
            state.coordinates[..3].copy_from_slice(&place);
            let found = said(&m, &state).unwrap_or_else(|| panic!("{solid} at {place:?}"));
            assert!(found[0].gap > 0.0 && (norm3(found[0].normal) - 1.0).abs() < 1e-12);
        }
    }
}
