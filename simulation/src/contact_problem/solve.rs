//! Forces of contacts with unknown modes.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::DVector;

use super::{
    Mode, Problem, Solution, Unsolved,
    certified::{Refused, attempt, with_certificate},
    edge::beyond,
    enumerate::enumerate,
    jam::jam,
    motion::centred,
    near::near,
    pressed::pressed,
};

/// Forces that obey the laws, with modes and a certificate. If all contacts without slip can stick, they do.
/// Among many forces for one motion the analytic centre is taken. `guess` saves work, and selects among
/// several motions other than rest.
///
/// # Errors
/// See [`Unsolved`]. Forces that violate a law by more than 1e-12 of its terms are never returned.
pub fn solve(problem: &Problem<'_>, guess: Option<&DVector<f64>>) -> Result<Solution, Unsolved> {
    problem.check()?;
    let still: Vec<Mode> = problem.slip.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
    let few = problem.contacts() <= CENTRED;
    if few && let Some(found) = with_certificate(problem, &still) {
        return Ok(found);
    }
    match attempt(problem, guess) {
        Ok(found) if few => Ok(beyond(problem, &found).unwrap_or_else(|| centred(problem, found))),
        Ok(found) => Ok(found),
        Err(Refused { reason: Unsolved::NotFound { violation }, nearest }) => {
            let nearest = nearest.filter(|_| violation < NEAR);
            if let Some(found) = nearest.and_then(|nearest| near(problem, &nearest)) {
                return Ok(found);
            }
            if let Some(first) = enumerate(problem).into_iter().next().or_else(|| pressed(problem)) {
                return Ok(first);
            }
            Err(jam(problem)
                .map_or(Unsolved::NotFound { violation }, |(contact, f)| Unsolved::Jam { contact, f }))
        }
        Err(Refused { reason, .. }) => Err(reason),
    }
}

/// Up to this number of contacts, rest is tried first, and the analytic centre of forces that are not unique
/// is taken.
const CENTRED: usize = 48;

/// Forces with a violation below this show which modes are admissible.
const NEAR: f64 = 1e-6;
