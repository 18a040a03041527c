//! The contact of a sphere on a surface z = h(x, y) or on a curve y = h(x) (section 16.13 of docs/theory.md).
//!
//! The unknowns are the slopes of the surface where the sphere touches it: they tell how far from below the centre that
//! is.

use super::algebra::*;
use super::features::{Touch, axes_of};
use super::heights::slope;
use super::iterations::{Solution, either, is_found, solved};
use super::shared::Shared;
use crate::model::mechanism::{Definition, Height, Kind, Scalar, Shape, Vector};
use crate::span::Span;

/// Steps of the iteration.
const STEPS: usize = 8;
/// The contact; none for a surface whose slopes have no slope.
pub fn between([sphere, surface]: [&Shape; 2], definitions: &mut Vec<Definition>, at: Span) -> Vec<Touch> {
    let mut shared = Shared::pair([sphere, surface], definitions, at);
    let shared = &mut shared;
    let touch = match surface.kind {
        Kind::Curve => {
            Ground::<1>::of(sphere, surface, at, shared).map(|ground| ground.touch(sphere, shared))
        }
        _ => Ground::<2>::of(sphere, surface, at, shared).map(|ground| ground.touch(sphere, shared)),
    };
    touch.into_iter().collect()
}

/// A ground with N slopes under a sphere.
struct Ground<'s, const N: usize> {
    height: &'s Height,
    /// the second derivatives of the height
    curvatures: [[Scalar; N]; N],
    /// along which the place is counted
    across: [Vector; N],
    up: Vector,
    /// the centre of the sphere
    place: [Scalar; N],
    level: Scalar,
    radius: Scalar,
    at: Span,
}

/// A place of the ground that is found from slopes there.
struct Foot<const N: usize> {
    /// the slopes of the ground
    slopes: [Scalar; N],
    /// the differences between the slopes from which the place was found and these
    rest: [Scalar; N],
    /// the sum of 1 and the squares of the slopes from which the place was found, and its root
    steep: Scalar,
    length: Scalar,
    at: [Scalar; 2],
}

impl<'s, const N: usize> Ground<'s, N> {
    fn of(sphere: &Shape, surface: &'s Shape, at: Span, shared: &mut Shared<'_>) -> Option<Self> {
        let height = surface.height.as_ref()?;
        let curvatures: [[Option<Scalar>; N]; N] =
            symmetric(|i, j| slope(&height.slopes[i], Height::PLACES[j], surface.span));
        if curvatures.iter().flatten().any(Option::is_none) {
            return None;
        }
        let curvatures = curvatures.map(|row| row.map(|entry| entry.unwrap_or_else(|| integer(0))));
        let axes = axes_of(surface);
        let d = sphere.at.from(&surface.at);
        let across: [Vector; N] = std::array::from_fn(|i| axes[i].clone());
        let up = axes[N].clone();
        let place = across.each_ref().map(|e| shared.scalar(dot(&d, e), "place of the centre"));
        let level = shared.scalar(dot(&d, &up), "level of the centre");
        let radius = sphere.sizes.first().cloned().unwrap_or_else(|| integer(0));
        Some(Ground { height, curvatures, across, up, place, level, radius, at })
    }

    /// The place where a sphere touches a ground that has these slopes there.
    fn foot(&self, slopes: &[Scalar; N], shared: &mut Shared<'_>) -> Foot<N> {
        let squares = slopes.iter().map(|slope| square(slope.clone()));
        let steep = shared.scalar(all(std::iter::once(integer(1)).chain(squares)), "steepness");
        let length = shared.scalar(root(steep.clone()), "steepness");
        let reach =
            shared.scalar(quotient(self.radius.clone(), length.clone(), self.at), "height of the centre");
        let mut at = [integer(0), integer(0)];
        for (i, at) in at.iter_mut().enumerate().take(N) {
            let there = all([self.place[i].clone(), product([reach.clone(), slopes[i].clone()])]);
            *at = shared.scalar(there, "place of contact");
        }
        let found: [Scalar; N] =
            std::array::from_fn(|i| shared.scalar(self.height.slopes[i].at(&at), "slope of the ground"));
        let rest = std::array::from_fn(|i| {
            shared.scalar(less(slopes[i].clone(), found[i].clone()), "difference of slopes")
        });
        Foot { slopes: slopes.clone(), rest, steep, length, at }
    }

