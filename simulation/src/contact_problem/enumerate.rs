//! All solutions of few contacts, mode by mode.
//!
//! A contact without slip may separate, stick or begin to slip. If none begins to slip, the equations are
//! linear. The directions in which contacts begin to slip follow from equations in their angles alone.
//!
//! Theory: docs/theory.md, section 17.10.

use nalgebra::Vector2;

use super::{
    Mode, Problem, Solution, Solutions,
    certified::{attempt, with_certificate},
    directions::{Choice, MOST_ENUMERATED, directions},
    motion::centred,
};

/// All motions of at most [`MOST_ENUMERATED`] contacts that the laws allow, each with forces, the one with
/// most contacts at rest first; empty for more contacts, or for an invalid problem.
///
/// If at most one contact begins to slip, no solution is missed. Directions of several contacts are sought
/// from a grid. Different forces with the same motion count as one solution; the forces are those of
/// [`with_modes`](super::with_modes).
pub fn enumerate(problem: &Problem<'_>) -> Vec<Solution> {
    let k = problem.contacts();
    if k > MOST_ENUMERATED || problem.check().is_err() {
        return Vec::new();
    }
    let mut found: Vec<Solution> = Vec::new();
    // If contacts can share their load in many ways as they begin to slip, there are many motions; this is
    // one of them.
    if let Ok(first) = attempt(problem, None) {
        found.push(centred(problem, first));
    }
    let choices: Vec<Vec<Choice>> = (0..k).map(|i| choices(problem, i)).collect();
    let mut places = vec![0; k];
    loop {
        let chosen: Vec<Choice> =
            places.iter().zip(&choices).map(|(&place, choices)| choices[place]).collect();
        for modes in ways(problem, &chosen) {
            accept(problem, &modes, &mut found);
        }
        // The next combination.
        let Some(i) = (0..k).find(|&i| places[i] + 1 < choices[i].len()) else { break };
        places[i] += 1;
        places[..i].fill(0);
    }
    found.sort_by_key(|solution| solution.modes.iter().map(rank).sum::<usize>());
    let solutions = if found.len() == 1 { Solutions::Unique } else { Solutions::Several };
    found.iter_mut().for_each(|solution| solution.solutions = solutions);
    found
}

fn rank(mode: &Mode) -> usize {
    match mode {
        Mode::Stick => 0,
        Mode::Slide(_) => 1,
        Mode::Separate => 2,
    }
}

fn choices(problem: &Problem<'_>, i: usize) -> Vec<Choice> {
    match problem.slip[i] {
        Some(d) => vec![Choice::Known(Mode::Slide(d)), Choice::Known(Mode::Separate)],
        None if problem.mu[i] > 0.0 => {
            vec![Choice::Known(Mode::Stick), Choice::Begin, Choice::Known(Mode::Separate)]
        }
        None => vec![Choice::Known(Mode::Stick), Choice::Known(Mode::Separate)],
    }
}

/// The modes for a choice, with all possible directions of the contacts that begin to slip.
fn ways(problem: &Problem<'_>, chosen: &[Choice]) -> Vec<Vec<Mode>> {
    let open: Vec<usize> = (0..chosen.len()).filter(|&i| chosen[i] == Choice::Begin).collect();
    let with = |found: &[Vector2<f64>]| {
        let mut directions = found.iter();
        let mode = |choice: &Choice| match choice {
            Choice::Known(mode) => *mode,
            Choice::Begin => directions.next().map_or(Mode::Stick, |d| Mode::Slide(*d)),
        };
        chosen.iter().map(mode).collect()
    };
    if open.is_empty() {
        return vec![with(&[])];
    }
    directions(problem, chosen, &open).iter().map(|found| with(found)).collect()
}

/// Adds the forces of these modes if they obey the laws and their motion is new.
fn accept(problem: &Problem<'_>, wanted: &[Mode], found: &mut Vec<Solution>) {
    let Some(solution) = with_certificate(problem, wanted) else { return };
    let size = solution.acceleration.amax().max(problem.beta.amax());
    let same = |other: &Solution| (&other.acceleration - &solution.acceleration).amax() <= SAME * size;
    if !found.iter().any(same) {
        found.push(solution);
    }
}

/// Two motions are the same if their accelerations differ by less than this part of the greatest one.
const SAME: f64 = 1e-8;
