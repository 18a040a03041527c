//! Chooses the modes of the closed contacts at an instant.
//!
//! For a single contact the runtime has an exact solution. For several contacts, rest is chosen if it is
//! admissible: all contacts without slip keep sticking. Otherwise the forces of all contacts are computed
//! together ([`contact_problem::solve`]), and determine the modes. Contacts that leave their static cones
//! slip with the sliding coefficient (docs/theory.md, section 17.15).

use std::cell::Cell;

use hodograph::{ContactError, ContactMode, Selection, contact_mode_after};
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

use crate::closed::closed_contacts::{ClosedContacts, least_squares};
use crate::closed::forces::{Forces, Hold, Lacking, forces};
use crate::closed::pair::Friction;
use crate::contact_problem::{self, MOST_ENUMERATED, Mode, Problem, Unsolved, Wanted};

/// The mode of a closed contact after an event.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Decision {
    Separate,
    Stick,
    /// Sliding along a direction; and whether slip begins now.
    Slide(Vector2<f64>, bool),
}

impl Decision {
    /// The direction in which slip begins, if it does.
    pub fn begins(&self) -> Option<Vector2<f64>> {
        match self {
            Self::Slide(direction, true) => Some(*direction),
            _ => None,
        }
    }

    /// The mode that lasts, unless it is that of an open contact.
    fn hold(&self) -> Option<Hold> {
        match self {
            Self::Separate => None,
            Self::Stick => Some(Hold::Stick),
            Self::Slide(direction, _) => Some(Hold::Slide(*direction)),
        }
    }

    /// Whether another decision is for the same mode.
    pub fn is_of_kind(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Slide(_, begins), Self::Slide(_, other)) => begins == other,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// Decisions for all closed contacts.
#[derive(Clone, Debug)]
pub(crate) struct Choice {
    pub decisions: Vec<Decision>,
    pub forces: Vec<Vector3<f64>>,
    /// Whether others were possible, where that is known without looking for them.
    pub selection: Option<Selection>,
    /// The contacts that static friction holds, or would.
    held: Vec<bool>,
}

impl Choice {
    /// Decisions of which nobody knows whether others were possible.
    pub fn among_unknown(decisions: Vec<Decision>, forces: Vec<Vector3<f64>>) -> Self {
        Self { decisions, forces, selection: Some(Selection::Unknown), held: Vec::new() }
    }
}

/// Contacts whose modes are asked for: their state, the direction of slip of each (`None` without slip), and their
/// friction.
#[derive(Clone, Debug)]
pub(crate) struct Question {
    pub support: ClosedContacts,
    pub slips: Vec<Option<Vector2<f64>>>,
    pub friction: Vec<Friction>,
}

impl Question {
    /// Chooses the modes; see [`choose`].
    pub fn choose(&self, before: &DVector<f64>) -> Result<Choice, Lacking> {
        choose(&self.support, &self.slips, &self.friction, before)
    }

    /// A choice with directions of beginning slip in which no acceleration is left across them but rounding: differences
    /// of forces as large as the certificate allows turn slow slip. The same choice where there are none so near.
    pub fn with_exact_directions(&self, mut choice: Choice) -> Choice {
        let begin: Vec<(usize, usize)> = (0..self.slips.len())
            .filter(|&i| choice.decisions[i].begins().is_some())
            .map(|place| (place, place))
            .collect();
        let known: Option<Vec<Hold>> = choice.decisions.iter().map(Decision::hold).collect();
        let Some(known) = known else { return choice };
        let mu: Vec<f64> = self
            .friction
            .iter()
            .zip(&known)
            .map(|(mu, hold)| if hold.direction().is_some() { mu.slips } else { mu.sticks })
            .collect();
        let mut directions: Vec<Option<Vector2<f64>>> = known.iter().map(Hold::direction).collect();
        let forces = |directions: &[Option<Vector2<f64>>]| {
            let holds: Vec<Hold> = directions.iter().map(|d| d.map_or(Hold::Stick, Hold::Slide)).collect();
            forces(&self.support, &holds, &mu, None, Wanted::Acceleration).ok()
        };
        begin_along(&begin, &mut directions, &vec![0.0; begin.len()], forces);
        let turned = |&(place, _): &(usize, usize)| match (directions[place], known[place].direction()) {
            (Some(found), Some(before)) => (found - before).norm(),
            _ => f64::INFINITY,
        };
        if begin.iter().map(turned).all(|turned| turned <= EXACT) {
            for &(place, _) in &begin {
                if let Some(direction) = directions[place] {
                    choice.decisions[place] = Decision::Slide(direction, true);
                }
            }
        }
        choice
    }

