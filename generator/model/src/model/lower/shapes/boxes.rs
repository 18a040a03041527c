//! Contacts of boxes in space: vertices on faces and edges on edges (section 16.10 of docs/theory.md).
//!
//! With the axes a_i and half sides r_i of the first box, b_j and s_j of the second, and d from the middle of the
//! second to that of the first, all lengths here are sums and products of the cosines a_i . b_j and the components of
//! d. They are definitions without a name in the model, which all contacts of a pair share.

use super::algebra::*;
use super::faces::{OVERLAPS, gap_of, greatest, opposite_of};
use super::features::{Touch, axes_of};
use crate::model::mechanism::{
    Anchor, Definition, DefinitionId, DefinitionValue, FrameId, Scalar, Shape, Vector,
};
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
/// Edges whose angle has a sine below this are parallel: the vertices at their ends touch instead.
const PARALLEL: (i64, i64) = (1, 1_000_000);
/// Below this square a sine is zero, so that its root has a derivative.
const NO_ANGLE: (i64, i64) = (1, 1_000_000_000_000_000_000);

/// The contacts: vertices of the first box on the second, those of the second on the first, and edges on edges.
pub fn between(first: &Shape, second: &Shape, definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let pair = BoxPair::of(first, second, definitions, at);
    let mut touches: Vec<Touch> = corner_signs().map(|signs| pair.strikes(&signs, definitions)).collect();
    touches.extend(corner_signs().map(|signs| pair.is_struck(&signs, definitions)));
    for (i, j) in pairs_of_axes() {
        for parities in [[1, 1], [1, -1], [-1, 1], [-1, -1]] {
            touches.push(pair.crosses(i, j, parities, definitions));
        }
    }
    debug_assert_eq!(touches.len(), CONTACTS);
    touches
}

/// On which side of the middle a vertex is, along each axis, in the order of [`super::features::corners`].
fn corner_signs() -> impl Iterator<Item = [i64; 3]> {
    (0..8).map(|number| [0, 1, 2].map(|i| if number >> i & 1 == 0 { 1 } else { -1 }))
}

fn pairs_of_axes() -> impl Iterator<Item = (usize, usize)> {
    (0..3).flat_map(|i| (0..3).map(move |j| (i, j)))
}

/// The two other axes, so that all three are right-handed.
fn others(i: usize) -> [usize; 2] {
    [(i + 1) % 3, (i + 2) % 3]
}

/// a, or -a.
fn signed(sign: i64, a: Scalar) -> Scalar {
    if sign < 0 { opposite_of(a) } else { a }
}

fn all(terms: impl IntoIterator<Item = Scalar>) -> Scalar {
    Scalar::Add(terms.into_iter().collect())
}

/// Positive where edges are not parallel; of such that are it is minus the extent.
fn crossed(squared_sine: Scalar, extent: &Scalar) -> Scalar {
    let parallel = square(ratio(PARALLEL.1, PARALLEL.0));
    product([less(product([parallel, squared_sine]), integer(1)), extent.clone()])
}

fn least(bounds: Vec<Scalar>) -> Scalar {
    bounds.into_iter().reduce(lesser).unwrap_or_else(|| integer(1))
}

/// Gives an expression to all that use it.
fn shared(value: Scalar, what: &str, at: Span, definitions: &mut Vec<Definition>) -> Scalar {
    Scalar::Definition(keep(DefinitionValue::Scalar(value), what, at, definitions))
}

fn shared_vector(value: Vector, what: &str, at: Span, definitions: &mut Vec<Definition>) -> Vector {
    Vector::Definition(keep(DefinitionValue::Vector(value), what, at, definitions))
}

