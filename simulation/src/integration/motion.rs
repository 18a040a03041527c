//! The right-hand side of the integration: the rates of the state for constant modes of all contacts.

use std::borrow::Cow;
use std::cell::RefCell;

use hodograph::{ComponentKind, ContactError, State, StateError};
use nalgebra::{DVector, Vector2};

use crate::Drive;
use crate::closed::angles::Angles;
use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, Lacking, forces};
use crate::closed::pair::Pair;
use crate::closed::phase::Closed;
use crate::closed::settled_direction;
use crate::closed::slip_direction::settle_directions;
use crate::closed::torques::WithTorques;
use crate::contact_problem::Wanted;

/// Slip below this, relative to the terms of the contact velocity, counts as zero.
pub(crate) const NO_SLIP: f64 = 1e-11;
/// Below this speed of slip, relative to the terms of the contact velocity, its direction is the one in which
/// it began.
pub(crate) const DIRECTION: f64 = 1e-10;

/// Why the rates cannot be evaluated.
#[derive(Clone, Debug)]
pub(crate) enum Failure {
    State(StateError),
    Contact(usize, ContactError<f64>),
    /// No forces of all closed contacts are compatible with their modes.
    NoForces,
    /// A function of the surfaces of a contact fails.
    Law(usize, String),
    Input(String),
}

impl From<StateError> for Failure {
    fn from(error: StateError) -> Self {
        Self::State(error)
    }
}

/// The system that is integrated: coordinates, speeds, work of friction, work of inputs.
pub(crate) struct Motion<'a> {
    pub mechanism: WithTorques<'a>,
    pub angles: &'a Angles,
    pub drive: &'a Drive,
    pub surfaces: &'a [Option<Pair>],
    pub held: &'a [f64],
    pub closed: &'a [Closed],
    /// whether the mechanism is at rest, so that the rates are rounding errors
    pub resting: bool,
    /// the greatest speeds so far
    pub scale: &'a [f64],
}

/// The evaluation of a state.
pub(crate) struct Evaluation {
    pub rates: Vec<f64>,
    pub support: ClosedContacts,
    pub holds: Vec<Hold>,
    pub forces: Option<Forces>,
}

/// Work space for evaluations of one motion.
pub(crate) struct Room {
    support: ClosedContacts,
    holds: Vec<Hold>,
    mu: Vec<f64>,
    inputs: Vec<f64>,
    numbers: Vec<f64>,
    /// The forces of the last state, which is nearby; of several contacts.
    last: Option<DVector<f64>>,
}

impl Room {
    /// The closed contacts in the last state, and their modes.
    pub fn contacts(&self) -> (&ClosedContacts, &[Hold]) {
        (&self.support, &self.holds)
    }
}

/// The direction of slip that began along `began`: its own direction if slip is larger than the rounding
/// error of its terms. `now` is their size, `ever` that with the greatest speeds so far: a rounding error
/// that projections leave of slip that begins from zero may be opposite to its direction, even if nothing
/// else moves.
fn direction(
    slip: Vector2<f64>,
    began: Vector2<f64>,
    now: impl Fn() -> f64,
    ever: impl Fn() -> f64,
) -> Vector2<f64> {
    let speed = slip.norm();
    let forward = slip.dot(&began) > 0.0;
    if speed > DIRECTION * now() && (forward || speed > NO_SLIP * ever()) { slip / speed } else { began }
}

/// Keeps these forces for the next state.
fn keep(last: &mut Option<DVector<f64>>, forces: &DVector<f64>) {
    match last {
        Some(last) if last.len() == forces.len() => last.copy_from(forces),
        none => *none = Some(forces.clone()),
    }
}

/// Number of components of the state beyond coordinates and speeds: work of friction and of inputs.
pub(crate) const WORKS: usize = 2;

