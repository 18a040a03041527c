//! Forces of contacts whose modes are not known.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::several::{
    self, Certificate, Dense, SeveralContacts, Unfound, memory_of_several, solve_several,
};
use nalgebra::{DVector, Vector2};

use super::{
    Mode, Problem, Solution, Solutions, Unsolved,
    enumerate::{enumerate, with_certificate},
    motion::centred,
    problem::three,
    sparse::Sparse,
};

/// Forces that obey the laws, with modes and certificate. Where all contacts that do not slip may go on sticking, they
/// do. Among many forces for one motion the analytic centre is taken. `guess` saves work, and chooses among several
/// motions that are not rest.
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
        Ok(found) if few => Ok(centred(problem, found)),
        Ok(found) => Ok(found),
        Err(Unsolved::NotFound { violation }) => {
            if let Some(first) = enumerate(problem).into_iter().next() {
                return Ok(first);
            }
            Err(match jammed(problem) {
                Some(contact) => Unsolved::Jam { contact, f: own_f(problem, contact).unwrap_or(0.0) },
                None => Unsolved::NotFound { violation },
            })
        }
        Err(reason) => Err(reason),
    }
}

/// f of a contact that slides, alone.
fn own_f(problem: &Problem<'_>, i: usize) -> Option<f64> {
    let d = problem.slip[i]?;
    let row = 3 * i;
    Some(
        problem.w[(row, row)]
            - problem.mu[i] * (problem.w[(row, row + 1)] * d.x + problem.w[(row, row + 2)] * d.y),
    )
}

/// The contact that slides with the least f, if that is not positive.
fn jammed(problem: &Problem<'_>) -> Option<usize> {
    let ratio = |i: usize| own_f(problem, i).map(|f| f / problem.w[(3 * i, 3 * i)]);
    (0..problem.contacts())
        .filter(|&i| ratio(i).is_some_and(|f| f <= 1e-6))
        .min_by(|&a, &b| ratio(a).unwrap_or(1.0).total_cmp(&ratio(b).unwrap_or(1.0)))
}

/// The method of the runtime on this problem.
pub(super) fn attempt(problem: &Problem<'_>, guess: Option<&DVector<f64>>) -> Result<Solution, Unsolved> {
    problem.check()?;
    let (k, n) = (problem.contacts(), 3 * problem.contacts());
    if guess.is_some_and(|guess| guess.len() != n) {
        return Err(Unsolved::Lengths);
    }
    let beta = without_noise(problem);
    let contacts = several_contacts(problem, &beta);
    let mut force = guess.map_or_else(|| vec![0.0; n], |guess| guess.as_slice().to_vec());
    let mut acceleration = vec![0.0; n];
    let mut memory = vec![0.0; memory_of_several(k)];
    let sparse = if k >= SPARSE { Sparse::new(problem.w) } else { None };
    let certificate = match sparse {
        Some(mut steps) => solve_several(&contacts, &mut force, &mut acceleration, &mut memory, &mut steps),
        None => {
            let mut matrix = vec![0.0; n * n];
            let mut steps = Dense::new(&mut matrix);
            solve_several(&contacts, &mut force, &mut acceleration, &mut memory, &mut steps)
        }
    }
    .map_err(unsolved)?;
    let force = DVector::from_vec(force);
    let acceleration = problem.w * &force + problem.beta;
    let modes = modes(problem, &force, &acceleration);
    Ok(Solution { force, acceleration, modes, certificate, solutions: Solutions::Unknown })
}

/// The violations of the laws by given forces.
///
/// # Errors
/// [`Unsolved::Lengths`] and [`Unsolved::Input`].
pub fn certificate(problem: &Problem<'_>, force: &DVector<f64>) -> Result<Certificate<f64>, Unsolved> {
    problem.check()?;
    let beta = without_noise(problem);
    let mut memory = vec![0.0; memory_of_several(problem.contacts())];
    several::certify(&several_contacts(problem, &beta), force.as_slice(), &mut memory).map_err(unsolved)
}

fn several_contacts<'a>(problem: &Problem<'a>, beta: &'a [f64]) -> SeveralContacts<'a, f64> {
    SeveralContacts { matrix: problem.w.as_slice(), beta, mu: problem.mu, slip: problem.slip }
}

/// beta, zero where it is rounding.
fn without_noise(problem: &Problem<'_>) -> Vec<f64> {
    let clean = |(row, &beta): (usize, &f64)| if beta.abs() <= problem.noise(row) { 0.0 } else { beta };
    problem.beta.iter().enumerate().map(clean).collect()
}

fn unsolved(reason: Unfound<f64>) -> Unsolved {
    match reason {
        Unfound::Input { contact } => Unsolved::Input { contact },
        Unfound::NotFound { violation } => Unsolved::NotFound { violation },
        _ => Unsolved::Lengths,
    }
}

/// What each contact does.
pub(super) fn modes(problem: &Problem<'_>, force: &DVector<f64>, acceleration: &DVector<f64>) -> Vec<Mode> {
    let mut terms = problem.beta.abs();
    for (column, force) in problem.w.column_iter().zip(force.iter()) {
        for (terms, entry) in terms.iter_mut().zip(column.iter()) {
            *terms += (entry * force).abs();
        }
    }
    (0..problem.contacts())
        .map(|i| {
            let (lambda, a) = (three(force, i), three(acceleration, i));
            let zero = |row: usize| ZERO * three(&terms, i).amax() + problem.noise(3 * i + row);
            if lambda.x <= 0.0 && a.x > zero(0) {
                return Mode::Separate;
            }
            if let Some(d) = problem.slip[i] {
                return Mode::Slide(d);
            }
            let size = a.y.hypot(a.z);
            if size <= zero(1).max(zero(2)) {
                Mode::Stick
            } else {
                Mode::Slide(Vector2::new(a.y, a.z) / size)
            }
        })
        .collect()
}

/// Greatest violation that is accepted.
pub(super) const ACCEPTED: f64 = 1e-12;

/// Up to so many contacts rest is looked for first, and the centre of forces that are not unique is taken.
const CENTRED: usize = 48;

/// From so many contacts on, a matrix with many zeros is eliminated by blocks.
const SPARSE: usize = 12;

/// Accelerations up to this beside their terms count as zero.
const ZERO: f64 = 1e-12;
