//! Chooses the modes of the closed contacts at an instant.
//!
//! One contact has an exact answer in the runtime. Of several contacts, rest is taken where it fits: all that
//! do not slip keep sticking. Otherwise the forces of all contacts are found at once
//! ([`contact_problem::solve`]), and the modes follow from them.

use hodograph::{ContactError, ContactMode, Selection, contact_mode_after};
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

use crate::closed_contacts::{ClosedContacts, least_squares};
use crate::contact_problem::{self, MOST_ENUMERATED, Mode, Problem, Unsolved};
use crate::forces::{Forces, Lacking};

/// What a closed contact does from an event on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    Separate,
    Stick,
    /// Along a direction; whether slip begins now.
    Slide(Vector2<f64>, bool),
}

/// Decisions for all closed contacts, and whether others were possible.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub decisions: Vec<Decision>,
    pub forces: Vec<Vector3<f64>>,
    pub selection: Vec<Selection>,
}

/// Chooses the modes of closed contacts. `slips` is the direction of slip of each, none where it does not
/// slip; `before` are the forces so far, to which those chosen are near where several fit.
pub(crate) fn choose(
    support: &ClosedContacts,
    slips: &[Option<Vector2<f64>>],
    mu: &[f64],
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    if support.len() == 1 {
        return one(support, slips[0], mu[0], before);
    }
    let problem = support.problem(mu, slips);
    if let Some(rest) = contact_problem::rest(&problem) {
        let modes: Vec<Mode> = slips.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
        return Ok(chosen(&problem, &modes, &rest.force));
    }
    let solution = contact_problem::solve(&problem, Some(before)).map_err(|unsolved| match unsolved {
        Unsolved::Jam { contact, .. } => {
            let free_acceleration = support.beta[3 * contact];
            Lacking::Contact(contact, ContactError::Jam { free_acceleration })
        }
        _ => Lacking::Together,
    })?;
    // Among many forces for this motion, those in the middle.
    match contact_problem::with_modes(&problem, &solution.modes) {
        Ok(middle) if middle.margin >= 0.0 => Ok(chosen(&problem, &solution.modes, &middle.force)),
        _ => Ok(chosen(&problem, &solution.modes, &solution.force)),
    }
}

fn chosen(problem: &Problem<'_>, modes: &[Mode], force: &DVector<f64>) -> Choice {
    let decision = |(mode, slip): (&Mode, &Option<Vector2<f64>>)| match mode {
        Mode::Separate => Decision::Separate,
        Mode::Stick => Decision::Stick,
        Mode::Slide(direction) => Decision::Slide(*direction, slip.is_none()),
    };
    Choice {
        decisions: modes.iter().zip(problem.slip).map(decision).collect(),
        forces: (0..modes.len()).map(|i| ClosedContacts::three(force, i)).collect(),
        selection: vec![selection(problem, modes); modes.len()],
    }
}

/// Whether other modes fit too. Nobody looks where there are many contacts.
fn selection(problem: &Problem<'_>, modes: &[Mode]) -> Selection {
    if modes.len() > MOST_ENUMERATED {
        return Selection::Unknown;
    }
    if only_rest(problem, modes) {
        return Selection::Unique;
    }
    let differs = |other: &contact_problem::Solution| {
        other.modes.iter().zip(modes).any(|(other, mode)| !other.is_like(mode))
    };
    let several = contact_problem::enumerate(problem).iter().any(differs);
    if several { Selection::SeveralModes } else { Selection::Unique }
}

/// Whether contacts rest and could do so without friction: then no other motion obeys the laws (docs/theory.md,
/// section 17.10).
fn only_rest(problem: &Problem<'_>, modes: &[Mode]) -> bool {
    let rests = modes.iter().all(|mode| *mode == Mode::Stick) && problem.slip.iter().all(Option::is_none);
    rests && contact_problem::rest(&Problem { mu: &vec![0.0; modes.len()], ..*problem }).is_some()
}

