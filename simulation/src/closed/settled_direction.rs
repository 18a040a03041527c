//! Settled directions of slip: those in which the accelerations perpendicular to them have prescribed values.
//!
//! Theory: docs/theory.md, section 17.5.

use nalgebra::{DMatrix, Vector2};
use smallvec::SmallVec;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, Lacking};
use crate::closed::phase::Closed;

/// Difference of angles for derivatives, rad.
const TURN: f64 = 1e-5;
/// Largest number of secant steps.
const STEPS: usize = 12;
/// An angle has converged if the product of its last two changes is below this, rad^2: the remaining error is
/// of this order.
const FOUND: f64 = 1e-15;
/// Several angles have converged if their next change is expected to be below this, rad.
const NEXT: f64 = 1e-13;
/// Changes of an angle below this are rounding errors, rad; also where accelerations are small differences.
const ROUNDING: f64 = 1e-14;
const COARSE: f64 = 1e-11;

/// Lists of so many contacts need no memory from the heap.
const FEW: usize = 4;
/// A number for each contact that turns.
pub(crate) type Angles = SmallVec<[f64; FEW]>;

/// A function that returns the forces for modes.
pub(crate) type Solve<'a> = dyn Fn(&[Hold]) -> Result<Forces, Lacking> + 'a;

/// Gives settled contacts the directions that follow from the state at a time; `None` if there are none.
pub(crate) fn settle(
    support: &ClosedContacts,
    closed: &[Closed],
    t: f64,
    holds: &mut [Hold],
    solve: &Solve<'_>,
) -> Option<()> {
    let turning = |place: &usize| closed[*place].turning.as_ref();
    let places: SmallVec<[usize; FEW]> = (0..closed.len()).filter(|place| turning(place).is_some()).collect();
    let Some(first) = places.first().and_then(turning) else { return Some(()) };
    let mut inverse = (*first.inverse).clone();
    for place in &places {
        if let (Some(turning), Some(from)) = (turning(place), closed[*place].slides) {
            holds[*place] = Hold::Slide(turned(from, turning.angle(t)));
        }
    }
    let wanted = |place: usize, d: &Vector2<f64>| {
        let slip = support.slip(place);
        turning(&place).map_or(0.0, |turning| turning.rate(t) * slip.dot(d) + turning.fading(t))
    };
    turn_until(holds, &places, &mut inverse, &wanted, solve)
}

/// A unit vector rotated by an angle.
fn turned(d: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y)
}

/// The accelerations of contacts perpendicular to their directions of slip.
pub(crate) fn across(holds: &[Hold], places: &[usize], solve: &Solve<'_>) -> Option<Angles> {
    let found = solve(holds).ok()?.acceleration;
    let component = |&place: &usize| {
        let d = holds[place].direction()?;
        Some(d.x * found[3 * place + 2] - d.y * found[3 * place + 1])
    };
    places.iter().map(component).collect()
}

/// The derivatives of the accelerations perpendicular to the directions of `places` with respect to their
/// angles.
pub(crate) fn slopes(holds: &[Hold], places: &[usize], solve: &Solve<'_>) -> Option<DMatrix<f64>> {
    let mut slopes = DMatrix::zeros(places.len(), places.len());
    for (column, &place) in places.iter().enumerate() {
        let at = |angle: f64| -> Option<Angles> {
            let mut there: SmallVec<[Hold; FEW]> = holds.into();
            there[place] = Hold::Slide(turned(holds[place].direction()?, angle));
            across(&there, places, solve)
        };
        for (row, (above, below)) in at(TURN)?.iter().zip(&at(-TURN)?).enumerate() {
            slopes[(row, column)] = (above - below) / (2.0 * TURN);
        }
    }
    Some(slopes)
}

