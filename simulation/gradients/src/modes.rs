//! The modes of closed contacts, and the forces in known modes: such that sticking contacts do not accelerate and
//! sliding contacts do not separate.
//!
//! Theory: docs/theory.md, section 19.1.

use hodograph::generated::hypot;
use hodograph::{Contacts, Mechanism, State, StateError};
use hodograph_simulation::{ClosedPart, Guard, SmoothPart};
use nalgebra::{DMatrix, DVector, Dyn, FullPivLU};

use crate::Reason;
use crate::field::{At, ContactTerms, Field};

/// The mode of a closed contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ModeKind {
    Stick,
    Slide {
        /// the direction in which slip began
        began: [f64; 2],
        /// slip up to this speed, m/s, has no direction of its own, and takes that in which it began
        slow: f64,
    },
    /// sliding in this direction, independent of the present slip
    Along([f64; 2]),
}

/// A closed contact and its mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mode {
    pub contact: usize,
    pub kind: ModeKind,
}

/// Slip below this part of the terms of the contact velocity, or of the velocity that all kinetic energy would give the
/// contact, has no direction of its own.
const NO_DIRECTION: f64 = 1e-10;
/// This many roundings of a direction of slip, or of a derivative, are no error.
pub(crate) const ROUNDINGS: f64 = 64.0;
/// Relative to the greatest mobility of all contacts: an axis with less mobility cannot move.
const IMMOBILE: f64 = 1e-13;
/// Relative to the greatest pivot: a smaller pivot means that the forces are not unique.
const SINGULAR: f64 = 1e-9;

/// An unknown force: along one axis of a sticking contact, or the normal force of a sliding contact together
/// with its friction.
pub(crate) struct Unknown {
    /// index among the closed contacts, and the axis of the equation: 0 along the normal
    pub place: usize,
    pub axis: usize,
    /// `None` for a force without friction of its own
    pub slip: Option<Slip>,
}

/// How a contact slides.
#[derive(Clone, Copy)]
pub(crate) struct Slip {
    pub mu: f64,
    /// direction
    pub along: [f64; 2],
    /// the speed, m/s, if the direction is that of the present slip
    pub speed: Option<f64>,
}

impl Slip {
    /// Friction for a normal force of 1.
    pub fn friction(&self) -> [f64; 2] {
        self.along.map(|part| self.mu * part)
    }
}

/// The forces of the closed contacts in known modes.
pub(crate) struct Balance {
    pub unknowns: Vec<Unknown>,
    /// response of the speeds to each unknown
    pub columns: Vec<Vec<f64>>,
    /// the matrix that takes the unknowns to the accelerations which must vanish, and its factors
    pub matrix: DMatrix<f64>,
    pub solver: FullPivLU<f64, Dyn, Dyn>,
    /// the unknowns
    pub lambda: DVector<f64>,
    /// what the forces add to the rates of the speeds
    pub pushed: Vec<f64>,
}

impl Balance {
    /// Index of the partial velocity of a speed in the equation of an unknown.
    pub fn row(&self, contact_terms: &ContactTerms, i: usize, speed: usize) -> usize {
        contact_terms.partial(self.unknowns[i].place, self.unknowns[i].axis, speed)
    }
}

