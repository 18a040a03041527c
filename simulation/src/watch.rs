//! The functions of a step whose zeros are events: gaps, normal forces, cones of friction, functions of the user.

use hodograph::{Kind, State};

use crate::SimulationError;
use crate::forces::margins;
use crate::motion::Failure;
use crate::phase::{Closed, Leaving, Phase, mus};
use crate::simulation::Simulation;
use crate::stepper::Step;

/// A contact that lifts off is apart where its gap is above this, m.
const LIFTED: f64 = 1e-11;
/// A sliding contact with f / m_nn below this jams.
const JAM: f64 = 1e-6;

/// What is watched in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Watched {
    /// the gap of a contact
    Gap(usize),
    /// normal force of a contact (place among the closed ones)
    Normal(usize),
    /// whether friction suffices
    Cone(usize),
    /// f of the only closed contact
    Jam,
    /// a user's function, times this sign
    User(usize, f64),
}

impl Simulation<'_> {
    /// What must be watched from here on, and what rounding may do to it.
    pub(crate) fn watched(&self, closed: &[Closed], h: f64) -> (Vec<Watched>, Vec<f64>) {
        let (mut watched, mut noise) = (Vec::new(), Vec::new());
        let n = self.mechanism.count(Kind::Coordinate);
        let size = self.y[..n].iter().fold(1e-3_f64, |size, q| size.max(q.abs()));
        let rounding = 4.0 * f64::EPSILON * size;
        for (contact, phase) in self.phases.iter().enumerate() {
            if let Phase::Open(leaving) = phase
                && self.surfaces[contact].is_some()
            {
                watched.push(Watched::Gap(contact));
                noise.push(match leaving {
                    // Divided by the time, at the second point of the step.
                    Leaving::Bounced(_) => rounding / (0.0024 * h),
                    _ => rounding,
                });
            }
        }
        for (place, contact) in closed.iter().enumerate() {
            watched.push(Watched::Normal(place));
            noise.push(0.0);
            if contact.slides.is_none() {
                watched.push(Watched::Cone(place));
                noise.push(0.0);
            } else if closed.len() == 1 {
                watched.push(Watched::Jam);
                noise.push(0.0);
            }
        }
        let (q, u) = (&self.y[..n], &self.y[n..n + self.mechanism.count(Kind::Speed)]);
        for (index, function) in self.options.events.iter().enumerate() {
            let value = function(self.t, q, u);
            watched.push(Watched::User(index, if value < 0.0 { -1.0 } else { 1.0 }));
            noise.push(1e-15);
        }
        (watched, noise)
    }

    /// The values of what is watched, a time after the front.
    pub(crate) fn values(
        &self,
        closed: &[Closed],
        watched: &[Watched],
        after: f64,
        y: &[f64],
    ) -> Result<Vec<f64>, Failure> {
        let motion = self.motion(closed);
        let t = self.t + after;
        let (q, u) = motion.split(y);
        let inputs = motion.inputs(t, y)?;
        let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
        let mut conditions = Vec::new();
        let mut f = 1.0;
        if !closed.is_empty() {
            let evaluation = motion.evaluate(t, y)?;
            if let Some(forces) = &evaluation.forces {
                conditions = margins(forces, &evaluation.holds, &mus(closed));
                f = forces.f;
            }
        }
        watched
            .iter()
            .map(|what| match *what {
                Watched::Gap(contact) => {
                    let gap = self.mechanism.gap(contact, &state)?.unwrap_or(1.0);
                    Ok(match self.phases[contact] {
                        Phase::Open(Leaving::Bounced(start)) if after > 0.0 => (gap - start) / after,
                        Phase::Open(Leaving::Bounced(_)) => {
                            self.mechanism.contact_velocity(contact, &state)?.x
                        }
                        Phase::Open(Leaving::Lifted) => gap + LIFTED,
                        _ => gap,
                    })
                }
                Watched::Normal(place) => Ok(conditions.get(place).map_or(1.0, |margins| margins[0])),
                Watched::Cone(place) => Ok(conditions.get(place).map_or(1.0, |margins| margins[1])),
                Watched::Jam => Ok(f - JAM),
                Watched::User(index, sign) => Ok(sign * (self.options.events[index])(t, q, u)),
            })
            .collect()
    }

    /// Gap and normal velocity of a contact at the end of a step.
    pub(crate) fn gap_at(&self, step: &Step, contact: usize) -> Result<(f64, f64), SimulationError> {
        let motion = self.motion(&[]);
        let (q, u) = motion.split(&step.end);
        let state = State { time: step.t + step.h, coordinates: q, speeds: u, inputs: &self.held };
        let fault = |error| self.failure(Failure::State(error));
        let gap = self.mechanism.gap(contact, &state).map_err(fault)?.unwrap_or(1.0);
        Ok((gap, self.mechanism.contact_velocity(contact, &state).map_err(fault)?.x))
    }

    /// Contacts that were about to leave are apart once their gaps are open.
    pub(crate) fn arm(&mut self) -> Result<(), SimulationError> {
        self.arm_others(usize::MAX)
    }

    pub(crate) fn arm_others(&mut self, but: usize) -> Result<(), SimulationError> {
        let Some(step) = self.step.clone() else { return Ok(()) };
        for contact in 0..self.phases.len() {
            if contact == but {
                continue;
            }
            match self.phases[contact] {
                Phase::Open(Leaving::Bounced(_)) if step.h > 0.0 => {
                    let (gap, _) = self.gap_at(&step, contact)?;
                    self.phases[contact] =
                        Phase::Open(if gap > 0.0 { Leaving::Apart } else { Leaving::Lifted });
                }
                Phase::Open(Leaving::Lifted) => {
                    let (gap, _) = self.gap_at(&step, contact)?;
                    if gap > LIFTED {
                        self.phases[contact] = Phase::Open(Leaving::Apart);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}
