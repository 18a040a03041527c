//! Contacts of rectangles, whose sides end, against the nearest points of two convex bodies, which are
//! found in another way: every vertex of one with the other body, every edge with every edge.
//!
//! The numbers are those of a derived program. The closed forms are in
//! `generator/model/src/model/lower/shapes/faces.rs`.

use hodograph::{ComponentKind, Contacts, State};
use hodograph_random::Random;
use nalgebra::Vector3;

use crate::ledge::block_on_ledge::BlockOnLedge;
use crate::many::model;

pub type V = [f64; 3];

/// Half the sides of the two bodies.
type Halves = [[f64; 3]; 2];

/// The middles of two bodies, and their axes.
pub struct Pose {
    pub at: [V; 2],
    pub axes: [[V; 3]; 2],
}

pub fn dot3(a: V, b: V) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

pub fn norm3(a: V) -> f64 {
    dot3(a, a).sqrt()
}

pub fn sub3(a: V, b: V) -> V {
    [0, 1, 2].map(|i| a[i] - b[i])
}

pub fn plus(a: V, b: V, s: f64) -> V {
    [0, 1, 2].map(|i| a[i] + s * b[i])
}

fn scaled(a: V, s: f64) -> V {
    a.map(|x| s * x)
}

/// Components along axes.
pub fn along(v: V, axes: &[V; 3]) -> V {
    [0, 1, 2].map(|i| dot3(v, axes[i]))
}

pub fn back(v: V, axes: &[V; 3]) -> V {
    [0, 1, 2].map(|k| (0..3).map(|i| v[i] * axes[i][k]).sum())
}

/// Where the nearest points of two bodies are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// a vertex of this body in the inside of a face of the other
    Face(usize),
    /// the insides of an edge of each
    Edges,
    /// a vertex on an edge or a vertex
    Other,
}

/// The nearest points of two bodies that are apart.
#[derive(Clone, Copy, Debug)]
pub struct Nearest {
    pub distance: f64,
    pub points: [V; 2],
    pub place: Place,
}

/// This far from the end of a face or edge a place is in its inside.
pub const INSIDE: f64 = 1e-6;

fn corners(pose: &Pose, halves: &Halves, body: usize) -> Vec<V> {
    let h = halves[body];
    let corner = |number: usize| {
        let side = |i: usize| if number >> i & 1 == 0 { h[i] } else { -h[i] };
        plus(pose.at[body], back([side(0), side(1), side(2)], &pose.axes[body]), 1.0)
    };
    // those of a rectangle twice
    (0..8).map(corner).collect()
}

fn nearest(pose: &Pose, halves: &Halves) -> Option<Nearest> {
    let mut best: Option<Nearest> = None;
    let mut look = |found: Nearest| {
        if best.is_none_or(|best| found.distance < best.distance) {
            best = Some(found);
        }
    };
    for body in [0, 1] {
        let other = 1 - body;
        for vertex in corners(pose, halves, body) {
            let local = along(sub3(vertex, pose.at[other]), &pose.axes[other]);
            let held = [0, 1, 2].map(|i| local[i].clamp(-halves[other][i], halves[other][i]));
            let beyond = (0..3).filter(|&i| local[i].abs() > halves[other][i] - INSIDE).count();
            if held == local {
                return None;
            }
            let there = plus(pose.at[other], back(held, &pose.axes[other]), 1.0);
            let points = if body == 0 { [vertex, there] } else { [there, vertex] };
            let flat = halves[other][2] == 0.0;
            let place = if beyond == 1 + usize::from(flat) { Place::Face(body) } else { Place::Other };
            look(Nearest { distance: norm3(sub3(vertex, there)), points, place });
        }
    }
    let edges = |body: usize| {
        let (vertices, axes) = (corners(pose, halves, body), pose.axes[body]);
        (0..3).flat_map(move |i| {
            let vertices = vertices.clone();
            let ends = (0..8).filter(move |number| number >> i & 1 == 0).map(move |number| vertices[number]);
            ends.map(move |end| (end, scaled(axes[i], -2.0 * halves[body][i]))).collect::<Vec<_>>()
        })
    };
    for body in [0, 1] {
        if edges(body).any(|edge| pierces(edge, pose, halves, 1 - body)) {
            return None;
        }
    }
    for (p, d) in edges(0) {
        for (q, e) in edges(1) {
            crossing((p, d), (q, e)).into_iter().for_each(&mut look);
        }
    }
    best
}

/// The nearest places of two edges, from p along d and from q along e, that are inside of both.
pub fn crossing((p, d): (V, V), (q, e): (V, V)) -> Option<Nearest> {
    let (dd, ee, de, w) = (dot3(d, d), dot3(e, e), dot3(d, e), sub3(p, q));
    let det = dd * ee - de * de;
    if det <= 1e-12 * dd * ee {
        return None;
    }
    let t = (de * dot3(e, w) - ee * dot3(d, w)) / det;
    let u = (dd * dot3(e, w) - de * dot3(d, w)) / det;
    let inside = |x: f64, length: f64| x * length > INSIDE && (1.0 - x) * length > INSIDE;
    let points = [plus(p, d, t), plus(q, e, u)];
    let distance = norm3(sub3(points[0], points[1]));
    (inside(t, dd.sqrt()) && inside(u, ee.sqrt())).then_some(Nearest {
        distance,
        points,
        place: Place::Edges,
    })
}

