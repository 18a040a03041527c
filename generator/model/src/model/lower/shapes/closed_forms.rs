//! Contact points, normals and gaps of pairs of shapes, in closed form (section 16.8 of docs/theory.md).
//!
//! With the nearest points p_1 and p_2 of the two surfaces and the unit normal n from the second to the first,
//! the gap is g = n . (p_1 - p_2). The point of a contact is p_1, as a material point of the first shape.

use super::algebra::*;
use super::faces;
use super::features::{Touch, axes_of, corners};
use crate::model::mechanism::{Anchor, Kind, Scalar, Shape, Vector};
use crate::span::Span;

/// All contacts of a pair, in the order of their numbers; `at` is where the pair is stated. Pairs that are not
/// compiled have none.
pub fn touches(first: &Shape, inside: bool, second: &Shape, at: Span) -> Vec<Touch> {
    match (second.kind, inside) {
        (Kind::Plane | Kind::HalfSpace, _) => on_plane(first, second, at),
        (Kind::Implicit, _) => corners(first).iter().filter_map(|p| on_implicit(p, second)).collect(),
        (Kind::Surface, _) => corners(first).iter().filter_map(|p| on_height(p, second, 2)).collect(),
        (Kind::Curve, _) => corners(first).iter().filter_map(|p| on_height(p, second, 1)).collect(),
        (Kind::Box, true) => in_box(first, second),
        (Kind::Rectangle, _) if first.kind == Kind::Rectangle => faces::between(first, second),
        (Kind::Capsule, false) if first.kind == Kind::Capsule => vec![on_capsule(first, second, at)],
        (_, false) => vec![on_solid(first, second, at)],
        (_, true) => vec![in_solid(first, second, at)],
    }
}

/// The axis of a shape that has one.
fn axis_of(shape: &Shape) -> Vector {
    shape.axis.clone().unwrap_or(Vector::Zero)
}

/// What of a convex shape can be nearest to a plane with the normal n.
fn on_plane(shape: &Shape, plane: &Shape, at: Span) -> Vec<Touch> {
    let normal = axis_of(plane);
    // a point of the shape, deeper than which it reaches by `depth` along -n, at `by` from there
    let touch = |core: Anchor, by: Vector, depth: Scalar| {
        let gap = less(dot(&core.from(&plane.at), &normal), depth);
        Touch::endless(core.plus(by), normal.clone(), gap)
    };
    let ball = |centre: Anchor, radius: &Scalar| {
        touch(centre, opposite(&scaled(radius.clone(), &normal)), radius.clone())
    };
    // the lowest point of a circle of radius R about the axis a: along -m with m = n - (n.a) a, which is a x (n x a); of a
    // circle that lies almost flat the difference would lose its digits
    let rim = |centre: Anchor, radius: &Scalar, tube: Option<&Scalar>| {
        let a = axis_of(shape);
        let across = cross(&normal, &a);
        let length = norm(&across);
        let out = scaled(quotient(opposite_of(radius.clone()), length.clone(), at), &cross(&a, &across));
        let depth = product([radius.clone(), length]);
        match tube {
            None => touch(centre, out, depth),
            Some(tube) => {
                let by = total([out, opposite(&scaled(tube.clone(), &normal))]);
                touch(centre, by, sum([depth, tube.clone()]))
            }
        }
    };
    let along = |length: Scalar| scaled(length, &axis_of(shape));
    let ends =
        |length: &Scalar| [along(half(length)), opposite(&along(half(length)))].map(|by| shape.at.plus(by));
    match (shape.kind, &shape.sizes[..]) {
        (Kind::Sphere, [r]) => vec![ball(shape.at.clone(), r)],
        (Kind::Capsule, [r, l]) => ends(l).map(|end| ball(end, r)).into(),
        (Kind::Disc, [r]) => vec![rim(shape.at.clone(), r, None)],
        (Kind::Cylinder, [r, l]) => ends(l).map(|end| rim(end, r, None)).into(),
        (Kind::Torus, [r, tube]) => vec![rim(shape.at.clone(), r, Some(tube))],
        (Kind::Cone, [r, h]) => {
            let apex = shape.at.plus(along(h.clone()));
            vec![rim(shape.at.clone(), r, None), touch(apex, Vector::Zero, integer(0))]
        }
        (Kind::Ellipsoid, sizes) => {
            // the support point -A n/sqrt(n.A n), where A has the squares of the semi-axes
            let axes = axes_of(shape);
            let parts = axes.iter().zip(sizes).map(|(e, s)| {
                let along = dot(&normal, e);
                (scaled(product([square(s.clone()), along.clone()]), e), product([s.clone(), along]))
            });
            let (terms, squares): (Vec<Vector>, Vec<Scalar>) =
                parts.map(|(term, share)| (term, square(share))).unzip();
            let depth = root(Scalar::Add(squares));
            let by = opposite(&scaled(quotient(integer(1), depth.clone(), at), &total(terms)));
            vec![touch(shape.at.clone(), by, depth)]
        }
        _ => corners(shape).into_iter().map(|p| touch(p, Vector::Zero, integer(0))).collect(),
    }
}