impl<'a> Motion<'a> {
    /// Coordinates and speeds.
    pub fn split<'y>(&self, y: &'y [f64]) -> (&'y [f64], &'y [f64]) {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        (&y[..n], &y[n..n + p])
    }

    /// The inputs in a state.
    pub fn inputs(&self, t: f64, y: &[f64]) -> Result<Cow<'a, [f64]>, Failure> {
        let mut inputs = Cow::Borrowed(self.held);
        if let Drive::Continuous(_) = self.drive {
            self.drive_inputs(t, y, inputs.to_mut())?;
        }
        Ok(inputs)
    }

    /// Replaces constant inputs by those that are functions of time and state.
    fn drive_inputs(&self, t: f64, y: &[f64], inputs: &mut [f64]) -> Result<(), Failure> {
        if let Drive::Continuous(function) = self.drive {
            let (q, u) = self.split(y);
            function(t, q, u, inputs);
            if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
                return Err(Failure::Input(self.bad_input(bad, inputs[bad])));
            }
        }
        Ok(())
    }

    /// The message about an input that is not finite.
    pub fn bad_input(&self, index: usize, value: f64) -> String {
        let name =
            self.mechanism.component(ComponentKind::Input, index).map_or("?", |component| component.name);
        format!("the input {name} is {value}: what drives the mechanism must give finite numbers")
    }

    /// Work space that is reused from one evaluation to the next.
    pub fn room(&self) -> Room {
        let contacts: Vec<usize> = self.closed.iter().map(|closed| closed.contact).collect();
        Room {
            support: ClosedContacts::room(self.mechanism, &contacts),
            holds: Vec::new(),
            mu: Vec::new(),
            inputs: Vec::new(),
            numbers: Vec::new(),
            last: None,
        }
    }

    /// The modes at these velocities.
    pub fn holds(&self, support: &ClosedContacts, speeds: &[f64]) -> Vec<Hold> {
        let mut holds = Vec::with_capacity(self.closed.len());
        self.hold(support, speeds, &mut holds);
        holds
    }

    fn hold(&self, support: &ClosedContacts, speeds: &[f64], holds: &mut Vec<Hold>) {
        holds.clear();
        holds.extend(self.closed.iter().enumerate().map(|(i, closed)| match closed.slides {
            None => Hold::Stick,
            // The direction follows from the state.
            Some(began) if closed.turning.is_some() => Hold::Slide(began),
            Some(began) => Hold::Slide(self.direction(support, i, (support.slip(i), began), speeds)),
        }));
    }

    /// The direction of this slip of a contact, which began along `began`, at these speeds; `support` is the contact
    /// here or nearby.
    pub fn direction(
        &self,
        support: &ClosedContacts,
        i: usize,
        (slip, began): (Vector2<f64>, Vector2<f64>),
        speeds: &[f64],
    ) -> Vector2<f64> {
        let size = |speeds: &[f64]| support.velocity_size(i, speeds);
        direction(slip, began, || size(speeds), || size(self.scale))
    }

    /// The coefficients of friction in these modes at these velocities.
    pub fn rub(&self, support: &ClosedContacts, holds: &[Hold], mus: &mut Vec<f64>) -> Result<(), Failure> {
        mus.clear();
        for (i, (closed, hold)) in self.closed.iter().zip(holds).enumerate() {
            mus.push(match (hold, &self.surfaces[closed.contact]) {
                (Hold::Slide(_), Some(pair)) if !closed.bounces => pair
                    .sliding(support.slip(i).norm())
                    .map_err(|message| Failure::Law(closed.contact, message))?,
                _ => closed.mu,
            });
        }
        Ok(())
    }

    /// Rates and the forces of the closed contacts; if many forces give one motion, their analytic centre.
    pub fn evaluate(&self, t: f64, y: &[f64]) -> Result<Evaluation, Failure> {
        self.evaluated(t, y, None, Wanted::Centre)
    }

    /// The same, starting from approximate forces, which saves work.
    pub fn evaluate_near(&self, t: f64, y: &[f64], guess: Option<&Forces>) -> Result<Evaluation, Failure> {
        self.evaluated(t, y, guess.map(|forces| &forces.lambda), Wanted::Centre)
    }

    /// The same, but if there are many forces of these modes, any of them.
    pub fn estimate(&self, t: f64, y: &[f64]) -> Result<Evaluation, Failure> {
        self.evaluated(t, y, None, Wanted::Any)
    }

    /// Writes the rates to `rates`, and returns any forces with this motion; `room` is the work space of this motion.
    pub fn rates(
        &self,
        t: f64,
        y: &[f64],
        rates: &mut [f64],
        room: &mut Room,
    ) -> Result<Option<Forces>, Failure> {
        self.write_rates(t, y, (None, Wanted::Motion), rates, room)
    }

    fn evaluated(
        &self,
        t: f64,
        y: &[f64],
        guess: Option<&DVector<f64>>,
        wanted: Wanted,
    ) -> Result<Evaluation, Failure> {
        let (mut rates, mut room) = (vec![0.0; y.len()], self.room());
        let forces = self.write_rates(t, y, (guess, wanted), &mut rates, &mut room)?;
        let Room { support, holds, .. } = room;
        Ok(Evaluation { rates, support, holds, forces })
    }

    fn write_rates(
        &self,
        t: f64,
        y: &[f64],
        (guess, wanted): (Option<&DVector<f64>>, Wanted),
        rates: &mut [f64],
        room: &mut Room,
    ) -> Result<Option<Forces>, Failure> {
        let (q, u) = self.split(y);
        let (n, p) = (q.len(), u.len());
        let Room { support, holds, mu, inputs, numbers, last } = room;
        inputs.clear();
        inputs.extend_from_slice(self.held);
        self.drive_inputs(t, y, inputs)?;
        let state = State { time: t, coordinates: q, speeds: u, inputs };
        rates.fill(0.0);
        support.with_rates(self.mechanism, &state, self.angles, rates, numbers)?;
        self.hold(support, u, holds);
        let mut found = None;
        if !holds.is_empty() {
            self.rub(support, holds, mu)?;
            let lacking = |lacking| match lacking {
                Lacking::Contact(i, error) => Failure::Contact(self.closed[i].contact, error),
                Lacking::Common => Failure::NoForces,
            };
            // Where forces are not unique, those of a state nearby, or of directions nearby, are next to them.
            let near = RefCell::new(guess.cloned().or_else(|| last.take()));
            let several = holds.len() > 1;
            let solve = |holds: &[Hold]| {
                let found = forces(support, holds, mu, near.borrow().as_ref(), Wanted::Acceleration)?;
                if several {
                    keep(&mut near.borrow_mut(), &found.lambda);
                }
                Ok(found)
            };
            settle_directions(support, self.closed, holds, &solve);
            settled_direction::settle(support, self.closed, t, holds, &solve).ok_or(Failure::NoForces)?;
            let answer = forces(support, holds, mu, near.borrow().as_ref(), wanted).map_err(lacking)?;
            *last = near.into_inner().filter(|_| several);
            if several {
                keep(last, &answer.lambda);
            }
            let greatest = answer.lambda.amax();
            let accelerations = &mut rates[n..n + p];
            // The sums of the magnitudes of the terms.
            numbers.clear();
            numbers.extend(accelerations.iter().map(|rate| rate.abs()));
            for (response, force) in support.response.as_slice().chunks_exact(p.max(1)).zip(&answer.lambda) {
                for ((rate, size), response) in accelerations.iter_mut().zip(&mut *numbers).zip(response) {
                    *rate += response * force;
                    *size += response.abs() * greatest;
                }
            }
            // Components that friction holds are exactly zero.
            let rounding = if self.resting { 1e-11 } else { 64.0 * f64::EPSILON };
            for (rate, size) in accelerations.iter_mut().zip(numbers.iter()) {
                if rate.abs() <= rounding * size {
                    *rate = 0.0;
                }
            }
            for (i, hold) in holds.iter().enumerate() {
                if let Hold::Slide(_) = hold {
                    let force = answer.of(i);
                    rates[n + p] += Vector2::new(force.y, force.z).dot(&support.slip(i));
                }
            }
            found = Some(answer);
        }
        if inputs.iter().any(|&input| input != 0.0) {
            rates[n + p + 1] = self.input_power(&state, numbers)?;
        }
        Ok(found)
    }

    /// The power of the inputs: the generalised forces that they add, times the speeds; 0 where there are no forces without
    /// them, as of an input that divides. `numbers` is work space.
    fn input_power(&self, state: &State<'_>, numbers: &mut Vec<f64>) -> Result<f64, StateError> {
        let (p, w) = (state.speeds.len(), state.inputs.len());
        numbers.clear();
        numbers.resize(2 * p + w, 0.0);
        let (with, rest) = numbers.split_at_mut(p);
        let (without, none) = rest.split_at_mut(p);
        self.mechanism.forcing(state, with)?;
        if self.mechanism.forcing(&State { inputs: none, ..*state }, without).is_err() {
            return Ok(0.0);
        }
        Ok(with.iter().zip(&*without).zip(state.speeds).map(|((a, b), u)| (a - b) * u).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two links of a chain on a floor came to rest except for 1.5e-14 m/s, which was all that moved. Slip
    /// began in the opposite direction, was immediately taken to go forward, and had to begin again, 2000
    /// times.
    #[test]
    fn slip_goes_the_way_it_began_while_it_is_rounding() {
        let (began, left) = (Vector2::new(-1.0, 0.0), Vector2::new(1.485_565e-14, 0.0));
        let of = |slip, now: f64, ever: f64| direction(slip, began, || now, || ever);
        assert_eq!(of(left, left.norm(), 0.7), began);
        assert_eq!(of(-left, left.norm(), 0.7), began);
        // Slip of rounding errors has the direction in which it began; larger slip has its own.
        assert_eq!(of(-left, 0.7, 0.7), began);
        assert_eq!(of(1e3 * left, 1e3 * left.norm(), 0.7), -began);
        let across = Vector2::new(-3e-6, 4e-6);
        assert!((of(across, 1e-3, 0.7) - Vector2::new(-0.6, 0.8)).norm() < 1e-15);
    }
}
