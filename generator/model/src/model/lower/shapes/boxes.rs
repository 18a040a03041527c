//! Contacts of boxes in space: vertices on faces and edges on edges (section 16.10 of docs/theory.md).
//!
//! With the axes a_i and half sides r_i of the first box, b_j and s_j of the second, and d from the middle of the
//! second to that of the first, all lengths here are sums and products of the cosines a_i . b_j and the components of
//! d. They are definitions without a name in the model, which all contacts of a pair share.

use super::algebra::*;
use super::faces::greatest;
use super::features::{Touch, axes_of};
use super::separation::*;
use super::shared::Shared;
use crate::model::mechanism::{Anchor, Definition, FrameId, Scalar, Shape, Vector};
use crate::span::Span;

/// The number of contacts of two boxes: 8 vertices of each, and four pairs of edges for each of the 9 pairs of axes.
pub const CONTACTS: usize = 8 + 8 + 9 * 4;

/// Shares of the extent of both boxes: by how much a vertex may be beyond the end of a face, and by how much the
/// crossing of two edges must be within both, and a vertex of the second box from a corner of the first.
const REACH: (i64, i64) = (4, 1_000_000_000);
const WITHIN: (i64, i64) = (1, 1_000_000_000);
/// By how much the boxes must overlap across a face, and by how much the height of a crossing may be less than the
/// distance of the boxes.
const OVERLAP: (i64, i64) = (8, 1_000_000_000);
/// Below this square a sine is zero, so that its root has a derivative.
const NO_ANGLE: (i64, i64) = (1, 1_000_000_000_000_000_000);

/// The contacts: vertices of the first box on the second, those of the second on the first, and edges on edges.
pub fn between(first: &Shape, second: &Shape, definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut shared = Shared::pair([first, second], definitions, at);
    let pair = BoxPair::of(first, second, &mut shared);
    let mut touches: Vec<Touch> = corner_signs().map(|signs| pair.strikes(&signs, &mut shared)).collect();
    touches.extend(corner_signs().map(|signs| pair.is_struck(&signs, &mut shared)));
    for (i, j) in pairs_of_axes() {
        for parities in [[1, 1], [1, -1], [-1, 1], [-1, -1]] {
            touches.push(pair.crosses(i, j, parities, &mut shared));
        }
    }
    debug_assert_eq!(touches.len(), CONTACTS);
    touches
}

fn pairs_of_axes() -> impl Iterator<Item = (usize, usize)> {
    (0..3).flat_map(|i| (0..3).map(move |j| (i, j)))
}

/// On which sides of the middle, along two axes of a box, the two edges along the third are that can be nearest to
/// what is beyond them along a normal: `support` has the signs of the normal's two components, `components` their
/// sizes. Both edges bound the face that is most across the normal; the first has equal signs, the second has not.
fn nearest_edges(
    support: [Scalar; 2],
    components: [&Scalar; 2],
    shared: &mut Shared<'_>,
) -> [[Scalar; 2]; 2] {
    let steeper = sign(less(components[0].clone(), components[1].clone()));
    let steeper = shared.scalar(steeper, "which component across edges is greater");
    let lead = all([
        product([step(steeper.clone()), support[0].clone()]),
        product([less(integer(1), step(steeper.clone())), support[1].clone()]),
    ]);
    let lead = shared.scalar(lead, "side of the nearest edge");
    let other = shared.scalar(product([lead.clone(), steeper]), "side of the edge beside it");
    [[lead.clone(), lead], [other.clone(), opposite_of(other)]]
}

/// One of two boxes, as the vertices of the other see it.
struct Side {
    frame: FrameId,
    /// half sides
    half: [Scalar; 3],
    /// components, along its axes, of what leads from its middle to that of the other
    away: [Scalar; 3],
    /// for each axis: 1 if the face furthest from the other box is across it, else 0
    across: [Scalar; 3],
    /// for each axis: on which side the other box is, 1 or -1
    sides: [Scalar; 3],
    /// for each axis: how far the boxes are apart along it
    apart: [Scalar; 3],
    /// for each axis: by how much further a vertex may be beyond an edge along it, which is parallel to one of the other
    slack: [Scalar; 3],
    /// the outward normal of the face, and a tangent
    outward: Vector,
    tangent: Vector,
}

