//! The rates of a motion in known modes of its closed contacts, with derivatives. The forces are such that
//! sticking contacts do not accelerate and sliding contacts do not separate.
//!
//! Theory: docs/theory.md, section 19.1.

use hodograph::StateError;
use hodograph::generated::hypot;
use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};

use crate::Reason;
use crate::field::{At, ContactTerms, Field};

/// The mode of a closed contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ModeKind {
    Stick,
    /// sliding; the direction is used if slip is too small to have one
    Slide([f64; 2]),
    /// sliding in this direction, independent of the present slip
    Along([f64; 2]),
}

/// A closed contact and its mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mode {
    pub contact: usize,
    pub kind: ModeKind,
}

/// Slip below this part of the terms of the contact velocity has no direction of its own.
const NO_DIRECTION: f64 = 1e-10;
/// Relative to the greatest mobility of all contacts: an axis with less mobility cannot move.
const IMMOBILE: f64 = 1e-13;
/// Relative to the greatest pivot: a smaller pivot means that the forces are not unique.
const SINGULAR: f64 = 1e-9;

/// A number with its derivatives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Number {
    pub value: f64,
    pub by: Vec<f64>,
}

/// An unknown force: along one axis of a sticking contact, or the normal force of a sliding contact together
/// with its friction.
struct Unknown {
    /// index among the closed contacts, and the axis of the equation: 0 along the normal
    place: usize,
    axis: usize,
    /// mu times the direction of slip, with derivatives; `None` for a force without friction of its own
    friction: Option<[Number; 2]>,
}

/// Rates in known modes, and the contact forces.
pub(crate) struct ModeRates {
    /// rates of coordinates and speeds, and their derivatives (n + p rows, k columns)
    pub rates: Vec<f64>,
    pub rates_by: Vec<f64>,
    /// along n, t, s of each closed contact, N
    pub forces: Vec<[Number; 3]>,
    /// the direction of slip of each; `None` if it sticks
    pub directions: Vec<Option<[f64; 2]>>,
    pub contact_terms: ContactTerms,
}

