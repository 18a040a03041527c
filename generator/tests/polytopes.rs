//! Contacts of spheres on polytopes against the nearest points of their triangles, and polytopes that are none.

use hodograph_generator::check::check;
use hodograph_generator::numeric::views::{cross3, dot3, norm3, sub3};
use hodograph_generator::rendering::render;
use hodograph_generator::source::Source;

use crate::shapes::{V, along, back, compare, compare_capsules, model, of_segments, plus, scaled};

/// The vertices of a polytope on B, and the corners of its faces counterclockwise as seen from outside.
const PYRAMID: ([V; 5], [&[usize]; 5]) = (
    [[0.3, 0.0, -0.2], [0.0, 0.4, -0.2], [-0.3, 0.0, -0.2], [0.0, -0.4, -0.2], [0.1, 0.1, 0.4]],
    [&[3, 2, 1, 0], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
);

/// The distance of a place from the pyramid, negative inside, and its direction: the greatest height over a face inside;
/// outside the nearest of the places on its triangles.
fn off_pyramid(c: V) -> (f64, V) {
    let (vertices, faces) = PYRAMID;
    let mut inside: (f64, V) = (f64::NEG_INFINITY, [0.0; 3]);
    let mut outside: (f64, V) = (f64::INFINITY, [0.0; 3]);
    for face in faces {
        for i in 1..face.len() - 1 {
            let [a, b, d] = [0, i, i + 1].map(|k| vertices[face[k]]);
            let n = cross3(sub3(b, a), sub3(d, a));
            let n = scaled(n, 1.0 / norm3(n));
            let height = dot3(n, sub3(c, a));
            if height > inside.0 {
                inside = (height, n);
            }
            let foot = plus(c, n, -height);
            let sides = [[a, b], [b, d], [d, a]];
            let is_over = sides.iter().all(|[p, q]| dot3(cross3(n, sub3(*q, *p)), sub3(foot, *p)) >= 0.0);
            let on_sides = sides.map(|[p, q]| {
                let way = sub3(q, p);
                plus(p, way, (dot3(sub3(c, p), way) / dot3(way, way)).clamp(0.0, 1.0))
            });
            for place in on_sides.into_iter().chain(is_over.then_some(foot)) {
                let away = sub3(c, place);
                if norm3(away) < outside.0 {
                    outside = (norm3(away), scaled(away, 1.0 / norm3(away)));
                }
            }
        }
    }
    if inside.0 < 0.0 { inside } else { outside }
}

#[test]
fn spheres_on_polytopes() {
    let vertices =
        PYRAMID.0.map(|v| format!("H + {}*F.x + {}*F.y + {}*F.z", v[0], v[1], v[2]).replace("*F", "*10*k*F"));
    let shapes = format!("S {{ of: A, sphere: k }}, T {{ of: B, polytope: [{}] }}", vertices.join(", "));
    let m = model(&shapes, "S on T");
    let inside = std::cell::Cell::new(0);
    compare("sphere on polytope", &m, |said, pose| {
        let [one] = said else { panic!() };
        let c = along(sub3(pose.at[0], pose.at[1]), &pose.axes[1]);
        let (distance, n) = off_pyramid(c);
        // where the centre is next to the surface the direction is lost
        if distance.abs() < 0.02 {
            return None;
        }
        inside.set(inside.get() + usize::from(distance < 0.0));
        let n = back(n, &pose.axes[1]);
        let point = plus(pose.at[0], n, -0.1);
        let direction = norm3(sub3(one.normal, n)) * distance.abs();
        Some(
            (one.gap - distance + 0.1)
                .abs()
                .max(norm3(sub3(one.point, point)) * distance.abs())
                .max(direction),
        )
    });
    assert!(inside.get() > 10, "{}", inside.get());
}

/// The nearest points of a segment and the pyramid: of the ends with the pyramid, and of the segment with each edge; with
/// the square of the sine of the angle that tells how well they are known. `None` where the segment passes through.
fn of_segment_and_pyramid([c, a]: [V; 2], h: f64) -> Option<(V, V, f64)> {
    let (vertices, faces) = PYRAMID;
    let (mut from, mut to) = (-h, h);
    let mut pairs: Vec<(V, V, f64)> = Vec::new();
    for face in faces {
        let [p, q, r] = [0, 1, 2].map(|k| vertices[face[k]]);
        let n = cross3(sub3(q, p), sub3(r, p));
        let (height, slope) = (dot3(n, sub3(c, p)), dot3(n, a));
        let at = -height / slope;
        if slope > 0.0 {
            to = at.min(to)
        } else {
            from = at.max(from)
        }
        for i in 0..face.len() {
            let [p, q] = [i, (i + 1) % face.len()].map(|k| vertices[face[k]]);
            let way = sub3(q, p);
            let (middle, half) = (plus(p, way, 0.5), 0.5 * norm3(way));
            pairs.push(of_segments([c, a], h, [middle, scaled(way, 0.5 / half)], half));
        }
    }
    if from < to {
        return None;
    }
    for sign in [-1.0, 1.0] {
        let end = plus(c, a, sign * h);
        let (distance, n) = off_pyramid(end);
        pairs.push((end, plus(end, n, -distance), 1.0));
    }
    let distance = |(p, q, _): &(V, V, f64)| norm3(sub3(*p, *q));
    pairs.into_iter().min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// The contacts of a capsule on a pyramid: two ends, eight edges, five vertices.
#[test]
fn capsules_on_polytopes() {
    let vertices = PYRAMID.0.map(|v| format!("H + 10*k*F.vec({}, {}, {})", v[0], v[1], v[2]));
    let capsule = "S { of: A, capsule: [k, 10*k], axis: E.x }";
    let m = model(&format!("{capsule}, T {{ of: B, polytope: [{}] }}", vertices.join(", ")), "S on T");
    assert_eq!(m.contacts.len(), 15);
    compare_capsules("capsule on polytope", &m, 8, |segment| of_segment_and_pyramid(segment, 0.5));
}

/// Polytopes that are none, and pairs with too many contacts, are named.
#[test]
fn polytopes_without_a_hull() {
    let said = |polytope: &str, pair: &str| -> String {
        let text = format!(
            "mechanism Two;
parameters {{ m: kg = 1, J: kg*m^2 = 0.1, k: m = 0.1, free: m }}
coordinates {{ q1: m, q2: m = 5, q3: m, q4: rad, q5: rad, q6: rad }}
speeds {{ u1: m/s, u2: m/s, u3: m/s, u4: rad/s, u5: rad/s, u6: rad/s }}
frames {{ E = N.euler(xyz, q4, q5, q6); }}
points {{ G = O + q1*N.x + q2*N.y + q3*N.z; }}
bodies {{ A {{ frame: E, centre: G, mass: m, inertia: [J, J, J] }} }}
shapes {{ S {{ of: A, polytope: [{polytope}] }}, Crate {{ at: O, box: [k, k, k] }}, Floor {{ plane: N.y }} }}
contacts {{ touch {{ {pair} }} }}
"
        );
        let source = Source::file("two.mech", text);
        render(&check(&source).diagnostics, &source)
    };
    let corner = "G, G + k*E.x, G + k*E.y";
    let flat = said(&format!("{corner}, G + k*E.x + k*E.y"), "S on Crate");
    assert!(flat.contains("`S` is no solid: all of its vertices are in one plane"), "{flat}");
    let unknown = said(&format!("{corner}, G + free*E.z"), "Crate on S");
    assert!(
        unknown.contains("`S` is no solid") && unknown.contains("the values that the model gives"),
        "{unknown}"
    );
    let inner = said(&format!("{corner}, G + k*E.z, G + k/10*E.vec(1, 1, 1)"), "S on Crate");
    assert!(inner.contains("point 5 of `S` is no vertex"), "{inner}");
    let around: Vec<String> =
        (0..24).map(|i| format!("G + k*E.vec(cos({i}*pi/12), sin({i}*pi/12), {})", i % 2)).collect();
    let many = said(&around.join(", "), "S on Crate");
    assert!(many.contains("contacts, of vertices with faces") && many.contains("more than 256"), "{many}");
    // on a plane only vertices count
    let on_plane = said(&format!("{corner}, G + k*E.x + k*E.y"), "S on Floor");
    assert!(!on_plane.contains("error"), "{on_plane}");
}
