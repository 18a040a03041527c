//! Many motions at once: [`simulate_many`].
//!
//! Rows are independent of each other, so outcomes have the same bits in any order and on any number of
//! threads. An error of a row is the outcome of that row.

use std::ops::Deref;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use hodograph::{Contacts, State};

use crate::{
    ContactPhase, EnergyAccount, ErrorKind, Event, EventKind, Options, Progress, Simulation, SimulationError,
};

/// One of many motions: a mechanism with its parameters, an initial state, and the options of the simulation.
#[derive(Clone, Debug)]
pub struct Case<M> {
    /// the mechanism: `&machine` for one that all rows share, `Box::new(machine)` for one per row
    pub mechanism: M,
    /// time at the start, s
    pub time: f64,
    /// coordinates at the start
    pub coordinates: Vec<f64>,
    /// independent speeds at the start
    pub speeds: Vec<f64>,
    /// inputs at the start
    pub inputs: Vec<f64>,
    /// the options of the simulation
    pub options: Options,
    /// final time, s
    pub until: f64,
}

/// The outcome of a motion.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Outcome {
    /// final time: that of the case, or that of the error, s
    pub time: f64,
    /// time since which the mechanism is at rest, s; `None` if it moves at the end
    pub rest: Option<f64>,
    /// coordinates at the end
    pub coordinates: Vec<f64>,
    /// independent speeds at the end
    pub speeds: Vec<f64>,
    /// indices of the contacts that are closed at the end, increasing: the face on which a body lies
    pub closed: Vec<usize>,
    /// the energy account at the end
    pub energy: EnergyAccount,
    /// number of collisions; a simultaneous impact of several contacts counts as one
    pub collisions: usize,
    /// number of events
    pub events: usize,
    /// whether an event of the motion reported that other modes were possible
    pub several_modes: bool,
    /// whether [`Batch::stop`] ended the motion at an event
    pub stopped: bool,
    /// why the motion ended early; the other fields then belong to the last time that was reached
    pub error: Option<SimulationError>,
}

impl Outcome {
    /// A name, lower case and stable between versions: `rest`, `stopped`, `moving`, or the kind of the error.
    pub fn kind(&self) -> &'static str {
        match (&self.error, self.rest) {
            (Some(error), _) => error.kind.name(),
            (None, Some(_)) => "rest",
            (None, None) if self.stopped => "stopped",
            (None, None) => "moving",
        }
    }

    fn bits(&self, add: &mut impl FnMut(u64)) {
        add(self.time.to_bits());
        add(self.rest.map_or(u64::MAX, f64::to_bits));
        self.coordinates.iter().chain(&self.speeds).for_each(|value| add(value.to_bits()));
        self.closed.iter().for_each(|&contact| add(contact as u64));
        let EnergyAccount { kinetic, potential, friction, impacts, inputs } = self.energy;
        for energy in [kinetic, potential.unwrap_or(f64::NAN), friction, impacts, inputs] {
            add(energy.to_bits());
        }
        add(self.collisions as u64);
        add(self.events as u64);
        add(u64::from(self.several_modes));
        self.kind().bytes().for_each(|byte| add(u64::from(byte)));
    }
}

/// A hash of all bits of outcomes, in order: equal outcomes have equal digests.
pub fn digest<'o>(outcomes: impl IntoIterator<Item = &'o Outcome>) -> u64 {
    // FNV-1a over words.
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for outcome in outcomes {
        outcome.bits(&mut |word| hash = (hash ^ word).wrapping_mul(0x0100_0000_01b3).rotate_left(29));
    }
    hash
}

/// Observes a batch from another thread, and can cancel it.
#[derive(Debug, Default)]
pub struct Watch {
    done: AtomicUsize,
    cancelled: AtomicBool,
}

impl Watch {
    /// An observer of a batch that has not started.
    pub const fn new() -> Self {
        Self { done: AtomicUsize::new(0), cancelled: AtomicBool::new(false) }
    }

