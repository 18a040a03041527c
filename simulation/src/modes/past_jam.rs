//! Jams at which all forces are finite: two feet that slide apart press alike, until the least difference between them
//! grows, and one of them opens.
//!
//! Theory: docs/theory.md, section 17.6.

use crate::SimulationError;
use crate::closed::forces::JAM;
use crate::closed::mode_selection::{Choice, Question};
use crate::closed::phase::Phase;
use crate::contact_problem::{self, Mode};
use crate::integration::stepper::Step;
use crate::state::transition::Transition;

/// The first time by which a motion is continued past a jam, relative to the time of the problem, the factor from one to
/// the next, and their number.
const FIRST: f64 = 1e-11;
const LONGER: f64 = 8.0;
const TRIALS: i32 = 8;

/// The step past a jam, and the modes that are chosen at its end.
type Past = (Step, (Question, Choice));

impl Transition<'_> {
    /// Continues past a jam of these closed contacts at which forces are finite; the error `alone` if there are no modes in
    /// which nothing jams.
    pub(crate) fn go_past_a_jam(
        &mut self,
        contacts: &[usize],
        was: &[Phase],
        alone: SimulationError,
    ) -> Result<(), SimulationError> {
        let Some((mut step, decided)) = self.past_a_jam(contacts, was)? else { return Err(alone) };
        let start = self.front.t;
        self.commit(&mut step)?;
        self.apply_and_confirm(contacts, was, decided)?;
        self.crowded(start)
    }

    /// The next instant at which f of the contacts is as negative as it is positive here, at the rates of the present modes, and
    /// the modes that are chosen there, if they are others.
    fn past_a_jam(&self, contacts: &[usize], was: &[Phase]) -> Result<Option<Past>, SimulationError> {
        let Ok(here) = self.motion(&self.closed()).evaluate(self.front.t, &self.front.y) else {
            return Ok(None);
        };
        for trial in 0..TRIALS {
            let h = FIRST * LONGER.powi(trial) * self.front.scales.time;
            let end: Vec<f64> = self.front.y.iter().zip(&here.rates).map(|(y, rate)| y + h * rate).collect();
            let step = Step::still(self.front.t, h, &end);
            let Ok((question, choice)) = self.chosen_at(contacts, was, &step)? else { continue };
            if jams(&question) {
                let others = !self.go_on(contacts, &choice);
                return Ok(others.then_some((step, (question, choice))));
            }
        }
        Ok(None)
    }
}

/// Whether f of the contacts is clearly negative where all of them keep sticking or sliding.
fn jams(question: &Question) -> bool {
    let Question { support, slips, friction } = question;
    let held = friction.iter().zip(slips);
    let mu: Vec<f64> = held.map(|(mu, slip)| if slip.is_some() { mu.slips } else { mu.sticks }).collect();
    let modes: Vec<Mode> = slips.iter().map(|slip| slip.map_or(Mode::Stick, Mode::Slide)).collect();
    let found = contact_problem::with_modes(&support.problem(&mu, slips), &modes);
    found.is_ok_and(|found| found.f <= -JAM)
}
