//! Events at known times: jumps of inputs, samples of a controller, and the ends of sequences of bounces.

use crate::SimulationError;
use crate::state::transition::Transition;

impl Transition<'_> {
    /// The time of the next of these events.
    pub(crate) fn limit(&self) -> Option<f64> {
        let chatter = self.front.chatter.iter().map(|(time, _)| *time);
        let breaks = &self.options.breaks;
        let next_break = breaks.get(breaks.partition_point(|&time| time <= self.front.t)).copied();
        chatter
            .chain(self.front.next_sample)
            .chain(next_break)
            .filter(|&time| time > self.front.t)
            .reduce(f64::min)
    }

    /// Handles bounces that end at this time.
    pub(crate) fn on_time(&mut self) -> Result<(), SimulationError> {
        let now = self.front.t;
        let due: Vec<usize> =
            self.front.chatter.iter().filter(|(time, _)| *time <= now).map(|(_, contact)| *contact).collect();
        self.front.chatter.retain(|(time, _)| *time > now);
        let mut other_friction = false;
        for contact in due {
            if self.front.phases[contact].is_closed() {
                self.announce_contact(contact);
                other_friction |= self.pair(contact).is_some_and(|pair| !pair.is_the_same_in_impacts());
            }
        }
        if other_friction {
            self.keep_or_decide()?;
        }
        self.look_for_rest()
    }

    /// Replaces the inputs.
    pub(crate) fn change_inputs(&mut self, inputs: Vec<f64>) -> Result<(), SimulationError> {
        if inputs == self.front.held {
            return Ok(());
        }
        self.front.held = inputs;
        self.front.resting = false;
        let time = self.front.scales.time;
        self.front.next = self.front.next.min(5e-3 * self.options.max_step.min(time)).max(5e-6 * time);
        self.keep_or_decide()
    }
}