/// Turns the directions of slip of contacts until the accelerations perpendicular to them have the wanted
/// values. `inverse` is an approximate inverse of the derivative with respect to the angles, which is
/// improved: Broyden's method, for one contact the secant method.
pub(crate) fn turn_until(
    holds: &mut [Hold],
    places: &[usize],
    inverse: &mut DMatrix<f64>,
    wanted: &dyn Fn(usize, &Vector2<f64>) -> f64,
    solve: &Solve<'_>,
) -> Option<()> {
    let residual = |holds: &[Hold]| -> Option<Angles> {
        let mut left = across(holds, places, solve)?;
        for (left, &place) in left.iter_mut().zip(places) {
            *left -= wanted(place, &holds[place].direction()?);
        }
        Some(left)
    };
    let times = |inverse: &DMatrix<f64>, of: &dyn Fn(usize) -> f64| -> Angles {
        let row = |i: usize| (0..places.len()).map(|j| inverse[(i, j)] * of(j)).sum();
        (0..places.len()).map(row).collect()
    };
    let mut left = residual(holds)?;
    let mut last: Option<f64> = None;
    for _ in 0..STEPS {
        let step = times(inverse, &|j| -left[j]);
        let size = step
            .iter()
            .fold(0.0_f64, |size, part| if part.is_nan() { f64::NAN } else { size.max(part.abs()) });
        // steps that grow lead to other directions with the same accelerations, not to the settled ones
        let grows = last.is_some_and(|last| size > last && size > COARSE);
        if size.is_nan() || size >= 1.0 || grows {
            return None;
        }
        for (&place, by) in places.iter().zip(&step) {
            holds[place] = Hold::Slide(turned(holds[place].direction()?, *by).normalize());
        }
        let found = match places.len() {
            1 => size * last.unwrap_or(1.0) <= FOUND,
            _ => size * last.map_or(1.0, |last| size / last) <= NEXT,
        };
        if size <= ROUNDING || found {
            return Some(());
        }
        last = Some(size);
        let after = residual(holds)?;
        let change = times(inverse, &|j| after[j] - left[j]);
        let along: f64 = step.iter().zip(&change).map(|(step, change)| step * change).sum();
        if along != 0.0 {
            let row: Angles = (0..places.len())
                .map(|j| (0..places.len()).map(|i| inverse[(i, j)] * step[i]).sum::<f64>() / along)
                .collect();
            for (j, row) in row.iter().enumerate() {
                for (i, (step, change)) in step.iter().zip(&change).enumerate() {
                    inverse[(i, j)] += (step - change) * row;
                }
            }
        }
        left = after;
    }
    (last? <= COARSE).then_some(())
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::closed::forces::forces;
    use crate::contact_problem::Wanted;

    /// Two sliding contacts of one body: the acceleration perpendicular to the slip of one or of both takes
    /// the wanted value.
    #[test]
    fn a_direction_is_turned_until_the_acceleration_across_it_is_that_wanted() {
        let point = |x: f64, y: f64, z: f64| {
            [[0.0, 0.0, 1.0, y, -x, 0.0], [1.0, 0.0, 0.0, 0.0, z, -y], [0.0, 1.0, 0.0, -z, 0.0, x]]
        };
        let rows: Vec<f64> =
            [point(-0.2, 0.1, -0.3), point(0.25, -0.15, -0.3)].into_iter().flatten().flatten().collect();
        let partials = DMatrix::from_row_slice(6, 6, &rows).transpose();
        let inverse = DMatrix::from_diagonal(&DVector::from_vec(vec![0.5, 0.5, 0.5, 6.0, 5.0, 4.0]));
        let response = &inverse * &partials;
        let directions = [Vector2::new(1.0, 0.0), Vector2::new(0.8, 0.6)];
        let support = ClosedContacts {
            contacts: vec![0, 1],
            coupled: partials.transpose() * &response,
            velocity: DVector::zeros(6),
            noise: DVector::zeros(6),
            beta: DVector::from_vec(vec![-9.0, 0.3, 1.0, -10.0, 0.2, 0.7]),
            partials,
            response,
        };
        let solve = |holds: &[Hold]| forces(&support, holds, &[0.3, 0.4], None, Wanted::Motion);
        for places in [vec![0], vec![1], vec![0, 1]] {
            let mut holds = directions.map(Hold::Slide);
            let known = across(&holds, &places, &solve).unwrap();
            let inverse = slopes(&holds, &places, &solve).unwrap().try_inverse().unwrap();
            // both together have the same accelerations along other directions, too, some 0.14 rad away: from
            // this distance they are not found, and nearer the right ones are
            let near = if places.len() == 1 { 1.0 } else { 0.25 };
            for (by, part) in [(0.05 * near, 1.0), (-0.08 * near, 1.4), (-0.08, 1.4)] {
                for &place in &places {
                    holds[place] = Hold::Slide(turned(directions[place], by));
                }
                let wanted = |place: usize, _: &Vector2<f64>| {
                    known[places.iter().position(|of| *of == place).unwrap()]
                };
                let found = turn_until(&mut holds, &places, &mut (part * &inverse), &wanted, &solve);
                if by == -0.08 && places.len() == 2 {
                    assert!(found.is_none());
                    continue;
                }
                found.unwrap();
                let there = across(&holds, &places, &solve).unwrap();
                assert!(there.iter().zip(&known).all(|(there, known)| (there - known).abs() < 1e-12));
                for &place in &places {
                    let d = holds[place].direction().unwrap();
                    assert!((d - directions[place]).norm() < 1e-13 && (d.norm() - 1.0).abs() < 1e-15, "{d}");
                }
            }
        }
    }
}
