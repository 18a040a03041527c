//! Contacts of polytopes (docs/theory.md, 16.12): against nearest points that are found in another way, and beside boxes,
//! which have contacts of their own.

use hodograph::{ComponentKind, Contacts, Law, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;

use crate::common::{run, start, surface};
use crate::faces::{
    Bodies, INSIDE, Nearest, Place, Pose, V, back, by_quaternion, compare, crossing, dot3, in_space, norm3,
    plus, sub3,
};
use crate::many::model;

/// The vertices of a solid along its axes, and the corners of its faces, in order.
struct Solid {
    vertices: Vec<V>,
    faces: Vec<Vec<usize>>,
}

impl Solid {
    fn wedge(a: f64) -> Solid {
        let end = |z: f64| [[-a, -0.5 * a, z], [1.2 * a, -0.5 * a, z], [-0.4 * a, 0.8 * a, z]];
        let faces = [&[0, 1, 2][..], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]];
        Solid {
            vertices: [end(1.5 * a), end(-1.5 * a)].concat(),
            faces: faces.iter().map(|face| face.to_vec()).collect(),
        }
    }

    fn gem(b: f64) -> Solid {
        let vertices = [
            [1.0, 0.1, 0.0],
            [-0.9, 0.0, 0.1],
            [0.0, 0.8, -0.1],
            [0.1, -1.0, 0.0],
            [0.0, 0.1, 1.1],
            [-0.1, 0.0, -0.7],
        ];
        let around = [[0, 4], [4, 1], [1, 5], [5, 0]];
        let faces = [2, 3].into_iter().flat_map(|top| around.map(|[a, b]| vec![top, a, b]));
        Solid { vertices: vertices.map(|v| v.map(|x| b * x)).into(), faces: faces.collect() }
    }

    fn edges(&self) -> Vec<[usize; 2]> {
        let sides = self.faces.iter().flat_map(|face| {
            (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]]).map(|[a, b]| [a.min(b), a.max(b)])
        });
        let mut edges: Vec<[usize; 2]> = sides.collect();
        edges.sort_unstable();
        edges.dedup();
        edges
    }
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A solid at a place: vertices, and for each face its outward normal.
struct Placed<'s> {
    solid: &'s Solid,
    vertices: Vec<V>,
    normals: Vec<V>,
}

impl<'s> Placed<'s> {
    fn new(solid: &'s Solid, at: V, axes: &[V; 3]) -> Self {
        let vertices: Vec<V> = solid.vertices.iter().map(|v| plus(at, back(*v, axes), 1.0)).collect();
        let count = vertices.len() as f64;
        let middle = [0, 1, 2].map(|i| vertices.iter().map(|v| v[i]).sum::<f64>() / count);
        let normal = |face: &Vec<usize>| {
            let [a, b, c] = [0, 1, 2].map(|i| vertices[face[i]]);
            let n = cross(sub3(b, a), sub3(c, b));
            let sign = dot3(n, sub3(a, middle)).signum();
            let size = norm3(n);
            n.map(|x| sign * x / size)
        };
        let normals = solid.faces.iter().map(normal).collect();
        Placed { solid, vertices, normals }
    }

    /// The heights of a place over all faces.
    fn heights(&self, p: V) -> impl Iterator<Item = f64> {
        let faces = self.solid.faces.iter().zip(&self.normals);
        faces.map(move |(face, n)| dot3(*n, sub3(p, self.vertices[face[0]])))
    }

    /// The nearest place on the surface to one outside, and whether it is well inside a face.
    fn nearest(&self, p: V) -> (V, bool) {
        let mut best = (f64::INFINITY, p, false);
        for ((face, n), height) in self.solid.faces.iter().zip(&self.normals).zip(self.heights(p)) {
            let there = plus(p, *n, -height);
            let inner =
                [0, 1, 2].map(|i| face.iter().map(|v| self.vertices[*v][i]).sum::<f64>() / face.len() as f64);
            let inside = (0..face.len()).map(|i| {
                let (a, b) = (self.vertices[face[i]], self.vertices[face[(i + 1) % face.len()]]);
                let m = cross(*n, sub3(b, a));
                let m = m.map(|x| x / norm3(m) * dot3(m, sub3(inner, a)).signum());
                dot3(m, sub3(there, a))
            });
            let inside = inside.fold(f64::INFINITY, f64::min);
            if height >= 0.0 && inside >= 0.0 && height < best.0 {
                best = (height, there, inside > INSIDE);
            }
        }
        for [a, b] in self.solid.edges() {
            let (a, way) = (self.vertices[a], sub3(self.vertices[b], self.vertices[a]));
            let t = (dot3(sub3(p, a), way) / dot3(way, way)).clamp(0.0, 1.0);
            let there = plus(a, way, t);
            if norm3(sub3(p, there)) < best.0 {
                best = (norm3(sub3(p, there)), there, false);
            }
        }
        (best.1, best.2)
    }

    /// Whether a segment has a place within.
    fn is_pierced(&self, [a, b]: [V; 2]) -> bool {
        let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
        for (h_a, h_b) in self.heights(a).zip(self.heights(b)) {
            let at = h_a / (h_a - h_b);
            match h_a < h_b {
                true => leaves = leaves.min(at),
                false => enters = enters.max(at),
            }
        }
        enters < leaves
    }

