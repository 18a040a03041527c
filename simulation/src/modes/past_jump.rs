//! Modes that end where the force jumps: the curvature of a surface does, at the rim of a cone or the edge of a box.
//!
//! Theory: docs/theory.md, section 17.11.

use crate::SimulationError;
use crate::closed::forces::relative_margins;
use crate::closed::phase::{Closed, mus};
use crate::state::transition::Transition;

/// A condition that ends a mode is zero there up to this part of the forces, unless they jump.
const CONTINUOUS: f64 = 1e-6;
/// Behind a jump a condition changes by no more than this part of itself.
const STEEP: f64 = 1e-2;
/// The first time by which a motion is continued past a jump, relative to the rounding error of the time, the factor from
/// one to the next, and their number.
const FIRST: f64 = 8.0;
const LONGER: f64 = 4.0;
const TRIALS: i32 = 6;

impl Transition<'_> {
    /// Moves past a jump of the forces of closed contacts that has ended their modes, so that their forces are those behind it:
    /// at the event the state may lie on either side of the jump, by rounding. Does nothing where the forces are continuous.
    pub(crate) fn go_past_a_jump(&mut self) -> Result<(), SimulationError> {
        let closed = self.closed();
        let here = self.least_margin(&closed, self.front.t, &self.front.y);
        let Some(margin) = here.filter(|margin| margin.abs() > CONTINUOUS) else { return Ok(()) };
        let rounding = f64::EPSILON * self.front.t.abs().max(self.front.scales.time);
        if margin < 0.0 {
            // Behind it by rounding, which may lead back. Beside a jam the condition is steep, and no jump.
            let after = FIRST * LONGER.powi(2) * rounding;
            let Some(mut step) = self.part(&closed, after) else { return Ok(()) };
            let behind = self.least_margin(&closed, self.front.t + after, &step.end);
            let jumped = behind.is_some_and(|behind| (behind - margin).abs() <= STEEP * margin.abs());
            return if jumped { self.commit(&mut step) } else { Ok(()) };
        }
        for trial in 0..TRIALS {
            let after = FIRST * LONGER.powi(trial) * rounding;
            let Some(step) = self.part(&closed, after) else { return Ok(()) };
            let behind = self.least_margin(&closed, self.front.t + after, &step.end);
            if behind.is_some_and(|margin| margin < 0.0) {
                // Twice as far, so that the correction of the state does not lead back.
                return self.part(&closed, 2.0 * after).map_or(Ok(()), |mut step| self.commit(&mut step));
            }
        }
        Ok(())
    }

    /// The same where the only closed contact lifts off: its force is compared with the one that it had.
    pub(crate) fn go_past_a_jump_of(&mut self, contact: usize) -> Result<(), SimulationError> {
        let (here, before) = (self.force_of(contact)?, self.front.forces[contact]);
        if here.x.abs() <= CONTINUOUS * before.norm() { Ok(()) } else { self.go_past_a_jump() }
    }

    /// The least margin of the conditions of these modes in a state, relative to the forces; `None` where there are no forces.
    fn least_margin(&self, closed: &[Closed], time: f64, state: &[f64]) -> Option<f64> {
        let evaluation = self.motion(closed).evaluate(time, state).ok()?;
        let forces = evaluation.forces.as_ref()?;
        relative_margins(forces, &evaluation.holds, &mus(closed), forces.rounding)
            .into_iter()
            .reduce(f64::min)
    }
}