/// The angle of an edge of each box, and what depends on it alone.
struct Edges {
    /// squared sine of the angle
    square: Scalar,
    /// the sine, no less than that of parallel edges
    sine: Scalar,
    /// 1 or -1, so that with it a x b leads from the second box to the first
    turned: Scalar,
    /// d . (a x b)
    apart: Scalar,
    /// sides of the two edges of each box that can be nearest, for parities 1 and -1, along its two other axes
    edges: [[[Scalar; 2]; 2]; 2],
    normal: Vector,
}

struct BoxPair<'s> {
    shapes: [&'s Shape; 2],
    at: Span,
    /// the sum of the half sides of both
    extent: Scalar,
    /// a_i . b_j
    cosines: [[Scalar; 3]; 3],
    boxes: [Side; 2],
    edges: Vec<Edges>,
    /// the greatest distance of the boxes along any of the fifteen axes
    distance: Scalar,
    /// the same without edges that are parallel, which have no axis across both: of boxes that overlap it is negative
    overlap: Scalar,
}

impl<'s> BoxPair<'s> {
    fn of(first: &'s Shape, second: &'s Shape, shared: &mut Shared<'_>) -> BoxPair<'s> {
        let shapes = [first, second];
        let at = shared.at;
        let axes = shapes.map(axes_of);
        let frames = shapes.map(|shape| shape.axes.unwrap_or(shape.frame));
        let half = shapes.map(|shape| [0, 1, 2].map(|i| shape.sizes.get(i).map_or(integer(0), half)));
        let extent = shared.scalar(all(half.iter().flatten().cloned()), "extent");
        let d = first.at.from(&second.at);
        let cosines: [[Scalar; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| shared.scalar(dot(&axes[0][i], &axes[1][j]), "cosine"))
        });
        let sizes: [[Scalar; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| shared.scalar(size(cosines[i][j].clone()), "size of a cosine"))
        });
        let along: [[Scalar; 3]; 2] = [0, 1].map(|body| {
            let axes: &[Vector; 3] = &axes[body];
            [0, 1, 2].map(|i| shared.scalar(dot(&d, &axes[i]), "distance of the middles"))
        });
        // how far the boxes are apart along the axes of each
        let faces = [0, 1].map(|body| {
            [0, 1, 2].map(|i| {
                let reach = (0..3).map(|j| {
                    let of_both = if body == 0 { &sizes[i][j] } else { &sizes[j][i] };
                    product([half[1 - body][j].clone(), of_both.clone()])
                });
                let reach = all(std::iter::once(half[body][i].clone()).chain(reach));
                shared.scalar(less(size(along[body][i].clone()), reach), "distance along an axis")
            })
        });
        // and along the products of their axes; a x b has the components -c_lj and c_kj along the first's
        // axes k and l, c_io and -c_im along the second's axes m and o
        let mut edges = Vec::new();
        let mut distances: Vec<Scalar> = faces.iter().flatten().cloned().collect();
        let mut known = distances.clone();
        let mut sines: [[Vec<Scalar>; 3]; 2] = Default::default();
        for (i, j) in pairs_of_axes() {
            let ([k, l], [m, o]) = (others(i), others(j));
            let c = |a: usize, b: usize| cosines[a][b].clone();
            let square_of = shared.scalar(all([square(c(k, j)), square(c(l, j))]), "squared sine");
            let sine = shared.scalar(
                root(greater(square_of.clone(), square(ratio(PARALLEL.0, PARALLEL.1)))),
                "sine of edges that are not parallel",
            );
            let angle = shared
                .scalar(root(greater(square_of.clone(), ratio(NO_ANGLE.0, NO_ANGLE.1))), "sine of edges");
            sines[0][i].push(angle.clone());
            sines[1][j].push(angle);
            let apart = shared.scalar(
                less(product([along[0][l].clone(), c(k, j)]), product([along[0][k].clone(), c(l, j)])),
                "distance of the middles across edges",
            );
            let reach = all([
                product([half[0][k].clone(), sizes[l][j].clone()]),
                product([half[0][l].clone(), sizes[k][j].clone()]),
                product([half[1][m].clone(), sizes[i][o].clone()]),
                product([half[1][o].clone(), sizes[i][m].clone()]),
            ]);
            let distance = quotient(less(size(apart.clone()), reach), sine.clone(), at);
            let distance = shared.scalar(distance, "distance across edges");
            let crossed =
                shared.scalar(crossed(square_of.clone(), &extent), "whether edges are not parallel");
            known.push(lesser(distance.clone(), crossed));
            distances.push(distance);
            let turned = shared.scalar(sign(apart.clone()), "side of edges");
            let way = |sign_of: i64, c: Scalar| signed(sign_of, product([turned.clone(), sign(c)]));
            let of_first =
                nearest_edges([way(1, c(l, j)), way(-1, c(k, j))], [&sizes[l][j], &sizes[k][j]], shared);
            let of_second =
                nearest_edges([way(1, c(i, o)), way(-1, c(i, m))], [&sizes[i][o], &sizes[i][m]], shared);
            let part =
                |sign: i64, c: Scalar| quotient(signed(sign, product([turned.clone(), c])), sine.clone(), at);
            let mut components = [integer(0), integer(0), integer(0)];
            components[k] = shared.scalar(part(-1, c(l, j)), "normal of edges");
            components[l] = shared.scalar(part(1, c(k, j)), "normal of edges");
            let normal = Vector::Components(frames[0], Box::new(components));
            edges.push(Edges {
                square: square_of,
                sine,
                turned,
                apart,
                edges: [of_first, of_second],
                normal,
            });
        }
        let distance = distances.into_iter().reduce(greater).unwrap_or_else(|| integer(0));
        let distance = shared.scalar(distance, "distance of the boxes");
        let overlap = known.into_iter().reduce(greater).unwrap_or_else(|| integer(0));
        let overlap = shared.scalar(overlap, "distance of the boxes across edges that are not parallel");
        let boxes = [0, 1].map(|body| {
            let other_way = |a: &Scalar| if body == 0 { opposite_of(a.clone()) } else { a.clone() };
            let away = [0, 1, 2].map(|i| other_way(&along[body][i]));
            let sides = [0, 1, 2].map(|i| shared.scalar(sign(away[i].clone()), "side of a face"));
            let across: Vec<Scalar> = greatest(&faces[body])
                .into_iter()
                .map(|chosen| shared.scalar(chosen, "whether a face is nearest"))
                .collect();
            let across: [Scalar; 3] = std::array::from_fn(|i| across[i].clone());
            let slack = [0, 1, 2].map(|i| {
                let angle = shared.scalar(
                    sines[body][i].iter().cloned().reduce(lesser).unwrap_or_else(|| integer(1)),
                    "least angle of an edge",
                );
                let is_parallel = step(less(ratio(PARALLEL.0, PARALLEL.1), angle.clone()));
                shared.scalar(product([is_parallel, angle, extent.clone()]), "reach of parallel edges")
            });
            let out = [0, 1, 2]
                .map(|i| shared.scalar(product([across[i].clone(), sides[i].clone()]), "normal of a face"));
            let turned = [across[2].clone(), across[0].clone(), across[1].clone()];
            Side {
                frame: frames[body],
                half: half[body].clone(),
                away,
                across,
                sides,
                apart: faces[body].clone(),
                slack,
                outward: Vector::Components(frames[body], Box::new(out)),
                tangent: Vector::Components(frames[body], Box::new(turned)),
            }
        });
        let boxes = boxes.map(|side| {
            let outward = shared.vector(side.outward, "normal of the nearest face");
            let tangent = shared.vector(side.tangent, "tangent of the nearest face");
            Side { outward, tangent, ..side }
        });
        let edges = edges
            .into_iter()
            .map(|edges| {
                let normal = shared.vector(edges.normal, "normal of edges");
                Edges { normal, ..edges }
            })
            .collect();
        BoxPair { shapes, at, extent, cosines, boxes, edges, distance, overlap }
    }

    fn ending(
        &self,
        point: Anchor,
        (normal, tangent): (Vector, &Vector),
        known: (Scalar, Scalar),
        shared: &mut Shared<'_>,
    ) -> Touch {
        ending(point, (normal, tangent.clone()), known, (&self.overlap, &self.extent), shared)
    }

    fn share(&self, (n, d): (i64, i64)) -> Scalar {
        product([ratio(n, d), self.extent.clone()])
    }

    /// The place of a vertex of a box from the middle of the other, along the axes of the other.
    fn places(&self, body: usize, signs: &[i64; 3], shared: &mut Shared<'_>) -> [Scalar; 3] {
        let (own, other) = (&self.boxes[body], &self.boxes[1 - body]);
        [0, 1, 2].map(|j| {
            let shares = (0..3).map(|i| {
                let cosine = if body == 0 { &self.cosines[i][j] } else { &self.cosines[j][i] };
                signed(signs[i], product([own.half[i].clone(), cosine.clone()]))
            });
            let place = all(std::iter::once(other.away[j].clone()).chain(shares));
            shared.scalar(place, "place of a vertex")
        })
    }

    /// Where a box has a vertex.
    fn vertex(&self, body: usize, signs: &[i64; 3]) -> Anchor {
        let half = &self.boxes[body].half;
        let components = [0, 1, 2].map(|i| signed(signs[i], half[i].clone()));
        self.shapes[body].at.plus(Vector::Components(self.boxes[body].frame, Box::new(components)))
    }

    /// Height and validity of a vertex of a box over the face of the other that is nearest.
    fn over(&self, body: usize, places: &[Scalar; 3], shared: &mut Shared<'_>) -> (Scalar, Scalar) {
        let other = &self.boxes[1 - body];
        let beyond = [0, 1, 2].map(|i| {
            let beyond = less(size(places[i].clone()), other.half[i].clone());
            shared.scalar(beyond, "place beyond a face")
        });
        let above = [0, 1, 2].map(|i| {
            let above = product([other.across[i].clone(), other.sides[i].clone(), places[i].clone()]);
            shared.scalar(above, "place over a face")
        });
        let height =
            all((0..3)
                .map(|i| less(above[i].clone(), product([other.across[i].clone(), other.half[i].clone()]))));
        let mut bounds: Vec<Scalar> = (0..3)
            .map(|i| {
                // the edge beyond which this place is lies along the third axis
                let [k, l] = others(i);
                let slack = all([
                    product([other.across[k].clone(), other.slack[l].clone()]),
                    product([other.across[l].clone(), other.slack[k].clone()]),
                ]);
                let within = less(all([self.share(REACH), slack]), beyond[i].clone());
                let over = less(opposite_of(other.apart[i].clone()), self.share(OVERLAP));
                let beside = less(integer(1), other.across[i].clone());
                all([product([beside, lesser(within, over)]), above[i].clone()])
            })
            .collect();
        if body == 1 {
            // at a corner of the first box its own vertex touches
            let inner = all((0..3).map(|i| {
                let [k, l] = others(i);
                let slack = greater(other.slack[k].clone(), other.slack[l].clone());
                let twice = product([integer(2), slack]);
                let margin = all([lesser(beyond[k].clone(), beyond[l].clone()), twice]);
                product([other.across[i].clone(), opposite_of(margin)])
            }));
            bounds.push(less(inner, self.share(WITHIN)));
        }
        (height, least(bounds))
    }

    /// The contact of a vertex of the first box.
    fn strikes(&self, signs: &[i64; 3], shared: &mut Shared<'_>) -> Touch {
        let places = self.places(0, signs, shared);
        let known = self.over(0, &places, shared);
        let face = &self.boxes[1];
        self.ending(self.vertex(0, signs), (face.outward.clone(), &face.tangent), known, shared)
    }

    /// The contact of a vertex of the second box: with the matter of the first that is there.
    fn is_struck(&self, signs: &[i64; 3], shared: &mut Shared<'_>) -> Touch {
        let places = self.places(1, signs, shared);
        let known = self.over(1, &places, shared);
        let face = &self.boxes[0];
        let there = self.shapes[0].at.plus(Vector::Components(face.frame, Box::new(places)));
        self.ending(there, (opposite(&face.outward), &face.tangent), known, shared)
    }

    /// The contact of an edge of each box, along these axes.
    fn crosses(&self, i: usize, j: usize, parities: [i64; 2], shared: &mut Shared<'_>) -> Touch {
        let edges = &self.edges[3 * i + j];
        let ([k, l], [m, o]) = (others(i), others(j));
        let [first, second] = &self.boxes;
        let which = |body: usize| &edges.edges[body][usize::from(parities[body] < 0)];
        // from the middle of each box to that of its edge
        let by = |side: &Scalar, half: &Scalar| product([side.clone(), half.clone()]);
        let [to_k, to_l] = [by(&which(0)[0], &first.half[k]), by(&which(0)[1], &first.half[l])];
        let [to_m, to_o] = [by(&which(1)[0], &second.half[m]), by(&which(1)[1], &second.half[o])];
        let c = |a: usize, b: usize| self.cosines[a][b].clone();
        let minus = |a: Scalar| opposite_of(a);
        // w leads from the middle of the second edge to that of the first
        let across = all([
            edges.apart.clone(),
            minus(product([to_k.clone(), c(l, j)])),
            product([to_l.clone(), c(k, j)]),
            minus(product([to_m.clone(), c(i, o)])),
            product([to_o.clone(), c(i, m)]),
        ]);
        let height = quotient(product([edges.turned.clone(), across]), edges.sine.clone(), self.at);
        let height = shared.scalar(height, "height of edges");
        let along_second = |own: &Scalar, q: usize| {
            let away = second.away[q].clone();
            let shares = [product([to_k.clone(), c(k, q)]), product([to_l.clone(), c(l, q)])];
            all([away].into_iter().chain(shares).chain([minus(own.clone())]))
        };
        let along_first = |own: &Scalar, p: usize| {
            let away = minus(first.away[p].clone());
            let shares = [product([to_m.clone(), c(p, m)]), product([to_o.clone(), c(p, o)])];
            all([away].into_iter().chain([own.clone()]).chain(shares.map(minus)))
        };
        let divisor = square(edges.sine.clone());
        let t = minus(all([
            product([c(i, m), along_second(&to_m, m)]),
            product([c(i, o), along_second(&to_o, o)]),
        ]));
        let u = all([product([c(k, j), along_first(&to_k, k)]), product([c(l, j), along_first(&to_l, l)])]);
        let t = shared.scalar(quotient(t, divisor.clone(), self.at), "place on an edge");
        let u = quotient(u, divisor, self.at);
        let within = |half: &Scalar, place: Scalar| less(less(half.clone(), size(place)), self.share(WITHIN));
        let crossed = crossed(edges.square.clone(), &self.extent);
        let within = least(vec![within(&first.half[i], t.clone()), within(&second.half[j], u), crossed]);
        // steep, so that it hides none of the other bounds where the height is the distance
        let above = less(height.clone(), self.distance.clone());
        let above = product([ratio(OVERLAP.1, OVERLAP.0), above]);
        let reached = greater(all([above, self.extent.clone()]), minus(self.extent.clone()));
        let validity = lesser(within, reached);
        let mut components = [integer(0), integer(0), integer(0)];
        (components[i], components[k], components[l]) = (t, to_k, to_l);
        let point = self.shapes[0].at.plus(Vector::Components(first.frame, Box::new(components)));
        let tangent = axis(first.frame, i);
        self.ending(point, (edges.normal.clone(), &tangent), (height, validity), shared)
    }
}
