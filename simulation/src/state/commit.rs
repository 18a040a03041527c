//! Accepts the end of a step as the new front, and projects states onto the constraints.

use hodograph::ComponentKind;

use crate::closed::phase::{Closed, Modes};
use crate::closed::scales::SIZE;
use crate::integration::drift;
use crate::integration::motion::{Failure, Motion};
use crate::integration::stepper::{self, Step};
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// The greatest part of the kinetic energy so far that a correction may change, and a velocity that does not matter, in units
/// of the length and the time of the problem: of what rests all is rounding.
const PROJECTED: f64 = 1e-6;
const RESTS: f64 = 1e-6;
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
            // Forces that hold a point which runs away are none that act: the step is not made.
            self.front.t = step.t;
            self.front.y.copy_from_slice(step.start());
            self.drive()?;
            return self.end_at(contact);
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

    /// The closed contact whose velocity a correction changes most, if it changes the kinetic energy by more than the
    /// integration may err: the point has run to another place, where the bodies would strike each other.
    fn loses_energy(&self, before: Option<f64>, modes: &Modes, step: &Step) -> Option<usize> {
        let here = self.here();
        let (before, after) = (before?, self.mechanism.kinetic_energy(&here).ok()?);
        let most = PROJECTED.max(self.options.relative_tolerance.sqrt()) * self.front.greatest.max(before);
        if (after - before).abs() <= most {
            return None;
        }
        let p = here.speeds.len();
        let change: Vec<f64> =
            here.speeds.iter().zip(&step.end[here.coordinates.len()..]).map(|(a, b)| a - b).collect();
        let mut rows = vec![0.0; 3 * p];
        let mut changed = |contact: usize| -> Option<(usize, f64)> {
            self.mechanism.partial_velocities(contact, &here, &mut rows).ok()?;
            let along = |row: &[f64]| row.iter().zip(&change).map(|(row, by)| row * by).sum::<f64>().abs();
            Some((contact, rows.chunks_exact(p).map(along).fold(0.0, f64::max)))
        };
        let rests = RESTS * self.front.scales.length / self.front.scales.time;
        let contacts = modes.closed.iter().map(|closed| closed.contact);
        let own = contacts.filter(|&contact| self.mechanism.torque(contact).is_none());
        let most = own.filter_map(&mut changed).max_by(|one, other| one.1.total_cmp(&other.1));
        most.filter(|(_, by)| *by > rests).map(|(contact, _)| contact)
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
