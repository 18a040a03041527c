//! Contacts of polytopes, and of polytopes and boxes: vertices on faces and edges on edges (section 16.12 of
//! docs/theory.md).
//!
//! Everything is written in components along the axes of one of the two: vertices and edges of the second that the
//! first sees, and those of the first that the second sees, are definitions that all contacts of a pair share.

use super::algebra::*;
use super::faces::greatest;
use super::features::Touch;
use super::separation::*;
use super::shared::Shared;
use super::solids::*;
use crate::model::hulls::Hull;
use crate::model::mechanism::{Anchor, Definition, Scalar, Shape, Vector};
use crate::span::Span;

/// Shares of the extent of both: by how much a vertex may be beyond the end of a face, and by how much the crossing of
/// two edges must be within both, and a vertex of the second from a corner of the first.
const REACH: (i64, i64) = (4, 1_000_000_000);
const WITHIN: (i64, i64) = (1, 1_000_000_000);
/// By how much the face that counts must be further from the other body than all others are.
const LEAD: (i64, i64) = (8, 1_000_000_000);
/// By how much the height of a contact may be less than the distance of the solids.
const BELOW: (i64, i64) = (8, 1_000_000_000);
/// The angle, rad, by which the common normal of two edges may be beyond the normals of the faces at either.
const TURN: (i64, i64) = (8, 1_000_000_000);
/// How steep the bounds are within which the height of two edges counts: where their normal is not within those of the
/// faces, it has no sign.
const SHARP: i64 = 100_000_000;
/// Below this square a sine is zero, so that its root has a derivative.
const NO_ANGLE: (i64, i64) = (1, 1_000_000_000_000_000_000);

/// The contacts: vertices of the first on the second, those of the second on the first, and edges on edges.
pub fn between(
    shapes: [&Shape; 2],
    hulls: [&Hull; 2],
    definitions: &mut Vec<Definition>,
    at: Span,
) -> Vec<Touch> {
    let mut shared = Shared::pair(shapes, definitions, at);
    let solids = [0, 1].map(|body| Solid::of(shapes[body], hulls[body], &mut shared));
    let pair = Pair::of(solids, &mut shared);
    let [first, second] = &pair.solids;
    let mut touches: Vec<Touch> =
        (0..first.vertices.len()).map(|vertex| pair.strikes(vertex, &mut shared)).collect();
    touches.extend((0..second.vertices.len()).map(|vertex| pair.is_struck(vertex, &mut shared)));
    for crossing in &pair.crossings {
        touches.push(pair.crosses(crossing, &mut shared));
    }
    touches
}

/// One of two solids, as the other sees it.
struct View {
    /// places of its vertices, along the axes of the other, from the place of the other
    vertices: Vec<Components>,
    /// for each face of the other, the heights of its vertices over it
    heights: Vec<Vec<Scalar>>,
    /// for each face of the other, how far it is apart from it
    apart: Vec<Scalar>,
    /// by how much the greatest of these exceeds the second greatest
    lead: Scalar,
    /// for each face of the other: 1 for the one furthest from it, else 0
    chosen: Vec<Scalar>,
    /// the outward normal of that face, and a tangent
    outward: Vector,
    tangent: Vector,
    /// for each edge of the other: by how much further a vertex may be beyond it where one of its edges is parallel
    slack: Vec<Scalar>,
}

/// An edge of each of two solids.
struct Crossing {
    edges: [usize; 2],
    /// a x b of the unit vectors along them, along the axes of the first
    cross: Components,
    /// 1 or -1: with it a x b leads from the second to the first
    turned: Scalar,
    /// squared sine of their angle, and the sine, no less than that of parallel edges
    square: Scalar,
    sine: Scalar,
    /// the sine without that bound
    angle: Scalar,
    /// w from the middle of the second edge to that of the first
    between: Components,
    /// the unit vector along the second edge
    direction: Components,
    /// w . n
    height: Scalar,
    /// how far n is within the normals of the faces at both edges, an angle times the extent
    supports: Scalar,
}

/// By how much the greatest of some numbers exceeds the second greatest.
fn lead(values: &[Scalar]) -> Scalar {
    let Some((first, others)) = values.split_first() else { return integer(0) };
    let (mut best, mut next) = (first.clone(), None);
    for value in others {
        let behind = lesser(best.clone(), value.clone());
        next = Some(next.map_or(behind.clone(), |next| greater(next, behind)));
        best = greater(best, value.clone());
    }
    next.map_or_else(|| integer(0), |next| less(best, next))
}

struct Pair<'s> {
    solids: [Solid<'s>; 2],
    at: Span,
    extent: Scalar,
    /// the vertices of each, as the other sees them
    views: Vec<View>,
    crossings: Vec<Crossing>,
    /// the greatest distance along any normal of a face or of two edges: of solids that overlap it is negative
    distance: Scalar,
}

