//! Selects a motion in which no contact jams.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::DVector;

use super::{
    Problem, Solution, Unsolved,
    another::others,
    directions::MOST_ENUMERATED,
    enumerate::enumerate,
    prescribed::{Admissible, parts, with_modes},
    solve,
};

/// Like [`solve`], with the forces of the modes; but a motion in which more force at a sliding contact draws the bodies
/// together, so that the next rounding error decides between impact and separation, is taken only if no other was found; and
/// one beyond a jam only if all others are.
///
/// # Errors
/// See [`Unsolved`].
pub(crate) fn solve_without_jam(
    problem: &Problem<'_>,
    guess: Option<&DVector<f64>>,
) -> Result<(Solution, Option<Admissible>), Unsolved> {
    let first = solve(problem, guess)?;
    let middle = with_modes(problem, &first.modes).ok();
    if middle.is_none() || parts(problem, &first.modes) {
        return Ok((first, middle));
    }
    let mut best = (first, middle);
    let finite = |middle: &Option<Admissible>| middle.as_ref().is_some_and(|middle| middle.f > 0.0);
    let found: Box<dyn Iterator<Item = Solution>> = if problem.contacts() <= MOST_ENUMERATED {
        Box::new(enumerate(problem).into_iter())
    } else {
        Box::new(others(problem, &best.0.force))
    };
    for other in found {
        let middle = with_modes(problem, &other.modes).ok();
        if middle.is_some() && parts(problem, &other.modes) {
            return Ok((other, middle));
        }
        if finite(&middle) && !finite(&best.1) {
            best = (other, middle);
        }
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector, Vector2};

    use super::*;
    use crate::contact_problem::Mode;

    /// Three feet of a chain slide. All may press, but then more force at the second or the third draws the other closer; or
    /// the second opens.
    #[test]
    fn a_motion_without_a_jam_is_preferred() {
        let along = [2.746_251, 5.451_708, 0.0, -2.073_151, 5.451_708, 0.0, 0.116_671, 0.981_030, 0.0];
        let rows = [
            [6.432_057, 2.746_251, 0.0, -1.464_712, 2.746_251, 0.0, -0.291_886, 0.351_842, 0.0],
            along,
            [0.0; 9],
            [-1.464_712, -2.073_151, 0.0, 5.819_319, -2.073_151, 0.0, 4.152_173, 1.330_446, 0.0],
            along,
            [0.0; 9],
            [-0.291_886, 0.116_671, 0.0, 4.152_173, 0.116_671, 0.0, 10.137_233, -12.102_257, 0.0],
            [0.351_842, 0.981_030, 0.0, 1.330_446, 0.981_030, 0.0, -12.102_257, 28.404_850, 0.0],
            [0.0; 9],
        ];
        let w = DMatrix::from_row_slice(9, 9, rows.as_flattened());
        let beta = [-11.304_349, 0.131_766, 0.0, -9.430_992, 0.131_766, 0.0, -9.449_236, 0.169_012, 0.0];
        let beta = DVector::from_column_slice(&beta);
        let slides = Vector2::new(-1.0, 0.0);
        let (mu, slip) = ([0.583; 3], [Some(slides); 3]);
        let problem = Problem { w: &w, beta: &beta, mu: &mu, slip: &slip, noise: None };
        let pressed = with_modes(&problem, &[Mode::Slide(slides); 3]).unwrap();
        assert!(pressed.f < 0.0 && pressed.force.iter().step_by(3).all(|normal| *normal > 0.0));
        let (found, middle) = solve_without_jam(&problem, None).unwrap();
        assert_eq!(found.modes, [Mode::Slide(slides), Mode::Separate, Mode::Slide(slides)]);
        assert!(middle.unwrap().f > 0.0);
    }
}
