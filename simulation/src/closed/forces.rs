//! Computes the forces of closed contacts with known modes.

use hodograph::{ContactError, ContactMode, contact_force};
use nalgebra::{DVector, Vector2, Vector3};
use smallvec::SmallVec;

use crate::closed::closed_contacts::ClosedContacts;
use crate::contact_problem::{self, Admissible, Mode, Problem, UNHELD, Wanted};

/// The lists of so many contacts need no memory from the heap.
const FEW: usize = 4;

/// Sliding contacts jam where [`Forces::f`] is below this: their forces grow without bound as it falls to zero.
pub(crate) const JAM: f64 = 1e-6;

/// A contact that jams is not pressed if its force is at most this part of the greatest one.
const UNPRESSED: f64 = 1e-9;

/// The mode of a closed contact during the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    /// no slip
    Stick,
    /// slip along a direction of length one
    Slide(Vector2<f64>),
}

impl Hold {
    /// The direction of slip.
    pub fn direction(&self) -> Option<Vector2<f64>> {
        match self {
            Self::Stick => None,
            Self::Slide(direction) => Some(*direction),
        }
    }
}

/// Forces and accelerations of all closed contacts.
#[derive(Clone, Debug)]
pub(crate) struct Forces {
    /// n, t, s of each.
    pub lambda: DVector<f64>,
    /// W lambda + beta.
    pub acceleration: DVector<f64>,
    /// Whether the forces are unique for this motion.
    pub unique: bool,
    /// The distance from a jam ([`contact_problem::Admissible::f`]): f / m_nn of one sliding contact; 1 without.
    pub f: f64,
    /// Forces up to this are rounding errors, N.
    pub rounding: f64,
    /// The greatest acceleration of a contact without contact forces.
    pub free: f64,
}

impl Forces {
    /// The rates of the speeds under these forces (p).
    pub fn rates(&self, support: &ClosedContacts) -> DVector<f64> {
        &support.response * &self.lambda
    }

    /// The force of a contact.
    pub fn of(&self, i: usize) -> Vector3<f64> {
        ClosedContacts::three(&self.lambda, i)
    }
}

/// Why there are no forces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lacking {
    /// The contact with this index among the closed ones has none.
    Contact(usize, ContactError<f64>),
    /// No forces of all contacts are compatible with their modes.
    Common,
}

/// Forces under which sticking contacts do not accelerate and sliding ones do not separate. If many forces
/// give the same motion, the analytic centre of those that the laws allow is taken ([`contact_problem`]);
/// `guess` only saves work. With [`Wanted::Motion`] and [`Wanted::Acceleration`] any of these forces may be returned if no
/// contact slips.
pub(crate) fn forces(
    support: &ClosedContacts,
    holds: &[Hold],
    mu: &[f64],
    guess: Option<&DVector<f64>>,
    wanted: Wanted,
) -> Result<Forces, Lacking> {
    if support.is_idle() {
        let none = DVector::zeros(3 * holds.len());
        let rounding = support.least_force();
        return Ok(Forces {
            lambda: none.clone(),
            acceleration: none,
            unique: true,
            f: 1.0,
            rounding,
            free: support.beta.amax(),
        });
    }
    if let [hold] = holds {
        return single(support, *hold, mu[0]);
    }
    let (slips, modes) = (slips(holds), modes(holds));
    let problem = support.problem(mu, &slips);
    let mut found = contact_problem::found(&problem, &modes, guess, wanted).map_err(|_| Lacking::Common)?;
    if !found.force.iter().all(|value| value.is_finite()) {
        return Err(Lacking::Common);
    }
    if found.f <= 0.0 {
        found = beside_idle(support, &problem, &modes, &found, wanted).ok_or_else(|| {
            let contact = contact_problem::nearest_to_jam(&problem, &modes).unwrap_or(0);
            let free_acceleration = support.beta[3 * contact];
            Lacking::Contact(contact, ContactError::Jam { free_acceleration })
        })?;
    }
    Ok(Forces {
        lambda: found.force,
        acceleration: found.acceleration,
        unique: found.unique,
        f: found.f,
        rounding: support.least_force(),
        free: support.beta.amax(),
    })
}

/// The forces of contacts that jam in these modes, if none of those that jam is pressed or parts: without them nothing jams,
/// and they stay as they are (docs/theory.md, section 17.10).
fn beside_idle(
    support: &ClosedContacts,
    problem: &Problem<'_>,
    modes: &[Mode],
    jammed: &Admissible,
    wanted: Wanted,
) -> Option<Admissible> {
    let least = UNPRESSED * jammed.force.amax() + support.least_force();
    let idle = |i: usize| matches!(modes[i], Mode::Slide(_)) && jammed.force[3 * i].abs() <= least;
    let idle: SmallVec<[usize; FEW]> = (0..modes.len()).filter(|&i| idle(i)).collect();
    let mut rest: SmallVec<[Mode; FEW]> = SmallVec::from_slice(modes);
    idle.iter().for_each(|&i| rest[i] = Mode::Separate);
    let found = contact_problem::found(problem, &rest, None, wanted).ok()?;
    let stays = |&i: &usize| found.acceleration[3 * i].abs() <= support.least_acceleration(i);
    (!idle.is_empty() && found.f > 0.0 && idle.iter().all(stays)).then_some(found)
}

