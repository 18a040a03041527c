//! The contact of a sphere on a surface z = h(x, y) or on a curve y = h(x) (section 16.13 of docs/theory.md).
//!
//! The unknowns are the slopes of the surface where the sphere touches it: they tell how far that place is from the one
//! below the centre.

use super::algebra::*;
use super::features::{Touch, axes_of};
use super::iterations::{Solution, either, is_found, solved};
use super::separation::least;
use super::shared::Shared;
use crate::model::mechanism::{Definition, Height, Kind, Scalar, Shape, Vector};
use crate::span::Span;

/// Steps of the iteration.
const STEPS: usize = 8;
/// Where a ground is looked at under a sphere: distances from below the centre, and how far the sphere reaches below the
/// centre there, in parts of its radius.
const RINGS: [[(i64, i64); 2]; 4] =
    [[(7, 25), (24, 25)], [(3, 5), (4, 5)], [(4, 5), (3, 5)], [(24, 25), (7, 25)]];
/// Directions of these places, of unit length.
const ON_CURVES: [[(i64, i64); 2]; 2] = [[(1, 1), (0, 1)], [(-1, 1), (0, 1)]];
const ON_SURFACES: [[(i64, i64); 2]; 8] = [
    [(1, 1), (0, 1)],
    [(-1, 1), (0, 1)],
    [(0, 1), (1, 1)],
    [(0, 1), (-1, 1)],
    [(20, 29), (21, 29)],
    [(-20, 29), (21, 29)],
    [(20, 29), (-21, 29)],
    [(-20, 29), (-21, 29)],
];
/// By how much of its radius a sphere may be in the ground there: above the rounding of singles.
const DEEPER: (i64, i64) = (1, 100_000);

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

/// A place of the ground at which it is looked at.
struct Look<const N: usize> {
    /// the slopes that it would have if the sphere touched it there
    slopes: [Scalar; N],
    /// the level of a sphere that reaches down to it
    level: Scalar,
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
        let all = height.curvatures(surface.span)?;
        let curvatures = std::array::from_fn(|i| std::array::from_fn(|j| all[i][j].clone()));
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

    /// Below the centre, and at some places under the sphere that do not depend on where it touches: the slopes that the
    /// ground would have if it were touched there, and the level of a sphere that reaches down to it.
    fn looked_at(&self, shared: &mut Shared<'_>) -> Vec<Look<N>> {
        let directions: &[[(i64, i64); 2]] = if N == 1 { &ON_CURVES } else { &ON_SURFACES };
        let places =
            RINGS.iter().flat_map(|ring| directions.iter().map(move |direction| (*ring, *direction)));
        let below = ([(0, 1), (1, 1)], [(0, 1), (0, 1)]);
        std::iter::once(below)
            .chain(places)
            .map(|([away, low], direction)| {
                let parts = direction.map(|part| product([ratio(away.0, away.1), ratio(part.0, part.1)]));
                let mut at = [integer(0), integer(0)];
                for (i, at) in at.iter_mut().enumerate().take(N) {
                    let there =
                        all([self.place[i].clone(), product([parts[i].clone(), self.radius.clone()])]);
                    *at = shared.scalar(there, "place under the sphere");
                }
                let level =
                    all([self.height.value.at(&at), product([ratio(low.0, low.1), self.radius.clone()])]);
                let level = shared.scalar(level, "level of a sphere that reaches down to a place");
                let slopes = std::array::from_fn(|i| product([ratio(low.1, low.0), parts[i].clone()]));
                Look { slopes, level }
            })
            .collect()
    }

    /// The slopes at the highest of these places.
    fn start(looked_at: &[Look<N>], shared: &mut Shared<'_>) -> [Scalar; N] {
        let mut looks = looked_at.iter();
        let Some(first) = looks.next() else { return std::array::from_fn(|_| integer(0)) };
        let (mut slopes, mut level) = (first.slopes.clone(), first.level.clone());
        for look in looks {
            let higher = step(less(look.level.clone(), level.clone()));
            let higher = shared.scalar(higher, "whether a place is higher");
            slopes = std::array::from_fn(|i| {
                let slope = either(&higher, look.slopes[i].clone(), slopes[i].clone());
                shared.scalar(slope, "slope at the highest place")
            });
            level = shared.scalar(greater(level, look.level.clone()), "level at the highest place");
        }
        slopes
    }

    fn touch(&self, sphere: &Shape, shared: &mut Shared<'_>) -> Touch {
        let looked_at = self.looked_at(shared);
        let start = Self::start(&looked_at, shared);
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
        let touching = quotient(self.radius.clone(), foot.length.clone(), self.at);
        let highest = all([self.height.value.at(&foot.at), touching]);
        let highest = shared.scalar(highest, "level of a sphere that touches");
        // it touches here first, unless it is in the ground at a place where it would touch before
        let level = shared.scalar(greater(self.level.clone(), highest.clone()), "level of the centre");
        let clearances = looked_at.into_iter().map(|look| less(level.clone(), look.level));
        let clear =
            all([least(clearances.collect()), product([ratio(DEEPER.0, DEEPER.1), self.radius.clone()])]);
        let found = product([found, step(lesser(fits, clear))]);
        let found = shared.scalar(found, "whether the sphere touches at one place only");
        let length = shared.scalar(quotient(foot.length.clone(), found, self.at), "length of the normal");
        let terms = (0..N).map(|i| opposite(&scaled(slopes[i].clone(), &self.across[i])));
        let steepest = total(std::iter::once(self.up.clone()).chain(terms));
        let normal = scaled(quotient(integer(1), length.clone(), self.at), &steepest);
        let normal = shared.vector(normal, "normal of the ground");
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