/// Whether an edge from p along d passes through a box.
fn pierces((p, d): (V, V), pose: &Pose, halves: &Halves, body: usize) -> bool {
    let (from, along_it) = (along(sub3(p, pose.at[body]), &pose.axes[body]), along(d, &pose.axes[body]));
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for i in 0..3 {
        let sides = [-1.0, 1.0].map(|side| (side * halves[body][i] - from[i]) / along_it[i]);
        enters = enters.max(sides[0].min(sides[1]));
        leaves = leaves.min(sides[0].max(sides[1]));
    }
    enters < leaves
}

/// A body before another that stands still.
pub struct Bodies<'m> {
    pub model: &'m dyn Contacts<f64>,
    /// their nearest points; `None` of bodies that overlap
    pub nearest: &'m dyn Fn(&Pose) -> Option<Nearest>,
    /// where the other is
    pub other: V,
    /// the place and the axes of the one at these coordinates
    pub place: fn(&[f64]) -> (V, [V; 3]),
    /// random coordinates and speeds
    pub random: fn(&mut Random) -> (Vec<f64>, Vec<f64>),
}

/// Counts what was seen.
#[derive(Debug, Default)]
pub struct Seen {
    pub faces: [usize; 2],
    pub edges: usize,
    others: usize,
    /// of these so many with all neighbours, at which rates were compared
    rates: usize,
}

/// Places of edges that are nearly parallel are known to rounding over the square of their angle.
const OF_EDGES: f64 = 1e-3;
const STEP: f64 = 1e-4;

/// Looks at so many random poses at which the bodies are apart.
pub fn compare(bodies: &Bodies<'_>, poses: usize) -> Seen {
    let model = bodies.model;
    let count = model.count(ComponentKind::Contact);
    let points: Vec<usize> = (0..count)
        .map(|contact| {
            let name = model.component(ComponentKind::Contact, contact).unwrap().name;
            model.index(ComponentKind::Point, name).unwrap()
        })
        .collect();
    let mut random = Random::new(0x1234_5678_9abc_def1);
    let (mut seen, mut worst, mut worst_rate, mut done) = (Seen::default(), 0.0_f64, [0.0_f64; 2], 0);
    while done < poses {
        let (q, u) = (bodies.random)(&mut random);
        let (at, axes) = (bodies.place)(&q);
        let pose = Pose {
            at: [at, bodies.other],
            axes: [axes, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]],
        };
        let Some(nearest) = (bodies.nearest)(&pose) else { continue };
        done += 1;
        let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
        let features = |contact: &usize| model.validity(*contact, &state).unwrap().is_some();
        let contacts: Vec<usize> = (0..count).filter(features).collect();
        let gap = |contact: usize, state: &State<'_>| model.gap(contact, state).unwrap().unwrap();
        // bodies that are apart touch nowhere
        let least = contacts.iter().map(|&contact| gap(contact, &state)).fold(f64::INFINITY, f64::min);
        assert!(least > 0.0 || least > -1e-7 && nearest.distance < 1e-6, "{least:e} {nearest:?}");
        let valid = |contact: &usize| model.validity(*contact, &state).unwrap().unwrap() > 1e-7;
        let closest =
            contacts.iter().copied().filter(valid).min_by(|a, b| gap(*a, &state).total_cmp(&gap(*b, &state)));
        match nearest.place {
            Place::Face(body) => seen.faces[body] += 1,
            Place::Edges => seen.edges += 1,
            Place::Other => {
                seen.others += 1;
                if let Some(closest) = closest {
                    assert!(gap(closest, &state) > nearest.distance - 1e-6, "{nearest:?}");
                }
                continue;
            }
        }
        let contact = closest.unwrap_or_else(|| panic!("{nearest:?}"));
        let known = model.contact_state(contact, &state).unwrap();
        // of the contacts that are valid all others are further
        worst = worst.max((gap(contact, &state) - nearest.distance).abs());
        let apart = sub3(nearest.points[0], nearest.points[1]);
        worst = worst.max(norm3(sub3(apart, scaled(known.normal.into(), nearest.distance))));
        let place: V = model.position(points[contact], &state).unwrap().into();
        let there = nearest.points[usize::from(nearest.place == Place::Face(1))];
        let weight = if nearest.place == Place::Edges { OF_EDGES } else { 1.0 };
        worst = worst.max(weight * norm3(sub3(place, there)));
        // the rate of the gap is the normal velocity, and the rates of all velocities the free acceleration, by
        // differences of order four along the motion
        let mut rates = [vec![0.0; q.len()], vec![0.0; u.len()]];
        model.coordinate_rates(&state, &mut rates[0]).unwrap();
        model.accelerations(&state, &mut rates[1]).unwrap();
        let moved = |h: f64| {
            let along = |from: &[f64], rates: &[f64]| -> Vec<f64> {
                from.iter().zip(rates).map(|(x, rate)| x + h * rate).collect()
            };
            (along(&q, &rates[0]), along(&u, &rates[1]))
        };
        let (mut gap_rate, mut acceleration, mut within) = (0.0, Vector3::zeros(), f64::INFINITY);
        for (steps, weight) in [(-2.0, 1.0), (-1.0, -8.0), (1.0, 8.0), (2.0, -1.0)] {
            let (q, u) = moved(steps * STEP);
            let there = State { coordinates: &q, speeds: &u, ..state };
            let weight = weight / (12.0 * STEP);
            gap_rate += weight * gap(contact, &there);
            within = within.min(model.validity(contact, &there).unwrap().unwrap());
            acceleration += weight * model.contact_velocity(contact, &there).unwrap();
        }
        let free = model.free_acceleration(contact, &state).unwrap();
        // a place that is near an end may be beyond it at a neighbour
        if within > 1e-7 {
            seen.rates += 1;
            let near = 1.0 + free.norm();
            worst_rate[0] = worst_rate[0].max((gap_rate - known.velocity.x).abs());
            worst_rate[1] = worst_rate[1].max((acceleration - free).norm() / near.powi(2));
        }
    }
    println!("{seen:?}: {worst:.1e} beside nearest points, {worst_rate:?} of rates beside differences");
    assert!(worst < 1e-12, "{worst:e}");
    assert!(worst_rate[0] < 1e-7 && worst_rate[1] < 1e-5, "{worst_rate:?}");
    seen
}

