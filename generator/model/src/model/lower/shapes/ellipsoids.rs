//! Contacts of spheres and ellipsoids on ellipsoids (section 16.13 of docs/theory.md).
//!
//! Everything is written in components along the axes of the second.

use super::algebra::*;
use super::features::{Touch, axes_of};
use super::iterations::{Solution, either, is_found, solved};
use super::separation::others;
use super::shared::Shared;
use super::solids::{Components, inner, keep, vector};
use crate::model::mechanism::{Definition, FrameId, Scalar, Shape};
use crate::span::Span;

/// Steps of the iterations: they suffice for semi-axes in a ratio of 1 to 100, and some more.
const STEPS_OF_SPHERE: usize = 8;
const STEPS: usize = 10;
/// The contact of a sphere on an ellipsoid: the distance of its centre.
pub fn under_sphere(
    [sphere, ellipsoid]: [&Shape; 2],
    definitions: &mut Vec<Definition>,
    at: Span,
) -> Vec<Touch> {
    let mut shared = Shared::pair([sphere, ellipsoid], definitions, at);
    let shared = &mut shared;
    let d = sphere.at.from(&ellipsoid.at);
    let place = keep(axes_of(ellipsoid).each_ref().map(|e| dot(&d, e)), "place of the centre", shared);
    let sizes = sizes_of(ellipsoid);
    let squares = keep(sizes.each_ref().map(|l| square(l.clone())), "squared semi-axis", shared);
    let stretched: Components = std::array::from_fn(|i| product([sizes[i].clone(), place[i].clone()]));
    let stretched = keep(stretched, "place times semi-axis", shared);
    // below the solution: one term alone is 1 there
    let starts = (0..3).map(|i| less(size(stretched[i].clone()), squares[i].clone()));
    let start = starts.reduce(greater).unwrap_or_else(|| integer(0));
    // the root of the sum of squares of l y/(t + l^2), and the next t
    let newton = |[t]: [Scalar; 1], shared: &mut Shared<'_>| {
        let divisors = keep(divisors(&squares, &t), "divisor", shared);
        let terms: Components =
            std::array::from_fn(|i| quotient(stretched[i].clone(), divisors[i].clone(), at));
        let terms = keep(terms, "term", shared);
        let sum = shared.scalar(inner(&terms, &terms), "sum of squares");
        let slope = all((0..3).map(|i| quotient(square(terms[i].clone()), divisors[i].clone(), at)));
        let excess = less(root(sum.clone()), integer(1));
        [all([t, quotient(product([excess, sum]), slope, at)])]
    };
    let solution =
        solved([start], STEPS_OF_SPHERE, newton, newton, "multiplier of the nearest place", shared);
    let Solution { frozen: [frozen], exact: [t] } = solution;
    // the sum is 1 at the solution
    let divided = divisors(&squares, &frozen);
    let terms: Components = std::array::from_fn(|i| quotient(stretched[i].clone(), divided[i].clone(), at));
    let rest = less(inner(&terms, &terms), integer(1));
    let found = shared.scalar(is_found(rest, integer(1)), "whether the nearest place is found");
    let divided = divisors(&squares, &t);
    let across: Components = std::array::from_fn(|i| quotient(place[i].clone(), divided[i].clone(), at));
    let across = keep(across, "normal, not of unit length,", shared);
    let length = root(inner(&across, &across));
    let length = shared.scalar(quotient(length, found, at), "length of the normal");
    let normal = across.map(|part| quotient(part, length.clone(), at));
    let normal = shared.vector(vector(axes_frame(ellipsoid), normal), "normal of the nearest place");
    let radius = sphere.sizes.first().cloned().unwrap_or_else(|| integer(0));
    let gap = less(product([t, length]), radius.clone());
    vec![Touch::endless(sphere.at.plus(opposite(&scaled(radius, &normal))), normal, gap)]
}