fn keep(value: DefinitionValue, what: &str, span: Span, definitions: &mut Vec<Definition>) -> DefinitionId {
    definitions.push(Definition { name: what.to_owned(), docs: String::new(), value, span });
    DefinitionId(definitions.len() - 1)
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
    fn of(first: &'s Shape, second: &'s Shape, definitions: &mut Vec<Definition>, at: Span) -> BoxPair<'s> {
        let shapes = [first, second];
        let name = |what: &str| format!("{what} of `{}` and `{}`", first.name, second.name);
        let axes = shapes.map(axes_of);
        let frames = shapes.map(|shape| shape.axes.unwrap_or(shape.frame));
        let half = shapes.map(|shape| [0, 1, 2].map(|i| shape.sizes.get(i).map_or(integer(0), half)));
        let mut share = |value: Scalar, what: &str| shared(value, &name(what), at, definitions);
        let extent = share(all(half.iter().flatten().cloned()), "extent");
        let d = first.at.from(&second.at);
        let cosines: [[Scalar; 3]; 3] =
            std::array::from_fn(|i| std::array::from_fn(|j| share(dot(&axes[0][i], &axes[1][j]), "cosine")));
        let sizes: [[Scalar; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| share(size(cosines[i][j].clone()), "size of a cosine"))
        });
        let along: [[Scalar; 3]; 2] = [0, 1].map(|body| {
            let axes: &[Vector; 3] = &axes[body];
            [0, 1, 2].map(|i| share(dot(&d, &axes[i]), "distance of the middles"))
        });
        // how far the boxes are apart along the axes of each
        let faces = [0, 1].map(|body| {
            [0, 1, 2].map(|i| {
                let reach = (0..3).map(|j| {
                    let of_both = if body == 0 { &sizes[i][j] } else { &sizes[j][i] };
                    product([half[1 - body][j].clone(), of_both.clone()])
                });
                let reach = all(std::iter::once(half[body][i].clone()).chain(reach));
                share(less(size(along[body][i].clone()), reach), "distance along an axis")
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
            let square_of = share(all([square(c(k, j)), square(c(l, j))]), "squared sine");
            let sine = share(
                root(greater(square_of.clone(), square(ratio(PARALLEL.0, PARALLEL.1)))),
                "sine of edges that are not parallel",
            );
            let angle =
                share(root(greater(square_of.clone(), ratio(NO_ANGLE.0, NO_ANGLE.1))), "sine of edges");
            sines[0][i].push(angle.clone());
            sines[1][j].push(angle);
            let apart = share(
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
            let distance = share(distance, "distance across edges");
            let crossed = share(crossed(square_of.clone(), &extent), "whether edges are not parallel");
            known.push(lesser(distance.clone(), crossed));
            distances.push(distance);
            let turned = share(sign(apart.clone()), "side of edges");
            let way = |sign_of: i64, c: Scalar| signed(sign_of, product([turned.clone(), sign(c)]));
            let mut nearest = |support: [Scalar; 2], components: [&Scalar; 2]| {
                let steeper = share(
                    sign(less(components[0].clone(), components[1].clone())),
                    "which component across edges is greater",
                );
                let lead = all([
                    product([step(steeper.clone()), support[0].clone()]),
                    product([less(integer(1), step(steeper.clone())), support[1].clone()]),
                ]);
                let lead = share(lead, "side of the nearest edge");
                let other = share(product([lead.clone(), steeper]), "side of the edge beside it");
                [[lead.clone(), lead], [other.clone(), opposite_of(other)]]
            };
            let of_first = nearest([way(1, c(l, j)), way(-1, c(k, j))], [&sizes[l][j], &sizes[k][j]]);
            let of_second = nearest([way(1, c(i, o)), way(-1, c(i, m))], [&sizes[i][o], &sizes[i][m]]);
            let part =
                |sign: i64, c: Scalar| quotient(signed(sign, product([turned.clone(), c])), sine.clone(), at);
            let mut components = [integer(0), integer(0), integer(0)];
            components[k] = share(part(-1, c(l, j)), "normal of edges");
            components[l] = share(part(1, c(k, j)), "normal of edges");
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
        let distance = share(distance, "distance of the boxes");
        let overlap = known.into_iter().reduce(greater).unwrap_or_else(|| integer(0));
        let overlap = share(overlap, "distance of the boxes across edges that are not parallel");
        let boxes = [0, 1].map(|body| {
            let other_way = |a: &Scalar| if body == 0 { opposite_of(a.clone()) } else { a.clone() };
            let away = [0, 1, 2].map(|i| other_way(&along[body][i]));
            let sides = [0, 1, 2].map(|i| share(sign(away[i].clone()), "side of a face"));
            let across: Vec<Scalar> = greatest(&faces[body])
                .into_iter()
                .map(|chosen| share(chosen, "whether a face is nearest"))
                .collect();
            let across: [Scalar; 3] = std::array::from_fn(|i| across[i].clone());
            let slack = [0, 1, 2].map(|i| {
                let angle = share(
                    sines[body][i].iter().cloned().reduce(lesser).unwrap_or_else(|| integer(1)),
                    "least angle of an edge",
                );
                let is_parallel = step(less(ratio(PARALLEL.0, PARALLEL.1), angle.clone()));
                share(product([is_parallel, angle, extent.clone()]), "reach of parallel edges")
            });
            let out =
                [0, 1, 2].map(|i| share(product([across[i].clone(), sides[i].clone()]), "normal of a face"));
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
            let outward = shared_vector(side.outward, &name("normal of the nearest face"), at, definitions);
            let tangent = shared_vector(side.tangent, &name("tangent of the nearest face"), at, definitions);
            Side { outward, tangent, ..side }
        });
        let edges = edges
            .into_iter()
            .map(|edges| {
                let normal = shared_vector(edges.normal, &name("normal of edges"), at, definitions);
                Edges { normal, ..edges }
            })
            .collect();
        BoxPair { shapes, at, extent, cosines, boxes, edges, distance, overlap }
    }

    fn share(&self, (n, d): (i64, i64)) -> Scalar {
        product([ratio(n, d), self.extent.clone()])
    }

    fn named(&self, value: Scalar, what: &str, definitions: &mut Vec<Definition>) -> Scalar {
        let name = format!("{what} of `{}` and `{}`", self.shapes[0].name, self.shapes[1].name);
        shared(value, &name, self.at, definitions)
    }

    /// The place of a vertex of a box from the middle of the other, along the axes of the other.
    fn places(&self, body: usize, signs: &[i64; 3], definitions: &mut Vec<Definition>) -> [Scalar; 3] {
        let (own, other) = (&self.boxes[body], &self.boxes[1 - body]);
        [0, 1, 2].map(|j| {
            let shares = (0..3).map(|i| {
                let cosine = if body == 0 { &self.cosines[i][j] } else { &self.cosines[j][i] };
                signed(signs[i], product([own.half[i].clone(), cosine.clone()]))
            });
            let place = all(std::iter::once(other.away[j].clone()).chain(shares));
            self.named(place, "place of a vertex", definitions)
        })
    }

    /// Where a box has a vertex.
    fn vertex(&self, body: usize, signs: &[i64; 3]) -> Anchor {
        let half = &self.boxes[body].half;
        let components = [0, 1, 2].map(|i| signed(signs[i], half[i].clone()));
        self.shapes[body].at.plus(Vector::Components(self.boxes[body].frame, Box::new(components)))
    }

    /// Height and validity of a vertex of a box over the face of the other that is nearest.
    fn over(&self, body: usize, places: &[Scalar; 3], definitions: &mut Vec<Definition>) -> (Scalar, Scalar) {
        let other = &self.boxes[1 - body];
        let beyond = [0, 1, 2].map(|i| {
            let beyond = less(size(places[i].clone()), other.half[i].clone());
            self.named(beyond, "place beyond a face", definitions)
        });
        let above = [0, 1, 2].map(|i| {
            let above = product([other.across[i].clone(), other.sides[i].clone(), places[i].clone()]);
            self.named(above, "place over a face", definitions)
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
    fn strikes(&self, signs: &[i64; 3], definitions: &mut Vec<Definition>) -> Touch {
        let places = self.places(0, signs, definitions);
        let known = self.over(0, &places, definitions);
        let face = &self.boxes[1];
        self.touch(self.vertex(0, signs), (face.outward.clone(), &face.tangent), known, definitions)
    }

    /// The contact of a vertex of the second box: with the matter of the first that is there.
    fn is_struck(&self, signs: &[i64; 3], definitions: &mut Vec<Definition>) -> Touch {
        let places = self.places(1, signs, definitions);
        let known = self.over(1, &places, definitions);
        let face = &self.boxes[0];
        let there = self.shapes[0].at.plus(Vector::Components(face.frame, Box::new(places)));
        self.touch(there, (opposite(&face.outward), &face.tangent), known, definitions)
    }

    /// The contact of an edge of each box, along these axes.
    fn crosses(&self, i: usize, j: usize, parities: [i64; 2], definitions: &mut Vec<Definition>) -> Touch {
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
        let height = self.named(height, "height of edges", definitions);
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
        let t = self.named(quotient(t, divisor.clone(), self.at), "place on an edge", definitions);
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
        self.touch(point, (edges.normal.clone(), &tangent), (height, validity), definitions)
    }

    /// A contact; where it is none, its gap is how far it is from that.
    fn touch(
        &self,
        point: Anchor,
        (normal, tangent): (Vector, &Vector),
        (height, validity): (Scalar, Scalar),
        definitions: &mut Vec<Definition>,
    ) -> Touch {
        let validity = self.named(validity, "validity of a contact", definitions);
        let apart = all([self.overlap.clone(), self.share(OVERLAPS)]);
        let gap = gap_of(height, opposite_of(validity.clone()), apart);
        Touch { point, normal, gap, validity: Some(validity), tangent: Some(tangent.clone()) }
    }
}
