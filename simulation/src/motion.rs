//! The right-hand side of the integration: the rates of the state while the modes of all contacts stay the
//! same.

use hodograph::{ComponentKind, ContactError, Contacts, State, StateError};
use nalgebra::{DVector, Vector2};

use crate::Drive;
use crate::closed_contacts::ClosedContacts;
use crate::contact_problem::Wanted;
use crate::forces::{Forces, Hold, Lacking, forces};
use crate::pair::Pair;
use crate::phase::Closed;
use crate::slip_direction::settle_directions;

/// Slip below this, relative to the speeds that make it up, is none.
pub(crate) const NO_SLIP: f64 = 1e-11;
/// Below this speed of slip, relative to the speeds that make it up, its direction is the one in which it
/// began.
pub(crate) const DIRECTION: f64 = 1e-10;

/// Why the rates cannot be evaluated.
#[derive(Clone, Debug)]
pub(crate) enum Failure {
    State(StateError),
    Contact(usize, ContactError<f64>),
    /// No forces of all closed contacts fit their modes.
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
    pub mechanism: &'a dyn Contacts<f64>,
    pub drive: &'a Drive,
    pub surfaces: &'a [Option<Pair>],
    pub held: &'a [f64],
    pub closed: &'a [Closed],
    /// Nothing moves: what is left of the rates is rounding.
    pub resting: bool,
    /// the greatest speeds so far
    pub scale: &'a [f64],
}

/// All that is known of a state.
pub(crate) struct Evaluation {
    pub rates: Vec<f64>,
    pub support: ClosedContacts,
    pub holds: Vec<Hold>,
    pub forces: Option<Forces>,
}

/// The direction of slip that began along `began`: its own, where it is more than rounding of the terms that make it
/// up. `now` is their size, `ever` that of the greatest speeds so far: what projections have left of a slip that begins
/// from none may be rounding of those, against the way it goes, although nothing else moves any more.
fn direction(slip: Vector2<f64>, began: Vector2<f64>, now: f64, ever: f64) -> Vector2<f64> {
    let speed = slip.norm();
    let forward = slip.dot(&began) > 0.0;
    if speed > DIRECTION * now && (forward || speed > NO_SLIP * ever) { slip / speed } else { began }
}

/// Numbers of the state beyond coordinates and speeds: work of friction and of inputs.
pub(crate) const WORKS: usize = 2;