impl Field<'_> {
    /// The rates in these modes.
    pub fn mode_rates(&self, modes: &[Mode], at: &At<'_>) -> Result<ModeRates, Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let contact_terms = self.contact_terms(&contacts, at).map_err(Reason::State)?;
        let mut rates: Vec<f64> = (0..n + p).map(|index| contact_terms.value(index)).collect();
        let mut rates_by: Vec<f64> = (0..n + p).flat_map(|index| contact_terms.by(index).to_vec()).collect();
        let nothing = || Number { value: 0.0, by: vec![0.0; k] };
        let mut forces: Vec<[Number; 3]> = modes.iter().map(|_| [nothing(), nothing(), nothing()]).collect();
        let directions: Vec<Option<[f64; 2]>> = modes
            .iter()
            .enumerate()
            .map(|(place, mode)| {
                direction(&contact_terms, place, mode.kind, &at.state[n..]).map(|found| found.0)
            })
            .collect();
        if modes.is_empty() {
            return Ok(ModeRates { rates, rates_by, forces, directions, contact_terms });
        }
        let unknowns = self.unknowns(modes, &contact_terms, &at.state[n..])?;
        let m = unknowns.len();
        // The columns are the responses of the speeds to each unknown.
        let columns: Vec<Vec<Number>> =
            unknowns.iter().map(|unknown| self.column(&contact_terms, unknown)).collect();
        let row = |i: usize, speed: usize| contact_terms.partial(unknowns[i].place, unknowns[i].axis, speed);
        let matrix = DMatrix::from_fn(m, m, |i, j| {
            (0..p).map(|speed| contact_terms.value(row(i, speed)) * columns[j][speed].value).sum()
        });
        let free = |i: usize| contact_terms.free(unknowns[i].place, unknowns[i].axis);
        let right = DVector::from_fn(m, |i, _| -contact_terms.value(free(i)));
        let solver = factors(matrix)?;
        let unsolved = || Reason::State(StateError::NotFinite);
        let lambda = solver.solve(&right).ok_or_else(unsolved)?;
        // The accelerations under the forces.
        let pushed: Vec<f64> =
            (0..p).map(|speed| (0..m).map(|j| columns[j][speed].value * lambda[j]).sum()).collect();
        let mut right_by = DMatrix::zeros(m, k);
        let mut pushed_by = vec![0.0; p * k];
        for (speed, row) in pushed_by.chunks_exact_mut(k).enumerate() {
            for (column, lambda) in columns.iter().zip(lambda.iter()) {
                row.iter_mut().zip(&column[speed].by).for_each(|(sum, by)| *sum += by * lambda);
            }
        }
        for i in 0..m {
            let beta = contact_terms.by(free(i));
            for d in 0..k {
                let change: f64 = (0..p)
                    .map(|speed| {
                        let index = row(i, speed);
                        contact_terms.by(index)[d] * pushed[speed]
                            + contact_terms.value(index) * pushed_by[speed * k + d]
                    })
                    .sum();
                right_by[(i, d)] = -beta[d] - change;
            }
        }
        let lambda_by = solver.solve(&right_by).ok_or_else(unsolved)?;
        for speed in 0..p {
            rates[n + speed] += pushed[speed];
            for d in 0..k {
                let more: f64 = (0..m).map(|j| columns[j][speed].value * lambda_by[(j, d)]).sum();
                rates_by[(n + speed) * k + d] += pushed_by[speed * k + d] + more;
            }
        }
        for (j, unknown) in unknowns.iter().enumerate() {
            let own = Number { value: lambda[j], by: lambda_by.row(j).iter().copied().collect() };
            if let Some(friction) = &unknown.friction {
                for (axis, friction) in friction.iter().enumerate() {
                    let by =
                        friction.by.iter().zip(&own.by).map(|(f, l)| -(f * own.value + friction.value * l));
                    forces[unknown.place][1 + axis] =
                        Number { value: -friction.value * own.value, by: by.collect() };
                }
            }
            forces[unknown.place][unknown.axis] = own;
        }
        Ok(ModeRates { rates, rates_by, forces, directions, contact_terms })
    }

    /// Derivatives of a state in which the derivatives of the speeds are projected, with the least kinetic
    /// energy, so that closed contacts do not separate, and sticking ones do not slip.
    pub fn project(&self, modes: &[Mode], at: &At<'_>) -> Result<Vec<f64>, Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let mut by = at.by.to_vec();
        if modes.is_empty() {
            return Ok(by);
        }
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let contact_terms = self.contact_terms(&contacts, at).map_err(Reason::State)?;
        let rows = constrained_rows(&contact_terms, modes, p);
        let partial =
            |i: usize, speed: usize| contact_terms.value(contact_terms.partial(rows[i].0, rows[i].1, speed));
        let response =
            |i: usize, speed: usize| contact_terms.value(contact_terms.response(rows[i].0, rows[i].1, speed));
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            (0..p).map(|speed| partial(i, speed) * response(j, speed)).sum()
        });
        let right = DMatrix::from_fn(rows.len(), k, |i, d| {
            contact_terms.by(contact_terms.velocity(rows[i].0, rows[i].1))[d]
        });
        let impulses = factors(matrix)?.solve(&right).ok_or(Reason::ForcesNotUnique)?;
        for speed in 0..p {
            for d in 0..k {
                let change: f64 = (0..rows.len()).map(|i| response(i, speed) * impulses[(i, d)]).sum();
                by[(n + speed) * k + d] -= change;
            }
        }
        Ok(by)
    }

    fn unknowns(
        &self,
        modes: &[Mode],
        contact_terms: &ContactTerms,
        speeds: &[f64],
    ) -> Result<Vec<Unknown>, Reason> {
        let rows = constrained_rows(contact_terms, modes, self.p);
        let mut unknowns = Vec::new();
        for (place, mode) in modes.iter().enumerate() {
            match direction(contact_terms, place, mode.kind, speeds) {
                None => {
                    let own = rows.iter().filter(|(other, _)| *other == place);
                    unknowns.extend(own.map(|&(place, axis)| Unknown { place, axis, friction: None }));
                }
                Some((along, speed)) => {
                    let surface = self.surface(mode.contact);
                    let mu = surface.ok_or(Reason::ModesChanged)?.mu;
                    let by_mu = |d: usize| {
                        let is = self.by.get(d).is_some_and(|by| by.is_friction_of(mode.contact));
                        if is { 1.0 } else { 0.0 }
                    };
                    // The direction of slip changes with the perpendicular component of the change of slip.
                    let across = |d: usize| match speed {
                        Some(speed) => {
                            let change =
                                [1, 2].map(|axis| contact_terms.by(contact_terms.velocity(place, axis))[d]);
                            let part = along[0] * change[1] - along[1] * change[0];
                            [-along[1] * part / speed, along[0] * part / speed]
                        }
                        None => [0.0, 0.0],
                    };
                    let friction = [0, 1].map(|axis| Number {
                        value: mu * along[axis],
                        by: (0..self.k).map(|d| by_mu(d) * along[axis] + mu * across(d)[axis]).collect(),
                    });
                    unknowns.push(Unknown { place, axis: 0, friction: Some(friction) });
                }
            }
        }
        Ok(unknowns)
    }

    /// The response of the speeds to an unknown.
    fn column(&self, contact_terms: &ContactTerms, unknown: &Unknown) -> Vec<Number> {
        let place = unknown.place;
        let number = |axis: usize, speed: usize| {
            let index = contact_terms.response(place, axis, speed);
            Number { value: contact_terms.value(index), by: contact_terms.by(index).to_vec() }
        };
        (0..self.p)
            .map(|speed| {
                let mut sum = number(unknown.axis, speed);
                for (axis, friction) in unknown.friction.iter().flatten().enumerate() {
                    let response = number(1 + axis, speed);
                    sum.value -= friction.value * response.value;
                    for (sum, (f, r)) in sum.by.iter_mut().zip(friction.by.iter().zip(&response.by)) {
                        *sum -= f * response.value + friction.value * r;
                    }
                }
                sum
            })
            .collect()
    }
}

