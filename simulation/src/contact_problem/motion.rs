//! Selects one motion among many: if contacts that begin to slip can share their load in many ways, each way
//! has other friction and hence another motion. The motion whose forces are the analytic centre for its own
//! directions of slip is selected.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DMatrix, DVector, Vector2};

use super::{
    Mode, Problem, Solution,
    certified::with_certificate,
    common_slip::slip_together,
    prescribed::{Admissible, with_modes_near},
};

/// The solution with the forces that its modes prescribe, if these obey the laws as well.
pub(super) fn centred(problem: &Problem<'_>, found: Solution) -> Solution {
    let like =
        |solution: &Solution| solution.modes.iter().zip(&found.modes).all(|(one, other)| one.is_like(other));
    let open: Vec<usize> = (0..found.modes.len())
        .filter(|&i| problem.slip[i].is_none() && matches!(found.modes[i], Mode::Slide(_)))
        .collect();
    if !open.is_empty()
        && let Some(modes) = settled(problem, &found, &open)
        && let Some(centred) = with_certificate(problem, &modes).filter(like)
    {
        return centred;
    }
    with_certificate(problem, &found.modes).filter(like).unwrap_or(found)
}

/// The modes of a solution, with directions in which the contacts slip under the analytic centre of the
/// forces for these directions; `None` if the forces are unique or the iteration does not converge.
fn settled(problem: &Problem<'_>, found: &Solution, open: &[usize]) -> Option<Vec<Mode>> {
    let first = with_modes_near(problem, &found.modes, Some(&found.force)).ok()?;
    if first.unique {
        return None;
    }
    settle(problem, found.modes.clone(), open, first.force)
}

/// Modes whose directions are changed until each contact slips along its own acceleration.
pub(super) fn settle(
    problem: &Problem<'_>,
    mut modes: Vec<Mode>,
    open: &[usize],
    mut force: DVector<f64>,
) -> Option<Vec<Mode>> {
    if is_slow(problem, &modes, open, &force)
        && let Some(modes) = slip_together(problem, &modes, open, None, &force)
    {
        return Some(modes);
    }
    let mut last = f64::INFINITY;
    for _ in 0..ROUNDS {
        let (turns, centre) = turns(problem, &modes, open, &force)?;
        force = centre.force;
        let greatest = turns.amax();
        if greatest <= 1e-14 || (greatest <= 1e-11 && greatest >= 0.5 * last) {
            return Some(modes);
        }
        last = greatest;
        // Newton's method with finite differences; for many contacts each direction is set to that of its own
        // slip.
        let step = if open.len() <= MOST {
            let mut rates = DMatrix::zeros(open.len(), open.len());
            for j in 0..open.len() {
                let mut turned = modes.clone();
                turn(&mut turned[open[j]], DIFFERENCE);
                let there = self::turns(problem, &turned, open, &force)?.0;
                rates.set_column(j, &((there - &turns) / DIFFERENCE));
            }
            rates.lu().solve(&turns).map(|step| -step)?
        } else {
            turns
        };
        let part = (0.5 / step.amax()).min(1.0);
        for (&i, step) in open.iter().zip(step.iter()) {
            turn(&mut modes[i], part * step);
        }
    }
    None
}

/// Whether contacts slip with such small accelerations that their directions cannot be computed from
/// differences of forces.
pub(crate) fn is_slow(problem: &Problem<'_>, modes: &[Mode], open: &[usize], force: &DVector<f64>) -> bool {
    let acceleration = problem.w * force + problem.beta;
    let along = |&i: &usize| match modes[i] {
        Mode::Slide(d) => {
            problem.scale(i) * (d.x * acceleration[3 * i + 1] + d.y * acceleration[3 * i + 2]).abs()
        }
        _ => 0.0,
    };
    let pulls = (0..3 * modes.len()).map(|row| problem.scale(row / 3) * problem.beta[row].abs());
    open.iter().map(along).fold(0.0, f64::max) < SLOW * pulls.fold(0.0, f64::max)
}

/// The angles from the given directions to those of the accelerations under the centre of their forces.
fn turns(
    problem: &Problem<'_>,
    modes: &[Mode],
    open: &[usize],
    near: &DVector<f64>,
) -> Option<(DVector<f64>, Admissible)> {
    let centre = with_modes_near(problem, modes, Some(near)).ok()?;
    let angles = DVector::from_fn(open.len(), |j, _| {
        let i = open[j];
        let (t, s) = (centre.acceleration[3 * i + 1], centre.acceleration[3 * i + 2]);
        match modes[i] {
            Mode::Slide(d) => (d.x * s - d.y * t).atan2(d.x * t + d.y * s),
            _ => 0.0,
        }
    });
    Some((angles, centre))
}

fn turn(mode: &mut Mode, angle: f64) {
    if let Mode::Slide(d) = mode {
        let (sin, cos) = angle.sin_cos();
        *d = Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y).normalize();
    }
}

/// Accelerations of slip below this part of those without forces are slow.
const SLOW: f64 = 1e-3;
/// Rounds until directions settle, the most contacts for which their changes are found by differences, and the angle of
/// these.
const ROUNDS: usize = 60;
const MOST: usize = 16;
const DIFFERENCE: f64 = 1e-6;
