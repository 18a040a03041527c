//! Forces where Newton's method ends just above the accepted violation.
//!
//! Contacts that can hardly move relative to each other, as those of a straight chain along itself, make equations so
//! ill-conditioned that it does. Where modes are known, elimination is as accurate as numbers are. Which contacts slip is
//! seen from accelerations that the forces of the other modes leave.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::{DVector, Vector2};

use super::{
    Mode, Problem, Solution, Unsolved,
    certified::{ZERO, attempt, modes, with_certificate, zeros},
    motion::settle,
    prescribed::{Admissible, FITS, with_modes},
};

/// The forces next to these, which violate a law by little.
pub(super) fn near(problem: &Problem<'_>, force: &DVector<f64>) -> Option<Solution> {
    let acceleration = problem.w * force + problem.beta;
    let mut tried: Vec<Vec<Mode>> = Vec::new();
    ZEROS.into_iter().find_map(|part| {
        let modes = modes(problem, force, &acceleration, &zeros(problem, force, part));
        if tried.contains(&modes) {
            return None;
        }
        tried.push(modes.clone());
        slipping(problem, modes)
    })
}

/// Modes and forces that violate the laws by less than the state of a motion is known to, where none were found that obey
/// them: the motion goes on in these modes until it leaves them.
pub(crate) fn nearly(problem: &Problem<'_>, guess: Option<&DVector<f64>>) -> Option<(Vec<Mode>, Admissible)> {
    let refused = attempt(problem, guess).err()?;
    let (Unsolved::NotFound { violation }, Some(force)) = (refused.reason, refused.nearest) else {
        return None;
    };
    let acceleration = problem.w * &force + problem.beta;
    let fits = |part: f64| {
        let modes = modes(problem, &force, &acceleration, &zeros(problem, &force, part));
        let found = with_modes(problem, &modes).ok()?;
        (found.margin >= -NEARLY && found.f > 0.0).then_some((modes, found))
    };
    ZEROS.into_iter().filter(|part| (violation..=NEARLY).contains(part)).find_map(fits)
}

/// The forces of these modes, or of those that follow from what they violate: contacts begin to slip, the fastest first,
/// until friction of the others does not suffice; then these begin, and the slowest stick.
fn slipping(problem: &Problem<'_>, mut modes: Vec<Mode>) -> Option<Solution> {
    for _ in 0..ROUNDS * modes.len() {
        let found = with_modes(problem, &modes).ok()?;
        let open: Vec<usize> = (0..modes.len()).filter(|&i| begins(problem, &modes, i)).collect();
        if !open.is_empty()
            && let Some(settled) = settle(problem, modes.clone(), &open, found.force)
        {
            modes = settled;
        }
        if let Some(solution) = with_certificate(problem, &modes) {
            return Some(solution);
        }
        modes = next(problem, &modes)?;
    }
    None
}

/// The modes with a change where they violate the laws most.
fn next(problem: &Problem<'_>, modes: &[Mode]) -> Option<Vec<Mode>> {
    let mut next = modes.to_vec();
    let found = with_modes(problem, modes).ok()?;
    let zeros = zeros(problem, &found.force, ZERO);
    let of = |all: &DVector<f64>, i: usize| Vector2::new(all[3 * i + 1], all[3 * i + 2]);
    let speed = |i: usize| of(&found.acceleration, i).norm() / zeros[3 * i + 1].max(zeros[3 * i + 2]);
    let sticks = |i: &usize| modes[*i] == Mode::Stick;
    let greatest =
        |of: &dyn Fn(usize) -> f64| (0..modes.len()).filter(sticks).max_by(|&a, &b| of(a).total_cmp(&of(b)));
    if found.margin >= -FITS {
        let fastest = greatest(&speed).filter(|&i| speed(i) > 1.0)?;
        next[fastest] = Mode::Slide(of(&found.acceleration, fastest).normalize());
        return Some(next);
    }
    let excess = |i: usize| of(&found.force, i).norm() - problem.mu[i] * found.force[3 * i];
    let weakest = greatest(&excess).filter(|&i| excess(i) > 0.0)?;
    // Contacts with one and the same acceleration move as one body.
    let away = Mode::Slide(-of(&found.force, weakest).normalize());
    let together = |a: usize, b: usize| {
        let zero = SAME * (zeros[3 * a + 1] + zeros[3 * b + 1]);
        (of(&found.acceleration, a) - of(&found.acceleration, b)).norm() <= zero
    };
    let slowest = (0..modes.len())
        .filter(|&i| begins(problem, modes, i))
        .min_by(|&a, &b| speed(a).total_cmp(&speed(b)));
    for i in 0..modes.len() {
        if modes[i] == Mode::Stick && together(i, weakest) {
            next[i] = away;
        } else if begins(problem, modes, i) && slowest.is_some_and(|slowest| together(i, slowest)) {
            next[i] = Mode::Stick;
        }
    }
    Some(next)
}

fn begins(problem: &Problem<'_>, modes: &[Mode], i: usize) -> bool {
    problem.slip[i].is_none() && matches!(modes[i], Mode::Slide(_))
}

/// Accelerations are the same if they differ by no more than this many times what counts as zero.
const SAME: f64 = 4.0;

/// Rounds for each contact.
const ROUNDS: usize = 2;

/// The parts of their terms up to which the accelerations that Newton's method leaves may be errors.
const ZEROS: [f64; 6] = [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-6];

/// The violation with which a motion goes on: errors of its state bring accelerations of this part of their terms.
const NEARLY: f64 = 1e-8;