/// The components of contact velocities that the modes keep at zero: index of the contact, and axis.
fn constrained_rows(contact_terms: &ContactTerms, modes: &[Mode], p: usize) -> Vec<(usize, usize)> {
    let mobility = |&(place, axis): &(usize, usize)| -> f64 {
        let term = |speed| {
            contact_terms.value(contact_terms.partial(place, axis, speed))
                * contact_terms.value(contact_terms.response(place, axis, speed))
        };
        (0..p).map(term).sum()
    };
    let all = (0..modes.len()).flat_map(|place| (0..3).map(move |axis| (place, axis)));
    let greatest = all.clone().map(|row| mobility(&row)).fold(0.0, f64::max);
    // In plane motion nothing moves along the third axis.
    let held = |row: &(usize, usize)| {
        let sticks = modes[row.0].kind == ModeKind::Stick;
        row.1 == 0 || (sticks && mobility(row) > IMMOBILE * greatest)
    };
    all.filter(held).collect()
}

/// The LU factors of a matrix that is not singular.
fn factors(matrix: DMatrix<f64>) -> Result<FullPivLU<f64, Dyn, Dyn>, Reason> {
    let solver = matrix.full_piv_lu();
    let pivots = solver.u().diagonal().abs();
    let singular = !pivots.is_empty() && pivots.min() <= SINGULAR * pivots.max();
    if singular { Err(Reason::ForcesNotUnique) } else { Ok(solver) }
}

/// The direction in which a contact slides, and the speed of slip if the direction is that of slip; `None` if
/// it sticks.
fn direction(
    contact_terms: &ContactTerms,
    place: usize,
    kind: ModeKind,
    speeds: &[f64],
) -> Option<([f64; 2], Option<f64>)> {
    match kind {
        ModeKind::Stick => None,
        ModeKind::Along(direction) => Some((direction, None)),
        ModeKind::Slide(began) => {
            let slip = [1, 2].map(|axis| contact_terms.value(contact_terms.velocity(place, axis)));
            let speed = hypot(slip[0], slip[1]);
            let size =
                (0..3).map(|axis| contact_terms.velocity_size(place, axis, speeds)).fold(0.0, f64::max);
            if speed > NO_DIRECTION * size {
                Some((slip.map(|part| part / speed), Some(speed)))
            } else {
                Some((began, None))
            }
        }
    }
}
