//! Solves for the forces of closed contacts whose modes are known.

use hodograph::{ContactError, ContactMode, contact_force};
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

use crate::closed_contacts::{ClosedContacts, solve};

/// A sliding contact with f / m_nn below this jams: its force grows without bound as f falls to zero.
pub(crate) const JAM: f64 = 1e-6;

/// What a closed contact does while the motion goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    /// no slip
    Stick,
    /// slip along a direction of length one
    Slide(Vector2<f64>),
}

/// Forces and accelerations of all closed contacts.
#[derive(Clone, Debug)]
pub(crate) struct Forces {
    /// n, t, s of each.
    pub lambda: DVector<f64>,
    /// W lambda + beta.
    pub acceleration: DVector<f64>,
    /// Whether no other forces give the same.
    pub unique: bool,
    /// How near the system is to having no solution: f / m_nn of a single sliding contact, else 1.
    pub f: f64,
}

impl Forces {
    /// The rates that they give to the speeds (p).
    pub fn rates(&self, support: &ClosedContacts) -> DVector<f64> {
        &support.response * &self.lambda
    }

    /// The force of one.
    pub fn of(&self, i: usize) -> Vector3<f64> {
        ClosedContacts::three(&self.lambda, i)
    }
}

/// Why there are none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lacking {
    /// The contact with this place among the closed ones has none.
    Contact(usize, ContactError<f64>),
    /// Together they have none.
    Together,
}

/// Forces under which sticking contacts do not accelerate and sliding ones do not part. Where the support is overdetermined they are shared so
/// that the sum of lambda^2 over the `weights` of the contacts is least: weights are normal forces, so that all contacts use their friction alike.
pub(crate) fn forces(
    support: &ClosedContacts,
    holds: &[Hold],
    mu: &[f64],
    weights: Option<&[f64]>,
) -> Result<Forces, Lacking> {
    if let [hold] = holds {
        return single(support, *hold, mu[0]);
    }
    let k = support.len();
    // lambda = P z: a sticking contact has three unknowns, a sliding one its normal force.
    let columns = columns(holds);
    let m = columns.len();
    let greatest = weights.map_or(0.0, |weights| weights.iter().fold(0.0_f64, |a, b| a.max(*b)));
    let share = |i: usize| match weights {
        Some(weights) if greatest > 0.0 => (weights[i] / greatest).max(1e-3).sqrt(),
        _ => 1.0,
    };
    let mut push = DMatrix::zeros(3 * k, m);
    for (j, &(i, axis)) in columns.iter().enumerate() {
        let share = share(i);
        push[(3 * i + axis, j)] = share;
        if let Hold::Slide(d) = holds[i] {
            push[(3 * i + 1, j)] = -mu[i] * d.x * share;
            push[(3 * i + 2, j)] = -mu[i] * d.y * share;
        }
    }
    let row = |j: usize| 3 * columns[j].0 + columns[j].1;
    let pushed = &support.coupled * &push;
    let matrix = DMatrix::from_fn(m, m, |a, b| share(columns[a].0) * pushed[(row(a), b)]);
    let right = DVector::from_fn(m, |a, _| -share(columns[a].0) * support.beta[row(a)]);
    let (z, unique) = solve(&matrix, &right);
    let lambda = &push * z;
    let acceleration = &support.coupled * &lambda + &support.beta;
    let left = (0..m).map(|a| acceleration[row(a)].abs()).fold(0.0, f64::max);
    let size = support.beta.amax() + (support.coupled.abs() * lambda.abs()).amax();
    if !lambda.iter().all(|value| value.is_finite()) || left > INCONSISTENT * size {
        return Err(Lacking::Together);
    }
    Ok(Forces { lambda, acceleration, unique, f: 1.0 })
}

/// The forces of an overdetermined support with nearly their own normal forces as weights, so that all contacts use their friction alike, and the weights
/// with which they were found; `weights` are a first guess.
pub(crate) fn shared(
    support: &ClosedContacts,
    holds: &[Hold],
    mu: &[f64],
    mut weights: Vec<f64>,
) -> Result<(Forces, Vec<f64>), Lacking> {
    let mut answer = forces(support, holds, mu, Some(&weights))?;
    for _ in 0..SHARING {
        if answer.unique {
            break;
        }
        weights.iter_mut().enumerate().for_each(|(i, weight)| *weight = answer.lambda[3 * i].max(0.0));
        answer = forces(support, holds, mu, Some(&weights))?;
    }
    Ok((answer, weights))
}

/// Accelerations that forces should cancel may be left in this ratio to their terms: see the bound of pivots.
const INCONSISTENT: f64 = 1e-6;

/// Rounds of sharing.
const SHARING: usize = 3;

/// The unknowns: contact and axis.
fn columns(holds: &[Hold]) -> Vec<(usize, usize)> {
    let mut columns = Vec::new();
    for (i, hold) in holds.iter().enumerate() {
        columns.push((i, 0));
        if matches!(hold, Hold::Stick) {
            columns.extend([(i, 1), (i, 2)]);
        }
    }
    columns
}

/// One contact: the runtime's own answer.
fn single(support: &ClosedContacts, hold: Hold, mu: f64) -> Result<Forces, Lacking> {
    let (mode, slip) = match hold {
        Hold::Stick => (ContactMode::Stick, Vector2::zeros()),
        Hold::Slide(d) => (ContactMode::Slide, d),
    };
    let matrix = support.reduced(0);
    let beta = ClosedContacts::three(&support.beta, 0);
    let answer =
        contact_force(mode, &matrix, &beta, &slip, mu).map_err(|error| Lacking::Contact(0, error))?;
    Ok(Forces {
        lambda: DVector::from_column_slice(answer.force.as_slice()),
        acceleration: DVector::from_column_slice(answer.acceleration.as_slice()),
        unique: answer.force_is_unique,
        f: answer.margins.f.map_or(1.0, |f| f / matrix.nn),
    })
}

/// Relative slack of the conditions that end a mode, so that rounding on an edge does not.
const SLACK: f64 = 2e-12;

/// What must stay positive while the modes last: per contact lambda_n, and (mu lambda_n)^2 - lambda_tan^2 of one that sticks (else 1).
pub(crate) fn margins(forces: &Forces, holds: &[Hold], mu: &[f64]) -> Vec<[f64; 2]> {
    let size = forces.lambda.amax();
    holds
        .iter()
        .enumerate()
        .map(|(i, hold)| {
            let force = forces.of(i);
            let cone = match hold {
                Hold::Slide(_) => 1.0,
                Hold::Stick => {
                    let most = mu[i] * force.x;
                    let over = force.y * force.y + force.z * force.z;
                    most * most * (1.0 + 2.0 * SLACK) + (SLACK * size).powi(2) - over
                }
            };
            [force.x + SLACK * size, cone]
        })
        .collect()
}

/// Whether all conditions of the modes hold.
pub(crate) fn hold_good(forces: &Forces, holds: &[Hold], mu: &[f64]) -> bool {
    margins(forces, holds, mu).iter().flatten().all(|&margin| margin >= 0.0)
}
