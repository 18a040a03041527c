//! Boxes and polytopes by their vertices, faces and edges, in components along the axes of the frame in which they are
//! fixed (section 16.12 of docs/theory.md).

use super::algebra::*;
use super::features::axes_of;
use super::separation::{corner_signs, least};
use super::shared::Shared;
use crate::model::hulls::{Edge, Hull};
use crate::model::mechanism::{FrameId, Kind, Scalar, Shape, Vector};

/// Vertices are in one plane up to this share of the longest edge.
const FLAT: (i64, i64) = (1, 1_000_000_000);

/// Components along the axes of a frame.
pub type Components = [Scalar; 3];

/// A solid with plane faces.
pub struct Solid<'s> {
    pub shape: &'s Shape,
    /// along whose axes all components are; all places are from that of the shape
    pub frame: FrameId,
    pub vertices: Vec<Components>,
    pub faces: Vec<Face>,
    pub edges: Vec<SolidEdge>,
}

/// A face of a solid.
pub struct Face {
    /// the outward unit normal n
    pub normal: Components,
    /// n . p of its points p
    pub height: Scalar,
    /// its sides, in order
    pub sides: Vec<Side>,
}

/// A side of a face: an edge, as the face sees it.
pub struct Side {
    /// the number of the edge
    pub edge: usize,
    /// the unit vector m in the face, across the edge, towards the inside
    pub inward: Components,
    /// m . p of the points p of the edge
    pub offset: Scalar,
}

/// An edge of a solid.
pub struct SolidEdge {
    /// which vertices and faces it has
    pub of: Edge,
    /// the unit vector along it
    pub direction: Components,
    pub half_length: Scalar,
    pub middle: Components,
}

/// a . b
pub fn inner(a: &Components, b: &Components) -> Scalar {
    all((0..3).map(|i| product([a[i].clone(), b[i].clone()])))
}

/// a x b
pub fn outer(a: &Components, b: &Components) -> Components {
    std::array::from_fn(|i| {
        let (k, l) = ((i + 1) % 3, (i + 2) % 3);
        less(product([a[k].clone(), b[l].clone()]), product([a[l].clone(), b[k].clone()]))
    })
}

/// a - b
pub fn difference(a: &Components, b: &Components) -> Components {
    std::array::from_fn(|i| less(a[i].clone(), b[i].clone()))
}

/// The vector with these components.
pub fn vector(frame: FrameId, components: Components) -> Vector {
    Vector::Components(frame, Box::new(components))
}

fn length(a: &Components) -> Scalar {
    root(inner(a, a))
}

fn parts(a: Components, of: &Scalar, shared: &Shared<'_>) -> Components {
    a.map(|part| quotient(part, of.clone(), shared.at))
}

/// Gives components to all that use them.
pub fn keep(components: Components, what: &str, shared: &mut Shared<'_>) -> Components {
    components.map(|component| shared.scalar(component, what))
}

/// The normal of a face, not of unit length: from corners that are far from each other.
fn across(corners: &[usize], vertices: &[Components]) -> Components {
    let third = corners.len() / 3;
    let [a, b, c] = [0, third, 2 * third].map(|i| &vertices[corners[i]]);
    outer(&difference(b, a), &difference(c, a))
}

/// 1 where these vertices have this hull, else 0: each is behind the planes of all faces that it is not in, and in the
/// planes of those that it is in. Other values of parameters than those of the model may change the hull.
fn is_hull(vertices: &[Components], hull: &Hull, shared: &mut Shared<'_>) -> Scalar {
    let edges = hull.edges.iter().map(|edge| {
        let [a, b] = edge.ends.map(|end| &vertices[end]);
        length(&difference(b, a))
    });
    let size = shared.scalar(edges.reduce(greater).unwrap_or_else(|| integer(1)), "longest edge");
    let margin = shared.scalar(product([ratio(FLAT.0, FLAT.1), size.clone()]), "margin of planes");
    let mut bounds = Vec::new();
    for corners in &hull.faces {
        let normal = keep(across(corners, vertices), "normal of a face", shared);
        // of a face without an area all heights are zero, which is no height behind it
        let area = greater(length(&normal), square(margin.clone()));
        let area = shared.scalar(area, "normal of a face");
        for (number, vertex) in vertices.iter().enumerate() {
            let above = inner(&normal, &difference(vertex, &vertices[corners[0]]));
            let above = quotient(above, area.clone(), shared.at);
            bounds.push(match corners.contains(&number) {
                true => less(margin.clone(), super::algebra::size(above)),
                false => opposite_of(all([above, margin.clone()])),
            });
        }
    }
    step(least(bounds))
}

