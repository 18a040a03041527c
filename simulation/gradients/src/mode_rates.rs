//! The rates of a motion in known modes of its closed contacts, with derivatives along directions.
//!
//! Theory: docs/theory.md, section 19.1.

use hodograph::StateError;
use nalgebra::DMatrix;

use crate::Reason;
use crate::field::{At, ContactTerms, Field};
use crate::modes::{Balance, Mode, Slip, Unknown, constrained_rows, factors};

/// A number with its derivatives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Number {
    pub value: f64,
    pub by: Vec<f64>,
}

/// Rates in known modes, and the contact forces.
pub(crate) struct ModeRates {
    /// rates of coordinates and speeds, and their derivatives (n + p rows, k columns)
    pub rates: Vec<f64>,
    pub rates_by: Vec<f64>,
    /// magnitudes of the terms of the rates, and of those of their derivatives
    pub terms: Vec<f64>,
    pub terms_by: Vec<f64>,
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
        let speeds = &at.state[n..];
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let contact_terms = self.contact_terms(&contacts, at).map_err(Reason::State)?;
        let mut rates: Vec<f64> = (0..n + p).map(|index| contact_terms.value(index)).collect();
        let mut rates_by: Vec<f64> = (0..n + p).flat_map(|index| contact_terms.by(index).to_vec()).collect();
        let mut terms: Vec<f64> = rates.iter().map(|rate| rate.abs()).collect();
        let mut terms_by: Vec<f64> = rates_by.iter().map(|by| by.abs()).collect();
        let nothing = || Number { value: 0.0, by: vec![0.0; k] };
        let mut forces: Vec<[Number; 3]> = modes.iter().map(|_| [nothing(), nothing(), nothing()]).collect();
        let directions = Field::directions(modes, &contact_terms, speeds);
        if modes.is_empty() {
            return Ok(ModeRates { rates, rates_by, terms, terms_by, forces, directions, contact_terms });
        }
        let balance = self.balance(modes, &contact_terms, speeds)?;
        let Balance { unknowns, columns, lambda, pushed, solver, .. } = &balance;
        let m = unknowns.len();
        let friction_by: Vec<[Vec<f64>; 2]> =
            unknowns.iter().map(|unknown| self.friction_by(modes, &contact_terms, unknown)).collect();
        let columns_by: Vec<Vec<Vec<f64>>> = unknowns
            .iter()
            .zip(&friction_by)
            .map(|(unknown, by)| self.column_by(&contact_terms, unknown, by))
            .collect();
        let mut right_by = DMatrix::zeros(m, k);
        let mut pushed_by = vec![0.0; p * k];
        for (speed, row) in pushed_by.chunks_exact_mut(k).enumerate() {
            for (column, lambda) in columns_by.iter().zip(lambda.iter()) {
                row.iter_mut().zip(&column[speed]).for_each(|(sum, by)| *sum += by * lambda);
            }
        }
        for i in 0..m {
            let beta = contact_terms.by(contact_terms.free(unknowns[i].place, unknowns[i].axis));
            for d in 0..k {
                let change: f64 = (0..p)
                    .map(|speed| {
                        let index = balance.row(&contact_terms, i, speed);
                        contact_terms.by(index)[d] * pushed[speed]
                            + contact_terms.value(index) * pushed_by[speed * k + d]
                    })
                    .sum();
                right_by[(i, d)] = -beta[d] - change;
            }
        }
        let lambda_by = solver.solve(&right_by).ok_or(Reason::State(StateError::NotFinite))?;
        for speed in 0..p {
            rates[n + speed] += pushed[speed];
            terms[n + speed] += (0..m).map(|j| (columns[j][speed] * lambda[j]).abs()).sum::<f64>();
            for d in 0..k {
                let more = (0..m).map(|j| columns[j][speed] * lambda_by[(j, d)]);
                let (by, terms) = (&mut rates_by[(n + speed) * k + d], &mut terms_by[(n + speed) * k + d]);
                *by += pushed_by[speed * k + d] + more.clone().sum::<f64>();
                *terms += pushed_by[speed * k + d].abs() + more.map(f64::abs).sum::<f64>();
            }
        }
        for (j, unknown) in unknowns.iter().enumerate() {
            let own = Number { value: lambda[j], by: lambda_by.row(j).iter().copied().collect() };
            let friction = unknown.slip.iter().flat_map(Slip::friction);
            for (axis, (friction, friction_by)) in friction.zip(&friction_by[j]).enumerate() {
                let by = friction_by.iter().zip(&own.by).map(|(f, l)| -(f * own.value + friction * l));
                forces[unknown.place][1 + axis] = Number { value: -friction * own.value, by: by.collect() };
            }
            forces[unknown.place][unknown.axis] = own;
        }
        Ok(ModeRates { rates, rates_by, terms, terms_by, forces, directions, contact_terms })
    }

    /// Derivatives of a state in which the derivatives of the speeds are projected, with the least kinetic
    /// energy, so that closed contacts do not separate, and sticking ones do not slip; and the sizes of their terms.
    pub fn project(&self, modes: &[Mode], at: &At<'_>) -> Result<(Vec<f64>, Vec<f64>), Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let mut by = at.by.to_vec();
        let mut sizes: Vec<f64> = by.iter().map(|by| by.abs()).collect();
        if modes.is_empty() {
            return Ok((by, sizes));
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
                let place = (n + speed) * k + d;
                for change in (0..rows.len()).map(|i| response(i, speed) * impulses[(i, d)]) {
                    by[place] -= change;
                    sizes[place] += change.abs();
                }
            }
        }
        Ok((by, sizes))
    }

    /// Derivatives of the friction of a sliding contact for a normal force of 1.
    fn friction_by(&self, modes: &[Mode], contact_terms: &ContactTerms, unknown: &Unknown) -> [Vec<f64>; 2] {
        let (Some(Slip { mu, along, speed }), place) = (unknown.slip, unknown.place) else {
            return [Vec::new(), Vec::new()];
        };
        // The direction of slip changes with the perpendicular component of the change of slip.
        let across = |d: usize| match speed {
            Some(speed) => {
                let change = [1, 2].map(|axis| contact_terms.by(contact_terms.velocity(place, axis))[d]);
                let part = along[0] * change[1] - along[1] * change[0];
                [-along[1] * part / speed, along[0] * part / speed]
            }
            None => [0.0, 0.0],
        };
        [0, 1].map(|axis| {
            let by = |d| self.by_friction(d, modes[place].contact) * along[axis] + mu * across(d)[axis];
            (0..self.k).map(by).collect()
        })
    }

    /// Derivatives of the response of the speeds to an unknown.
    fn column_by(
        &self,
        contact_terms: &ContactTerms,
        unknown: &Unknown,
        friction_by: &[Vec<f64>; 2],
    ) -> Vec<Vec<f64>> {
        let response = |axis: usize, speed: usize| contact_terms.response(unknown.place, axis, speed);
        let of = |speed: usize| {
            let mut sum = contact_terms.by(response(unknown.axis, speed)).to_vec();
            let friction = unknown.slip.iter().flat_map(Slip::friction);
            for (axis, (friction, friction_by)) in friction.zip(friction_by).enumerate() {
                let response = response(1 + axis, speed);
                let (value, by) = (contact_terms.value(response), contact_terms.by(response));
                for (sum, (f, r)) in sum.iter_mut().zip(friction_by.iter().zip(by)) {
                    *sum -= f * value + friction * r;
                }
            }
            sum
        };
        (0..self.p).map(of).collect()
    }
}