/// The contact of an ellipsoid on another: by how much both must be scaled about their centres to touch.
pub fn between([first, second]: [&Shape; 2], definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut shared = Shared::pair([first, second], definitions, at);
    let shared = &mut shared;
    let frame = axes_frame(second);
    let pair = Ellipsoids::of(first, second, shared);
    let d = pair.apart.clone();
    let [own, other] = [pair.first(&d), pair.second(&d)].map(|along| root(inner(&d, &along)));
    let start = quotient(own.clone(), all([own, other]), at);
    let bounds = [integer(0), integer(1)];
    let [low, high] = bounds;
    let within = |[share, low, high]: [Scalar; 3], shared: &mut Shared<'_>| {
        let (rest, next) = pair.newton(&share, shared);
        let next = shared.scalar(next, "next share");
        let above = shared.scalar(step(rest), "whether the share is too small");
        let low = shared.scalar(either(&above, share.clone(), low), "lower bound of the share");
        let high = shared.scalar(either(&above, high, share), "upper bound of the share");
        let inside = lesser(less(next.clone(), low.clone()), less(high.clone(), next.clone()));
        let inside = shared.scalar(step(inside), "whether the share is within its bounds");
        let held = lesser(greater(next, low.clone()), high.clone());
        let middle = half(&all([low.clone(), high.clone()]));
        [either(&inside, held, middle), low, high]
    };
    let newton = |[share, low, high]: [Scalar; 3], shared: &mut Shared<'_>| {
        let (_, next) = pair.newton(&share, shared);
        [next, low, high]
    };
    let solution = solved([start, low, high], STEPS, within, newton, "share of the second", shared);
    let Solution { frozen: [frozen, ..], exact: [share, ..] } = solution;
    let before = pair.at(&frozen, shared);
    let found = is_found(before.rest(&frozen), all(before.reaches.iter().cloned()));
    let found = shared.scalar(found, "whether the normal is found");
    let at_share = pair.at(&share, shared);
    let reach = all(at_share.reaches.iter().cloned());
    let length = root(inner(&at_share.along, &at_share.along));
    let length = shared.scalar(quotient(length, found, at), "length of the normal");
    let normal = at_share.along.each_ref().map(|part| quotient(part.clone(), length.clone(), at));
    let normal = shared.vector(vector(frame, normal), "normal of the contact");
    let gap = quotient(less(inner(&at_share.along, &d), reach), length, at);
    let by = at_share.first.map(|part| opposite_of(quotient(part, at_share.reaches[0].clone(), at)));
    vec![Touch::endless(first.at.plus(vector(frame, by)), normal, gap)]
}

/// Two ellipsoids: the matrices A_1 and A_2 of which x A^-1 x = 1 is the surface, and the place of the first from the
/// second.
struct Ellipsoids {
    /// A_1: it is symmetric
    first: [Components; 3],
    /// the diagonal of A_2
    second: Components,
    apart: Components,
    at: Span,
}

/// What belongs to the sum of both, with a share of the second.
struct AtShare {
    /// m, with ((1 - s) A_1 + s A_2) m = d
    along: Components,
    /// A_1 m and A_2 m
    first: Components,
    second: Components,
    /// how far each reaches along m, times abs(m)
    reaches: [Scalar; 2],
    /// the inverse of the sum
    inverse: [Components; 3],
}

impl AtShare {
    /// What vanishes at the solution: (1 - s) h_1 - s h_2.
    fn rest(&self, share: &Scalar) -> Scalar {
        let [own, other] = self.reaches.clone();
        less(product([less(integer(1), share.clone()), own]), product([share.clone(), other]))
    }
}

impl Ellipsoids {
    fn of(first: &Shape, second: &Shape, shared: &mut Shared<'_>) -> Ellipsoids {
        let axes = axes_of(second);
        let (own, sizes) = (axes_of(first), sizes_of(first));
        // semi-axes of the first along the axes of the second
        let rows: [Components; 3] = std::array::from_fn(|k| {
            let row = axes.each_ref().map(|e| product([sizes[k].clone(), dot(&own[k], e)]));
            keep(row, "semi-axis of the first", shared)
        });
        let matrix = symmetric(|i, j| {
            let entry = all(rows.iter().map(|row| product([row[i].clone(), row[j].clone()])));
            shared.scalar(entry, "matrix of the first")
        });
        let squares = sizes_of(second).map(square);
        let squares = keep(squares, "squared semi-axis of the second", shared);
        let d = first.at.from(&second.at);
        let apart = keep(axes.each_ref().map(|e| dot(&d, e)), "place of the first", shared);
        Ellipsoids { first: matrix, second: squares, apart, at: shared.at }
    }

