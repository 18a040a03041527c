//! Jams at which all forces are finite: two feet that slide apart press alike, until the least difference between them
//! grows, and one of them opens.
//!
//! Theory: docs/theory.md, section 17.6.

use hodograph::{Selection, State};
use nalgebra::Vector2;

use crate::SimulationError;
use crate::closed_contacts::ClosedContacts;
use crate::contact_problem::{self, Mode};
use crate::forces::JAM;
use crate::mode_selection::Choice;
use crate::motion::Failure;
use crate::phase::{Closed, Phase};
use crate::stepper::Step;
use crate::transition::Transition;

/// The first time by which a motion is continued past a jam, relative to the time of the problem, the factor from one to
/// the next, and their number.
const FIRST: f64 = 1e-11;
const LONGER: f64 = 8.0;
const TRIALS: i32 = 8;

impl Transition<'_> {
    /// The next instant at which f of a contact is as negative as it is positive here, at the rates of the present modes, and
    /// the modes there in which no contact jams; `None` if there are none.
    pub(crate) fn past_a_jam(&self, closed: &[Closed]) -> Result<Option<(Step, Choice)>, SimulationError> {
        let motion = self.motion(closed);
        let Ok(here) = motion.evaluate(self.front.t, &self.front.y) else { return Ok(None) };
        let contacts: Vec<usize> = closed.iter().map(|closed| closed.contact).collect();
        for trial in 0..TRIALS {
            let h = FIRST * LONGER.powi(trial) * self.front.scales.time;
            let end: Vec<f64> = self.front.y.iter().zip(&here.rates).map(|(y, rate)| y + h * rate).collect();
            let time = self.front.t + h;
            let (coordinates, speeds) = motion.split(&end);
            let inputs = motion.inputs(time, &end).map_err(|failure| self.failure(failure))?;
            let state = State { time, coordinates, speeds, inputs: &inputs };
            let support = ClosedContacts::loaded(self.mechanism, &state, self.angles, &contacts)
                .map_err(|error| self.failure(Failure::State(error)))?;
            let slips: Vec<Option<Vector2<f64>>> =
                motion.holds(&support, speeds).iter().map(|hold| hold.direction()).collect();
            let friction = self.frictions(&contacts, &slips, &support)?;
            let mu: Vec<f64> = friction.iter().map(|friction| friction.slips).collect();
            let problem = support.problem(&mu, &slips);
            let modes: Vec<Mode> = slips.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
            let jams = contact_problem::with_modes(&problem, &modes).is_ok_and(|found| found.f <= -JAM);
            if !jams {
                continue;
            }
            return Ok(match contact_problem::solve_without_jam(&problem, None) {
                Ok((solution, Some(middle)))
                    if middle.f > 0.0 && self.differs(&contacts, &solution.modes) =>
                {
                    let mut choice = self.choice_of(&contacts, &solution, 1.0);
                    choice.selection = Some(Selection::SeveralModes);
                    Some((Step::still(self.front.t, h, &end), choice))
                }
                _ => None,
            });
        }
        Ok(None)
    }

    /// Continues past a jam at which forces are finite; the error of `alone` if the motion cannot.
    pub(crate) fn go_past_a_jam(
        &mut self,
        was: &[Phase],
        alone: SimulationError,
    ) -> Result<(), SimulationError> {
        let closed = self.closed();
        let Some((mut step, choice)) = self.past_a_jam(&closed)? else { return Err(alone) };
        let contacts: Vec<usize> = closed.iter().map(|closed| closed.contact).collect();
        let start = self.front.t;
        self.commit(&mut step)?;
        self.apply(&contacts, was, &choice);
        self.crowded(start)
    }
}