    fn segments(&self) -> Vec<[V; 2]> {
        self.solid.edges().into_iter().map(|ends| ends.map(|end| self.vertices[end])).collect()
    }
}

fn nearest(pose: &Pose, solids: [&Solid; 2]) -> Option<Nearest> {
    let placed = [0, 1].map(|body| Placed::new(solids[body], pose.at[body], &pose.axes[body]));
    let mut best: Option<Nearest> = None;
    let mut look = |found: Nearest| {
        if best.is_none_or(|best| found.distance < best.distance) {
            best = Some(found);
        }
    };
    for body in [0, 1] {
        let other = &placed[1 - body];
        if placed[body].segments().into_iter().any(|segment| other.is_pierced(segment)) {
            return None;
        }
        for vertex in &placed[body].vertices {
            let (there, inside) = other.nearest(*vertex);
            let points = if body == 0 { [*vertex, there] } else { [there, *vertex] };
            let place = if inside { Place::Face(body) } else { Place::Other };
            look(Nearest { distance: norm3(sub3(*vertex, there)), points, place });
        }
    }
    for [p, p_end] in placed[0].segments() {
        for [q, q_end] in placed[1].segments() {
            crossing((p, sub3(p_end, p)), (q, sub3(q_end, q))).into_iter().for_each(&mut look);
        }
    }
    best
}

#[test]
fn wedges_on_gems() {
    let (wedge, gem) = (Solid::wedge(0.2), Solid::gem(0.4));
    let both = model("wedge_on_gem");
    let bodies = Bodies {
        model: &both,
        nearest: &|pose| nearest(pose, [&wedge, &gem]),
        other: [0.0; 3],
        place: by_quaternion,
        random: |random| in_space([0, 1, 2].map(|_| random.between(-0.8, 0.8)), random),
    };
    let seen = compare(&bodies, 4000);
    assert!(seen.faces.iter().all(|&count| count > 80) && seen.edges > 800, "{seen:?}");
}

/// What is thrown on a polytope moves as what is thrown on the same box: with the same number of events. The number of them
/// all.
fn move_alike(names: [&str; 2], middle: [f64; 3], throws: u64) -> usize {
    let both = names.map(model);
    let mut random = hodograph_random::Random::new(0x0e11_a950_0000_0031);
    let mut events = 0;
    for throw in 0..throws {
        let [x, y, z] = middle;
        let (q, mut u) =
            in_space([random.between(x - 0.2, x + 0.2), y, random.between(z - 0.2, z + 0.2)], &mut random);
        u[1] = -1.0;
        u.iter_mut().for_each(|u| *u *= 2.0);
        let ends = both.each_ref().map(|body| {
            let mut simulation = start(body, &q, &u, surface(0.4, 0.3, Law::Newton));
            let seen = run(&mut simulation, 0.4);
            ([simulation.coordinates(), simulation.speeds()].concat(), seen.len())
        });
        let apart = ends[0].0.iter().zip(&ends[1].0).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-7 && ends[0].1 == ends[1].1, "{throw}: {apart:e} {} {}", ends[0].1, ends[1].1);
        events += ends[0].1;
    }
    println!("{throws} throws with {events} events");
    events
}

/// A crate and a table that are polytopes move as those that are boxes: thrown on the edge of the table from all sides.
#[test]
fn polytopes_move_as_boxes_do() {
    assert!(move_alike(["crate_on_table", "crate_of_vertices"], [-0.1, 0.3, 0.0], 3) > 50);
}

/// So does a log: on the edge and the corner of the table.
#[test]
fn capsules_move_on_polytopes_as_on_boxes() {
    assert!(move_alike(["log_on_table", "log_on_slab"], [-0.1, 0.6, 0.0], 20) > 100);
}

/// Other values of parameters may turn a polytope inside out, or leave it no volume: its faces are not those of the model
/// any more, and the values are refused.
#[test]
fn polytopes_that_are_no_longer_convex_are_refused() {
    let die = model("die_on_ramp");
    let with = |name: &str, value: f64| {
        let mut values = die.all_parameters().to_vec();
        values[die.index(ComponentKind::Parameter, name).unwrap()] = value;
        InterpretedMechanism::with_parameters(die.model().clone(), die.program().clone(), &values)
    };
    let (q, u) = ([0.2, 0.6, 0.0, 1.0, 0.0, 0.0, 0.0], [0.0; 6]);
    let state = State { time: 0.0, coordinates: &q, speeds: &u, inputs: &[] };
    for height in [0.4, 0.1] {
        let ramp = with("h", height).unwrap();
        assert!((4..68).all(|contact| ramp.gap(contact, &state).is_ok()), "{height}");
    }
    for (name, value) in [("h", -0.4), ("h", 0.0), ("a", -0.1)] {
        let error = with(name, value).err().map(|error| error.to_string()).unwrap_or_default();
        assert!(
            error.contains("the parameters are singular")
                && error.contains("convex")
                && error.contains("of `Corners` and `Ramp`"),
            "{name} {value}: {error}"
        );
    }
}