    /// The number of finished rows.
    pub fn done(&self) -> usize {
        self.done.load(Ordering::Relaxed)
    }

    /// Cancels the batch: no further rows start, and running ones end after a hundredth of their time or an
    /// event.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether the batch was cancelled.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }
}

/// Whether the motion of a row ends at this event.
pub type StopAt<'s> = &'s (dyn Fn(usize, &Event) -> bool + Sync);

/// The execution of a batch.
#[derive(Clone, Copy, Default)]
pub struct Batch<'w> {
    /// Number of threads; `None`: those of the caller's pool, else one per core. Without the feature
    /// `parallel` there is one.
    pub threads: Option<usize>,
    /// The observer, which can cancel the batch.
    pub watch: Option<&'w Watch>,
    /// Ends the motion of a row at its first event for which this is true.
    pub stop: Option<StopAt<'w>>,
}

impl std::fmt::Debug for Batch<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { threads, watch, stop } = self;
        out.debug_struct("Batch")
            .field("threads", threads)
            .field("watch", watch)
            .field("stop", &stop.is_some())
            .finish()
    }
}

/// Simulates the motions of `rows` cases, each made from its index, and returns their outcomes in that order;
/// `None` for rows that a [`Watch`] has cancelled.
///
/// With the feature `parallel` they share the cores. An error of a row, including one of its `case`, is in
/// its outcome.
///
/// ```
/// use hodograph::{Law, Surface};
/// use hodograph_models::slender_rod_5dof::{Coordinates, SlenderRod5dof};
/// use hodograph_simulation::{Batch, Case, Options, simulate_many};
///
/// let rod = SlenderRod5dof::<f64>::default();
/// // The same fall on ten surfaces.
/// let case = |row: usize| {
///     let surface = Surface { mu: 0.1 * row as f64, e: 0.5, law: Law::Stronge };
///     let q: [f64; 5] = Coordinates { z: 2.0, ..Coordinates::default() }.into();
///     let options = Options { surface: Some(surface), ..Options::default() };
///     let (coordinates, speeds, inputs) = (q.to_vec(), vec![0.0; 5], vec![]);
///     Ok(Case { mechanism: &rod, time: 0.0, coordinates, speeds, inputs, options, until: 1.0 })
/// };
/// for outcome in simulate_many(10, case, &Batch::default()).into_iter().flatten() {
///     println!("{} at {} s, on {:?}", outcome.kind(), outcome.time, outcome.closed);
/// }
/// ```
pub fn simulate_many<M>(
    rows: usize,
    case: impl Fn(usize) -> Result<Case<M>, SimulationError> + Sync,
    batch: &Batch<'_>,
) -> Vec<Option<Outcome>>
where
    M: Deref<Target: Contacts<f64> + Sized>,
{
    let none = Watch::new();
    let watch = batch.watch.unwrap_or(&none);
    let one = |row: usize| {
        if watch.is_cancelled() {
            return None;
        }
        let outcome = match case(row) {
            Ok(case) => follow(&case, watch, &|event| batch.stop.is_some_and(|stop| stop(row, event)))?,
            Err(error) => Outcome { time: error.time, error: Some(error), ..Outcome::default() },
        };
        watch.done.fetch_add(1, Ordering::Relaxed);
        Some(outcome)
    };
    spread(rows, batch.threads, &one)
}

#[cfg(feature = "parallel")]
fn spread(
    rows: usize,
    threads: Option<usize>,
    one: &(dyn Fn(usize) -> Option<Outcome> + Sync),
) -> Vec<Option<Outcome>> {
    use rayon::prelude::*;
    // Motions take different times: each is given to the next free thread.
    let all = || (0..rows).into_par_iter().with_max_len(1).map(one).collect();
    match threads.map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build()) {
        Some(Ok(pool)) => pool.install(all),
        // If the operating system provides no threads of our own, existing ones are used.
        Some(Err(_)) | None => all(),
    }
}