impl Field<'_> {
    /// The modes during a part.
    pub fn modes(&self, part: &SmoothPart) -> Vec<Mode> {
        let at = |time, state: &[f64], ask: &dyn Fn(&State<'_>) -> Option<f64>| {
            let (coordinates, speeds) = state.split_at(self.n);
            ask(&State { time, coordinates, speeds, inputs: &part.inputs }).unwrap_or(0.0)
        };
        let energy = |state: &State<'_>| self.mechanism.kinetic_energy(state).ok();
        let kind = |closed: &ClosedPart| match closed.slides {
            None => ModeKind::Stick,
            Some(began) => {
                let mobility = |state: &State<'_>| {
                    let reduced = self.mechanism.contact_state(closed.contact, state).ok()?.reduced;
                    Some(reduced.tt.max(reduced.ss))
                };
                let energy = at(part.start, &part.first, &energy).max(at(part.end, &part.last, &energy));
                let greatest = 2.0 * energy * at(part.start, &part.first, &mobility);
                ModeKind::Slide { began, slow: NO_DIRECTION * greatest.max(0.0).sqrt() }
            }
        };
        part.closed.iter().map(|closed| Mode { contact: closed.contact, kind: kind(closed) }).collect()
    }

    /// The modes during the last part of slip: its direction at the start of the part goes on to its end, where it has none. The
    /// state there is that with which derivatives came: slip that slow has the direction of the errors of its integration,
    /// in which it has settled.
    pub fn modes_to_stop(&self, part: &SmoothPart, state: &[f64]) -> Result<Vec<Mode>, Reason> {
        let mut modes = self.modes(part);
        let Some(Guard::Slip(stopped)) = &part.ended_by else { return Ok(modes) };
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let none = vec![0.0; part.first.len() * self.k];
        let directions = |state: &[f64]| -> Result<Vec<Option<[f64; 2]>>, Reason> {
            let at = At { state, ..self.at_start(part, &none) };
            let terms = self.contact_terms(&contacts, &at).map_err(Reason::State)?;
            Ok(Field::directions(&modes, &terms, &state[self.n..]))
        };
        let (own, came) = (directions(&part.first)?, directions(state)?);
        for (mode, found) in modes.iter_mut().zip(own.into_iter().zip(came)) {
            if let (true, (Some(own), Some(came))) = (stopped.contains(&mode.contact), found) {
                let forward = own[0] * came[0] + own[1] * came[1] > 0.0;
                mode.kind = ModeKind::Along(if forward { came } else { own });
            }
        }
        Ok(modes)
    }

    /// The rounding of the directions of slip in a state, rad. Derivatives along the slip turn with it.
    pub fn rounding_of_directions(&self, modes: &[Mode], at: &At<'_>) -> Result<f64, Reason> {
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let terms = self.contact_terms(&contacts, at).map_err(Reason::State)?;
        let of = |(place, mode): (usize, &Mode)| -> f64 {
            let slow = match mode.kind {
                ModeKind::Stick => return 0.0,
                ModeKind::Slide { slow, .. } => slow,
                ModeKind::Along(_) => 0.0,
            };
            let slip = [1, 2].map(|axis| terms.value(terms.velocity(place, axis)));
            let slip = hypot(slip[0], slip[1]);
            let size: f64 = (0..3).map(|axis| terms.velocity_size(place, axis, &at.state[self.n..])).sum();
            if slip > slow { f64::EPSILON * size / slip } else { 0.0 }
        };
        Ok(ROUNDINGS * modes.iter().enumerate().map(of).fold(0.0, f64::max))
    }

    /// The forces in these modes.
    pub fn balance(
        &self,
        modes: &[Mode],
        contact_terms: &ContactTerms,
        speeds: &[f64],
    ) -> Result<Balance, Reason> {
        let p = self.p;
        let rows = constrained_rows(contact_terms, modes, p);
        let mut unknowns = Vec::new();
        for (place, mode) in modes.iter().enumerate() {
            match direction(contact_terms, place, mode.kind, speeds) {
                None => {
                    let own = rows.iter().filter(|(other, _)| *other == place);
                    unknowns.extend(own.map(|&(place, axis)| Unknown { place, axis, slip: None }));
                }
                Some((along, speed)) => {
                    let mu = self.surface(mode.contact).ok_or(Reason::ModesChanged)?.mu;
                    unknowns.push(Unknown { place, axis: 0, slip: Some(Slip { mu, along, speed }) });
                }
            }
        }
        let column = |unknown: &Unknown| -> Vec<f64> {
            let response =
                |axis, speed| contact_terms.value(contact_terms.response(unknown.place, axis, speed));
            let of = |speed| {
                let friction = unknown.slip.iter().flat_map(Slip::friction).enumerate();
                friction
                    .fold(response(unknown.axis, speed), |sum, (axis, f)| sum - f * response(1 + axis, speed))
            };
            (0..p).map(of).collect()
        };
        let columns: Vec<Vec<f64>> = unknowns.iter().map(column).collect();
        let m = unknowns.len();
        let partial = |i: usize, speed| {
            contact_terms.value(contact_terms.partial(unknowns[i].place, unknowns[i].axis, speed))
        };
        let matrix =
            DMatrix::from_fn(m, m, |i, j| (0..p).map(|speed| partial(i, speed) * columns[j][speed]).sum());
        let free = |i: usize| contact_terms.value(contact_terms.free(unknowns[i].place, unknowns[i].axis));
        let right = DVector::from_fn(m, |i, _| -free(i));
        let solver = factors(matrix.clone())?;
        let lambda = if m == 0 { Some(right) } else { solver.solve(&right) };
        let lambda = lambda.ok_or(Reason::State(StateError::NotFinite))?;
        let pushed = (0..p).map(|speed| (0..m).map(|j| columns[j][speed] * lambda[j]).sum()).collect();
        Ok(Balance { unknowns, columns, matrix, solver, lambda, pushed })
    }

    /// The direction of slip of each closed contact; `None` if it sticks.
    pub fn directions(modes: &[Mode], contact_terms: &ContactTerms, speeds: &[f64]) -> Vec<Option<[f64; 2]>> {
        let of = |(place, mode): (usize, &Mode)| direction(contact_terms, place, mode.kind, speeds);
        modes.iter().enumerate().map(|found| of(found).map(|(along, _)| along)).collect()
    }
}

/// The components of contact velocities that the modes keep at zero: index of the contact, and axis.
pub(crate) fn constrained_rows(
    contact_terms: &ContactTerms,
    modes: &[Mode],
    p: usize,
) -> Vec<(usize, usize)> {
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
pub(crate) fn factors(matrix: DMatrix<f64>) -> Result<FullPivLU<f64, Dyn, Dyn>, Reason> {
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
        ModeKind::Slide { began, slow } => {
            let slip = [1, 2].map(|axis| contact_terms.value(contact_terms.velocity(place, axis)));
            let speed = hypot(slip[0], slip[1]);
            let size =
                (0..3).map(|axis| contact_terms.velocity_size(place, axis, speeds)).fold(0.0, f64::max);
            if speed > slow.max(NO_DIRECTION * size) {
                Some((slip.map(|part| part / speed), Some(speed)))
            } else {
                Some((began, None))
            }
        }
    }
}
