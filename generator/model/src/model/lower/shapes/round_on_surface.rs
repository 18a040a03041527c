//! The contact of a round shape on a surface f(x, y, z) = 0 (section 16.15 of docs/theory.md).
//!
//! The unknown is the direction m of the normal: the shape touches where it is furthest against m, at a place where m leads
//! along the gradient of f.

use super::algebra::*;
use super::features::{Touch, axes_of};
use super::iterations::{Solution, either, freeze, is_found, solved};
use super::round::Round;
use super::separation::{least, others};
use super::shared::Shared;
use super::solids::{Components, inner, keep, vector};
use crate::model::mechanism::{Definition, OfPlace, Scalar, Shape};
use crate::span::Span;

/// Steps of the iteration.
const STEPS: usize = 5;
/// By how much of its size a shape may be in the ground at another place than the one that is found: above the rounding of
/// singles.
const DEEPER: (i64, i64) = (1, 100_000);

/// The contact; none with a surface whose slopes have no slope.
pub fn between([round, ground]: [&Shape; 2], definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut shared = Shared::pair([round, ground], definitions, at);
    let touch = Ground::of(ground).map(|own| own.touch(round, ground, &mut shared));
    touch.into_iter().collect()
}

/// What vanishes on a surface, with its second derivatives.
struct Ground {
    function: OfPlace<3>,
    curvatures: [Components; 3],
}

/// A direction, the place of the shape furthest against it, and the ground there.
struct Foot {
    direction: Components,
    at: Components,
    gradient: Components,
    length: Scalar,
    normal: Components,
    /// the difference of the direction from the normal
    rest: Components,
}

impl Ground {
    fn of(ground: &Shape) -> Option<Ground> {
        let function = OfPlace::above(ground)?;
        let curvatures = function.curvatures(ground.span)?;
        Some(Ground { function, curvatures })
    }

    fn gradient(&self, at: &Components, shared: &mut Shared<'_>) -> Components {
        keep(self.function.slopes.each_ref().map(|slope| slope.at(at)), "gradient of the ground", shared)
    }

    fn foot(&self, round: &Round, direction: Components, shared: &mut Shared<'_>) -> Foot {
        let at = round.place(&direction, shared);
        let gradient = self.gradient(&at, shared);
        let length = shared.scalar(root(inner(&gradient, &gradient)), "length of the gradient");
        let normal = gradient.clone().map(|part| quotient(part, length.clone(), shared.at));
        let normal = keep(normal, "normal of the ground", shared);
        let rest = std::array::from_fn(|i| less(direction[i].clone(), normal[i].clone()));
        let rest = keep(rest, "difference of directions", shared);
        Foot { direction, at, gradient, length, normal, rest }
    }

