//! Chooses the modes of several closed contacts at an event.
//!
//! For given forces at the other contacts the runtime gives the exact mode and force of one contact.
//! Repeating this for all contacts in turn until nothing changes (block Gauss-Seidel, as Jean and Moreau's
//! method of contact dynamics does for time steps) gives the modes; one linear system then gives the
//! forces to rounding. Where the iteration does not converge and there are few contacts, all combinations of
//! modes are tried.

use hodograph::{ContactError, ContactMode, Selection, contact_mode, contact_mode_after};
use nalgebra::{DMatrix, DVector, Vector2};

use crate::closed_contacts::{ClosedContacts, least_squares};
use crate::forces::{Forces, Hold, Lacking, hold_good, shared};

/// Rounds at most.
const ROUNDS: usize = 3000;
/// Combinations of modes are tried for at most so many contacts.
const FEW: usize = 4;

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
    pub forces: Vec<nalgebra::Vector3<f64>>,
    pub selection: Vec<Selection>,
    /// With which the forces were found where others are possible.
    pub weights: Vec<f64>,
    pub unique: bool,
}

/// Chooses the modes of closed contacts. `slips` is the direction of slip of each, none where it does not
/// slip.
pub(crate) fn choose(
    support: &ClosedContacts,
    slips: &[Option<Vector2<f64>>],
    mu: &[f64],
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    let k = support.len();
    if k == 1 {
        return one(support, slips[0], mu[0], before);
    }
    let mut lambda = before.clone();
    let mut decisions = vec![Decision::Separate; k];
    let mut failed = None;
    for round in 0..ROUNDS {
        let mut change = 0.0_f64;
        failed = None;
        for i in 0..k {
            match local(support, i, slips[i], mu[i], &lambda) {
                Ok((decision, force)) => {
                    decisions[i] = decision;
                    let old = ClosedContacts::three(&lambda, i);
                    change = change.max((force - old).amax());
                    lambda.rows_mut(3 * i, 3).copy_from(&force);
                }
                Err(error) => failed = Some((i, error)),
            }
        }
        let settled = change <= 1e-11 * lambda.amax();
        // What the modes say may be right long before the forces have settled.
        if failed.is_none() && (settled || round % 16 == 15) {
            // Friction that is just used up somewhere need not mean slip: others may take more.
            for decisions in [held(support, &decisions, slips, &lambda), decisions.clone()] {
                for about in [None, Some(&lambda)] {
                    if let Some(choice) = polished(support, &decisions, slips, mu, about) {
                        return Ok(choice);
                    }
                }
            }
        }
        if settled {
            break;
        }
    }
    if k <= FEW
        && let Some(choice) = tried(support, slips, mu)
    {
        return Ok(choice);
    }
    match failed {
        Some((i, error)) => Err(Lacking::Contact(i, error)),
        None => Err(Lacking::Together),
    }
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
        weights: vec![1.0],
        unique: answer.force_is_unique,
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

/// One contact for given forces at the others.
fn local(
    support: &ClosedContacts,
    i: usize,
    slip: Option<Vector2<f64>>,
    mu: f64,
    lambda: &DVector<f64>,
) -> Result<(Decision, nalgebra::Vector3<f64>), ContactError<f64>> {
    let matrix = support.reduced(i);
    let own = ClosedContacts::three(lambda, i);
    let total = support.coupled.fixed_rows::<3>(3 * i) * lambda + support.beta.fixed_rows::<3>(3 * i);
    let beta = total - matrix.apply(&own);
    let slip = slip.unwrap_or_else(Vector2::zeros);
    let answer = contact_mode(&matrix, &beta, &slip, mu)?;
    Ok((decision(answer.mode, answer.direction), answer.force))
}

/// The same decisions, but for contacts that begin to slip without an acceleration: they stick.
fn held(
    support: &ClosedContacts,
    decisions: &[Decision],
    slips: &[Option<Vector2<f64>>],
    lambda: &DVector<f64>,
) -> Vec<Decision> {
    let acceleration = &support.coupled * lambda + &support.beta;
    let size = support.beta.amax();
    decisions
        .iter()
        .enumerate()
        .map(|(i, decision)| {
            let rate = acceleration[3 * i + 1].hypot(acceleration[3 * i + 2]);
            let begins = matches!(decision, Decision::Slide(..)) && slips[i].is_none();
            if begins && rate <= 1e-6 * size { Decision::Stick } else { *decision }
        })
        .collect()
}

/// The forces of these modes by one linear system; `None` where they do not fit.
fn polished(
    support: &ClosedContacts,
    decisions: &[Decision],
    slips: &[Option<Vector2<f64>>],
    mu: &[f64],
    about: Option<&DVector<f64>>,
) -> Option<Choice> {
    let k = support.len();
    let mut directions: Vec<Option<Vector2<f64>>> = decisions
        .iter()
        .map(|decision| match decision {
            Decision::Slide(d, _) => Some(*d),
            _ => None,
        })
        .collect();
    let pressed: Vec<usize> = (0..k).filter(|&i| decisions[i] != Decision::Separate).collect();
    let part = part(support, &pressed);
    let friction: Vec<f64> = pressed.iter().map(|&i| mu[i]).collect();
    let weights: Vec<f64> = pressed.iter().map(|&i| about.map_or(1.0, |all| all[3 * i])).collect();
    let begin: Vec<(usize, usize)> = pressed
        .iter()
        .enumerate()
        .filter(|&(_, &i)| slips[i].is_none() && directions[i].is_some())
        .map(|(place, &i)| (place, i))
        .collect();
    let solved = |directions: &[Option<Vector2<f64>>]| -> Option<(Forces, Vec<f64>, Vec<Hold>)> {
        let holds: Vec<Hold> =
            pressed.iter().map(|&i| directions[i].map_or(Hold::Stick, Hold::Slide)).collect();
        let (forces, weights) = if pressed.is_empty() {
            let none =
                Forces { lambda: DVector::zeros(0), acceleration: DVector::zeros(0), unique: true, f: 1.0 };
            (none, Vec::new())
        } else {
            shared(&part, &holds, &friction, weights.clone()).ok()?
        };
        Some((forces, weights, holds))
    };
    begin_along(&begin, &mut directions, &vec![0.0; begin.len()], |directions| {
        solved(directions).map(|(forces, ..)| forces)
    })?;
    let found = solved(&directions);
    let (found, weights, holds) = found?;
    let mut all_weights = vec![0.0; k];
    pressed.iter().zip(&weights).for_each(|(&i, &weight)| all_weights[i] = weight);
    if !hold_good(&found, &holds, &friction) {
        return None;
    }
    let mut lambda = DVector::zeros(3 * k);
    for (place, &i) in pressed.iter().enumerate() {
        lambda.rows_mut(3 * i, 3).copy_from(&found.of(place));
    }
    let acceleration = &support.coupled * &lambda + &support.beta;
    let size = support.beta.amax() + (support.coupled.abs() * lambda.abs()).amax();
    let mut result = Vec::with_capacity(k);
    for i in 0..k {
        let rate = Vector2::new(acceleration[3 * i + 1], acceleration[3 * i + 2]);
        let fits = match (decisions[i], directions[i]) {
            (Decision::Separate, _) => acceleration[3 * i] >= -1e-11 * size,
            (Decision::Slide(..), Some(d)) if slips[i].is_none() => {
                rate.dot(&d) > 1e-11 * size && (rate - d * rate.dot(&d)).norm() <= 1e-9 * size
            }
            (Decision::Stick, _) => slips[i].is_none(),
            _ => true,
        };
        if !fits {
            return None;
        }
        result.push(match (decisions[i], directions[i]) {
            (Decision::Slide(..), Some(d)) => Decision::Slide(d, slips[i].is_none()),
            (other, _) => other,
        });
    }
    Some(Choice {
        decisions: result,
        forces: (0..k).map(|i| ClosedContacts::three(&lambda, i)).collect(),
        selection: vec![Selection::Unique; k],
        weights: all_weights,
        unique: found.unique,
    })
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
    for _ in 0..TURNS {
        let mut jacobian = DMatrix::zeros(m, m);
        for column in 0..m {
            let mut by = DVector::zeros(m);
            by[column] = TURN;
            let there = across(&turned(directions, &by))?;
            by[column] = -TURN;
            let here = across(&turned(directions, &by))?;
            jacobian.set_column(column, &((there - here) / (2.0 * TURN)));
        }
        let step = -least_squares(&jacobian, &residual);
        // Shorter where it does not help.
        let mut share = 1.0;
        let next = loop {
            let by = &step * (share * (1.0 / step.amax().max(1.0)));
            let next = turned(directions, &by);
            match across(&next) {
                Some(left) if left.amax() < residual.amax() => break Some((next, left, by.amax())),
                _ if share < 1e-3 => break None,
                _ => share *= 0.5,
            }
        };
        let Some((next, left, size)) = next else { break };
        directions.copy_from_slice(&next);
        residual = left;
        if size <= 1e-15 {
            break;
        }
    }
    Some(())
}

/// Steps of Newton's method at most, and the difference by which its derivatives are formed, rad.
const TURNS: usize = 30;
const TURN: f64 = 1e-6;

/// The support by some of the contacts.
pub(crate) fn part(support: &ClosedContacts, places: &[usize]) -> ClosedContacts {
    let rows: Vec<usize> = places.iter().flat_map(|&i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    ClosedContacts {
        contacts: places.iter().map(|&i| support.contacts[i]).collect(),
        coupled: support.coupled.select_rows(&rows).select_columns(&rows),
        partials: support.partials.select_rows(&rows),
        response: support.response.select_columns(&rows),
        velocity: support.velocity.select_rows(&rows),
        beta: support.beta.select_rows(&rows),
    }
}

/// Tries all combinations of modes.
fn tried(support: &ClosedContacts, slips: &[Option<Vector2<f64>>], mu: &[f64]) -> Option<Choice> {
    let k = support.len();
    for combination in 0..3_usize.pow(k as u32) {
        let mut rest = combination;
        let mut decisions = Vec::with_capacity(k);
        for slip in slips {
            decisions.push(match (rest % 3, slip) {
                (0, Some(d)) => Decision::Slide(*d, false),
                (0, None) => Decision::Stick,
                (1, None) => {
                    // A first guess of the direction: the free acceleration's.
                    let i = decisions.len();
                    let pull = Vector2::new(support.beta[3 * i + 1], support.beta[3 * i + 2]);
                    let size = pull.norm();
                    let guess = if size > 0.0 { pull / size } else { Vector2::new(1.0, 0.0) };
                    Decision::Slide(guess, true)
                }
                _ => Decision::Separate,
            });
            rest /= 3;
        }
        if let Some(choice) = polished(support, &decisions, slips, mu, None) {
            return Some(choice);
        }
    }
    None
}
