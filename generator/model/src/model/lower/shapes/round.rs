//! Round shapes by their places furthest along a direction: a ball, an ellipsoid, a circle, or the sum of a circle and a ball
//! (section 16.15 of docs/theory.md). All components are along the axes of what they are on.

use super::algebra::*;
use super::features::axes_of;
use super::separation::others;
use super::shared::Shared;
use super::solids::{Components, inner, keep};
use crate::model::mechanism::{Kind, Scalar, Shape, Vector};

/// Cosines and sines of angles in a quarter, about evenly apart.
const QUARTER: [[(i64, i64); 2]; 4] =
    [[(1, 1), (0, 1)], [(12, 13), (5, 13)], [(20, 29), (21, 29)], [(5, 13), (12, 13)]];
/// Directions along a rim keep this share of the gradient in the plane of the rim.
const IN_PLANE: (i64, i64) = (1, 16);

/// What a round shape is the sum of.
enum Part {
    Ball(Scalar),
    /// the matrix A of which x . A^-1 x = 1 is the surface
    Ellipsoid(Box<[Components; 3]>),
    Circle {
        radius: Scalar,
        axis: Components,
    },
}

/// A round shape.
pub struct Round {
    /// the place of its centre
    pub centre: Components,
    parts: Vec<Part>,
    /// its extent
    pub size: Scalar,
}

impl Round {
    /// The shape, with its centre from a place and along axes.
    pub fn of(shape: &Shape, from: &Shape, axes: &[Vector; 3], shared: &mut Shared<'_>) -> Round {
        let d = shape.at.from(&from.at);
        let components = |v: &Vector| axes.each_ref().map(|e| dot(v, e));
        let centre = keep(components(&d), "place of the centre", shared);
        let length = |i: usize| shape.sizes.get(i).cloned().unwrap_or_else(|| integer(0));
        let parts = match shape.kind {
            Kind::Ellipsoid => {
                let own = axes_of(shape);
                let rows: [Components; 3] = std::array::from_fn(|k| {
                    let row = components(&own[k]).map(|part| product([length(k), part]));
                    keep(row, "semi-axis", shared)
                });
                let matrix = symmetric(|i, j| {
                    let entry = all(rows.iter().map(|row| product([row[i].clone(), row[j].clone()])));
                    shared.scalar(entry, "matrix of the ellipsoid")
                });
                vec![Part::Ellipsoid(Box::new(matrix))]
            }
            Kind::Disc | Kind::Torus => {
                let axis = components(&shape.axis.clone().unwrap_or(Vector::Zero));
                let circle = Part::Circle { radius: length(0), axis: keep(axis, "axis of the rim", shared) };
                let tube = (shape.kind == Kind::Torus).then(|| Part::Ball(length(1)));
                std::iter::once(circle).chain(tube).collect()
            }
            _ => vec![Part::Ball(length(0))],
        };
        Round { centre, parts, size: all(shape.sizes.iter().cloned()) }
    }

    /// The place that is furthest against a direction m, which need not be of unit length.
    pub fn place(&self, m: &Components, shared: &mut Shared<'_>) -> Components {
        let mut place = self.centre.clone();
        for part in &self.parts {
            let (along, length) = part.reach(m, shared);
            let far = quotient(part.radius(), length, shared.at);
            let far = shared.scalar(far, "reach of the shape");
            for (place, along) in place.iter_mut().zip(along) {
                *place = less(place.clone(), product([far.clone(), along]));
            }
        }
        keep(place, "place of the shape", shared)
    }