/// How two solids lie to each other.
struct Relative {
    /// a_i . b_j of their axes
    cosines: [Components; 3],
    /// from the place of the other to the own one, along the axes of the other
    away: [Components; 2],
    /// for each: unit vectors along its edges, along the axes of the other
    directions: Vec<Vec<Components>>,
    /// for each: these along the normals of the faces of the other
    rising: Vec<Vec<Vec<Scalar>>>,
}

impl Relative {
    fn of(solids: &[Solid<'_>; 2], shared: &mut Shared<'_>) -> Relative {
        let axes = solids.each_ref().map(|solid| [0, 1, 2].map(|i| axis(solid.frame, i)));
        let cosines = std::array::from_fn(|i| {
            std::array::from_fn(|j| shared.scalar(dot(&axes[0][i], &axes[1][j]), "cosine"))
        });
        let d = solids[0].shape.at.from(&solids[1].shape.at);
        let away = std::array::from_fn(|body| {
            std::array::from_fn(|i| {
                let along = dot(&d, &axes[1 - body][i]);
                let along = if body == 0 { along } else { opposite_of(along) };
                shared.scalar(along, "distance of the places")
            })
        });
        let mut relative = Relative { cosines, away, directions: Vec::new(), rising: Vec::new() };
        for (body, solid) in solids.iter().enumerate() {
            let turned = solid.edges.iter().map(|edge| relative.turned(body, &edge.direction));
            let kept = turned.map(|e| keep(e, "direction of an edge", shared)).collect();
            relative.directions.push(kept);
        }
        for body in [0, 1] {
            let of_face = |face: &Face, shared: &mut Shared<'_>| {
                let along = relative.directions[body].iter().map(|e| inner(&face.normal, e));
                along.map(|slope| shared.scalar(slope, "slope of an edge")).collect()
            };
            let rising = solids[1 - body].faces.iter().map(|face| of_face(face, shared)).collect();
            relative.rising.push(rising);
        }
        relative
    }

    /// Components along the axes of the other of a vector that has these along a solid's own.
    fn turned(&self, body: usize, v: &Components) -> Components {
        std::array::from_fn(|other| {
            all((0..3).map(|own| {
                let [i, j] = if body == 0 { [own, other] } else { [other, own] };
                product([v[own].clone(), self.cosines[i][j].clone()])
            }))
        })
    }

    /// The place of a point of a solid, as the other sees it.
    fn seen(&self, body: usize, place: &Components) -> Components {
        let turned = self.turned(body, place);
        std::array::from_fn(|i| all([self.away[body][i].clone(), turned[i].clone()]))
    }
}