/// The directions of slip of contacts.
fn slips(holds: &[Hold]) -> SmallVec<[Option<Vector2<f64>>; FEW]> {
    holds.iter().map(Hold::direction).collect()
}

/// The modes of contacts in a problem.
fn modes(holds: &[Hold]) -> SmallVec<[Mode; FEW]> {
    holds.iter().map(|hold| hold.direction().map_or(Mode::Stick, Mode::Slide)).collect()
}

/// The sliding contact whose own force grows most towards a jam, by its index; the first one if none slides.
pub(crate) fn nearest_to_jam(support: &ClosedContacts, holds: &[Hold], mu: &[f64]) -> usize {
    let (slips, modes) = (slips(holds), modes(holds));
    contact_problem::nearest_to_jam(&support.problem(mu, &slips), &modes).unwrap_or(0)
}

/// A single contact: solved by the runtime.
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
        rounding: support.least_force(),
        free: support.beta.amax(),
    })
}

/// Those of so many contacts need no memory from the heap.
pub(crate) type Margins = SmallVec<[[f64; 2]; FEW]>;

/// Relative slack of the conditions that end a mode, so that rounding at the boundary does not end it.
pub(crate) const SLACK: f64 = 2e-12;

/// The functions that are positive while the modes last: for each contact lambda_n, and for a sticking one
/// (mu lambda_n)^2 - lambda_tan^2 (else 1). The square has the sign of lambda_n, since nothing is held without
/// pressure. Without friction there is no force to compare: a contact that does not slip must not begin to, so
/// its acceleration along the plane takes the place of the force (theory 17.11).
pub(crate) fn margins(forces: &Forces, holds: &[Hold], mu: &[f64]) -> Margins {
    // The forces of contacts that are not pressed are rounding errors.
    let slack = (SLACK * forces.lambda.amax()).max(forces.rounding);
    holds
        .iter()
        .enumerate()
        .map(|(i, hold)| {
            let force = forces.of(i);
            let cone = match hold {
                Hold::Slide(_) => 1.0,
                Hold::Stick if mu[i] == 0.0 && holds.len() > 1 => {
                    let along = ClosedContacts::three(&forces.acceleration, i).yz().norm();
                    let part = along / forces.free.max(f64::MIN_POSITIVE);
                    forces.lambda.amax().max(forces.rounding).powi(2) * (UNHELD - part)
                }
                Hold::Stick => {
                    let most = mu[i] * force.x;
                    let over = force.y * force.y + force.z * force.z;
                    most * most.abs() * (1.0 + 2.0 * SLACK) + (1.0 + mu[i] * mu[i]) * slack.powi(2) - over
                }
            };
            [force.x + slack, cone]
        })
        .collect()
}

/// The [`margins`] of all contacts, without that of friction where they slide, relative to the largest force, which is
/// not below `least`, N.
pub(crate) fn relative_margins(
    forces: &Forces,
    holds: &[Hold],
    mu: &[f64],
    least: f64,
) -> SmallVec<[f64; 2 * FEW]> {
    let size = forces.lambda.amax().max(least);
    let of = |(&[normal, cone], hold): (&[f64; 2], &Hold)| match hold {
        Hold::Slide(_) => [Some(normal / size), None],
        Hold::Stick => [Some(normal / size), Some(cone / (size * size))],
    };
    margins(forces, holds, mu).iter().zip(holds).flat_map(of).flatten().collect()
}

/// Whether all conditions of the modes are satisfied.
pub(crate) fn hold_good(forces: &Forces, holds: &[Hold], mu: &[f64]) -> bool {
    margins(forces, holds, mu).iter().flatten().all(|&margin| margin >= 0.0)
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// A foot in a plane stands on its toe, with hardly any force at its heel: friction of both stays inside
    /// its cone if there are such forces. When the heel was given a thousandth of the toe's weight, its
    /// friction was exhausted earlier than that of the foot, and it seemed to slip.
    #[test]
    fn heel_and_toe_share_friction_within_their_cones() {
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
                partials: partials.transpose(),
                response: response.clone(),
                velocity: DVector::zeros(6),
                noise: DVector::zeros(6),
            };
            let holds = [Hold::Stick, Hold::Stick];
            let found = forces(&support, &holds, &[0.63; 2], None, Wanted::Centre).unwrap();
            assert!(
                !found.unique
                    && (found.lambda[0] - heel).abs() < 1e-9
                    && (found.lambda[3] - 274.0).abs() < 1e-9
            );
            assert!(hold_good(&found, &holds, &[0.63; 2]), "{heel}: {}", found.lambda);
            assert!((found.lambda[1] + found.lambda[4] + 70.0).abs() < 1e-9);
        }
    }
}