/// The point of a solid that is nearest to a place outside of it, from the solid's own place; d is the place.
fn nearest(solid: &Shape, d: &Vector, at: Span) -> Vector {
    let a = axis_of(solid);
    match (solid.kind, &solid.sizes[..]) {
        (Kind::Capsule, [_, l]) => scaled(between_bounds(dot(d, &a), &half(l)), &a),
        (Kind::Cylinder, [r, l]) => {
            let along = scaled(between_bounds(dot(d, &a), &half(l)), &a);
            let m = total([d.clone(), opposite(&scaled(dot(d, &a), &a))]);
            // the squares keep this smooth on the axis
            let reach = root(greater(dot(&m, &m), square(r.clone())));
            total([along, scaled(quotient(r.clone(), reach, at), &m)])
        }
        (Kind::Cone, [r, height]) => nearest_on_cone(d, &a, [r, height], at),
        (Kind::Disc | Kind::Torus, [r, ..]) => {
            let m = total([d.clone(), opposite(&scaled(dot(d, &a), &a))]);
            scaled(r.clone(), &unit(&m, at))
        }
        (Kind::Box | Kind::Rectangle, sizes) => {
            let sides = axes_of(solid);
            let part = |(e, size): (&Vector, &Scalar)| scaled(between_bounds(dot(d, e), &half(size)), e);
            total(sides.iter().zip(sizes).map(part))
        }
        _ => Vector::Zero,
    }
}

/// The square of the part of a cone's radius below which a place counts as on its axis.
const ON_AXIS: (i64, i64) = (1, 1_000_000_000_000_000_000);

/// The point of a cone that is nearest to a place outside of it: that of the base below its plane, and that of the line
/// from rim to apex above. A place within the cone is its own nearest point.
fn nearest_on_cone(d: &Vector, a: &Vector, [r, height]: [&Scalar; 2], at: Span) -> Vector {
    let h = dot(d, a);
    let m = total([d.clone(), opposite(&scaled(h.clone(), a))]);
    let squares = dot(&m, &m);
    let away = root(greater(squares.clone(), product([ratio(ON_AXIS.0, ON_AXIS.1), square(r.clone())])));
    // from the rim, 0, to the apex, 1
    let line = sum([square(r.clone()), square(height.clone())]);
    let free =
        sum([product([less(r.clone(), away.clone()), r.clone()]), product([h.clone(), height.clone()])]);
    let place = lesser(greater(quotient(free, line, at), integer(0)), integer(1));
    let out = product([r.clone(), less(integer(1), place.clone())]);
    let up = product([place, height.clone()]);
    // What is above the plane of the base is nearest to the side; what is below it, to the base or to its rim, where the
    // side ends. Beyond the rim both have the same point: a choice by distances would be one by rounding near it.
    let side = step(h.clone());
    let base = less(integer(1), side.clone());
    let reach = root(greater(squares, square(r.clone())));
    let beside = sum([
        product([side.clone(), quotient(out, away.clone(), at)]),
        product([base, quotient(r.clone(), reach, at)]),
    ]);
    let on_surface = total([scaled(beside, &m), scaled(product([side, up]), a)]);
    // within: above the base, and below the side
    let below_side = less(
        product([r.clone(), height.clone()]),
        sum([product([away, height.clone()]), product([h.clone(), r.clone()])]),
    );
    let within = step(lesser(h, below_side));
    total([scaled(less(integer(1), within.clone()), &on_surface), scaled(within, d)])
}

/// By how much a solid is thicker than the points that [`nearest`] gives.
fn thickness(solid: &Shape) -> Option<Scalar> {
    match solid.kind {
        Kind::Sphere | Kind::Capsule => solid.sizes.first().cloned(),
        Kind::Torus => solid.sizes.get(1).cloned(),
        _ => None,
    }
}

/// A ball on a solid: the normal is along w, from the nearest point of the solid to the centre of the ball.
fn on_solid(ball: &Shape, solid: &Shape, at: Span) -> Touch {
    let d = ball.at.from(&solid.at);
    let w = match nearest(solid, &d, at) {
        Vector::Zero => d,
        nearest => total([d, opposite(&nearest)]),
    };
    let (radius, normal) = (radius_of(ball), unit(&w, at));
    let away = match thickness(solid) {
        None => radius.clone(),
        Some(thickness) => sum([radius.clone(), thickness]),
    };
    let point = ball.at.plus(opposite(&scaled(radius, &normal)));
    Touch::endless(point, normal, less(norm(&w), away))
}

/// The square of the angle between the axes of capsules, rad^2, below which they count as parallel: places along
/// them are not known then, and the distance does not depend on them but for rounding.
const PARALLEL: (i64, i64) = (1, 1_000_000_000_000);

