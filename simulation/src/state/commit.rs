//! Accepts the end of a step as the new front, and projects states onto the constraints.

use hodograph::ComponentKind;

use crate::closed::phase::{Closed, Modes};
use crate::closed::scales::SIZE;
use crate::integration::drift;
use crate::integration::motion::{Failure, Motion};
use crate::integration::stepper::{self, Step};
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// The greatest part of the kinetic energy so far that a correction may change.
const PROJECTED: f64 = 1e-5;
/// Speeds below this part of the greatest speed so far are set to zero.
const NOTHING: f64 = 1e-100;

impl Transition<'_> {
    /// Accepts the end of a step as the new front.
    pub(crate) fn commit(&mut self, step: &mut Step) -> Result<(), SimulationError> {
        let moving =
            self.mechanism.count(ComponentKind::Coordinate) + self.mechanism.count(ComponentKind::Speed);
        // What depends on time may set a mechanism in motion that was at rest.
        self.front.resting &= step.start()[..moving] == step.end[..moving];
        let modes = self.modes();
        self.front.t = step.t + step.h;
        self.front.y.copy_from_slice(&step.end);
        self.drive_smoothly(step.h)?;
        let kinetic = self.mechanism.kinetic_energy(&self.here()).ok();
        self.correct()?;
        if let Some(contact) = self.loses_energy(kinetic, &modes, step) {
            return self.end_with(contact, step);
        }
        self.drive()?;
        step.corrected(&self.front.y);
        self.arm(step)?;
        let n = self.mechanism.count(ComponentKind::Coordinate);
        if let Some(parts) = &mut self.parts {
            parts.add(step, &modes, &self.front.y[..moving]);
        }
        self.steps.push((step.clone(), modes));
        for (scale, speed) in self.front.scale.iter_mut().zip(&self.front.y[n..]) {
            *scale = scale.max(speed.abs());
        }
        if let Ok(kinetic) = self.mechanism.kinetic_energy(&self.here()) {
            self.front.greatest = self.front.greatest.max(kinetic);
        }
        Ok(())
    }

    /// The closed contact that moves fastest along its normal after a step whose correction changes the kinetic energy by more
    /// than the integration may err: its point has run to another place, where it would be struck.
    fn loses_energy(&self, before: Option<f64>, modes: &Modes, step: &Step) -> Option<usize> {
        let (before, after) = (before?, self.mechanism.kinetic_energy(&self.here()).ok()?);
        let most = PROJECTED.max(self.options.relative_tolerance.sqrt()) * self.front.greatest.max(before);
        if (after - before).abs() <= most {
            return None;
        }
        let contacts = modes.closed.iter().map(|closed| closed.contact);
        let own = contacts.filter(|&contact| self.mechanism.torque(contact).is_none());
        let speed = |contact: usize| self.gap_at(step, contact).map_or(0.0, |(_, velocity)| velocity.abs());
        own.max_by(|&one, &other| speed(one).total_cmp(&speed(other)))
    }

    /// Corrects the drift of the front.
    pub(crate) fn correct(&mut self) -> Result<(), SimulationError> {
        let mut y = std::mem::take(&mut self.front.y);
        let modes = self.modes();
        let done = self.project_onto_constraints(&modes, self.front.t, &mut y);
        self.front.y = y;
        done
    }

    /// Corrects the drift of a state that was integrated in these modes.
    fn project_onto_constraints(&self, modes: &Modes, t: f64, y: &mut [f64]) -> Result<(), SimulationError> {
        if modes.resting {
            // Not even the last bit of the norm of a quaternion changes.
            return Ok(());
        }
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let p = self.mechanism.count(ComponentKind::Speed);
        let mut closed: Vec<(usize, bool)> =
            modes.closed.iter().map(|closed| (closed.contact, closed.slides.is_none())).collect();
        let motion = Motion { held: &modes.held, ..self.motion(&modes.closed) };
        let inputs = motion.inputs(t, y).map_err(|failure| self.failure(failure))?;
        let mut q = y[..n].to_vec();
        let mut u = y[n..n + p].to_vec();
        let moved = (|| {
            drift::close_loops(self.mechanism.mechanism, t, &mut q, &u, &inputs)?;
            let contacts: Vec<usize> = closed.iter().map(|(contact, _)| *contact).collect();
            let sizes = (self.lengths, SIZE * self.front.scales.length);
            let drift::Corrected { left, known, ended } =
                drift::close_gaps(self.mechanism, t, &mut q, &u, &inputs, &contacts, sizes)?;
            let torques: Vec<usize> = self.mechanism.torques_of(&ended).collect();
            closed.retain(|(contact, _)| !ended.contains(contact) && !torques.contains(contact));
            // Velocities are projected last, at the corrected positions, since a remaining normal velocity
            // would count as an approach.
            drift::hold_velocities(self.mechanism, t, &q, &mut u, &inputs, (&closed, known))?;
            Ok(left)
        })();
        if let Some(left) = moved.map_err(|error| self.failure(Failure::State(error)))? {
            return Err(self.error(Some(left.contact), ErrorKind::Drift(left.gap)));
        }
        for (speed, scale) in u.iter_mut().zip(&self.front.scale) {
            // Repeated corrections of a zero speed leave numbers so small that their squares underflow.
            if speed.abs() < NOTHING * scale {
                *speed = 0.0;
            }
        }
        y[..n].copy_from_slice(&q);
        y[n..n + p].copy_from_slice(&u);
        Ok(())
    }

    /// The state at a time within a step that was made in these modes. It is integrated again up to that
    /// time, so that it is as accurate as the step itself.
    pub(crate) fn within_step(&self, step: &Step, modes: &Modes, time: f64) -> Option<Vec<f64>> {
        if modes.resting {
            return Some(step.end.clone());
        }
        let motion = Motion {
            mechanism: self.mechanism,
            angles: self.angles,
            drive: &self.options.drive,
            surfaces: self.surfaces,
            held: &modes.held,
            closed: &modes.closed,
            resting: modes.resting,
            scale: &self.front.scale,
        };
        let part = part_of(&motion, (step.t, step.start(), step.first()), time - step.t)?;
        let mut y = part.end;
        self.project_onto_constraints(modes, time, &mut y).ok()?;
        Some(y)
    }

    /// A part of the step from the front, integrated again.
    pub(crate) fn part(&self, closed: &[Closed], h: f64) -> Option<Step> {
        part_of(&self.motion(closed), (self.front.t, &self.front.y, None), h)
    }

    /// A part of a step from the front in the same modes, integrated again.
    pub(crate) fn part_again(&self, closed: &[Closed], whole: &Step, h: f64) -> Option<Step> {
        part_of(&self.motion(closed), (whole.t, whole.start(), whole.first()), h)
    }
}

/// The motion from a state over exactly the time `h`.
fn part_of(motion: &Motion<'_>, from: (f64, &[f64], Option<&[f64]>), h: f64) -> Option<Step> {
    let mut room = motion.room();
    let mut rates = |t: f64, y: &[f64], rates: &mut [f64]| {
        if motion.rates(t, y, rates, &mut room).is_err() {
            rates.fill(f64::NAN);
        }
    };
    stepper::part(&mut rates, from, h)
}