    /// Newton's matrix 1 - H D: H has the second derivatives of the height, D is how the place changes with slopes.
    fn matrix(&self, foot: &Foot<N>, shared: &mut Shared<'_>) -> [[Scalar; N]; N] {
        let curvatures: [[Scalar; N]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                shared.scalar(self.curvatures[i][j].at(&foot.at), "curvature of the ground")
            })
        });
        let reach = quotient(self.radius.clone(), foot.length.clone(), self.at);
        let reach = shared.scalar(reach, "height of the centre");
        let falls = quotient(reach.clone(), foot.steep.clone(), self.at);
        let falls = shared.scalar(falls, "change of the place");
        let moves: [[Scalar; N]; N] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let rest = product([falls.clone(), foot.slopes[i].clone(), foot.slopes[j].clone()]);
                let entry = if i == j { less(reach.clone(), rest) } else { opposite_of(rest) };
                shared.scalar(entry, "change of the place")
            })
        });
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let terms = (0..N).map(|k| product([curvatures[i][k].clone(), moves[k][j].clone()]));
                let entry = less(integer(i64::from(i == j)), all(terms));
                shared.scalar(entry, "matrix of Newton's step")
            })
        })
    }

    /// Newton's step.
    fn newton(&self, foot: &Foot<N>, shared: &mut Shared<'_>) -> [Scalar; N] {
        let matrix = self.matrix(foot, shared);
        let determinant = shared.scalar(determinant(&matrix), "determinant");
        std::array::from_fn(|i| {
            let terms = (0..N).map(|k| product([adjugate(&matrix, i, k), foot.rest[k].clone()]));
            shared.scalar(quotient(all(terms), determinant.clone(), self.at), "Newton's step")
        })
    }

    fn touch(&self, sphere: &Shape, shared: &mut Shared<'_>) -> Touch {
        let start: [Scalar; N] = {
            let mut below = [integer(0), integer(0)];
            below.iter_mut().zip(&self.place).for_each(|(below, place)| *below = place.clone());
            std::array::from_fn(|i| self.height.slopes[i].at(&below))
        };
        let by = |slopes: &[Scalar; N], step: &[Scalar; N], share: (i64, i64)| -> [Scalar; N] {
            std::array::from_fn(|i| {
                less(slopes[i].clone(), product([ratio(share.0, share.1), step[i].clone()]))
            })
        };
        let squares = |foot: &Foot<N>| all(foot.rest.iter().map(|rest| square(rest.clone())));
        // the better one of a whole and a quarter step
        let damped = |slopes: [Scalar; N], shared: &mut Shared<'_>| {
            let foot = self.foot(&slopes, shared);
            let step_of = self.newton(&foot, shared);
            let tried = [(1, 1), (1, 4)].map(|share| {
                let slopes = by(&slopes, &step_of, share).map(|slope| shared.scalar(slope, "tried slope"));
                let rest = squares(&self.foot(&slopes, shared));
                (slopes, rest)
            });
            let [(whole, rest), (part, rest_of_part)] = tried;
            let is_better = shared.scalar(step(less(rest_of_part, rest)), "whether the whole step is better");
            let mut part = part.into_iter();
            whole.map(|whole| either(&is_better, whole, part.next().unwrap_or_else(|| integer(0))))
        };
        let newton = |slopes: [Scalar; N], shared: &mut Shared<'_>| {
            let foot = self.foot(&slopes, shared);
            let step_of = self.newton(&foot, shared);
            by(&slopes, &step_of, (1, 1))
        };
        let solution = solved(start, STEPS, damped, newton, "slope at the place of contact", shared);
        let Solution { frozen, exact: slopes } = solution;
        let before = self.foot(&frozen, shared);
        let found = is_found(root(squares(&before)), before.length.clone());
        let foot = self.foot(&slopes, shared);
        // the sphere fits into the ground's hollow if both eigenvalues of the matrix are positive
        let matrix = self.matrix(&foot, shared);
        let trace = all((0..N).map(|i| matrix[i][i].clone()));
        let fits = lesser(determinant(&matrix), trace);
        let found = product([found, step(fits)]);
        let found = shared.scalar(found, "whether the sphere touches at one place only");
        let length = shared.scalar(quotient(foot.length.clone(), found, self.at), "length of the normal");
        let terms = (0..N).map(|i| opposite(&scaled(slopes[i].clone(), &self.across[i])));
        let steepest = total(std::iter::once(self.up.clone()).chain(terms));
        let normal = scaled(quotient(integer(1), length.clone(), self.at), &steepest);
        let normal = shared.vector(normal, "normal of the ground");
        let highest =
            all([self.height.value.at(&foot.at), quotient(self.radius.clone(), length.clone(), self.at)]);
        let gap = quotient(less(self.level.clone(), highest), length, self.at);
        let point = sphere.at.plus(opposite(&scaled(self.radius.clone(), &normal)));
        Touch::endless(point, normal, gap)
    }
}

/// The determinant of a matrix of one or two rows.
fn determinant<const N: usize>(a: &[[Scalar; N]; N]) -> Scalar {
    match N {
        1 => a[0][0].clone(),
        _ => less(product([a[0][0].clone(), a[1][1].clone()]), product([a[0][1].clone(), a[1][0].clone()])),
    }
}

/// An entry of the inverse times the determinant.
fn adjugate<const N: usize>(a: &[[Scalar; N]; N], i: usize, j: usize) -> Scalar {
    match (N, i == j) {
        (1, _) => integer(1),
        (_, true) => a[1 - i][1 - i].clone(),
        (_, false) => opposite_of(a[i][j].clone()),
    }
}
