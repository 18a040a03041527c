//! The faces and edges of polytopes: the convex hulls of their vertices.

use std::collections::HashMap;

/// Points that differ by less than this share of the greatest distance between any two are in one plane, or on one line.
const ONE_PLANE: f64 = 1e-9;

/// The hulls of the polytopes of a model, by their names.
pub type Hulls = HashMap<String, Result<Hull, NoHull>>;

/// A convex polytope: which of its vertices have a face or an edge in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hull {
    /// the vertices of each face, in order, counterclockwise as seen from outside
    pub faces: Vec<Vec<usize>>,
    /// all edges
    pub edges: Vec<Edge>,
}

/// An edge of a hull.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// the vertices at its ends
    pub ends: [usize; 2],
    /// the face on its left, as seen from outside on the way from the first end to the second, and that on its right
    pub faces: [usize; 2],
}

/// Why points are not the vertices of a solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoHull {
    /// they are in one plane
    Flat,
    /// this one is within the hull of the others, or at the place of another
    NoVertex(usize),
    /// their places are not known
    Unknown,
}

type V = [f64; 3];

fn minus(a: V, b: V) -> V {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: V, b: V) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V, b: V) -> V {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl Hull {
    /// The hull of points, of which each must be a vertex.
    pub fn of(points: &[V]) -> Result<Hull, NoHull> {
        if !points.iter().flatten().all(|x| x.is_finite()) {
            return Err(NoHull::Unknown);
        }
        let faces = faces(points)?;
        if let Some(inner) = (0..points.len()).find(|p| !faces.iter().flatten().any(|vertex| vertex == p)) {
            return Err(NoHull::NoVertex(inner));
        }
        let mut sides: HashMap<[usize; 2], usize> = HashMap::new();
        for (f, face) in faces.iter().enumerate() {
            for (i, &from) in face.iter().enumerate() {
                sides.insert([from, face[(i + 1) % face.len()]], f);
            }
        }
        let mut edges = Vec::new();
        for (f, face) in faces.iter().enumerate() {
            for (i, &from) in face.iter().enumerate() {
                let to = face[(i + 1) % face.len()];
                let Some(&other) = sides.get(&[to, from]) else { return Err(NoHull::Unknown) };
                if from < to {
                    edges.push(Edge { ends: [from, to], faces: [f, other] });
                }
            }
        }
        // Euler: what is closed and convex has two more vertices and faces than edges
        let closed = points.len() + faces.len() == edges.len() + 2;
        if closed { Ok(Hull { faces, edges }) } else { Err(NoHull::Unknown) }
    }
}

/// The faces: planes through three points with all others on one side.
fn faces(points: &[V]) -> Result<Vec<Vec<usize>>, NoHull> {
    let apart = points.iter().flat_map(|a| points.iter().map(|b| minus(*a, *b)));
    let scale = apart.map(|d| dot(d, d)).fold(0.0, f64::max).sqrt();
    let count = points.len();
    let mut found: Vec<Vec<usize>> = Vec::new();
    let mut flat = true;
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                if found.iter().any(|face| [i, j, k].iter().all(|p| face.contains(p))) {
                    flat = false;
                    continue;
                }
                let n = cross(minus(points[j], points[i]), minus(points[k], points[i]));
                let size = dot(n, n).sqrt();
                if size <= ONE_PLANE * scale * scale {
                    continue;
                }
                let n = n.map(|x| x / size);
                let heights: Vec<f64> = points.iter().map(|p| dot(n, minus(*p, points[i]))).collect();
                let (above, below) = (
                    heights.iter().any(|h| *h > ONE_PLANE * scale),
                    heights.iter().any(|h| *h < -ONE_PLANE * scale),
                );
                let n = match (above, below) {
                    (false, false) => return Err(NoHull::Flat),
                    (true, true) => {
                        flat = false;
                        continue;
                    }
                    (true, false) => n.map(|x| -x),
                    (false, true) => n,
                };
                flat = false;
                let on_it = (0..count).filter(|p| heights[*p].abs() <= ONE_PLANE * scale).collect();
                found.push(polygon(points, on_it, n, scale));
            }
        }
    }
    if flat { Err(NoHull::Flat) } else { Ok(found) }
}