impl Motion<'_> {
    /// Coordinates and speeds.
    pub fn split<'y>(&self, y: &'y [f64]) -> (&'y [f64], &'y [f64]) {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        (&y[..n], &y[n..n + p])
    }

    /// The inputs in a state.
    pub fn inputs(&self, t: f64, y: &[f64]) -> Result<Vec<f64>, Failure> {
        let mut inputs = self.held.to_vec();
        if let Drive::Continuous(function) = self.drive {
            let (q, u) = self.split(y);
            function(t, q, u, &mut inputs);
            if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
                return Err(Failure::Input(self.bad_input(bad, inputs[bad])));
            }
        }
        Ok(inputs)
    }

    /// What is said of an input that is no number.
    pub fn bad_input(&self, index: usize, value: f64) -> String {
        let name =
            self.mechanism.component(ComponentKind::Input, index).map_or("?", |component| component.name);
        format!("the input {name} is {value}: what drives the mechanism must give finite numbers")
    }

    /// Modes as they are at these velocities.
    pub fn holds(&self, support: &ClosedContacts, speeds: &[f64]) -> Vec<Hold> {
        self.closed
            .iter()
            .enumerate()
            .map(|(i, closed)| match closed.slides {
                None => Hold::Stick,
                Some(began) => {
                    let (now, ever) =
                        (support.velocity_size(i, speeds), support.velocity_size(i, self.scale));
                    Hold::Slide(direction(support.slip(i), began, now, ever))
                }
            })
            .collect()
    }

    /// The coefficients of friction in these modes at these velocities.
    fn mus(&self, support: &ClosedContacts, holds: &[Hold]) -> Result<Vec<f64>, Failure> {
        let mu = |(i, (closed, hold)): (usize, (&Closed, &Hold))| match (hold, &self.surfaces[closed.contact])
        {
            (Hold::Slide(_), Some(pair)) => {
                pair.sliding(support.slip(i).norm()).map_err(|message| Failure::Law(closed.contact, message))
            }
            _ => Ok(closed.mu),
        };
        self.closed.iter().zip(holds).enumerate().map(mu).collect()
    }

    /// Rates, and the forces of the closed contacts: where many forces give one motion, those in the middle.
    pub fn evaluate(&self, t: f64, y: &[f64]) -> Result<Evaluation, Failure> {
        self.evaluated(t, y, None, Wanted::Centre)
    }

    /// The same from forces that are nearly the answer, which save work.
    pub fn evaluate_near(&self, t: f64, y: &[f64], guess: Option<&Forces>) -> Result<Evaluation, Failure> {
        self.evaluated(t, y, guess.map(|forces| &forces.lambda), Wanted::Centre)
    }

    /// Rates alone.
    pub fn rates(&self, t: f64, y: &[f64]) -> Result<Vec<f64>, Failure> {
        self.evaluated(t, y, None, Wanted::Motion).map(|evaluation| evaluation.rates)
    }

    fn evaluated(
        &self,
        t: f64,
        y: &[f64],
        guess: Option<&DVector<f64>>,
        wanted: Wanted,
    ) -> Result<Evaluation, Failure> {
        let (q, u) = self.split(y);
        let (n, p) = (q.len(), u.len());
        let inputs = self.inputs(t, y)?;
        let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
        let mut rates = vec![0.0; n + p + WORKS];
        let contacts: Vec<usize> = self.closed.iter().map(|closed| closed.contact).collect();
        let support = ClosedContacts::with_rates(self.mechanism, &state, &contacts, &mut rates)?;
        let mut holds = self.holds(&support, u);
        let mut found = None;
        if !contacts.is_empty() {
            let mu = self.mus(&support, &holds)?;
            let lacking = |lacking| match lacking {
                Lacking::Contact(i, error) => Failure::Contact(contacts[i], error),
                Lacking::Common => Failure::NoForces,
            };
            let solve = |holds: &[Hold]| forces(&support, holds, &mu, None, Wanted::Motion);
            settle_directions(&support, self.closed, &mut holds, &solve);
            let answer = forces(&support, &holds, &mu, guess, wanted).map_err(lacking)?;
            let greatest = answer.lambda.amax();
            for (i, rate) in rates[n..n + p].iter_mut().enumerate() {
                let mut size = rate.abs();
                for (response, force) in support.response.row(i).iter().zip(answer.lambda.iter()) {
                    *rate += response * force;
                    size += response.abs() * greatest;
                }
                // What friction holds stays exactly where it is.
                let rounding = if self.resting { 1e-11 } else { 64.0 * f64::EPSILON };
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
            rates[n + p + 1] = self.input_power(&state)?;
        }
        Ok(Evaluation { rates, support, holds, forces: found })
    }

    /// Power of the inputs: the generalised forces they add, times the speeds.
    fn input_power(&self, state: &State<'_>) -> Result<f64, StateError> {
        let p = state.speeds.len();
        let (mut with, mut without) = (vec![0.0; p], vec![0.0; p]);
        self.mechanism.forcing(state, &mut with)?;
        let none = vec![0.0; state.inputs.len()];
        self.mechanism.forcing(&State { inputs: &none, ..*state }, &mut without)?;
        Ok(with.iter().zip(&without).zip(state.speeds).map(|((a, b), u)| (a - b) * u).sum())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two links of a chain on a floor came to rest but for 1.5e-14 m/s, which is all that moved there. Slip began the
    /// other way, was at once taken to go forward, and had to begin again, 2000 times.
    #[test]
    fn slip_goes_the_way_it_began_while_it_is_rounding() {
        let (began, left) = (Vector2::new(-1.0, 0.0), Vector2::new(1.485_565e-14, 0.0));
        assert_eq!(direction(left, began, left.norm(), 0.7), began);
        assert_eq!(direction(-left, began, left.norm(), 0.7), began);
        // Slip that is none of itself has the way it began; what is more than rounding has its own.
        assert_eq!(direction(-left, began, 0.7, 0.7), began);
        assert_eq!(direction(1e3 * left, began, 1e3 * left.norm(), 0.7), -began);
        let across = Vector2::new(-3e-6, 4e-6);
        assert!((direction(across, began, 1e-3, 0.7) - Vector2::new(-0.6, 0.8)).norm() < 1e-15);
    }
}