impl Crossing {
    fn of(
        solids: &[Solid<'_>; 2],
        relative: &Relative,
        [e, g]: [usize; 2],
        extent: &Scalar,
        shared: &mut Shared<'_>,
    ) -> Crossing {
        let (own, other) = (&solids[0].edges[e], &solids[1].edges[g]);
        let direction = relative.directions[1][g].clone();
        let cross = keep(outer(&own.direction, &direction), "product of edges", shared);
        let square_of = shared.scalar(inner(&cross, &cross), "squared sine");
        let sine = root(greater(square_of.clone(), square(ratio(PARALLEL.0, PARALLEL.1))));
        let sine = shared.scalar(sine, "sine of edges that are not parallel");
        let angle = root(greater(square_of.clone(), ratio(NO_ANGLE.0, NO_ANGLE.1)));
        let angle = shared.scalar(angle, "sine of edges");
        // the four of (16.8) for a x b; for b x a they have the opposite signs
        let [left, right] = own.of.faces.map(|f| relative.rising[1][f][g].clone());
        let [other_left, other_right] = other.of.faces.map(|f| relative.rising[0][f][e].clone());
        let bounds = vec![opposite_of(left), right, opposite_of(other_left), other_right];
        let greatest = bounds.iter().cloned().reduce(greater).unwrap_or_else(|| integer(0));
        let greatest = shared.scalar(greatest, "normal within those of faces");
        let least = shared.scalar(least(bounds), "normal within those of faces");
        let turned = sign(all([least.clone(), greatest.clone()]));
        let turned = shared.scalar(turned, "side of edges");
        let bound = shared.scalar(greater(least, opposite_of(greatest)), "normal within those of faces");
        let place = relative.seen(1, &other.middle);
        let between = keep(difference(&own.middle, &place), "distance of edges", shared);
        let height = product([turned.clone(), inner(&cross, &between)]);
        let height = shared.scalar(quotient(height, sine.clone(), shared.at), "height of edges");
        let supports = product([extent.clone(), quotient(bound, sine.clone(), shared.at)]);
        let supports = shared.scalar(supports, "normal within those of faces");
        let edges = [e, g];
        Crossing {
            edges,
            cross,
            turned,
            square: square_of,
            sine,
            angle,
            between,
            direction,
            height,
            supports,
        }
    }
}

impl View {
    /// The solid with this number, as the other sees it; `crossings` are those of all edges, in order.
    fn of(
        solids: &[Solid<'_>; 2],
        relative: &Relative,
        crossings: &[Crossing],
        body: usize,
        extent: &Scalar,
        shared: &mut Shared<'_>,
    ) -> View {
        let (own, other) = (&solids[body], &solids[1 - body]);
        let places = own.vertices.iter().map(|place| relative.seen(body, place));
        let vertices: Vec<Components> =
            places.map(|place| keep(place, "place of a vertex", shared)).collect();
        let heights: Vec<Vec<Scalar>> = (other.faces.iter())
            .map(|face| {
                let over = vertices.iter().map(|place| Solid::over(face, place));
                over.map(|height| shared.scalar(height, "height of a vertex")).collect()
            })
            .collect();
        let apart: Vec<Scalar> = (heights.iter())
            .map(|heights| shared.scalar(least(heights.clone()), "distance from a face"))
            .collect();
        let chosen: Vec<Scalar> = (greatest(&apart).into_iter())
            .map(|chosen| shared.scalar(chosen, "whether a face is nearest"))
            .collect();
        let lead = shared.scalar(lead(&apart), "lead of the nearest face");
        let of_chosen = |part: &dyn Fn(&Face) -> Scalar| {
            let faces = chosen.iter().zip(&other.faces);
            all(faces.map(|(chosen, face)| product([chosen.clone(), part(face)])))
        };
        let outward = std::array::from_fn(|i| of_chosen(&|face| face.normal[i].clone()));
        let along = |face: &Face, i: usize| match face.sides.first() {
            Some(side) => other.edges[side.edge].direction[i].clone(),
            None => integer(0),
        };
        let tangent = std::array::from_fn(|i| of_chosen(&|face| along(face, i)));
        let outward = shared.vector(vector(other.frame, outward), "normal of the nearest face");
        let tangent = shared.vector(vector(other.frame, tangent), "tangent of the nearest face");
        let slack = (0..other.edges.len())
            .map(|edge| {
                let sines = crossings.iter().filter(|crossing| crossing.edges[1 - body] == edge);
                let angle = sines.map(|crossing| crossing.angle.clone()).reduce(lesser);
                let angle = shared.scalar(angle.unwrap_or_else(|| integer(1)), "least angle of an edge");
                let is_parallel = step(less(ratio(PARALLEL.0, PARALLEL.1), angle.clone()));
                shared.scalar(product([is_parallel, angle, extent.clone()]), "reach of parallel edges")
            })
            .collect();
        View { vertices, heights, apart, lead, chosen, outward, tangent, slack }
    }
}

impl<'s> Pair<'s> {
    fn of(solids: [Solid<'s>; 2], shared: &mut Shared<'_>) -> Pair<'s> {
        let extent = shared.scalar(all(solids.iter().map(Solid::extent)), "extent");
        let relative = Relative::of(&solids, shared);
        let of_both = solids.each_ref().map(|solid| 0..solid.edges.len());
        let pairs = of_both[0].clone().flat_map(|e| of_both[1].clone().map(move |g| [e, g]));
        let crossings: Vec<Crossing> =
            pairs.map(|edges| Crossing::of(&solids, &relative, edges, &extent, shared)).collect();
        let views: Vec<View> =
            [0, 1].map(|body| View::of(&solids, &relative, &crossings, body, &extent, shared)).into();
        let of_edges = crossings.iter().map(|crossing| {
            let supports = product([integer(SHARP), crossing.supports.clone()]);
            let is_face = lesser(crossed(crossing.square.clone(), &extent), supports);
            lesser(crossing.height.clone(), is_face)
        });
        let faces = views.iter().flat_map(|view| view.apart.iter().cloned());
        let distance = faces.chain(of_edges).reduce(greater).unwrap_or_else(|| integer(0));
        let distance = shared.scalar(distance, "distance of the solids");
        Pair { solids, at: shared.at, extent, views, crossings, distance }
    }

    fn ending(
        &self,
        point: Anchor,
        directions: (Vector, Vector),
        known: (Scalar, Scalar),
        shared: &mut Shared<'_>,
    ) -> Touch {
        ending(point, directions, known, (&self.distance, &self.extent), shared)
    }

    fn share(&self, (n, d): (i64, i64)) -> Scalar {
        product([ratio(n, d), self.extent.clone()])
    }

    /// The extent, or minus the extent where a height is less than the distance of the solids: from behind a face, or two
    /// edges, a place may yet be outside of the whole. It jumps, for a steep bound would multiply rounding.
    fn reached(&self, height: &Scalar) -> Scalar {
        let above = less(height.clone(), self.distance.clone());
        product([sign(all([above, self.share(BELOW)])), self.extent.clone()])
    }

