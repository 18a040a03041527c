//! Selects a motion in which no contact jams.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::DVector;

use super::{
    Problem, Solution, Unsolved,
    another::others,
    directions::MOST_ENUMERATED,
    enumerate::enumerate,
    prescribed::{Admissible, with_modes},
    solve,
};

/// Like [`solve`], with the forces of the modes; but a motion in which f of a contact is not positive, so that the next
/// rounding error decides between impact and separation, is taken only if no other was found.
///
/// # Errors
/// See [`Unsolved`].
pub(crate) fn solve_without_jam(
    problem: &Problem<'_>,
    guess: Option<&DVector<f64>>,
) -> Result<(Solution, Option<Admissible>), Unsolved> {
    let first = solve(problem, guess)?;
    let middle = with_modes(problem, &first.modes).ok();
    if middle.as_ref().is_none_or(|middle| middle.f > 0.0) {
        return Ok((first, middle));
    }
    let lasts = |other: Solution| {
        let middle = with_modes(problem, &other.modes).ok()?;
        (middle.f > 0.0).then_some((other, Some(middle)))
    };
    let found = if problem.contacts() <= MOST_ENUMERATED {
        enumerate(problem).into_iter().find_map(lasts)
    } else {
        others(problem, &first.force).find_map(lasts)
    };
    Ok(found.unwrap_or((first, middle)))
}