#[cfg(not(feature = "parallel"))]
fn spread(
    rows: usize,
    _threads: Option<usize>,
    one: &(dyn Fn(usize) -> Option<Outcome> + Sync),
) -> Vec<Option<Outcome>> {
    (0..rows).map(one).collect()
}

/// Looks at the watch so often while a motion goes on.
const LOOKS: u32 = 100;

/// One motion; `None` where the watch ends it.
fn follow<M>(case: &Case<M>, watch: &Watch, stop: &dyn Fn(&Event) -> bool) -> Option<Outcome>
where
    M: Deref<Target: Contacts<f64> + Sized>,
{
    let state =
        State { time: case.time, coordinates: &case.coordinates, speeds: &case.speeds, inputs: &case.inputs };
    let mut outcome = Outcome { time: case.time, ..Outcome::default() };
    let failed = |error| Outcome {
        time: case.time,
        coordinates: case.coordinates.clone(),
        speeds: case.speeds.clone(),
        error: Some(error),
        ..Outcome::default()
    };
    let mechanism: &M::Target = &case.mechanism;
    let lasts = case.until - case.time;
    if !(lasts >= 0.0 && lasts.is_finite()) {
        let message = format!("until is {}: it must be finite, and not before the start", case.until);
        return Some(failed(SimulationError::new(mechanism, case.time, None, ErrorKind::BadOption(message))));
    }
    let mut options = case.options.clone();
    // The last step ends with the motion: coordinates, contacts and energies are those of one time.
    let place = options.breaks.partition_point(|time| *time < case.until);
    if case.until > case.time && options.breaks.get(place) != Some(&case.until) {
        options.breaks.insert(place, case.until);
    }
    let mut simulation = match Simulation::new(mechanism, &state, options) {
        Ok(simulation) => simulation,
        Err(error) => return Some(failed(error)),
    };
    for look in 1..=LOOKS {
        let until =
            if look == LOOKS { case.until } else { case.time + lasts * f64::from(look) / f64::from(LOOKS) };
        loop {
            if watch.is_cancelled() {
                return None;
            }
            match simulation.advance(until) {
                Ok(Progress::Event(event)) => {
                    outcome.count(&event.kind, event.time);
                    outcome.stopped = stop(&event);
                    if outcome.stopped {
                        break;
                    }
                }
                Ok(Progress::Reached) => break,
                Err(error) => {
                    outcome.error = Some(error);
                    break;
                }
            }
        }
        if outcome.stopped || outcome.error.is_some() {
            break;
        }
    }
    if outcome.error.is_some() {
        simulation.look_at_front();
    }
    outcome.end(&simulation);
    Some(outcome)
}

impl Outcome {
    fn count(&mut self, kind: &EventKind, time: f64) {
        self.events += 1;
        match kind {
            EventKind::Collision(_)
            | EventKind::SimultaneousCollision(_)
            | EventKind::ImpactWithoutCollision(_) => self.collisions += 1,
            EventKind::Rest => self.rest = Some(time),
            _ => {}
        }
        self.several_modes |= kind.selection() == Some(hodograph::Selection::SeveralModes);
    }

    fn end(&mut self, simulation: &Simulation<'_>) {
        self.time = simulation.time();
        self.coordinates = simulation.coordinates().to_vec();
        self.speeds = simulation.speeds().to_vec();
        let phases = (0..).map_while(|contact| simulation.phase(contact)).enumerate();
        self.closed =
            phases.filter(|(_, phase)| *phase != ContactPhase::Open).map(|(contact, _)| contact).collect();
        if !simulation.is_at_rest() {
            self.rest = None;
        }
        match simulation.energy() {
            Ok(energy) => self.energy = energy,
            Err(error) => {
                self.error.get_or_insert(error);
            }
        }
    }
}
