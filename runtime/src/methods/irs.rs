//! Partial integration and partial recursive summation (6.2, 6.3 of the paper): numerical while the contact
//! slides, closed form afterwards.

use nalgebra::Vector3;

use super::{
    Integration, MethodError, Solution, Summation,
    equations::{Problem, S},
    integrate::{self, Slid, Walk},
    law::Ending,
    sum,
};
use crate::{Path, ReducedMatrix, Surface};

/// The method for the sliding arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Partial {
    /// Recursive summation (56a)-(56l) with lambda = 0.
    Sum(Summation),
    /// Integration of (34) and (35).
    Integrate(Integration),
}

/// Sums or integrates while the contact slides, and finishes in closed form after slip has stopped: (57),
/// (58) if it sticks, (59), (60) if slip is renewed, with the procedures of 6.3 for the three hypotheses,
/// (61) and (62) for Stronge's.
///
/// # Errors
/// As [`crate::solve`], else [`MethodError::Unfinished`] or [`MethodError::BadOption`].
pub fn irs(
    matrix: &ReducedMatrix<f64>,
    approach: &Vector3<f64>,
    surface: &Surface<f64>,
    options: &Partial,
) -> Result<Solution, MethodError> {
    let problem = Problem::new(matrix, approach, surface)?;
    let mut ending = Ending::new(surface);
    let mut steps = 0;
    let (slid, slack) = match options {
        Partial::Sum(options) => {
            let d = options.step(&problem)?;
            (sum::slide(&problem, d, &mut ending, &mut steps)?, d * problem.pace())
        }
        Partial::Integrate(options) => {
            let mut walk = Walk { problem: &problem, options, made: 0 };
            let slid = integrate::slide(&mut walk, &mut ending)?;
            steps = walk.made;
            (slid, options.slack())
        }
    };
    let (end, path) = match slid {
        Slid::Ended(end) => (end, Path::Sliding),
        Slid::Stopped(at) => {
            let at = ending.slip_stopped(&problem, at);
            let arc = problem.terminal();
            let end = ending.close(&problem, &arc, arc.entered(at), slack)?;
            (end, arc.path(problem.start()[S] > 0.0))
        }
    };
    Ok(problem.outcome(approach, (&end, path), &ending, steps))
}
