//! Simulates a motion from sample to sample, with the events between them.

use hodograph_simulation::{Event, EventKind, Progress, Simulation, SimulationError, sample_times};

/// Below this part of the greatest kinetic energy so far, a thousand-millionth of the speeds, nothing moves any more.
const STILL: f64 = 1e-18;
/// The mechanism is at rest if nothing moves in this number of consecutive samples.
const SAMPLES_AT_REST: u32 = 10;

/// The time span of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// initial time, s
    pub start: f64,
    /// final time, s
    pub until: f64,
    /// time between samples, s
    pub step: f64,
    /// whether the motion ends as soon as the mechanism is at rest
    pub at_rest: bool,
}

/// An observer of samples and events; an error of it ends the motion.
pub trait Watch<E> {
    /// Called at the time of a sample.
    ///
    /// # Errors
    ///
    /// Ends the motion.
    fn sample(&mut self, simulation: &Simulation<'_>) -> Result<(), E>;

    /// Called after an event, at its time.
    ///
    /// # Errors
    ///
    /// Ends the motion.
    fn event(&mut self, event: &Event, simulation: &Simulation<'_>) -> Result<(), E>;
}

/// Simulates a motion from its start, of which no sample is taken: samples at `start + k step`, at the final
/// time, and where the motion ends by itself.
///
/// # Errors
///
/// Those of the simulation, and those of the observer.
pub fn follow<E: From<SimulationError>>(
    simulation: &mut Simulation<'_>,
    span: &Span,
    watch: &mut impl Watch<E>,
) -> Result<(), E> {
    let kinetic =
        |simulation: &Simulation<'_>| simulation.energy().map_or(f64::NAN, |account| account.kinetic);
    let (mut still, mut greatest) = (0, kinetic(simulation));
    for end in sample_times(span.start, span.step, span.until) {
        while let Progress::Event(event) = simulation.advance(end)? {
            watch.event(&event, simulation)?;
            if matches!(event.kind, EventKind::Singular) {
                // The motion ends by itself.
                return watch.sample(simulation);
            }
        }
        watch.sample(simulation)?;
        let now = kinetic(simulation);
        greatest = greatest.max(now);
        still = if simulation.is_at_rest() || now <= STILL * greatest { still + 1 } else { 0 };
        if span.at_rest && still >= SAMPLES_AT_REST {
            break;
        }
    }
    Ok(())
}
