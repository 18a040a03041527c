//! The direction in which slip settles: the one in which the acceleration across it is that wanted.
//!
//! Theory: docs/theory.md, section 17.5.

use nalgebra::Vector2;

use crate::closed_contacts::ClosedContacts;
use crate::forces::{Forces, Hold, Lacking};
use crate::phase::Closed;

/// Difference of angles by which derivatives are formed, rad.
const TURN: f64 = 1e-5;
/// Steps of the method of secants at most.
const STEPS: usize = 12;
/// The angle is found where the product of the last two changes is below this, rad^2: the error that is left is of
/// this order.
const FOUND: f64 = 1e-15;
/// Changes of the angle below this are rounding, rad.
const ROUNDING: f64 = 1e-14;

/// Forces for modes.
pub(crate) type Solve<'a> = dyn Fn(&[Hold]) -> Result<Forces, Lacking> + 'a;

/// Gives a contact that has settled the direction that follows from the state at a time. `None` where there is none.
pub(crate) fn settle(
    support: &ClosedContacts,
    closed: &[Closed],
    t: f64,
    holds: &mut [Hold],
    solve: &Solve<'_>,
) -> Option<()> {
    for (place, contact) in closed.iter().enumerate() {
        if let (Some(turning), Some(from)) = (contact.turning, contact.slides) {
            holds[place] = Hold::Slide(turned(from, turning.angle(t)));
            let slip = support.slip(place);
            let wanted = |d: &Vector2<f64>| turning.rate(t) * slip.dot(d) + turning.fading(t);
            turn_until(holds, place, turning.slope, &wanted, solve)?;
        }
    }
    Some(())
}

/// A vector of length one turned by an angle.
fn turned(d: Vector2<f64>, angle: f64) -> Vector2<f64> {
    let (sin, cos) = angle.sin_cos();
    Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y)
}

/// The acceleration across the direction of slip of a contact.
pub(crate) fn across(holds: &[Hold], place: usize, solve: &Solve<'_>) -> Option<f64> {
    let (d, found) = (holds[place].direction()?, solve(holds).ok()?);
    Some(d.x * found.acceleration[3 * place + 2] - d.y * found.acceleration[3 * place + 1])
}

/// The change of that acceleration by the angle of the direction.
pub(crate) fn slope(holds: &[Hold], place: usize, solve: &Solve<'_>) -> Option<f64> {
    let at = |angle: f64| -> Option<f64> {
        let mut there = holds.to_vec();
        there[place] = Hold::Slide(turned(holds[place].direction()?, angle));
        across(&there, place, solve)
    };
    Some((at(TURN)? - at(-TURN)?) / (2.0 * TURN))
}

/// Turns the direction of slip of a contact until the acceleration across it is that wanted. `slope` is nearly its
/// derivative by the angle.
pub(crate) fn turn_until(
    holds: &mut [Hold],
    place: usize,
    mut slope: f64,
    wanted: &dyn Fn(&Vector2<f64>) -> f64,
    solve: &Solve<'_>,
) -> Option<()> {
    let residual = |holds: &[Hold]| Some(across(holds, place, solve)? - wanted(&holds[place].direction()?));
    let mut left = residual(holds)?;
    let mut last = 1.0;
    for _ in 0..STEPS {
        let step = -left / slope;
        if step.is_nan() || step.abs() >= 1.0 {
            return None;
        }
        holds[place] = Hold::Slide(turned(holds[place].direction()?, step).normalize());
        if step.abs() <= ROUNDING || step.abs() * last <= FOUND {
            return Some(());
        }
        last = step.abs();
        let after = residual(holds)?;
        slope = (after - left) / step;
        left = after;
    }
    None
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};

    use super::*;
    use crate::contact_problem::Wanted;
    use crate::forces::forces;

    /// Two contacts of one body that slide: the acceleration across the slip of one becomes that wanted.
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
        for place in [0, 1] {
            let mut holds = directions.map(Hold::Slide);
            let known = across(&holds, place, &solve).unwrap();
            let slope = slope(&holds, place, &solve).unwrap();
            for (by, slope) in [(0.05, slope), (-0.08, 0.7 * slope)] {
                holds[place] = Hold::Slide(turned(directions[place], by));
                turn_until(&mut holds, place, slope, &|_| known, &solve).unwrap();
                let d = holds[place].direction().unwrap();
                assert!((d - directions[place]).norm() < 1e-13 && (d.norm() - 1.0).abs() < 1e-15, "{d}");
            }
        }
    }
}