    /// A_1 v
    fn first(&self, v: &Components) -> Components {
        self.first.each_ref().map(|row| inner(row, v))
    }

    /// A_2 v
    fn second(&self, v: &Components) -> Components {
        std::array::from_fn(|i| product([self.second[i].clone(), v[i].clone()]))
    }

    fn at(&self, share: &Scalar, shared: &mut Shared<'_>) -> AtShare {
        let rest = shared.scalar(less(integer(1), share.clone()), "share of the first");
        let mut sum =
            self.first.each_ref().map(|row| row.each_ref().map(|a| product([rest.clone(), a.clone()])));
        for (i, row) in sum.iter_mut().enumerate() {
            row[i] = all([row[i].clone(), product([share.clone(), self.second[i].clone()])]);
        }
        let sum = sum.map(|row| keep(row, "sum of both matrices", shared));
        let inverse = inverse(&sum, self.at, shared);
        let along = keep(
            inverse.each_ref().map(|row| inner(row, &self.apart)),
            "normal, not of unit length,",
            shared,
        );
        let [first, second] =
            [self.first(&along), self.second(&along)].map(|v| keep(v, "point, not scaled,", shared));
        let reaches =
            [&first, &second].map(|v| shared.scalar(root(inner(&along, v)), "reach along the normal"));
        AtShare { along, first, second, reaches, inverse }
    }

    /// What vanishes at the solution, and Newton's next share.
    fn newton(&self, share: &Scalar, shared: &mut Shared<'_>) -> (Scalar, Scalar) {
        let here = self.at(share, shared);
        let rest = shared.scalar(here.rest(share), "difference of the reaches");
        let change: Components = std::array::from_fn(|i| less(here.first[i].clone(), here.second[i].clone()));
        let change = keep(change, "difference of the points", shared);
        let change =
            keep(here.inverse.each_ref().map(|row| inner(row, &change)), "change of the normal", shared);
        let [own, other] = &here.reaches;
        // (1 - s)/h_2 - s/h_1 is almost linear; times h_1 h_2
        let of = |v: &Components, [reach, other]: [&Scalar; 2], share: Scalar| {
            let rate = quotient(inner(v, &change), reach.clone(), self.at);
            product([share, rate, quotient(other.clone(), reach.clone(), self.at)])
        };
        let slope = all([
            opposite_of(own.clone()),
            opposite_of(other.clone()),
            of(&here.first, [own, other], share.clone()),
            opposite_of(of(&here.second, [other, own], less(integer(1), share.clone()))),
        ]);
        let next = less(share.clone(), quotient(rest.clone(), slope, self.at));
        (rest, next)
    }
}

/// The inverse of a symmetric matrix.
fn inverse(a: &[Components; 3], at: Span, shared: &mut Shared<'_>) -> [Components; 3] {
    let cofactor = |i: usize, j: usize| {
        let ([k, l], [m, n]) = (others(i), others(j));
        less(product([a[k][m].clone(), a[l][n].clone()]), product([a[k][n].clone(), a[l][m].clone()]))
    };
    let cofactors: [Components; 3] = symmetric(|i, j| shared.scalar(cofactor(i, j), "cofactor"));
    let determinant = shared.scalar(inner(&a[0], &cofactors[0]), "determinant");
    symmetric(|i, j| {
        let entry = quotient(cofactors[i][j].clone(), determinant.clone(), at);
        shared.scalar(entry, "inverse of the sum")
    })
}

/// t + l^2
fn divisors(squares: &Components, t: &Scalar) -> Components {
    squares.each_ref().map(|square| all([t.clone(), square.clone()]))
}

fn sizes_of(ellipsoid: &Shape) -> Components {
    std::array::from_fn(|i| ellipsoid.sizes.get(i).cloned().unwrap_or_else(|| integer(0)))
}

fn axes_frame(shape: &Shape) -> FrameId {
    shape.axes.unwrap_or(shape.frame)
}