/// The vertices of a polytope, from its place along the axes of its frame, as long as they have this hull.
pub fn vertices_of(shape: &Shape, hull: &Hull, shared: &mut Shared<'_>) -> Vec<Components> {
    let axes = axes_of(shape);
    let from = shape.vertices.iter().map(|vertex| vertex.from(&shape.at));
    let vertices: Vec<Components> =
        from.map(|from| axes.each_ref().map(|e| shared.scalar(dot(&from, e), "vertex"))).collect();
    let sound = is_hull(&vertices, hull, shared);
    let sound = shared.scalar(sound, "whether the polytope is convex");
    vertices
        .into_iter()
        .map(|v| keep(parts(v, &sound, shared), "vertex, while all are convex,", shared))
        .collect()
}

/// The vertices of a box as numbers, in their order: its hull is that of every box.
pub fn corners_of_a_cube() -> Vec<[f64; 3]> {
    corner_signs().map(|signs| signs.map(|sign| if sign < 0 { -1.0 } else { 1.0 })).collect()
}

impl<'s> Solid<'s> {
    /// A box or a polytope with this hull.
    pub fn of(shape: &'s Shape, hull: &Hull, shared: &mut Shared<'_>) -> Solid<'s> {
        let is_box = shape.kind == Kind::Box;
        let frame = if is_box { shape.axes.unwrap_or(shape.frame) } else { shape.frame };
        let vertices: Vec<Components> = if is_box {
            let halves = [0, 1, 2].map(|i| shape.sizes.get(i).map_or(integer(0), half));
            corner_signs().map(|signs| std::array::from_fn(|i| signed(signs[i], halves[i].clone()))).collect()
        } else {
            vertices_of(shape, hull, shared)
        };
        // of a box they are along its axes
        let along_axis = |[a, b]: [usize; 2]| {
            let signs: Vec<[i64; 3]> = corner_signs().collect();
            let sign = |i: usize| (signs[b][i] - signs[a][i]) / 2;
            (is_box).then(|| (std::array::from_fn(|i| integer(sign(i))), (0..3).find(|i| sign(*i) != 0)))
        };
        let edges: Vec<SolidEdge> = (hull.edges.iter())
            .map(|edge| {
                let [a, b] = edge.ends.map(|end| vertices[end].clone());
                let middle: Components = std::array::from_fn(|i| half(&all([a[i].clone(), b[i].clone()])));
                let middle = keep(middle, "middle of an edge", shared);
                if let Some((direction, Some(axis))) = along_axis(edge.ends) {
                    let half_length = half(&shape.sizes[axis]);
                    return SolidEdge { of: *edge, direction, half_length, middle };
                }
                let way = difference(&b, &a);
                let size = shared.scalar(length(&way), "length of an edge");
                let direction = keep(parts(way, &size, shared), "direction of an edge", shared);
                SolidEdge { of: *edge, direction, half_length: half(&size), middle }
            })
            .collect();
        let faces = (hull.faces.iter().enumerate())
            .map(|(f, corners)| {
                let normal = if is_box {
                    // the side of the middle on which all four corners are
                    let signs: Vec<[i64; 3]> = corner_signs().collect();
                    std::array::from_fn(|i| integer(corners.iter().map(|c| signs[*c][i]).sum::<i64>() / 4))
                } else {
                    let across = keep(across(corners, &vertices), "normal of a face", shared);
                    let size = shared.scalar(length(&across), "normal of a face");
                    keep(parts(across, &size, shared), "normal of a face", shared)
                };
                let height = shared.scalar(inner(&normal, &vertices[corners[0]]), "height of a face");
                let sides = (0..corners.len())
                    .map(|i| {
                        let ends = [corners[i], corners[(i + 1) % corners.len()]];
                        let is_it = |edge: &SolidEdge| {
                            edge.of.faces.contains(&f) && ends.iter().all(|end| edge.of.ends.contains(end))
                        };
                        let edge = edges.iter().position(is_it).unwrap_or(0);
                        let way = if edges[edge].of.faces[0] == f { 1 } else { -1 };
                        let along = edges[edge].direction.clone().map(|part| signed(way, part));
                        let inward = keep(outer(&normal, &along), "inside of an edge", shared);
                        let offset = shared.scalar(inner(&inward, &vertices[ends[0]]), "inside of an edge");
                        Side { edge, inward, offset }
                    })
                    .collect();
                Face { normal, height, sides }
            })
            .collect();
        Solid { shape, frame, vertices, faces, edges }
    }

    /// Half of the sum of the lengths along three axes: of a solid that is no box, from the mean of its edges.
    pub fn extent(&self) -> Scalar {
        if self.shape.kind == Kind::Box {
            return all(self.shape.sizes.iter().map(half));
        }
        let count = i64::try_from(self.edges.len()).unwrap_or(1).max(1);
        product([ratio(3, count), all(self.edges.iter().map(|edge| edge.half_length.clone()))])
    }

    /// How far a place is within a side of a face.
    pub fn within(side: &Side, place: &Components) -> Scalar {
        less(inner(&side.inward, place), side.offset.clone())
    }

    /// The height of a place over a face.
    pub fn over(face: &Face, place: &Components) -> Scalar {
        less(inner(&face.normal, place), face.height.clone())
    }
}