    /// How that place moves against a change of m: a symmetric matrix whose eigenvalues are not negative.
    pub fn spread(&self, m: &Components, shared: &mut Shared<'_>) -> [Components; 3] {
        let mut sum: [Components; 3] = std::array::from_fn(|_| std::array::from_fn(|_| integer(0)));
        for part in &self.parts {
            let (along, length) = part.reach(m, shared);
            let far = shared.scalar(quotient(part.radius(), length.clone(), shared.at), "reach of the shape");
            let falls = quotient(far.clone(), square(length), shared.at);
            let falls = shared.scalar(falls, "change of the reach");
            for (i, row) in sum.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    let outer = product([falls.clone(), along[i].clone(), along[j].clone()]);
                    let own = less(product([far.clone(), part.measure(i, j)]), outer);
                    *entry = all([entry.clone(), own]);
                }
            }
        }
        sum.map(|row| keep(row, "change of the place", shared))
    }

    /// Directions in which it is looked at, of a ground with this gradient at a place: all about a ball or ellipsoid; of a
    /// circle along the rim, from where the gradient at the centre leads; the tube of a torus leans along the gradient.
    pub fn directions(
        &self,
        gradient: impl Fn(&Components, &mut Shared<'_>) -> Components,
        shared: &mut Shared<'_>,
    ) -> Vec<Components> {
        let Some(Part::Circle { radius, axis }) = self.parts.first() else { return all_about() };
        let first = gradient(&self.centre, shared);
        let first = across(&first, axis, shared);
        let length = shared.scalar(root(inner(&first, &first)), "length in the plane of the rim");
        let first = first.map(|part| quotient(part, length.clone(), shared.at));
        let first = keep(first, "direction in the plane of the rim", shared);
        let second = std::array::from_fn(|i| {
            let [j, k] = others(i);
            less(product([axis[j].clone(), first[k].clone()]), product([axis[k].clone(), first[j].clone()]))
        });
        let second = keep(second, "direction across it", shared);
        let quarters = QUARTER.iter().flat_map(|[cos, sin]| {
            [
                (*cos, *sin),
                ((-sin.0, sin.1), *cos),
                ((-cos.0, cos.1), (-sin.0, sin.1)),
                (*sin, (-cos.0, cos.1)),
            ]
        });
        let mut along_rim = |(cos, sin): ((i64, i64), (i64, i64))| {
            let direction: Components = std::array::from_fn(|i| {
                let along = product([ratio(cos.0, cos.1), first[i].clone()]);
                all([along, product([ratio(sin.0, sin.1), second[i].clone()])])
            });
            let direction = keep(direction, "direction along the rim", shared);
            if self.parts.len() == 1 {
                return direction;
            }
            let place: Components = std::array::from_fn(|i| {
                less(self.centre[i].clone(), product([radius.clone(), direction[i].clone()]))
            });
            let place = keep(place, "place of the rim", shared);
            let here = gradient(&place, shared);
            let in_plane = across(&here, axis, shared);
            let least = product([ratio(IN_PLANE.0, IN_PLANE.1), root(inner(&here, &here))]);
            let in_plane = all([root(inner(&in_plane, &in_plane)), least]);
            let in_plane = shared.scalar(in_plane, "share in the plane of the rim");
            let lean = shared.scalar(inner(&here, axis), "share along the axis");
            let leaning = std::array::from_fn(|i| {
                let rest = product([lean.clone(), axis[i].clone()]);
                all([product([in_plane.clone(), direction[i].clone()]), rest])
            });
            keep(leaning, "direction of a place of the tube", shared)
        };
        quarters.map(&mut along_rim).collect()
    }
}

impl Part {
    fn radius(&self) -> Scalar {
        match self {
            Part::Ball(radius) | Part::Circle { radius, .. } => radius.clone(),
            Part::Ellipsoid(_) => integer(1),
        }
    }

    /// M m and the root of m . M m, with the part's own measure M. The place furthest along m is the radius times their
    /// quotient.
    fn reach(&self, m: &Components, shared: &mut Shared<'_>) -> (Components, Scalar) {
        let along = match self {
            Part::Ball(_) => m.clone(),
            Part::Ellipsoid(matrix) => {
                keep(matrix.each_ref().map(|row| inner(row, m)), "direction of the place", shared)
            }
            Part::Circle { axis, .. } => across(m, axis, shared),
        };
        let length = shared.scalar(root(inner(m, &along)), "length of the direction");
        (along, length)
    }

    /// An entry of M.
    fn measure(&self, i: usize, j: usize) -> Scalar {
        let one = integer(i64::from(i == j));
        match self {
            Part::Ball(_) => one,
            Part::Ellipsoid(matrix) => matrix[i][j].clone(),
            Part::Circle { axis, .. } => less(one, product([axis[i].clone(), axis[j].clone()])),
        }
    }
}

/// The part of a vector that is perpendicular to an axis.
fn across(v: &Components, axis: &Components, shared: &mut Shared<'_>) -> Components {
    let share = shared.scalar(inner(v, axis), "component along the axis");
    let rest = std::array::from_fn(|i| less(v[i].clone(), product([share.clone(), axis[i].clone()])));
    keep(rest, "component across the axis", shared)
}

/// Unit vectors about evenly in all directions.
fn all_about() -> Vec<Components> {
    let axes =
        (0..3).flat_map(|i| [1, -1].map(|sign| (0..3).map(|j| (i64::from(i == j) * sign, 1)).collect()));
    let between = (0..3).flat_map(|short| {
        (0..8_usize).map(move |signs| {
            let part =
                |j: usize| (if j == short { 1 } else { 2 }) * (if signs >> j & 1 == 0 { 1 } else { -1 });
            (0..3).map(|j| (part(j), 3)).collect()
        })
    });
    let all: Vec<Vec<(i64, i64)>> = axes.chain(between).collect();
    all.into_iter().map(|parts| std::array::from_fn(|i| ratio(parts[i].0, parts[i].1))).collect()
}
