//! Advances the front of a motion, that is the state at the end of the last step, and corrects its drift.

use hodograph::{Kind, State};

use crate::motion::{Failure, Motion};
use crate::phase::{Closed, Modes};
use crate::simulation::Simulation;
use crate::stepper::{self, Step};
use crate::{Event, EventKind, SimulationError, drift};

impl Simulation<'_> {
    /// Takes the end of a step as the new front.
    pub(crate) fn commit(&mut self, step: &mut Step) -> Result<(), SimulationError> {
        self.past = self.modes();
        self.t = step.t + step.h;
        self.y.copy_from_slice(&step.end);
        self.correct()?;
        step.corrected(&self.y);
        self.arm(step)?;
        self.step = Some(step.clone());
        let n = self.mechanism.count(Kind::Coordinate);
        for (scale, speed) in self.scale.iter_mut().zip(&self.y[n..]) {
            *scale = scale.max(speed.abs());
        }
        let p = self.scale.len();
        let state =
            State { time: self.t, coordinates: &self.y[..n], speeds: &self.y[n..n + p], inputs: &self.held };
        if let Ok(kinetic) = self.mechanism.kinetic_energy(&state) {
            self.greatest = self.greatest.max(kinetic);
        }
        Ok(())
    }

    /// Corrects the drift of the front.
    pub(crate) fn correct(&mut self) -> Result<(), SimulationError> {
        let mut y = std::mem::take(&mut self.y);
        let modes = self.modes();
        let done = self.put_right(&modes, self.t, &mut y);
        self.y = y;
        done
    }

    /// The modes at the front.
    pub(crate) fn modes(&self) -> Modes {
        Modes { closed: self.closed(), held: self.held.clone(), resting: self.resting }
    }

    /// Corrects the drift of a state that was integrated in these modes.
    fn put_right(&self, modes: &Modes, t: f64, y: &mut [f64]) -> Result<(), SimulationError> {
        if modes.resting {
            // Not even the last bit of a quaternion's length changes.
            return Ok(());
        }
        let n = self.mechanism.count(Kind::Coordinate);
        let p = self.mechanism.count(Kind::Speed);
        let closed: Vec<(usize, bool)> =
            modes.closed.iter().map(|closed| (closed.contact, closed.slides.is_none())).collect();
        let mut q = y[..n].to_vec();
        let mut u = y[n..n + p].to_vec();
        let moved = (|| {
            drift::close_loops(self.mechanism, t, &mut q, &u, &modes.held)?;
            drift::hold_velocities(self.mechanism, t, &q, &mut u, &modes.held, &closed)?;
            let contacts: Vec<usize> = closed.iter().map(|(contact, _)| *contact).collect();
            drift::close_gaps(self.mechanism, t, &mut q, &u, &modes.held, &contacts)
        })();
        moved.map_err(|error| self.failure(Failure::State(error)))?;
        y[..n].copy_from_slice(&q);
        y[n..n + p].copy_from_slice(&u);
        Ok(())
    }

    /// The state at a time in the last step, integrated anew up to it: as exact as the step itself.
    pub(crate) fn within_step(&self, time: f64) -> Option<Vec<f64>> {
        let step = self.step.as_ref()?;
        let motion = Motion {
            mechanism: self.mechanism,
            drive: &self.options.drive,
            held: &self.past.held,
            closed: &self.past.closed,
            resting: self.past.resting,
        };
        let part = part_of(&motion, step.t, step.start(), time - step.t)?;
        let mut y = part.end;
        self.put_right(&self.past, time, &mut y).ok()?;
        Some(y)
    }

    /// A part of the step from the front, integrated anew.
    pub(crate) fn part(&self, closed: &[Closed], h: f64) -> Option<Step> {
        part_of(&self.motion(closed), self.t, &self.y, h)
    }

    /// Records an event with the state here.
    pub(crate) fn push(&mut self, contact: Option<usize>, kind: EventKind) {
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        self.queue.push_back(Event {
            time: self.t,
            contact,
            kind,
            coordinates: self.y[..n].to_vec(),
            speeds: self.y[n..n + p].to_vec(),
        });
    }
}

/// The motion from a state on, over exactly so long.
fn part_of(motion: &Motion<'_>, t: f64, y: &[f64], h: f64) -> Option<Step> {
    let rates = |t: f64, y: &[f64], rates: &mut [f64]| match motion.evaluate(t, y) {
        Ok(evaluation) => rates.copy_from_slice(&evaluation.rates),
        Err(_) => rates.fill(f64::NAN),
    };
    stepper::part(&rates, t, y, h)
}
