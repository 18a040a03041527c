//! Forces with a certificate: the certificate of given forces, the forces of given modes, and those that the
//! method of the runtime finds.
//!
//! Theory: docs/theory.md, section 17.10.

use hodograph::generated::hypot;
use hodograph::several::{
    self, Certificate, Dense, SeveralContacts, Unfound, memory_of_several, solve_several,
};
use nalgebra::{DVector, Vector2};

use super::{
    Mode, Problem, Solution, Solutions, Unsolved,
    prescribed::{FITS, Wanted, prescribed},
    problem::three,
    sparse::Sparse,
};

/// Why the method of the runtime has no answer.
pub(super) struct Refused {
    pub reason: Unsolved,
    /// The forces with the least violation; none for an invalid problem.
    pub nearest: Option<DVector<f64>>,
}

impl From<Unsolved> for Refused {
    fn from(reason: Unsolved) -> Self {
        Self { reason, nearest: None }
    }
}

/// The method of the runtime on this problem.
pub(super) fn attempt(problem: &Problem<'_>, guess: Option<&DVector<f64>>) -> Result<Solution, Refused> {
    problem.check()?;
    let (k, n) = (problem.contacts(), 3 * problem.contacts());
    if guess.is_some_and(|guess| guess.len() != n) {
        return Err(Unsolved::Lengths.into());
    }
    let beta = without_noise(problem);
    let contacts = several_contacts(problem, &beta);
    let mut force = guess.map_or_else(|| vec![0.0; n], |guess| guess.as_slice().to_vec());
    let mut acceleration = vec![0.0; n];
    let mut memory = vec![0.0; memory_of_several(k)];
    let sparse = if k >= SPARSE { Sparse::new(problem.w) } else { None };
    let found = match sparse {
        Some(mut steps) => solve_several(&contacts, &mut force, &mut acceleration, &mut memory, &mut steps),
        None => {
            let mut matrix = vec![0.0; n * n];
            let mut steps = Dense::new(&mut matrix);
            solve_several(&contacts, &mut force, &mut acceleration, &mut memory, &mut steps)
        }
    };
    let force = DVector::from_vec(force);
    let certificate = match found {
        Ok(certificate) => certificate,
        Err(reason) => return Err(Refused { reason: unsolved(reason), nearest: Some(force) }),
    };
    let acceleration = problem.w * &force + problem.beta;
    let modes = modes(problem, &force, &acceleration, &zeros(problem, &force, ZERO));
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

/// beta with components below their rounding errors set to zero.
fn without_noise(problem: &Problem<'_>) -> Vec<f64> {
    (0..problem.beta.len()).map(|row| problem.pull(row)).collect()
}

fn unsolved(reason: Unfound<f64>) -> Unsolved {
    match reason {
        Unfound::Input { contact } => Unsolved::Input { contact },
        Unfound::NotFound { violation } => Unsolved::NotFound { violation },
        _ => Unsolved::Lengths,
    }
}

/// What counts as zero in the accelerations that these forces cause: this part of their terms.
pub(super) fn zeros(problem: &Problem<'_>, force: &DVector<f64>, part: f64) -> DVector<f64> {
    let mut terms = problem.beta.abs();
    for (column, force) in problem.w.column_iter().zip(force.iter()) {
        for (terms, entry) in terms.iter_mut().zip(column.iter()) {
            *terms += (entry * force).abs();
        }
    }
    DVector::from_fn(terms.len(), |row, _| part * three(&terms, row / 3).amax() + problem.noise(row))
}

/// The mode of each contact, where accelerations up to these count as zero.
pub(super) fn modes(
    problem: &Problem<'_>,
    force: &DVector<f64>,
    acceleration: &DVector<f64>,
    zeros: &DVector<f64>,
) -> Vec<Mode> {
    (0..problem.contacts())
        .map(|i| {
            let (lambda, a) = (three(force, i), three(acceleration, i));
            let zero = |row: usize| zeros[3 * i + row];
            if lambda.x <= 0.0 && a.x > zero(0) {
                return Mode::Separate;
            }
            if let Some(d) = problem.slip[i] {
                return Mode::Slide(d);
            }
            let size = hypot(a.y, a.z);
            if size <= zero(1).max(zero(2)) {
                Mode::Stick
            } else {
                Mode::Slide(Vector2::new(a.y, a.z) / size)
            }
        })
        .collect()
}

/// Greatest violation of a law that is accepted.
pub(super) const ACCEPTED: f64 = 1e-12;

/// From this number of contacts on, a matrix with many zeros is eliminated by blocks.
const SPARSE: usize = 12;

/// Accelerations up to this part of their terms count as zero.
pub(super) const ZERO: f64 = 1e-12;

/// The forces in these modes, if they obey the laws.
pub(super) fn with_certificate(problem: &Problem<'_>, wanted: &[Mode]) -> Option<Solution> {
    let found = prescribed(problem, wanted, None, Wanted::Decision).ok()?;
    if found.margin < -FITS {
        return None;
    }
    let force = within(problem, wanted, found.force);
    let certificate = certificate(problem, &force).ok()?;
    if certificate.greatest() > ACCEPTED {
        return None;
    }
    let acceleration = problem.w * &force + problem.beta;
    let modes = modes(problem, &force, &acceleration, &zeros(problem, &force, ZERO));
    Some(Solution { force, acceleration, modes, certificate, solutions: Solutions::Unknown })
}

/// The forces moved back into the cones, where rounding has moved them outside.
fn within(problem: &Problem<'_>, modes: &[Mode], mut force: DVector<f64>) -> DVector<f64> {
    for (i, mode) in modes.iter().enumerate() {
        let normal = force[3 * i].max(0.0);
        let friction = Vector2::new(force[3 * i + 1], force[3 * i + 2]);
        let most = problem.mu[i] * normal;
        let size = friction.norm();
        let friction = match mode {
            Mode::Slide(d) => d * -most,
            _ if size > most => friction * (most / size),
            _ => friction,
        };
        force[3 * i] = normal;
        force[3 * i + 1] = friction.x;
        force[3 * i + 2] = friction.y;
    }
    force
}
