//! The rates of a motion in known modes of its closed contacts, with derivatives: the forces are those under which
//! sticking contacts do not accelerate and sliding ones do not part.
//!
//! Theory: docs/theory.md, section 19.1.

use hodograph::StateError;
use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};

use crate::Reason;
use crate::field::{At, Field, Together};

/// What a closed contact does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Hold {
    Stick,
    /// it slides; where slip is too small to have a direction, along this one
    Slide([f64; 2]),
    /// it slides along this direction, whatever its slip is
    Along([f64; 2]),
}

/// A closed contact and what it does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mode {
    pub contact: usize,
    pub hold: Hold,
}

/// Slip of this part of the speeds that make it up has no direction of its own.
const NO_DIRECTION: f64 = 1e-10;
/// Relative to the greatest mobility of all contacts, an axis along which nothing moves.
const IMMOBILE: f64 = 1e-13;
/// Relative to the greatest pivot, a pivot that vanishes: the forces are not unique.
const SINGULAR: f64 = 1e-9;

/// A number with its derivatives.
#[derive(Clone, Debug, Default)]
pub(crate) struct Number {
    pub value: f64,
    pub by: Vec<f64>,
}

/// An unknown force: of one axis of a contact that sticks, or the normal one of a contact that slides, with its friction.
struct Unknown {
    /// place among the closed contacts, and the axis of the equation: 0 along the normal
    place: usize,
    axis: usize,
    /// mu times the direction of slip, with derivatives: `None` where it has no friction of its own
    friction: Option<[Number; 2]>,
}

/// Rates in known modes, and the forces.
pub(crate) struct Moving {
    /// rates of coordinates and speeds, and their derivatives (n + p rows, k columns)
    pub rates: Vec<f64>,
    pub rates_by: Vec<f64>,
    /// along n, t, s of each closed contact, N
    pub forces: Vec<[Number; 3]>,
    /// the directions of slip of each
    pub directions: Vec<Option<[f64; 2]>>,
    pub together: Together,
}