    /// Whether other modes than the chosen ones were possible. They are looked for, which may cost more than the choice.
    pub fn selection(&self, choice: &Choice) -> Selection {
        if let Some(known) = choice.selection {
            return known;
        }
        let mu = coefficients(&self.friction, &choice.held);
        let mode = |decision: &Decision| match decision {
            Decision::Separate => Mode::Separate,
            Decision::Stick => Mode::Stick,
            Decision::Slide(direction, _) => Mode::Slide(*direction),
        };
        let modes: Vec<Mode> = choice.decisions.iter().map(mode).collect();
        let numbers = choice.forces.iter().flat_map(|force| force.iter().copied());
        let force = DVector::from_iterator(3 * choice.forces.len(), numbers);
        match selection(&self.support.problem(&mu, &self.slips), &modes, &force) {
            Selection::Unique if others_fit(&self.support, &self.slips, &self.friction, choice) => {
                Selection::SeveralModes
            }
            found => found,
        }
    }
}

/// Chooses the modes of closed contacts. `slips` is the direction of slip of each, `None` without slip;
/// `before` are the previous forces, near which solutions are sought if several are admissible.
pub(crate) fn choose(
    support: &ClosedContacts,
    slips: &[Option<Vector2<f64>>],
    friction: &[Friction],
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    if support.is_idle() {
        // No contact is pressed or separated: contacts without slip remain so, and sliding ones keep sliding.
        let decision =
            |slip: &Option<Vector2<f64>>| slip.map_or(Decision::Stick, |d| Decision::Slide(d, false));
        return Ok(Choice {
            decisions: slips.iter().map(decision).collect(),
            forces: vec![Vector3::zeros(); slips.len()],
            selection: Some(Selection::Unknown),
            held: Vec::new(),
        });
    }
    if support.len() == 1 {
        return one(support, slips[0], friction[0], before);
    }
    // Contacts without slip are held by static friction, until slip is found.
    let mut held: Vec<bool> = slips.iter().map(Option::is_none).collect();
    loop {
        let mu = coefficients(friction, &held);
        let problem = support.problem(&mu, slips);
        let mut choice = choose_with(support, &problem, before)?;
        let begins = |i: usize| held[i] && matches!(choice.decisions[i], Decision::Slide(..));
        let leave: Vec<usize> =
            (0..held.len()).filter(|&i| begins(i) && friction[i].sticks > friction[i].slips).collect();
        if leave.is_empty() {
            choice.held = held;
            return Ok(choice);
        }
        for i in leave {
            held[i] = false;
        }
    }
}

/// The coefficients of contacts that are held by static friction, that slip or that begin to slip.
fn coefficients(friction: &[Friction], held: &[bool]) -> Vec<f64> {
    friction.iter().zip(held).map(|(mu, &held)| if held { mu.sticks } else { mu.slips }).collect()
}

/// Whether other modes are admissible when each contact without slip may be held by static friction, or slip
/// with the lower coefficient: those of every subset of held contacts.
fn others_fit(
    support: &ClosedContacts,
    slips: &[Option<Vector2<f64>>],
    friction: &[Friction],
    choice: &Choice,
) -> bool {
    let open: Vec<usize> =
        (0..slips.len()).filter(|&i| slips[i].is_none() && friction[i].sticks > friction[i].slips).collect();
    if open.is_empty() || slips.len() > MOST_ENUMERATED {
        return false;
    }
    (0..1_usize << open.len()).any(|share| {
        let mut held: Vec<bool> = slips.iter().map(Option::is_none).collect();
        for (bit, &i) in open.iter().enumerate() {
            held[i] = share >> bit & 1 == 1;
        }
        let mu = coefficients(friction, &held);
        let lawful = |solution: &contact_problem::Solution| {
            (0..held.len())
                .all(|i| !(held[i] && open.contains(&i) && matches!(solution.modes[i], Mode::Slide(_))))
        };
        let differs = |solution: &contact_problem::Solution| {
            solution.modes.iter().zip(&choice.decisions).any(|(mode, decision)| {
                !matches!(
                    (mode, decision),
                    (Mode::Separate, Decision::Separate)
                        | (Mode::Stick, Decision::Stick)
                        | (Mode::Slide(_), Decision::Slide(..))
                )
            })
        };
        let solutions = contact_problem::enumerate(&support.problem(&mu, slips));
        solutions.iter().any(|solution| lawful(solution) && differs(solution))
    })
}

/// Chooses the modes if each contact has a single coefficient of friction.
fn choose_with(
    support: &ClosedContacts,
    problem: &Problem<'_>,
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    let slips = problem.slip;
    if let Some(rest) = contact_problem::rest(problem) {
        let modes: Vec<Mode> = slips.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
        return Ok(chosen(problem, &modes, &rest.force, None));
    }
    let found = contact_problem::solve_without_jam(problem, Some(before));
    if let Err(Unsolved::NotFound { .. }) = found
        && let Some((modes, nearly)) = contact_problem::nearly(problem, Some(before))
    {
        return Ok(chosen(problem, &modes, &nearly.force, Some(Selection::Unknown)));
    }
    let (solution, middle) = found.map_err(|unsolved| match unsolved {
        Unsolved::Jam { contact, .. } => {
            let free_acceleration = support.beta[3 * contact];
            Lacking::Contact(contact, ContactError::Jam { free_acceleration })
        }
        _ => Lacking::Common,
    })?;
    // Among many forces for this motion the analytic centre.
    match middle {
        Some(middle) if middle.margin >= 0.0 => Ok(chosen(problem, &solution.modes, &middle.force, None)),
        _ => Ok(chosen(problem, &solution.modes, &solution.force, None)),
    }
}

fn chosen(
    problem: &Problem<'_>,
    modes: &[Mode],
    force: &DVector<f64>,
    selection: Option<Selection>,
) -> Choice {
    let decision = |(mode, slip): (&Mode, &Option<Vector2<f64>>)| match mode {
        Mode::Separate => Decision::Separate,
        Mode::Stick => Decision::Stick,
        Mode::Slide(direction) => Decision::Slide(*direction, slip.is_none()),
    };
    Choice {
        decisions: modes.iter().zip(problem.slip).map(decision).collect(),
        forces: (0..modes.len()).map(|i| ClosedContacts::three(force, i)).collect(),
        selection,
        held: Vec::new(),
    }
}

/// Whether other modes are admissible, too. For many contacts they are not listed: another motion may be found,
/// but none is excluded.
fn selection(problem: &Problem<'_>, modes: &[Mode], force: &DVector<f64>) -> Selection {
    let many = modes.len() > MOST_ENUMERATED;
    if only_rest(problem, modes) {
        return if many { Selection::Unknown } else { Selection::Unique };
    }
    if many {
        let other = contact_problem::another(problem, force);
        return if other { Selection::SeveralModes } else { Selection::Unknown };
    }
    let differs = |other: &contact_problem::Solution| {
        other.modes.iter().zip(modes).any(|(other, mode)| !other.is_like(mode))
    };
    let several = contact_problem::enumerate(problem).iter().any(differs);
    if several { Selection::SeveralModes } else { Selection::Unique }
}

/// Whether contacts are at rest and could be so without friction: then no other motion obeys the laws
/// (docs/theory.md, section 17.10).
fn only_rest(problem: &Problem<'_>, modes: &[Mode]) -> bool {
    let rests = modes.iter().all(|mode| *mode == Mode::Stick) && problem.slip.iter().all(Option::is_none);
    rests && contact_problem::rest(&Problem { mu: &vec![0.0; modes.len()], ..*problem }).is_some()
}

fn one(
    support: &ClosedContacts,
    slip: Option<Vector2<f64>>,
    friction: Friction,
    before: &DVector<f64>,
) -> Result<Choice, Lacking> {
    let with = |mu: f64| {
        contact_mode_after(
            &support.reduced(0),
            &ClosedContacts::three(&support.beta, 0),
            &slip.unwrap_or_else(Vector2::zeros),
            mu,
            &ClosedContacts::three(before, 0),
        )
        .map_err(|error| Lacking::Contact(0, error))
    };
    let slipping = with(friction.slips);
    // Static friction may hold a contact that sliding friction does not.
    let held =
        if slip.is_none() && friction.sticks > friction.slips { with(friction.sticks).ok() } else { None };
    let answer = match held {
        Some(mut held) if held.mode == ContactMode::Stick => {
            if !slipping.is_ok_and(|other| other.mode == ContactMode::Stick) {
                held.selection = Selection::SeveralModes;
            }
            held
        }
        _ => slipping?,
    };
    Ok(Choice {
        decisions: vec![decision(answer.mode, answer.direction)],
        forces: vec![answer.force],
        selection: Some(answer.selection),
        held: Vec::new(),
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

/// Turns the directions in which slip begins until the acceleration perpendicular to each has the given
/// value, 0 for slip along the acceleration: Newton's method for the angles. `begin` are these contacts, by
/// their indices in the forces and in the directions. `None` if there are no such directions nearby; these are then the
/// best that were found.
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
    // New slip cannot be opposite to the acceleration; existing slip can.
    let starts = wanted.iter().all(|wanted| *wanted == 0.0);
    // The perpendicular components, beyond those that are wanted; accelerations without forces say how large they are.
    let free = Cell::new(0.0);
    let across = |directions: &[Option<Vector2<f64>>]| -> Option<DVector<f64>> {
        let found = forces(directions)?;
        free.set(found.free);
        let mut residual = DVector::zeros(m);
        for (row, &(place, i)) in begin.iter().enumerate() {
            let d = directions[i]?;
            let rate = Vector2::new(found.acceleration[3 * place + 1], found.acceleration[3 * place + 2]);
            residual[row] = d.x * rate.y - d.y * rate.x - wanted[row];
            if rate.dot(&d) < 0.0 && starts {
                // The opposite direction is not a solution.
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
        // Shorten the step if it does not help.
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
        // Derivatives are reused as long as they work well.
        if left.amax() < 1e-2 * residual.amax() {
            jacobian = Some(matrix);
        }
        residual = left;
        if longest <= 1e-14 {
            break;
        }
    }
    (residual.amax() <= ALONG * free.get()).then_some(())
}

/// Directions that turn by more than this are others than those that were chosen, rad.
const EXACT: f64 = 1e-3;
/// Largest number of Newton steps, the difference of angles for its derivatives, and angles below which only
/// rounding prevents further decrease, rad.
const TURNS: usize = 30;
const TURN: f64 = 1e-6;
const ROUNDED: f64 = 1e-10;
/// Perpendicular accelerations that may remain, relative to those without forces.
const ALONG: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;
    use hodograph_random::Random;

    /// One body with contacts at random places, pressed down.
    fn support(k: usize, random: &mut Random) -> ClosedContacts {
        let mut partials = DMatrix::zeros(6, 3 * k);
        for i in 0..k {
            let arm = Vector3::new(random.number(), random.number(), -0.3 + 0.1 * random.number());
            for (row, axis) in [Vector3::z(), Vector3::x(), Vector3::y()].into_iter().enumerate() {
                let turn = arm.cross(&axis);
                for c in 0..3 {
                    partials[(c, 3 * i + row)] = axis[c];
                    partials[(3 + c, 3 * i + row)] = turn[c];
                }
            }
        }
        let inverse = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1.0, 1.0, 9.0, 7.0, 5.0]));
        let response = &inverse * &partials;
        let load = DVector::from_vec(vec![
            4.0 * random.number(),
            4.0 * random.number(),
            -9.81,
            2.0 * random.number(),
            2.0 * random.number(),
            2.0 * random.number(),
        ]);
        ClosedContacts {
            contacts: (0..k).collect(),
            coupled: partials.tr_mul(&response),
            beta: partials.tr_mul(&load),
            partials,
            response,
            velocity: DVector::zeros(3 * k),
            noise: DVector::zeros(3 * k),
        }
    }

    /// The choices obey the law with two coefficients: sticking contacts do not accelerate and stay in their
    /// static cones, sliding ones have sliding friction opposite to their acceleration, and contacts within
    /// their static cones at rest stay at rest.
    #[test]
    fn choices_obey_both_coefficients() {
        let mut seen = [0; 4];
        for seed in 1..150_u64 {
            let mut random = Random::new(seed);
            let k = 1 + seed as usize % 3;
            let support = support(k, &mut random);
            let friction: Vec<Friction> = (0..k)
                .map(|_| {
                    let slips = 0.2 + 0.15 * random.number();
                    Friction { slips, sticks: slips + 0.2 + 0.15 * random.number() }
                })
                .collect();
            let slips = vec![None; k];
            let question = Question { support, slips, friction };
            let choice = question.choose(&DVector::zeros(3 * k)).unwrap();
            let selection = question.selection(&choice);
            let Question { support, slips, friction } = question;
            let mut all = DVector::zeros(3 * k);
            for (i, force) in choice.forces.iter().enumerate() {
                all.rows_mut(3 * i, 3).copy_from(force);
            }
            let acceleration = &support.coupled * &all + &support.beta;
            let size = 1e-9 * (all.amax() * support.coupled.amax() + support.beta.amax());
            let mut rests = true;
            for (i, friction) in friction.iter().enumerate() {
                let (force, a) = (ClosedContacts::three(&all, i), ClosedContacts::three(&acceleration, i));
                let tangential = Vector2::new(force.y, force.z);
                match choice.decisions[i] {
                    Decision::Separate => {
                        seen[0] += 1;
                        rests = false;
                        assert!(force.norm() == 0.0 && a.x > -size, "{seed}");
                    }
                    Decision::Stick => {
                        seen[1] += 1;
                        assert!(a.norm() < size, "{seed}: {a}");
                        assert!(tangential.norm() <= friction.sticks * force.x + size, "{seed}");
                    }
                    Decision::Slide(d, begins) => {
                        seen[2] += 1;
                        rests = false;
                        assert!(begins && force.x >= -size && a.x.abs() < size, "{seed}");
                        assert!((tangential + d * (friction.slips * force.x)).norm() < size, "{seed}");
                        assert!(d.dot(&Vector2::new(a.y, a.z)) > -size, "{seed}");
                        assert!((d.x * a.z - d.y * a.y).abs() < size, "{seed}");
                    }
                }
            }
            let mu: Vec<f64> = friction.iter().map(|friction| friction.sticks).collect();
            assert_eq!(rests, contact_problem::rest(&support.problem(&mu, &slips)).is_some(), "{seed}");
            // Sliding friction alone would have let it slip.
            let mu: Vec<f64> = friction.iter().map(|friction| friction.slips).collect();
            if rests && contact_problem::rest(&support.problem(&mu, &slips)).is_none() {
                seen[3] += 1;
                assert_eq!(selection, Selection::SeveralModes, "{seed}");
            }
        }
        assert!(seen.iter().all(|&seen| seen > 10), "{seen:?}");
    }
}