    /// Height and validity of a vertex of a solid over the face of the other that is nearest.
    fn over(&self, body: usize, vertex: usize, shared: &mut Shared<'_>) -> (Scalar, Scalar) {
        let (view, other) = (&self.views[body], &self.solids[1 - body]);
        let place = &view.vertices[vertex];
        let of_chosen = |parts: Vec<Scalar>| {
            all(view.chosen.iter().zip(parts).map(|(chosen, part)| product([chosen.clone(), part])))
        };
        let height = of_chosen(view.heights.iter().map(|heights| heights[vertex].clone()).collect());
        let height = shared.scalar(height, "height of a vertex");
        let mut within = Vec::new();
        let mut from_corners = Vec::new();
        for face in &other.faces {
            let sides: Vec<Scalar> = (face.sides.iter())
                .map(|side| shared.scalar(Solid::within(side, place), "place within a face"))
                .collect();
            let reach = sides.iter().zip(&face.sides);
            let reach = reach.map(|(within, side)| all([within.clone(), view.slack[side.edge].clone()]));
            within.push(least(reach.collect()));
            // at a corner of the first solid its own vertex touches
            let corners = (0..sides.len()).map(|i| {
                let next = (i + 1) % sides.len();
                let slack = [i, next].map(|i| view.slack[face.sides[i].edge].clone());
                let [a, b] = slack;
                let margin = product([integer(2), greater(a, b)]);
                less(greater(sides[i].clone(), sides[next].clone()), margin)
            });
            from_corners.push(least(corners.collect()));
        }
        let mut bounds = vec![
            all([of_chosen(within), self.share(REACH)]),
            less(view.lead.clone(), self.share(LEAD)),
            self.reached(&height),
        ];
        if body == 1 {
            bounds.push(less(of_chosen(from_corners), self.share(WITHIN)));
        }
        (height, least(bounds))
    }

    /// The contact of a vertex of the first solid.
    fn strikes(&self, vertex: usize, shared: &mut Shared<'_>) -> Touch {
        let known = self.over(0, vertex, shared);
        let (own, view) = (&self.solids[0], &self.views[0]);
        let point = own.shape.at.plus(vector(own.frame, own.vertices[vertex].clone()));
        self.ending(point, (view.outward.clone(), view.tangent.clone()), known, shared)
    }

    /// The contact of a vertex of the second solid: with the matter of the first that is there.
    fn is_struck(&self, vertex: usize, shared: &mut Shared<'_>) -> Touch {
        let known = self.over(1, vertex, shared);
        let (first, view) = (&self.solids[0], &self.views[1]);
        let there = first.shape.at.plus(vector(first.frame, view.vertices[vertex].clone()));
        self.ending(there, (opposite(&view.outward), view.tangent.clone()), known, shared)
    }

    /// The contact of an edge of each solid.
    fn crosses(&self, crossing: &Crossing, shared: &mut Shared<'_>) -> Touch {
        let [first, second] = &self.solids;
        let own = &first.edges[crossing.edges[0]];
        let other = &second.edges[crossing.edges[1]];
        // the places of the common perpendicular on both edges, from their middles; without cancellation where the
        // edges are almost parallel
        let divisor = square(crossing.sine.clone());
        let place = |along: &Components| {
            let part = inner(&outer(&crossing.between, along), &crossing.cross);
            quotient(opposite_of(part), divisor.clone(), self.at)
        };
        let t = shared.scalar(place(&crossing.direction), "place on an edge");
        let u = place(&own.direction);
        let within = |half: &Scalar, place: Scalar| less(less(half.clone(), size(place)), self.share(WITHIN));
        let supports = all([crossing.supports.clone(), self.share(TURN)]);
        let supports = shared.scalar(supports, "normal within those of faces");
        let counts = opposite_of(product([integer(SHARP), supports.clone()]));
        let validity = least(vec![
            within(&own.half_length, t.clone()),
            within(&other.half_length, u),
            crossed(crossing.square.clone(), &self.extent),
            supports,
            greater(self.reached(&crossing.height), counts),
        ]);
        let normal = crossing.cross.each_ref().map(|part| {
            quotient(product([crossing.turned.clone(), part.clone()]), crossing.sine.clone(), self.at)
        });
        let normal = shared.vector(vector(first.frame, normal), "normal of edges");
        let components: Components = std::array::from_fn(|i| {
            all([own.middle[i].clone(), product([t.clone(), own.direction[i].clone()])])
        });
        let point = first.shape.at.plus(vector(first.frame, components));
        let tangent = vector(first.frame, own.direction.clone());
        self.ending(point, (normal, tangent), (crossing.height.clone(), validity), shared)
    }
}