impl Field<'_> {
    /// The rates in these modes.
    pub fn moving(&self, modes: &[Mode], at: &At<'_>) -> Result<Moving, Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let together = self.together(&contacts, at).map_err(Reason::State)?;
        let mut rates: Vec<f64> = (0..n + p).map(|index| together.value(index)).collect();
        let mut rates_by: Vec<f64> = (0..n + p).flat_map(|index| together.by(index).to_vec()).collect();
        let nothing = || Number { value: 0.0, by: vec![0.0; k] };
        let mut forces: Vec<[Number; 3]> = modes.iter().map(|_| [nothing(), nothing(), nothing()]).collect();
        let directions: Vec<Option<[f64; 2]>> = modes
            .iter()
            .enumerate()
            .map(|(place, mode)| direction(&together, place, mode.hold, &at.state[n..]).map(|found| found.0))
            .collect();
        if modes.is_empty() {
            return Ok(Moving { rates, rates_by, forces, directions, together });
        }
        let unknowns = self.unknowns(modes, &together, &at.state[n..])?;
        let m = unknowns.len();
        // Columns: the response of the speeds to each unknown.
        let columns: Vec<Vec<Number>> =
            unknowns.iter().map(|unknown| self.column(&together, unknown)).collect();
        let row = |i: usize, speed: usize| together.partial(unknowns[i].place, unknowns[i].axis, speed);
        let matrix = DMatrix::from_fn(m, m, |i, j| {
            (0..p).map(|speed| together.value(row(i, speed)) * columns[j][speed].value).sum()
        });
        let free = |i: usize| together.free(unknowns[i].place, unknowns[i].axis);
        let right = DVector::from_fn(m, |i, _| -together.value(free(i)));
        let solver = unique(matrix)?;
        let unsolved = || Reason::State(StateError::NotFinite);
        let lambda = solver.solve(&right).ok_or_else(unsolved)?;
        // The accelerations by the forces.
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
            let beta = together.by(free(i));
            for d in 0..k {
                let change: f64 = (0..p)
                    .map(|speed| {
                        let index = row(i, speed);
                        together.by(index)[d] * pushed[speed]
                            + together.value(index) * pushed_by[speed * k + d]
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
        Ok(Moving { rates, rates_by, forces, directions, together })
    }

    /// Derivatives of a state whose speeds follow, so that contacts do not part, and do not slip where they stick: by the
    /// least change of kinetic energy.
    pub fn hold(&self, modes: &[Mode], at: &At<'_>) -> Result<Vec<f64>, Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let mut by = at.by.to_vec();
        if modes.is_empty() {
            return Ok(by);
        }
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let together = self.together(&contacts, at).map_err(Reason::State)?;
        let rows = held_rows(&together, modes, p);
        let partial = |i: usize, speed: usize| together.value(together.partial(rows[i].0, rows[i].1, speed));
        let response =
            |i: usize, speed: usize| together.value(together.response(rows[i].0, rows[i].1, speed));
        let matrix = DMatrix::from_fn(rows.len(), rows.len(), |i, j| {
            (0..p).map(|speed| partial(i, speed) * response(j, speed)).sum()
        });
        let right =
            DMatrix::from_fn(rows.len(), k, |i, d| together.by(together.velocity(rows[i].0, rows[i].1))[d]);
        let impulses = unique(matrix)?.solve(&right).ok_or(Reason::ForcesNotUnique)?;
        for speed in 0..p {
            for d in 0..k {
                let change: f64 = (0..rows.len()).map(|i| response(i, speed) * impulses[(i, d)]).sum();
                by[(n + speed) * k + d] -= change;
            }
        }
        Ok(by)
    }

    fn unknowns(&self, modes: &[Mode], together: &Together, speeds: &[f64]) -> Result<Vec<Unknown>, Reason> {
        let rows = held_rows(together, modes, self.p);
        let mut unknowns = Vec::new();
        for (place, mode) in modes.iter().enumerate() {
            match direction(together, place, mode.hold, speeds) {
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
                    // A direction of slip turns by the part of a change across it.
                    let across = |d: usize| match speed {
                        Some(speed) => {
                            let change = [1, 2].map(|axis| together.by(together.velocity(place, axis))[d]);
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
    fn column(&self, together: &Together, unknown: &Unknown) -> Vec<Number> {
        let place = unknown.place;
        let number = |axis: usize, speed: usize| {
            let index = together.response(place, axis, speed);
            Number { value: together.value(index), by: together.by(index).to_vec() }
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

/// The components of velocities that closed contacts keep at zero: place and axis.
fn held_rows(together: &Together, modes: &[Mode], p: usize) -> Vec<(usize, usize)> {
    let mobility = |&(place, axis): &(usize, usize)| -> f64 {
        let term = |speed| {
            together.value(together.partial(place, axis, speed))
                * together.value(together.response(place, axis, speed))
        };
        (0..p).map(term).sum()
    };
    let all = (0..modes.len()).flat_map(|place| (0..3).map(move |axis| (place, axis)));
    let greatest = all.clone().map(|row| mobility(&row)).fold(0.0, f64::max);
    // In a plane nothing moves along the third axis.
    let held = |row: &(usize, usize)| {
        let sticks = modes[row.0].hold == Hold::Stick;
        row.1 == 0 || (sticks && mobility(row) > IMMOBILE * greatest)
    };
    all.filter(held).collect()
}

/// The factors of a matrix that is not singular.
fn unique(matrix: DMatrix<f64>) -> Result<FullPivLU<f64, Dyn, Dyn>, Reason> {
    let solver = matrix.full_piv_lu();
    let pivots = solver.u().diagonal().abs();
    let singular = !pivots.is_empty() && pivots.min() <= SINGULAR * pivots.max();
    if singular { Err(Reason::ForcesNotUnique) } else { Ok(solver) }
}

/// The direction in which a contact slides, and its speed where the direction follows from it; `None` while it sticks.
fn direction(
    together: &Together,
    place: usize,
    hold: Hold,
    speeds: &[f64],
) -> Option<([f64; 2], Option<f64>)> {
    match hold {
        Hold::Stick => None,
        Hold::Along(direction) => Some((direction, None)),
        Hold::Slide(began) => {
            let slip = [1, 2].map(|axis| together.value(together.velocity(place, axis)));
            let speed = slip[0].hypot(slip[1]);
            let size = (0..3).map(|axis| together.velocity_size(place, axis, speeds)).fold(0.0, f64::max);
            if speed > NO_DIRECTION * size {
                Some((slip.map(|part| part / speed), Some(speed)))
            } else {
                Some((began, None))
            }
        }
    }
}
