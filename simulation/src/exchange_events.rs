//! Handles events of a motion that another program integrates, where an indicator is zero: the transitions of
//! a step's events, after the time of the event is found again.

use hodograph::State;

use crate::closed::phase::{Closed, Leaving, Phase};
use crate::closed::scales::SIZE;
use crate::exchange::Frozen;
use crate::integration::drift;
use crate::integration::motion::Failure;
use crate::modes::mode_changes::Ending;
use crate::state::front::Front;
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// If the indicator of slip is negative, slip below this part of the greatest speeds so far ends; greater
/// slip has turned by a right angle.
const ENDS: f64 = 1e-4;
/// Impacts are handled at most this part of the time of the problem before the time at which they are found.
const LATEST: f64 = 0.1;
/// Contacts collide together if their gaps closed within this part of the delay with which their impact was
/// found.
const SAME: f64 = 1e-6;
/// Largest number of events that are handled at one time.
const MOST: usize = 32;

impl Transition<'_> {
    /// Handles the events in this state.
    pub(crate) fn handle_here(&mut self, state: &State<'_>) -> Result<(), SimulationError> {
        let start = self.front.t;
        self.goes_to(state);
        self.front.omegas.fill(None);
        self.front.turnings.fill(None);
        let inputs = state.inputs.to_vec();
        let changed = inputs != self.front.held;
        if changed {
            self.front.held.clone_from(&inputs);
            self.front.resting = false;
        }
        self.on_time()?;
        let mut was = None;
        for _ in 0..MOST {
            let here = self.front.clone();
            let here = self.here_of(&here);
            let values = self.frozen_values(&here).map_err(|failure| self.failure(failure))?;
            let negative = |(what, value): (Frozen, &f64)| (*value <= 0.0).then_some(what);
            let crossed: Vec<Frozen> =
                self.frozen_functions().into_iter().zip(&values).filter_map(negative).collect();
            if crossed.is_empty() || was.as_ref() == Some(&crossed) {
                break;
            }
            self.handle_crossed(&crossed)?;
            self.crowded(start)?;
            was = Some(crossed);
        }
        if changed { self.keep_or_decide() } else { Ok(()) }
    }

    /// Handles the functions that crossed zero: gaps first, since an impact decides the modes of all closed
    /// contacts.
    fn handle_crossed(&mut self, crossed: &[Frozen]) -> Result<(), SimulationError> {
        let closed = self.closed();
        let gaps: Vec<usize> = crossed
            .iter()
            .filter_map(|what| if let Frozen::Gap(gap) = what { Some(*gap) } else { None })
            .collect();
        if !gaps.is_empty() {
            return self.gaps_closed(&closed, &gaps);
        }
        if let Some(contact) =
            crossed.iter().find_map(|what| if let Frozen::End(end) = what { Some(*end) } else { None })
        {
            return self.leave(contact);
        }
        self.correct()?;
        let (mut stopped, mut normal, mut cone) = (Vec::new(), None, None);
        for what in crossed {
            match *what {
                Frozen::Slip(index) => stopped.push(index),
                Frozen::Normal(index) => normal = normal.or(Some(index)),
                Frozen::Cone(index) => cone = cone.or(Some(index)),
                Frozen::Gap(_) | Frozen::End(_) | Frozen::Jam => {}
            }
        }
        if let Some(contact) = normal {
            return self.modes_ended(contact, Ending::NormalForce);
        }
        if let Some(contact) = cone {
            return self.modes_ended(contact, Ending::Friction);
        }
        if !stopped.is_empty() {
            return self.slips_ended(&closed, &stopped);
        }
        self.jammed(&closed)
    }

    /// Handles gaps that closed a little earlier: approaching contacts collide at the time when the first gap
    /// was zero, and the motion continues from there to the present time. If an importer finds an event late,
    /// the error is quadratic in the delay.
    fn gaps_closed(&mut self, closed: &[Closed], gaps: &[usize]) -> Result<(), SimulationError> {
        let now = self.front.t;
        let (mut late, mut fastest, mut stay) = (0.0_f64, None, Vec::new());
        for &contact in gaps {
            let (gap, rate) = self.gap_here(contact)?;
            if self.ends(contact) && self.keeps_height(contact)? {
                return self.enter(contact);
            }
            if rate >= 0.0 {
                stay.push(contact);
            } else {
                late = late.max((gap.min(0.0) / rate).min(LATEST * self.front.scales.time));
                if fastest.is_none_or(|(_, least)| rate < least) {
                    fastest = Some((contact, rate));
                }
            }
        }
        let Some((contact, _)) = fastest else {
            for contact in stay {
                self.front.phases[contact] = Phase::Open(Leaving::NOW);
            }
            return self.close(closed, gaps);
        };
        self.drift_by(-late)?;
        let mut touching = Vec::new();
        for &gap in gaps {
            let (open, rate) = self.gap_here(gap)?;
            if gap == contact || open <= -SAME * late * rate {
                touching.push(gap);
            }
        }
        self.close(closed, &touching)?;
        self.gap_is_known(contact)?;
        self.strike(contact)?;
        self.drift_by(now - self.front.t)
    }

    /// Gap and normal velocity of a contact at the front.
    fn gap_here(&self, contact: usize) -> Result<(f64, f64), SimulationError> {
        let here = self.here();
        let fault = |error| self.failure(Failure::State(error));
        let gap = self.mechanism.gap(contact, &here).map_err(fault)?.unwrap_or(1.0);
        Ok((gap, self.mechanism.contact_velocity(contact, &here).map_err(fault)?.x))
    }

    /// Advances over a short time in the present modes, by the midpoint rule.
    fn drift_by(&mut self, time: f64) -> Result<(), SimulationError> {
        if time == 0.0 || self.front.resting {
            self.front.t += time;
            return Ok(());
        }
        let rates = |transition: &Self, front: &Front| {
            let found = transition.frozen(&transition.here_of(front));
            found.map(|found| found.rates).map_err(|failure| transition.failure(failure))
        };
        let moved = |front: &Front, rates: &[f64], time: f64| {
            let y = front.y.iter().zip(rates).map(|(value, rate)| value + time * rate).collect();
            Front { t: front.t + time, y, ..front.clone() }
        };
        let front = self.front.clone();
        let middle = moved(&front, &rates(self, &front)?, 0.5 * time);
        self.front = moved(&front, &rates(self, &middle)?, time);
        Ok(())
    }

    /// Corrects the positions so that these gaps are zero, like those of the closed contacts, and so that the
    /// latter have no normal velocity that would count as an approach.
    fn close(&mut self, closed: &[Closed], gaps: &[usize]) -> Result<(), SimulationError> {
        let front = self.front.clone();
        let here = self.here_of(&front);
        let touching: Vec<usize> = closed
            .iter()
            .map(|closed| closed.contact)
            .filter(|&contact| self.mechanism.torque(contact).is_none())
            .chain(gaps.iter().copied())
            .collect();
        let mut q = here.coordinates.to_vec();
        let sizes = (self.lengths, SIZE * front.scales.length);
        let moved =
            drift::close_gaps(self.mechanism, here.time, &mut q, here.speeds, here.inputs, &touching, sizes);
        let drift::Corrected { left, .. } = moved.map_err(|error| self.failure(Failure::State(error)))?;
        if let Some(left) = left {
            return Err(self.error(Some(left.contact), ErrorKind::Drift(left.gap)));
        }
        self.front.y[..q.len()].copy_from_slice(&q);
        self.correct()
    }

    /// Slip along the previous directions of these contacts is not positive: small slip ends, and other slip
    /// has turned.
    fn slips_ended(&mut self, closed: &[Closed], contacts: &[usize]) -> Result<(), SimulationError> {
        let front = self.front.clone();
        let here = self.here_of(&front);
        let found = self.frozen(&here).map_err(|failure| self.failure(failure))?;
        let mut stopped = Vec::new();
        for (place, contact) in closed.iter().enumerate().filter(|(_, c)| contacts.contains(&c.contact)) {
            let slip = found.support.slip(place);
            if slip.norm() <= ENDS * found.support.velocity_size(place, &front.scale) {
                self.front.phases[contact.contact] = Phase::Stick;
                stopped.push(contact.contact);
            } else {
                self.front.phases[contact.contact] = Phase::Slide(slip.normalize());
            }
        }
        if stopped.is_empty() {
            return Ok(());
        }
        self.correct()?;
        self.slip_ended(&stopped)
    }
}
