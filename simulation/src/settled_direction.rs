//! Directions in which slip settles: those in which the accelerations across them are those wanted.
//!
//! Theory: docs/theory.md, section 17.5.

use nalgebra::{DMatrix, DVector, Vector2};

use crate::closed_contacts::ClosedContacts;
use crate::forces::{Forces, Hold, Lacking};
use crate::phase::Closed;

/// Difference of angles by which derivatives are formed, rad.
const TURN: f64 = 1e-5;
/// Steps of the method of secants at most.
const STEPS: usize = 12;
/// An angle is found where the product of its last two changes is below this, rad^2: the error that is left is of
/// this order.
const FOUND: f64 = 1e-15;
/// Several angles are found where their next change is expected to be below this, rad.
const NEXT: f64 = 1e-13;
/// Changes of an angle below this are rounding, rad; and those where accelerations are small differences.
const ROUNDING: f64 = 1e-14;
const COARSE: f64 = 1e-11;

/// Forces for modes.
pub(crate) type Solve<'a> = dyn Fn(&[Hold]) -> Result<Forces, Lacking> + 'a;

/// Gives contacts that have settled the directions that follow from the state at a time. `None` where there are none.
pub(crate) fn settle(
    support: &ClosedContacts,
    closed: &[Closed],
    t: f64,
    holds: &mut [Hold],
    solve: &Solve<'_>,
) -> Option<()> {
    let turning = |place: &usize| closed[*place].turning.as_ref();
    let places: Vec<usize> = (0..closed.len()).filter(|place| turning(place).is_some()).collect();
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

/// A vector of length one turned by an angle.
fn turned(d: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y)
}

/// The accelerations across the directions of slip of contacts.
pub(crate) fn across(holds: &[Hold], places: &[usize], solve: &Solve<'_>) -> Option<DVector<f64>> {
    let found = solve(holds).ok()?.acceleration;
    let mut across = DVector::zeros(places.len());
    for (across, &place) in across.iter_mut().zip(places) {
        let d = holds[place].direction()?;
        *across = d.x * found[3 * place + 2] - d.y * found[3 * place + 1];
    }
    Some(across)
}

/// The change of the accelerations across the directions of `places` by the angle of each of them.
pub(crate) fn slopes(holds: &[Hold], places: &[usize], solve: &Solve<'_>) -> Option<DMatrix<f64>> {
    let mut slopes = DMatrix::zeros(places.len(), places.len());
    for (column, &place) in places.iter().enumerate() {
        let at = |angle: f64| -> Option<DVector<f64>> {
            let mut there = holds.to_vec();
            there[place] = Hold::Slide(turned(holds[place].direction()?, angle));
            across(&there, places, solve)
        };
        slopes.set_column(column, &((at(TURN)? - at(-TURN)?) / (2.0 * TURN)));
    }
    Some(slopes)
}

/// Turns the directions of slip of contacts until the accelerations across them are those wanted. `inverse` is nearly
/// that of the derivative by the angles, and becomes more so: Broyden's method, of one contact that of secants.
pub(crate) fn turn_until(
    holds: &mut [Hold],
    places: &[usize],
    inverse: &mut DMatrix<f64>,
    wanted: &dyn Fn(usize, &Vector2<f64>) -> f64,
    solve: &Solve<'_>,
) -> Option<()> {
    let residual = |holds: &[Hold]| -> Option<DVector<f64>> {
        let mut left = across(holds, places, solve)?;
        for (left, &place) in left.iter_mut().zip(places) {
            *left -= wanted(place, &holds[place].direction()?);
        }
        Some(left)
    };
    let mut left = residual(holds)?;
    let mut last: Option<f64> = None;
    for _ in 0..STEPS {
        let step = -(&*inverse * &left);
        let size = step.amax();
        // steps that grow lead to other directions with the same accelerations than those that settle
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
        let change = &*inverse * (&after - &left);
        let along = step.dot(&change);
        if along != 0.0 {
            let row = inverse.tr_mul(&step).transpose() / along;
            *inverse += (step - change) * row;
        }
        left = after;
    }
    (last? <= COARSE).then_some(())
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::contact_problem::Wanted;
    use crate::forces::forces;

    /// Two contacts of one body that slide: the acceleration across the slip of one or of both becomes that wanted.
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
            // both together have the same accelerations along other directions, too, some 0.14 rad away: from as far as
            // these none are found, and nearer the right ones
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
                assert!((across(&holds, &places, &solve).unwrap() - &known).amax() < 1e-12);
                for &place in &places {
                    let d = holds[place].direction().unwrap();
                    assert!((d - directions[place]).norm() < 1e-13 && (d.norm() - 1.0).abs() < 1e-15, "{d}");
                }
            }
        }
    }
}