fn one(
    support: &ClosedContacts,
    slip: Option<Vector2<f64>>,
    mu: f64,
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    let answer = contact_mode_after(
        &support.reduced(0),
        &ClosedContacts::three(&support.beta, 0),
        &slip.unwrap_or_else(Vector2::zeros),
        mu,
        &ClosedContacts::three(before, 0),
    )
    .map_err(|error| Lacking::Contact(0, error))?;
    Ok(Choice {
        decisions: vec![decision(answer.mode, answer.direction)],
        forces: vec![answer.force],
        selection: vec![answer.selection],
    })
}

fn decision(mode: ContactMode, direction: Option<Vector2<f64>>) -> Decision {
    match (mode, direction) {
        (ContactMode::Slide, Some(d)) => Decision::Slide(d, false),
        (ContactMode::BeginSlip, Some(d)) => Decision::Slide(d, true),
        (ContactMode::Stick, _) => Decision::Stick,
        _ => Decision::Separate,
    }
}

/// Turns the directions in which slip begins until the acceleration across each is that given, 0 where it is
/// along it: Newton's method for the angles. `begin` are these contacts, by their place in the forces and in
/// the directions.
pub(crate) fn begin_along(
    begin: &[(usize, usize)],
    directions: &mut [Option<Vector2<f64>>],
    wanted: &[f64],
    forces: impl Fn(&[Option<Vector2<f64>>]) -> Option<Forces>,
) -> Option<()> {
    if begin.is_empty() {
        return Some(());
    }
    let m = begin.len();
    // Slip that begins cannot be against the acceleration; slip that there is may.
    let starts = wanted.iter().all(|wanted| *wanted == 0.0);
    // Across each direction, relative to the size of the acceleration.
    let across = |directions: &[Option<Vector2<f64>>]| -> Option<DVector<f64>> {
        let found = forces(directions)?;
        let mut residual = DVector::zeros(m);
        for (row, &(place, i)) in begin.iter().enumerate() {
            let d = directions[i]?;
            let rate = Vector2::new(found.acceleration[3 * place + 1], found.acceleration[3 * place + 2]);
            residual[row] = d.x * rate.y - d.y * rate.x - wanted[row];
            if rate.dot(&d) < 0.0 && starts {
                // The other way round is no zero.
                residual[row] += if residual[row] < 0.0 { rate.dot(&d) } else { -rate.dot(&d) };
            }
        }
        Some(residual)
    };
    let turned = |directions: &[Option<Vector2<f64>>], by: &DVector<f64>| {
        let mut directions = directions.to_vec();
        for (by, &(_, i)) in by.iter().zip(begin) {
            let (sin, cos) = by.sin_cos();
            directions[i] =
                directions[i].map(|d| Vector2::new(cos * d.x - sin * d.y, sin * d.x + cos * d.y).normalize());
        }
        directions
    };
    let mut residual = across(directions)?;
    let mut jacobian: Option<DMatrix<f64>> = None;
    for _ in 0..TURNS {
        let matrix = match jacobian.take() {
            Some(known) => known,
            None => {
                let mut matrix = DMatrix::zeros(m, m);
                for column in 0..m {
                    let mut by = DVector::zeros(m);
                    by[column] = TURN;
                    let there = across(&turned(directions, &by))?;
                    matrix.set_column(column, &((there - &residual) / TURN));
                }
                matrix
            }
        };
        let step = -least_squares(&matrix, &residual);
        let longest = step.amax();
        // Shorter where it does not help.
        let mut share = 1.0 / longest.max(1.0);
        let next = loop {
            let next = turned(directions, &(&step * share));
            match across(&next) {
                Some(left) if left.amax() < residual.amax() => break Some((next, left)),
                _ if share < 1e-3 || longest < ROUNDED => break None,
                _ => share *= 0.5,
            }
        };
        let Some((next, left)) = next else { break };
        directions.copy_from_slice(&next);
        // Derivatives that serve well serve again.
        if left.amax() < 1e-2 * residual.amax() {
            jacobian = Some(matrix);
        }
        residual = left;
        if longest <= 1e-14 {
            break;
        }
    }
    Some(())
}

/// Steps of Newton's method at most, the difference by which its derivatives are formed, and angles of which rounding
/// alone may keep it from falling, rad.
const TURNS: usize = 30;
const TURN: f64 = 1e-6;
const ROUNDED: f64 = 1e-10;