#[test]
fn rectangles_on_rectangles() {
    let bodies = Bodies {
        model: &BlockOnLedge::<f64>::default(),
        nearest: &|pose| nearest(pose, &[[0.15, 0.1, 0.0], [1.0, 0.5, 0.0]]),
        other: [-1.0, -0.5, 0.0],
        place: |q| {
            let (s, c) = q[2].sin_cos();
            ([q[0], q[1], 0.0], [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        },
        random: |random| {
            let q = vec![
                -1.0 + random.between(-1.5, 1.5),
                -0.5 + random.between(-1.0, 1.0),
                random.between(-3.0, 3.0),
            ];
            (q, (0..3).map(|_| random.between(-1.0, 1.0)).collect())
        },
    };
    let seen = compare(&bodies, 10_000);
    assert!(seen.faces.iter().all(|&count| count > 300), "{seen:?}");
}

#[test]
fn boxes_on_boxes() {
    let crates = model("crate_on_table");
    let bodies = Bodies {
        model: &crates,
        nearest: &|pose| nearest(pose, &[[0.15, 0.1, 0.12], [1.0, 0.1, 1.0]]),
        other: [-1.0, -0.1, 0.0],
        place: by_quaternion,
        random: |random| {
            let at = [
                -1.0 + random.between(-1.4, 1.4),
                -0.1 + random.between(-0.5, 0.5),
                random.between(-1.4, 1.4),
            ];
            in_space(at, random)
        },
    };
    let seen = compare(&bodies, 10_000);
    assert!(seen.faces.iter().all(|&count| count > 200) && seen.edges > 2000, "{seen:?}");
}

/// The place and the axes of a body that a quaternion turns.
pub fn by_quaternion(q: &[f64]) -> (V, [V; 3]) {
    let e = [3, 4, 5, 6].map(|i| q[i]);
    ([q[0], q[1], q[2]], [0, 1, 2].map(|i| turned(e, i)))
}

/// Coordinates and speeds of a body at a place, in any orientation.
pub fn in_space(at: V, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let mut e: [f64; 4] = std::array::from_fn(|_| random.between(-1.0, 1.0));
    while dot4(e, e) > 1.0 || dot4(e, e) < 0.01 {
        e = std::array::from_fn(|_| random.between(-1.0, 1.0));
    }
    let size = dot4(e, e).sqrt();
    let q = at.into_iter().chain(e.map(|c| c / size)).collect();
    (q, (0..6).map(|_| random.between(-1.0, 1.0)).collect())
}

fn dot4(a: [f64; 4], b: [f64; 4]) -> f64 {
    (0..4).map(|i| a[i] * b[i]).sum()
}

/// An axis of a frame that a quaternion turns.
fn turned([s, x, y, z]: [f64; 4], axis: usize) -> V {
    let columns = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + s * z), 2.0 * (x * z - s * y)],
        [2.0 * (x * y - s * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + s * x)],
        [2.0 * (x * z + s * y), 2.0 * (y * z - s * x), 1.0 - 2.0 * (x * x + y * y)],
    ];
    columns[axis]
}