/// The corners of the hull of points in a plane, counterclockwise about its normal: from the one that is furthest to
/// one side, each time the next one behind which no other is (Jarvis).
fn polygon(points: &[V], within: Vec<usize>, normal: V, scale: f64) -> Vec<usize> {
    let axis = minus(points[within[1]], points[within[0]]);
    let furthest = |a: &usize, b: &usize| dot(points[*a], axis).total_cmp(&dot(points[*b], axis));
    let mut corners: Vec<usize> = within.iter().copied().min_by(furthest).into_iter().collect();
    while let Some(&at) = corners.last() {
        let mut next: Option<usize> = None;
        for &p in within.iter().filter(|p| **p != at) {
            let way = minus(points[p], points[at]);
            let length = dot(way, way).sqrt();
            if length <= ONE_PLANE * scale {
                continue;
            }
            let Some(best) = next else {
                next = Some(p);
                continue;
            };
            let best = minus(points[best], points[at]);
            let turn = dot(cross(best, way), normal) / dot(best, best).sqrt();
            // to the right of the best, or farther away in the same direction
            let farther = turn.abs() <= ONE_PLANE * scale && dot(way, way) > dot(best, best);
            if turn < -ONE_PLANE * scale || farther {
                next = Some(p);
            }
        }
        match next {
            Some(next) if next != corners[0] && corners.len() < within.len() => corners.push(next),
            _ => break,
        }
    }
    corners
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube() -> Vec<V> {
        (0..8).map(|n| [0, 1, 2].map(|i| if n >> i & 1 == 0 { 1.0 } else { -1.0 })).collect()
    }

    /// Faces lie on the left of their edges, seen from outside, and each edge has two.
    fn is_sound(points: &[V], hull: &Hull) {
        let middle: V = [0, 1, 2].map(|i| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64);
        for face in &hull.faces {
            let n = cross(minus(points[face[1]], points[face[0]]), minus(points[face[2]], points[face[1]]));
            assert!(dot(n, minus(points[face[0]], middle)) > 0.0, "{face:?}");
            for p in points {
                assert!(dot(n, minus(*p, points[face[0]])) < 1e-9, "{face:?}");
            }
        }
        for edge in &hull.edges {
            let directed = |face: &[usize], [a, b]: [usize; 2]| {
                (0..face.len()).any(|i| face[i] == a && face[(i + 1) % face.len()] == b)
            };
            let [a, b] = edge.ends;
            assert!(
                directed(&hull.faces[edge.faces[0]], [a, b]) && directed(&hull.faces[edge.faces[1]], [b, a])
            );
        }
    }

    #[test]
    fn hulls_of_solids() {
        let half = 0.5;
        let wedge = [0.0, 1.0].into_iter().flat_map(|z| [[0.0, 0.0, z], [2.0, 0.0, z], [0.0, half, z]]);
        let octahedron = (0..6).map(|n| {
            let mut p = [0.0; 3];
            p[n / 2] = if n % 2 == 0 { 1.0 } else { -1.3 };
            p
        });
        let tetrahedron = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let prism: Vec<V> = (0..12)
            .map(|n| {
                let (sin, cos) = (f64::from(n / 2) * std::f64::consts::PI / 3.0).sin_cos();
                [cos, sin, f64::from(n % 2)]
            })
            .collect();
        for (points, faces, edges) in [
            (cube(), 6, 12),
            (wedge.collect(), 5, 9),
            (octahedron.collect(), 8, 12),
            (tetrahedron, 4, 6),
            (prism, 8, 18),
        ] {
            let hull = Hull::of(&points).unwrap();
            assert_eq!((hull.faces.len(), hull.edges.len()), (faces, edges));
            is_sound(&points, &hull);
        }
    }

    #[test]
    fn what_has_no_hull() {
        let mut points = cube();
        assert_eq!(Hull::of(&points[..4]), Err(NoHull::Flat));
        assert_eq!(Hull::of(&points[..2]), Err(NoHull::Flat));
        // within, in the middle of a face, on an edge, twice at one place
        for inner in [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.2], [1.0, 1.0, 1.0]] {
            points.truncate(8);
            points.push(inner);
            assert!(matches!(Hull::of(&points), Err(NoHull::NoVertex(p)) if points[p] == inner), "{inner:?}");
        }
        points[3] = [f64::NAN; 3];
        assert_eq!(Hull::of(&points), Err(NoHull::Unknown));
    }
}
