//! Events at known times: samples of a controller, jumps of inputs, and the ends of sequences of bounces.

use hodograph::Kind;

use crate::simulation::Simulation;
use crate::{Drive, Reason, SimulationError};

impl Simulation<'_> {
    /// The time of the next of these events.
    pub(crate) fn limit(&self) -> Option<f64> {
        let chatter = self.chatter.iter().map(|(time, _)| *time);
        let breaks = &self.options.breaks;
        let next_break = breaks.get(breaks.partition_point(|&time| time <= self.t)).copied();
        chatter.chain(self.next_sample).chain(next_break).filter(|&time| time > self.t).reduce(f64::min)
    }

    /// Handles the ends of bounces at this time.
    pub(crate) fn on_time(&mut self) -> Result<(), SimulationError> {
        let now = self.t;
        let due: Vec<usize> =
            self.chatter.iter().filter(|(time, _)| *time <= now).map(|(_, contact)| *contact).collect();
        self.chatter.retain(|(time, _)| *time > now);
        for contact in due {
            if self.phases[contact].is_closed() {
                self.announce_contact(contact);
            }
        }
        self.look_for_rest()
    }

    /// Calls the controller if its sampling time has come.
    pub(crate) fn sample(&mut self) -> Result<(), SimulationError> {
        let Some(due) = self.next_sample else { return Ok(()) };
        if due > self.t {
            return Ok(());
        }
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let (t, q, u) = (self.t, self.y[..n].to_vec(), self.y[n..n + p].to_vec());
        let Drive::Sampled { period, controller } = &mut self.options.drive else { return Ok(()) };
        let mut inputs = self.held.clone();
        controller.control(t, &q, &u, &mut inputs);
        self.samples += 1;
        self.next_sample = Some(self.start + *period * self.samples as f64);
        if let Some(bad) = inputs.iter().position(|value| !value.is_finite()) {
            let message = self.motion(&[]).bad_input(bad, inputs[bad]);
            return Err(self.error(None, Reason::Input(message)));
        }
        if inputs != self.held {
            self.held = inputs;
            self.resting = false;
            self.next = self.next.min(1e-3 * self.options.max_step.min(1.0)).max(1e-6);
            self.settle_again()?;
        }
        Ok(())
    }
}