    /// Newton's matrix 1 + K B: K tells how the normal changes with the place, B how the place changes against the direction.
    fn matrix(&self, round: &Round, foot: &Foot, shared: &mut Shared<'_>) -> [Components; 3] {
        let curvatures: [Components; 3] = symmetric(|i, j| {
            let entry = quotient(self.curvatures[i][j].at(&foot.at), foot.length.clone(), shared.at);
            shared.scalar(entry, "curvature of the ground")
        });
        // the normal stays of unit length
        let along = curvatures.each_ref().map(|row| inner(row, &foot.normal));
        let along = keep(along, "curvature along the normal", shared);
        let bends: [Components; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let lost = product([foot.normal[i].clone(), along[j].clone()]);
                shared.scalar(less(curvatures[i][j].clone(), lost), "change of the normal")
            })
        });
        let spread = round.spread(&foot.direction, shared);
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let terms = (0..3).map(|k| product([bends[i][k].clone(), spread[k][j].clone()]));
                let entry = all(std::iter::once(integer(i64::from(i == j))).chain(terms));
                shared.scalar(entry, "matrix of Newton's step")
            })
        })
    }

    /// The inverse of Newton's matrix, of which derivatives take no notice.
    fn inverse(&self, round: &Round, foot: &Foot, shared: &mut Shared<'_>) -> [Components; 3] {
        let matrix = self.matrix(round, foot, shared);
        let cofactors = cofactors(&matrix, shared);
        let determinant = shared.scalar(inner(&matrix[0], &cofactors[0]), "determinant");
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let entry = quotient(cofactors[j][i].clone(), determinant.clone(), shared.at);
                shared.scalar(freeze(entry), "inverse of Newton's matrix")
            })
        })
    }

    fn touch(&self, shape: &Shape, ground: &Shape, shared: &mut Shared<'_>) -> Touch {
        let axes = axes_of(ground);
        let round = &Round::of(shape, ground, &axes, shared);
        let looked_at: Vec<(Components, Scalar)> = round
            .directions(|at, shared| self.gradient(at, shared), shared)
            .into_iter()
            .map(|direction| {
                let at = round.place(&direction, shared);
                let value = shared.scalar(self.function.value.at(&at), "function of the ground");
                (direction, value)
            })
            .collect();
        let start = lowest(&looked_at, shared);
        let by = |direction: &Components, step: &Components, share: (i64, i64)| -> Components {
            std::array::from_fn(|i| {
                less(direction[i].clone(), product([ratio(share.0, share.1), step[i].clone()]))
            })
        };
        let squares = |foot: &Foot| inner(&foot.rest, &foot.rest);
        // the better one of a whole and a quarter step
        let damped = |direction: Components, shared: &mut Shared<'_>| {
            let foot = self.foot(round, direction, shared);
            let step_of = step_by(&self.inverse(round, &foot, shared), &foot, shared);
            let tried = [(1, 1), (1, 4)].map(|share| {
                let next = keep(by(&foot.direction, &step_of, share), "tried direction", shared);
                let length = shared.scalar(root(inner(&next, &next)), "its length");
                let next = next.map(|part| quotient(part, length.clone(), shared.at));
                let next = keep(next, "tried direction", shared);
                let rest = squares(&self.foot(round, next.clone(), shared));
                (next, rest)
            });
            let [(whole, rest), (part, rest_of_part)] = tried;
            let is_better = shared.scalar(step(less(rest_of_part, rest)), "whether the whole step is better");
            std::array::from_fn(|i| either(&is_better, whole[i].clone(), part[i].clone()))
        };
        // both of the last steps have the matrix of the first
        let mut inverse = None;
        let newton = |direction: Components, shared: &mut Shared<'_>| {
            let foot = self.foot(round, direction, shared);
            let inverse = inverse.get_or_insert_with(|| self.inverse(round, &foot, shared));
            by(&foot.direction, &step_by(inverse, &foot, shared), (1, 1))
        };
        let solution = solved(start, STEPS, damped, newton, "direction of the normal", shared);
        let Solution { frozen, exact: direction } = solution;
        let before = self.foot(round, frozen, shared);
        let found = is_found(root(squares(&before)), integer(1));
        let foot = self.foot(round, direction, shared);
        // the shape fits into the ground's hollow if both eigenvalues of the matrix across the normal are positive
        let matrix = self.matrix(round, &foot, shared);
        let trace = all((0..3).map(|i| matrix[i][i].clone()));
        let cofactors = cofactors(&matrix, shared);
        let fits = lesser(inner(&matrix[0], &cofactors[0]), less(trace, integer(1)));
        // it touches here first, unless it is deeper in the ground at another place
        let value = shared.scalar(self.function.value.at(&foot.at), "function of the ground");
        let level = shared.scalar(lesser(value.clone(), integer(0)), "lowest value, if it is in the ground");
        let others = looked_at.into_iter().map(|(_, value)| less(value, level.clone()));
        let slack = product([ratio(DEEPER.0, DEEPER.1), round.size.clone(), foot.length.clone()]);
        let clear = all([least(others.collect()), slack]);
        let found = product([found, step(lesser(fits, clear))]);
        let found = shared.scalar(found, "whether the shape touches at one place only");
        let length = quotient(foot.length.clone(), found, shared.at);
        let length = shared.scalar(length, "length of the gradient");
        let frame = ground.axes.unwrap_or(ground.frame);
        let normal = foot.gradient.map(|part| quotient(part, length.clone(), shared.at));
        let normal = shared.vector(vector(frame, normal), "normal of the ground");
        let by = std::array::from_fn(|i| less(foot.at[i].clone(), round.centre[i].clone()));
        let gap = quotient(value, length, shared.at);
        Touch::endless(shape.at.plus(vector(frame, by)), normal, gap)
    }
}

/// What an inverse of Newton's matrix makes of what is left.
fn step_by(inverse: &[Components; 3], foot: &Foot, shared: &mut Shared<'_>) -> Components {
    keep(inverse.each_ref().map(|row| inner(row, &foot.rest)), "Newton's step", shared)
}

/// The direction in which the function is least.
fn lowest(looked_at: &[(Components, Scalar)], shared: &mut Shared<'_>) -> Components {
    let mut looks = looked_at.iter().cloned();
    let Some((mut direction, mut value)) = looks.next() else { return [0, 1, 2].map(integer) };
    for (other, lower) in looks {
        let is_lower = step(less(value.clone(), lower.clone()));
        let is_lower = shared.scalar(is_lower, "whether a place is lower");
        let next = std::array::from_fn(|i| either(&is_lower, other[i].clone(), direction[i].clone()));
        direction = keep(next, "direction of the lowest place", shared);
        value = shared.scalar(lesser(value, lower), "value at the lowest place");
    }
    direction
}

/// The cofactors of a matrix.
fn cofactors(a: &[Components; 3], shared: &mut Shared<'_>) -> [Components; 3] {
    std::array::from_fn(|i| {
        std::array::from_fn(|j| {
            let ([k, l], [m, n]) = (others(i), others(j));
            let cofactor = less(
                product([a[k][m].clone(), a[l][n].clone()]),
                product([a[k][n].clone(), a[l][m].clone()]),
            );
            shared.scalar(cofactor, "cofactor")
        })
    })
}
