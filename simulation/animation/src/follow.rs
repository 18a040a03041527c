//! Follows a motion from sample to sample, with the events between them.

use hodograph_simulation::{Event, EventKind, Progress, Simulation, SimulationError};

/// Speeds below count as none, in their units.
const STILL: f64 = 1e-9;
/// All is at rest where this many samples show no speed.
const RESTS: u32 = 10;

/// Which stretch of time is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// where it begins, s
    pub start: f64,
    /// where it ends, s
    pub until: f64,
    /// from sample to sample, s
    pub step: f64,
    /// whether it ends earlier where all is at rest
    pub at_rest: bool,
}

/// Who is told of samples and events, and may end the motion by an error of their own.
pub trait Watch<E> {
    /// The simulation is at the time of a sample.
    ///
    /// # Errors
    ///
    /// Ends the motion.
    fn sample(&mut self, simulation: &Simulation<'_>) -> Result<(), E>;

    /// An event happened, and the simulation is where it did.
    ///
    /// # Errors
    ///
    /// Ends the motion.
    fn event(&mut self, event: &Event, simulation: &Simulation<'_>) -> Result<(), E>;
}

/// Follows a motion that stands at its start, of which there is no sample: samples at `start + k step`, at
/// the end, and where the motion ends by itself.
///
/// # Errors
///
/// Those of the simulation, and of who watches.
pub fn follow<E: From<SimulationError>>(
    simulation: &mut Simulation<'_>,
    span: &Span,
    watch: &mut impl Watch<E>,
) -> Result<(), E> {
    let mut still = 0;
    for count in 1_u64.. {
        let end = (span.start + count as f64 * span.step).min(span.until);
        while let Progress::Event(event) = simulation.advance(end)? {
            watch.event(&event, simulation)?;
            if matches!(event.kind, EventKind::Singular) {
                // The motion has an end of its own.
                return watch.sample(simulation);
            }
        }
        watch.sample(simulation)?;
        let is_still = simulation.speeds().iter().all(|speed| speed.abs() <= STILL);
        still = if is_still { still + 1 } else { 0 };
        if end >= span.until || span.at_rest && still >= RESTS {
            break;
        }
    }
    Ok(())
}
