//! Inputs that are functions of time and state, at the front of the motion.

use std::borrow::Cow;

use hodograph::{ComponentKind, State, StateError};

use crate::closed::phase::Phase;
use crate::integration::motion::Failure;
use crate::interface::drive::Drive;
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// A gap has another rate than the velocity of its contact if what remains of it is this part of what an input changed, and
/// this many times its rounding and the tolerance.
const OTHER: f64 = 1e-3;
const MANY: f64 = 100.0;

/// A difference of velocities or momenta that is this part of their size is rounding.
const ROUNDING: f64 = 1e-12;

impl Transition<'_> {
    /// Evaluates the inputs that are functions of time and state at the front, whose time or state has changed.
    pub(crate) fn drive(&mut self) -> Result<(), SimulationError> {
        if let Drive::Continuous(_) = self.options.drive {
            let inputs = self.motion(&[]).inputs(self.front.t, &self.front.y).map(Cow::into_owned);
            self.front.held = inputs.map_err(|failure| self.failure(failure))?;
        }
        Ok(())
    }

    /// Like [`Self::drive`], at the end of a step of this length that was not corrected yet, in which inputs changed
    /// smoothly. Refuses changes whose consequences the equations do not hold.
    pub(crate) fn drive_smoothly(&mut self, h: f64) -> Result<(), SimulationError> {
        let before = self.front.held.clone();
        self.drive()?;
        if before != self.front.held {
            self.refuse_rates(&before)?;
            self.refuse_gaps(&before, h)?;
        }
        Ok(())
    }

    /// A gap that follows an input must have the rate that the velocity of its contact says, which has kept it closed in a
    /// step of this length from these inputs.
    fn refuse_gaps(&self, before: &[f64], h: f64) -> Result<(), SimulationError> {
        let fault = |error| self.failure(Failure::State(error));
        let here = self.here();
        for contact in (0..self.front.phases.len()).filter(|&contact| self.front.phases[contact].is_closed())
        {
            if self.mechanism.torque(contact).is_some() {
                continue;
            }
            let gap = |inputs| self.mechanism.gap(contact, &State { inputs, ..here });
            let (old, new) = (gap(before).map_err(fault)?, gap(here.inputs).map_err(fault)?);
            let (Some(old), Some(new)) = (old, new) else { continue };
            let error = self.options.relative_tolerance * self.front.scales.length;
            let drift = MANY * self.rounding_of_gap(contact).max(error);
            if old != new && new.abs() > drift && new.abs() > OTHER * (new - old).abs() {
                return Err(self.error(Some(contact), ErrorKind::GapRate { rate: new / h, velocity: 0.0 }));
            }
        }
        Ok(())
    }

    /// The equations hold no rates of inputs: one that stands in velocities may change from these values as long as that
    /// accelerates nothing.
    fn refuse_rates(&self, before: &[f64]) -> Result<(), SimulationError> {
        for (index, &value) in
            before.iter().enumerate().filter(|(index, value)| self.front.held[*index] != **value)
        {
            let mut old = self.front.held.clone();
            old[index] = value;
            let accelerates =
                self.momenta_follow(&old).map_err(|error| self.failure(Failure::State(error)))?;
            let touches =
                self.contact_that_follows(&old).map_err(|error| self.failure(Failure::State(error)))?;
            let name = || {
                let input = self.mechanism.component(ComponentKind::Input, index);
                input.map_or("?", |input| input.name).to_owned()
            };
            let cure = "write it in the model as a function of `time`, whose rate is known, or let it be constant between samples";
            if let Some(contact) = touches {
                let message = format!(
                    "the input {} is part of the velocity at a closed contact and changes, but the equations do not hold the rate of an input: {cure}",
                    name()
                );
                return Err(self.error(Some(contact), ErrorKind::BadInput(message)));
            }
            if accelerates {
                let message = format!(
                    "the input {} is part of the velocity of a body and changes, which accelerates others, but the equations do not hold the rate of an input: {cure}",
                    name()
                );
                return Err(self.error(None, ErrorKind::BadInput(message)));
            }
        }
        Ok(())
    }

    /// Whether the momenta of the generalized speeds, dK/du at constant speeds, are others with these inputs: the change of
    /// the input would be felt by the speeds. K is a quadratic function of them.
    fn momenta_follow(&self, old: &[f64]) -> Result<bool, StateError> {
        let here = self.here();
        let energy = |speeds: &[f64], inputs: &[f64]| {
            self.mechanism.kinetic_energy(&State {
                time: here.time,
                coordinates: here.coordinates,
                speeds,
                inputs,
            })
        };
        let mut speeds = vec![0.0; here.speeds.len()];
        let still = [energy(&speeds, old)?, energy(&speeds, here.inputs)?];
        if still[0] == still[1] && energy(here.speeds, old)? == energy(here.speeds, here.inputs)? {
            return Ok(false);
        }
        // Differences of a quadratic function are exact for any unit; the greatest speed so far keeps its terms alike.
        let greatest = self.front.scale.iter().fold(0.0_f64, |size, speed| size.max(*speed));
        let unit = if greatest > 0.0 { greatest } else { 1.0 };
        for r in 0..speeds.len() {
            let mut momentum = [0.0; 2];
            let mut size = still[0].abs() + still[1].abs();
            for (momentum, inputs) in momentum.iter_mut().zip([old, here.inputs]) {
                speeds[r] = unit;
                let forward = energy(&speeds, inputs)?;
                speeds[r] = -unit;
                let backward = energy(&speeds, inputs)?;
                speeds[r] = 0.0;
                *momentum = forward - backward;
                size += forward.abs() + backward.abs();
            }
            if (momentum[1] - momentum[0]).abs() > ROUNDING * size {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// A closed contact whose normal velocity is another with these inputs, or whose velocity if it sticks.
    fn contact_that_follows(&self, old: &[f64]) -> Result<Option<usize>, StateError> {
        let here = self.here();
        for contact in (0..self.front.phases.len()).filter(|&contact| self.front.phases[contact].is_closed())
        {
            if self.mechanism.torque(contact).is_some() {
                continue;
            }
            let with = |inputs| self.mechanism.contact_velocity(contact, &State { inputs, ..here });
            let (before, now) = (with(old)?, with(here.inputs)?);
            let change = now - before;
            // Slip may follow an input: the force of friction has no rate of the slip in it.
            let slides = matches!(self.front.phases[contact], Phase::Slide(_));
            let change = if slides { change.x.abs() } else { change.amax() };
            if change > ROUNDING * (now.amax() + before.amax()) {
                return Ok(Some(contact));
            }
        }
        Ok(None)
    }
}