/// A capsule on another: the nearest points of two segments, each held within its segment, and found again where the
/// other is beyond an end (section 16.8).
fn on_capsule(first: &Shape, second: &Shape, at: Span) -> Touch {
    let ([r, l], [other, length]) = (&first.sizes[..], &second.sizes[..]) else {
        return on_solid(first, second, at);
    };
    let (a, b, d) = (axis_of(first), axis_of(second), first.at.from(&second.at));
    let (along, d_a, d_b) = (dot(&a, &b), dot(&d, &a), dot(&d, &b));
    // sin^2 of the angle as the square of a vector: it is exact where the axes are nearly parallel
    let across = Vector::Cross(Box::new(a.clone()), Box::new(b.clone()));
    let apart = greater(dot(&across, &across), ratio(PARALLEL.0, PARALLEL.1));
    let free = quotient(less(product([along.clone(), d_b.clone()]), d_a.clone()), apart, at);
    let guess = between_bounds(free, &half(l));
    let unheld = sum([d_b, product([along.clone(), guess.clone()])]);
    let there = between_bounds(unheld.clone(), &half(length));
    // Only beyond an end of the second is the place on the first another one: found again where it is the same, rounding
    // would hold one of the two at an end and not the other.
    let beyond = step(less(size(unheld), half(length)));
    let again = between_bounds(less(product([along, there.clone()]), d_a), &half(l));
    let here = sum([product([beyond.clone(), again]), product([less(integer(1), beyond), guess])]);
    let w = total([d, scaled(here.clone(), &a), opposite(&scaled(there, &b))]);
    let normal = unit(&w, at);
    let point = first.at.plus(total([scaled(here, &a), opposite(&scaled(r.clone(), &normal))]));
    Touch::endless(point, normal, less(norm(&w), sum([r.clone(), other.clone()])))
}

/// A ball within a sphere, a capsule or a cylinder without ends: w leads from the middle to the ball's centre.
fn in_solid(ball: &Shape, hollow: &Shape, at: Span) -> Touch {
    let d = ball.at.from(&hollow.at);
    let a = axis_of(hollow);
    let w = match hollow.kind {
        Kind::Cylinder => total([d.clone(), opposite(&scaled(dot(&d, &a), &a))]),
        Kind::Capsule => total([d.clone(), opposite(&nearest(hollow, &d, at))]),
        _ => d,
    };
    let (radius, out) = (radius_of(ball), unit(&w, at));
    let gap = less(less(radius_of(hollow), radius.clone()), norm(&w));
    Touch::endless(ball.at.plus(scaled(radius, &out)), opposite(&out), gap)
}

/// A ball within a box: six walls.
fn in_box(ball: &Shape, hollow: &Shape) -> Vec<Touch> {
    let d = ball.at.from(&hollow.at);
    let radius = radius_of(ball);
    let mut out = Vec::new();
    for (e, size) in axes_of(hollow).iter().zip(&hollow.sizes) {
        for inward in [opposite(e), e.clone()] {
            let gap = less(sum([half(size), dot(&d, &inward)]), radius.clone());
            let point = ball.at.plus(opposite(&scaled(radius.clone(), &inward)));
            out.push(Touch::endless(point, inward, gap));
        }
    }
    out
}

/// A point on a surface z = h(x, y), or, with one slope, on a curve y = h(x). The gap
/// (z - h)/sqrt(1 + |grad h|^2) vanishes on the surface, and there its rate is n . v.
fn on_height(point: &Anchor, surface: &Shape, slopes: usize) -> Option<Touch> {
    let height = surface.height.as_ref()?;
    let [x, y, z] = axes_of(surface);
    let d = point.from(&surface.at);
    let (up, across) = if slopes == 2 { (z, vec![x, y]) } else { (y, vec![x]) };
    let mut places: Vec<Scalar> = across.iter().map(|e| dot(&d, e)).collect();
    places.resize(2, integer(0));
    let places: [Scalar; 2] = places.try_into().ok()?;
    let slope = |i: usize| height.slopes[i].at(&places);
    let steep = (0..slopes).map(|i| square(slope(i)));
    let length = root(Scalar::Add(std::iter::once(integer(1)).chain(steep).collect()));
    let terms = across.iter().enumerate().map(|(i, e)| opposite(&scaled(slope(i), e)));
    let steepest = total(std::iter::once(up.clone()).chain(terms));
    let at = surface.span;
    let gap = quotient(less(dot(&d, &up), height.value.at(&places)), length.clone(), at);
    let normal = scaled(quotient(integer(1), length, at), &steepest);
    Some(Touch::endless(point.clone(), normal, gap))
}

/// A vertex near an implicit surface: f over the length of its gradient, which is the normal.
fn on_implicit(point: &Anchor, surface: &Shape) -> Option<Touch> {
    let function = surface.function.as_ref()?;
    let axes = axes_of(surface);
    let d = point.from(&surface.at);
    let place = axes.each_ref().map(|e| dot(&d, e));
    let gradient = function.slopes.each_ref().map(|slope| slope.at(&place));
    let length = root(all(gradient.iter().cloned().map(square)));
    let at = surface.span;
    let gap = quotient(function.value.at(&place), length.clone(), at);
    let along = total(axes.iter().zip(gradient).map(|(e, slope)| scaled(slope, e)));
    Some(Touch::endless(point.clone(), scaled(quotient(integer(1), length, at), &along), gap))
}

fn radius_of(round: &Shape) -> Scalar {
    round.sizes.first().cloned().unwrap_or_else(|| integer(0))
}
