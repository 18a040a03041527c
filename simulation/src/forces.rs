//! Solves for the forces of closed contacts whose modes are known.

use hodograph::{ContactError, ContactMode, contact_force};
use nalgebra::{DMatrix, DVector, Vector2, Vector3};

use crate::closed_contacts::{ClosedContacts, least_squares, null_space, solve};

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

/// Forces under which sticking contacts do not accelerate and sliding ones do not part. Where the support is
/// overdetermined they are shared so that the sum of lambda^2 over the `weights` of the contacts is least:
/// weights are normal forces, so that all contacts use their friction alike.
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
    let mut lambda = &push * z;
    if !unique {
        share_friction(support, &columns, mu, &mut lambda);
    }
    let acceleration = &support.coupled * &lambda + &support.beta;
    let left = (0..m).map(|a| acceleration[row(a)].abs()).fold(0.0, f64::max);
    let size = support.beta.amax() + (support.coupled.abs() * lambda.abs()).amax();
    if !lambda.iter().all(|value| value.is_finite()) || left > INCONSISTENT * size {
        return Err(Lacking::Together);
    }
    Ok(Forces { lambda, acceleration, unique, f: 1.0 })
}

/// Shares the friction of sticking contacts anew among those that can take it from each other, as the heel
/// and the toe of a foot can, in proportion to what each may have: the sum of friction^2 / (mu lambda_n) is
/// least. Normal forces and accelerations stay the same.
fn share_friction(
    support: &ClosedContacts,
    columns: &[(usize, usize)],
    mu: &[f64],
    lambda: &mut DVector<f64>,
) {
    let tangential: Vec<(usize, usize)> = columns.iter().copied().filter(|&(_, axis)| axis > 0).collect();
    let row = |(i, axis): (usize, usize)| 3 * i + axis;
    let matrix = DMatrix::from_fn(columns.len(), tangential.len(), |a, b| {
        support.coupled[(row(columns[a]), row(tangential[b]))]
    });
    let free = null_space(&matrix);
    if free.ncols() == 0 {
        return;
    }
    let most: Vec<f64> = tangential.iter().map(|&(i, _)| mu[i] * lambda[3 * i]).collect();
    let greatest = most.iter().copied().fold(0.0, f64::max);
    if greatest <= 0.0 {
        return;
    }
    let weigh = |j: usize| 1.0 / (most[j] / greatest).max(LEAST_SHARE).sqrt();
    let weighed = DMatrix::from_fn(free.nrows(), free.ncols(), |j, k| weigh(j) * free[(j, k)]);
    let right = DVector::from_fn(free.nrows(), |j, _| -weigh(j) * lambda[row(tangential[j])]);
    let change = &free * least_squares(&weighed, &right);
    for (&place, change) in tangential.iter().zip(change.iter()) {
        lambda[row(place)] += change;
    }
}

/// Below this ratio to the greatest a share of friction counts as this.
const LEAST_SHARE: f64 = 1e-10;

/// The forces of an overdetermined support with nearly their own normal forces as weights, so that all
/// contacts use their friction alike, and the weights with which they were found; `weights` are a first
/// guess.
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

/// What must stay positive while the modes last: per contact lambda_n, and (mu lambda_n)^2 - lambda_tan^2 of
/// one that sticks (else 1).
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A foot in a plane that stands on its toe, with hardly a force at its heel: both use their friction
    /// alike. Where the heel was given a thousandth of the toe's weight, its friction was used up when
    /// that of the foot was not, and it seemed to slip.
    #[test]
    fn heel_and_toe_use_their_friction_alike() {
        let point = |x: f64, z: f64| [[0.0, 1.0, -x], [1.0, 0.0, z], [0.0, 0.0, 0.0]];
        let rows: Vec<f64> =
            [point(-0.07, -0.05), point(0.13, -0.05)].into_iter().flatten().flatten().collect();
        let partials = DMatrix::from_row_slice(6, 3, &rows);
        let inverse = DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 2.0, 600.0]));
        let response = &inverse * partials.transpose();
        let coupled = &partials * &response;
        for heel in [1e-4, 0.1, 100.0] {
            let wanted = DVector::from_vec(vec![heel, -20.0, 0.0, 274.0, -50.0, 0.0]);
            let support = ClosedContacts {
                contacts: vec![0, 1],
                beta: -(&coupled * &wanted),
                coupled: coupled.clone(),
                partials: partials.clone(),
                response: response.clone(),
                velocity: DVector::zeros(6),
            };
            let found = forces(&support, &[Hold::Stick, Hold::Stick], &[0.63; 2], Some(&[1.0, 1.0])).unwrap();
            assert!(
                !found.unique
                    && (found.lambda[0] - heel).abs() < 1e-9
                    && (found.lambda[3] - 274.0).abs() < 1e-9
            );
            let (first, second) = (found.lambda[1] / found.lambda[0], found.lambda[4] / found.lambda[3]);
            assert!((first / second - 1.0).abs() < 1e-6, "{heel}: {first} {second}");
            assert!((found.lambda[1] + found.lambda[4] + 70.0).abs() < 1e-9);
        }
    }
}
