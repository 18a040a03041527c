//! Carries derivatives through the smooth parts and events of a motion.
//!
//! Theory: docs/theory.md, section 19.

use std::cell::OnceCell;
use std::ops::Range;

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::stepper::{Tolerances, step};
use hodograph_simulation::{Event, EventKind, Guard, Options, SmoothPart};
use nalgebra::{DMatrix, DVector};

use crate::by::NonDifferentiable;
use crate::collocation::{Collocation, Stages, Stretch};
use crate::field::{At, Direction, Field, Sampling};
use crate::followed::{Followed, GradientError, Sample};
use crate::force_jumps::{Place, jump};
use crate::junction::{EventDerivatives, Junction};
use crate::modes::{Mode, ModeKind};
use crate::{By, Reason, Undefined, closed};

/// The states of the repeated integration agree with those of the motion to this part of their size.
const STATE_AGREEMENT: f64 = 1e-6;
/// At the start, the rate at which closed contacts separate along a direction may be at most this part of its
/// terms.
const MAX_SEPARATION: f64 = 1e-9;
/// Largest number of explicit steps within one step of the motion. It is tried first; where a contact slides and more
/// than `FEW_STEPS` are needed, the equations are stiff.
const MAX_STEPS: usize = 20_000;
const FEW_STEPS: usize = 32;

/// A motion with its derivatives. Matrices have a row per coordinate and independent speed, in the units of
/// the model, and a column per variable.
#[derive(Clone, Debug)]
pub struct MotionGradient {
    /// the variables
    pub by: Vec<By>,
    /// the events up to the last of the given times
    pub events: Vec<EventGradient>,
    /// the states at the given times
    pub samples: Vec<Sample>,
    /// the time and the reason if derivatives end
    pub undefined: Option<Undefined>,
}

/// An event with derivatives: of its time, and of the state at this time, which changes with the variables.
#[derive(Clone, Debug)]
pub struct EventGradient {
    /// the event
    pub event: Event,
    /// derivatives of its time, s per unit of the variable; `None` if the motion is not differentiable up to
    /// there, or if the time is only reported (the end of bounces, rest)
    pub time: Option<DVector<f64>>,
    /// derivatives of the state at the event, before all events at this time
    pub before: Option<DMatrix<f64>>,
    /// derivatives of the state at the event, after it
    pub after: Option<DMatrix<f64>>,
}

/// Simulates the motion from a start state to the last of the `times`, which increase, and differentiates it
/// with respect to each of `by`.
///
/// The components of a quaternion of the start state are treated as independent numbers, which are then
/// normalised.
///
/// # Errors
///
/// [`GradientError`]. A motion without derivatives is not an error: see [`MotionGradient::undefined`].
pub fn differentiate(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: Options,
    by: &[By],
    times: &[f64],
) -> Result<MotionGradient, GradientError> {
    differentiate_from(mechanism, start, options, by, times, Start::Free)
}

/// How the derivatives of a start state with closed contacts are formed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Start {
    /// As given; a variable whose change opens a contact has no derivative.
    Free,
    /// Coordinates are projected by the least change, and speeds by that of least kinetic energy, so that closed contacts
    /// stay closed and do not begin to slip.
    Held,
}

/// Like [`differentiate`].
pub(crate) fn differentiate_from(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: Options,
    by: &[By],
    times: &[f64],
    how: Start,
) -> Result<MotionGradient, GradientError> {
    let followed = Followed::new(mechanism, start, options, by, times)?;
    let directions = by.iter().map(|&by| vec![(by, 1.0)]).collect();
    let mut propagation = Propagation::new(&followed, mechanism, start, directions);
    propagation.follow(&followed, how);
    Ok(MotionGradient { by: by.to_vec(), ..propagation.motion })
}

/// The derivatives of the start state along directions (n + p rows, a column for each and one more).
pub(crate) fn seeds(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    directions: &[Direction],
) -> Vec<f64> {
    let (n, k) = (start.coordinates.len(), directions.len() + 1);
    let mut by = vec![0.0; (n + start.speeds.len()) * k];
    for (direction, variables) in directions.iter().enumerate() {
        for &(variable, rate) in variables {
            match variable {
                By::Coordinate(index) => by[index * k + direction] += rate,
                By::Speed(index) => by[(n + index) * k + direction] += rate,
                _ => {}
            }
        }
    }
    for quaternion in mechanism.quaternions() {
        let parts = quaternion.map(|index| start.coordinates[index]);
        let square: f64 = parts.iter().map(|part| part * part).sum();
        for direction in 0..k {
            let along: f64 =
                quaternion.iter().zip(parts).map(|(&index, part)| by[index * k + direction] * part).sum();
            for (&index, part) in quaternion.iter().zip(parts) {
                let rate = &mut by[index * k + direction];
                *rate = (*rate - along * part / square) / square.sqrt();
            }
        }
    }
    by
}

/// The state of the propagation of derivatives through a motion.
pub(crate) struct Propagation<'m> {
    pub field: Field<'m>,
    /// steps of stiff parts, once there is one
    collocation: OnceCell<Collocation<'m>>,
    sampling: Option<Sampling>,
    tolerances: Tolerances,
    /// derivatives of the state: n + p rows, k columns
    by: Vec<f64>,
    /// magnitudes of the terms that these were added up from: what closed contacts leave of them is rounding of these
    terms: Vec<f64>,
    /// the state with which derivatives came to the end of the last part
    reached: Vec<f64>,
    /// the modes during the last part of slip
    stopping: Vec<Mode>,
    /// time of the previous events, s
    since: f64,
    pub motion: MotionGradient,
    /// how the derivatives were carried, if that is to be kept
    pub pieces: Option<Vec<Piece>>,
}

/// One after the other these take derivatives through a motion.
#[derive(Clone, Debug)]
pub(crate) enum Piece {
    /// A step of the integration within a part.
    Step {
        /// index of the part
        part: usize,
        t: f64,
        h: f64,
        /// the state at its start
        state: Vec<f64>,
    },
    /// A step of collocation within a part.
    Collocation { part: usize, stages: Stages },
    /// A line along the rates at the start of a part.
    Straight {
        part: usize,
        /// s
        time: f64,
        modes: Vec<Mode>,
    },
    /// The sample with this index is taken.
    Sample(usize),
    /// The events at the end of a part.
    Events {
        part: usize,
        junction: Box<Junction>,
        /// their indices
        events: Range<usize>,
    },
}

impl<'m> Propagation<'m> {
    pub fn new(
        followed: &Followed,
        mechanism: &'m InterpretedMechanism,
        start: &State<'_>,
        directions: Vec<Direction>,
    ) -> Self {
        let by = seeds(mechanism, start, &directions);
        Propagation {
            terms: by.iter().map(|by| by.abs()).collect(),
            by,
            field: Field::new(mechanism, directions, followed.surfaces.clone(), followed.sampling),
            collocation: OnceCell::new(),
            sampling: followed.sampling,
            tolerances: followed.tolerances.clone(),
            reached: followed.parts.first().map_or_else(Vec::new, |part| part.first.clone()),
            stopping: Vec::new(),
            since: followed.start,
            motion: MotionGradient {
                by: Vec::new(),
                events: Vec::new(),
                samples: followed.samples.clone(),
                undefined: None,
            },
            pieces: None,
        }
    }

    /// Carries the derivatives through the motion.
    pub fn follow(&mut self, followed: &Followed, how: Start) {
        let Followed { parts, start, end, .. } = followed;
        let (start, end) = (*start, *end);
        let mut events = followed.events.iter().cloned().peekable();
        let at_once = |time: f64| move |event: &Event| event.time <= time;
        let first: Vec<Event> = std::iter::from_fn(|| events.next_if(at_once(start))).collect();
        if let Err(lacking) = self.begin(how, parts, &first) {
            self.lacks(start, lacking);
        }
        let known = self.motion.undefined.is_none().then(|| self.matrix(&self.by));
        self.motion.events.extend(first.into_iter().map(|event| EventGradient {
            event,
            time: known.as_ref().map(|by| DVector::zeros(by.ncols())),
            before: known.clone(),
            after: known.clone(),
        }));
        let mut sampled = self.sample(0, start);
        for (index, part) in parts.iter().enumerate() {
            if part.start >= end {
                break;
            }
            let rest = &self.motion.samples[sampled..];
            let within = sampled..sampled + rest.iter().take_while(|sample| sample.time < part.end).count();
            sampled = within.end;
            if self.motion.undefined.is_none()
                && let Err((time, why)) = self.through((index, part), within, end)
            {
                self.lacks(time, (None, why));
            }
            if part.end > end {
                break;
            }
            let here: Vec<Event> = std::iter::from_fn(|| events.next_if(at_once(part.end))).collect();
            self.at_end((index, part), parts.get(index + 1), here);
            sampled = self.sample(sampled, part.end);
        }
    }

    /// Checks the start: closed contacts must stay closed along all directions.
    pub fn begin(
        &mut self,
        how: Start,
        parts: &[SmoothPart],
        events: &[Event],
    ) -> Result<(), NonDifferentiable> {
        let contacts = self.field.mechanism.count(ComponentKind::Contact);
        if parts.iter().flat_map(|part| &part.closed).any(|closed| closed.contact >= contacts) {
            return Err((None, Reason::ModesChanged));
        }
        let struck = events.iter().find(|event| {
            let kind = &event.kind;
            matches!(
                kind,
                EventKind::Collision(_)
                    | EventKind::SimultaneousCollision(_)
                    | EventKind::ImpactWithoutCollision(_)
            )
        });
        if let Some(event) = struck {
            return Err((event.contact, Reason::StartInCollision));
        }
        let Some(first) = parts.first() else { return Ok(()) };
        let modes = self.field.modes(first);
        if how == Start::Held {
            let contacts: Vec<usize> = first.closed.iter().map(|closed| closed.contact).collect();
            let (coordinates, speeds) = first.first.split_at(self.field.n);
            let state = State { time: first.start, coordinates, speeds, inputs: &first.inputs };
            closed::project(self.field.mechanism, &contacts, &state, &mut self.by, self.field.k)
                .map_err(|why| (None, why))?;
            let held = self.field.project(&modes, &self.field.at_start(first, &self.by));
            let (held, terms) = held.map_err(|why| (None, why))?;
            self.by = held;
            self.terms.iter_mut().zip(&terms).for_each(|(sum, term)| *sum += term);
        }
        match self
            .field
            .separation(&modes, &self.field.at_start(first, &self.by), &self.terms, 0.0)
            .map_err(|why| (None, why))?
        {
            Some((contact, direction, left)) if left > MAX_SEPARATION => {
                let variables = self.field.directions_of.get(direction);
                let by = variables.and_then(|variables| variables.first());
                Err((Some(contact), by.map_or(Reason::ModesChanged, |(by, _)| Reason::StartInContact(*by))))
            }
            _ => Ok(()),
        }
    }

    fn keep(&mut self, piece: impl FnOnce() -> Piece) {
        if let Some(pieces) = &mut self.pieces {
            pieces.push(piece());
        }
    }

    fn lacks(&mut self, time: f64, (contact, reason): NonDifferentiable) {
        self.motion.undefined.get_or_insert(Undefined { time, contact, reason });
    }

    fn matrix(&self, by: &[f64]) -> DMatrix<f64> {
        let k = self.field.k;
        DMatrix::from_fn(by.len() / k, k - 1, |row, column| by[row * k + column])
    }

    /// Copies derivatives to the samples up to a time, from the sample with the index `from` on; returns the
    /// index of the next sample.
    fn sample(&mut self, from: usize, time: f64) -> usize {
        let due = self.motion.samples[from..].iter().take_while(|sample| sample.time <= time).count();
        if self.motion.undefined.is_none() {
            let by = self.matrix(&self.by);
            for index in from..from + due {
                self.motion.samples[index].derivative = Some(by.clone());
                self.keep(|| Piece::Sample(index));
            }
        }
        from + due
    }

    /// Carries the derivatives through a part and to the samples within it; the error says from which time on
    /// this is impossible. The part is integrated again with derivatives, and must agree with the motion.
    fn through(
        &mut self,
        part: (usize, &SmoothPart),
        samples: Range<usize>,
        end: f64,
    ) -> Result<(), (f64, Reason)> {
        let (of, part) = part;
        let modes = self.field.modes(part);
        let count = part.first.len();
        let mut y = part.first.clone();
        y.extend_from_slice(&self.by);
        let mut now = part.start;
        for index in samples {
            let time = self.motion.samples[index].time;
            self.carry((of, part), &modes, (now, time), &mut y).map_err(|why| why.from(now))?;
            agree(&y[..count], &self.motion.samples[index].state).map_err(|why| why.from(now))?;
            self.motion.samples[index].derivative = Some(self.matrix(&y[count..]));
            self.keep(|| Piece::Sample(index));
            now = time;
        }
        self.carry((of, part), &modes, (now, part.end.min(end)), &mut y).map_err(|why| why.from(now))?;
        if part.end <= end {
            agree(&y[..count], &part.last).map_err(|why| why.from(now))?;
        }
        self.by.copy_from_slice(&y[count..]);
        self.reached.copy_from_slice(&y[..count]);
        Ok(())
    }

    /// State and derivatives, carried from one time to another within a part.
    fn carry(
        &mut self,
        part: (usize, &SmoothPart),
        modes: &[Mode],
        (from, to): (f64, f64),
        y: &mut [f64],
    ) -> Result<(), Reason> {
        match &part.1.ended_by {
            Some(Guard::Slip(_)) => {
                let time = to - from;
                self.stopping = self.field.modes_to_stop(part.1, &self.reached)?;
                let modes = self.stopping.clone();
                self.keep(|| Piece::Straight { part: part.0, time, modes });
                self.straight(part.1, &self.stopping, time, y)
            }
            _ => self.integrate(part, modes, (from, to), y),
        }
    }

    /// Integrates the variational equations from one time to another.
    fn integrate(
        &mut self,
        (of, part): (usize, &SmoothPart),
        modes: &[Mode],
        (from, to): (f64, f64),
        y: &mut [f64],
    ) -> Result<(), Reason> {
        let mut pieces = self.pieces.take();
        let (start, kept) = (y.to_vec(), pieces.as_ref().map_or(0, Vec::len));
        let return_to_start = |y: &mut [f64], pieces: &mut Option<Vec<Piece>>| {
            y.copy_from_slice(&start);
            pieces.iter_mut().for_each(|pieces| pieces.truncate(kept));
        };
        let rubs = |mode: &Mode| {
            matches!(mode.kind, ModeKind::Slide { .. })
                && self.field.surface(mode.contact).is_some_and(|surface| surface.mu > 0.0)
        };
        let may_be_stiff = modes.iter().any(rubs);
        let most = if may_be_stiff { FEW_STEPS } else { MAX_STEPS };
        let mut done = self.steps((of, part), modes, (from, to), y, (most, pieces.as_mut()));
        // No other steps pass a jump.
        let failed = |done: &Result<(), Reason>| matches!(done, Err(why) if !why.is_jump());
        if may_be_stiff && failed(&done) {
            return_to_start(y, &mut pieces);
            done = Stretch::new(&self.field, part, modes, &self.tolerances)
                .and_then(|stretch| self.collocate((of, &stretch), (from, to), y, pieces.as_mut()));
            if failed(&done) {
                return_to_start(y, &mut pieces);
                done = self.steps((of, part), modes, (from, to), y, (MAX_STEPS, pieces.as_mut()));
            }
        }
        self.pieces = pieces;
        done
    }

    /// Steps of collocation.
    pub(crate) fn collocation(&self) -> &Collocation<'m> {
        let make = || Collocation::new(self.field.mechanism, self.field.surfaces.clone(), self.sampling);
        self.collocation.get_or_init(make)
    }

    /// At most so many explicit steps.
    fn steps(
        &self,
        (of, part): (usize, &SmoothPart),
        modes: &[Mode],
        (from, to): (f64, f64),
        y: &mut [f64],
        (most, mut pieces): (usize, Option<&mut Vec<Piece>>),
    ) -> Result<(), Reason> {
        let count = part.first.len();
        let row = self.field.row(part.start);
        let mut failed = None;
        let mut rates = |time: f64, y: &[f64], rates: &mut [f64]| {
            let (state, by) = y.split_at(count);
            let at = At { time, state, by, time_by: &[], inputs: &part.inputs, row };
            match self.field.mode_rates(modes, &at) {
                Ok(mode_rates) => {
                    rates[..count].copy_from_slice(&mode_rates.rates);
                    rates[count..].copy_from_slice(&mode_rates.rates_by);
                }
                Err(why) => {
                    failed.get_or_insert(why);
                    rates.fill(f64::NAN);
                }
            }
        };
        let (mut now, mut h) = (from, to - from);
        let mut first: Option<Vec<f64>> = None;
        for _ in 0..most {
            if now >= to {
                return Ok(());
            }
            let Some(made) = step(&mut rates, (now, y, first.as_deref()), h, &self.tolerances) else { break };
            // The sum of steps may miss the end by rounding.
            let end = if made.h >= to - now { to } else { now + made.h };
            let mut last = vec![0.0; y.len()];
            rates(end, &made.end, &mut last);
            if let Some(time) =
                self.jumps((part, modes), (now, y, made.first().unwrap_or(&[])), (end, &made.end, &last))
            {
                return Err(Reason::ForceJump { time });
            }
            if let Some(pieces) = &mut pieces {
                pieces.push(Piece::Step { part: of, t: now, h: made.h, state: y[..count].to_vec() });
            }
            now = end;
            y.copy_from_slice(&made.end);
            h = made.next.min(to - now);
            first = Some(last);
        }
        Err(failed.unwrap_or(Reason::Inaccurate(f64::INFINITY)))
    }

    /// The time at which the rates of the state jump within a step, of which both ends are given by time, state and rates.
    pub(crate) fn jumps(
        &self,
        (part, modes): (&SmoothPart, &[Mode]),
        (from, before, first): (f64, &[f64], &[f64]),
        (to, after, last): (f64, &[f64], &[f64]),
    ) -> Option<f64> {
        let count = part.first.len();
        let none = vec![0.0; count * self.field.k];
        let rates = |time: f64, state: &[f64], rates: &mut [f64]| {
            let at = At { time, state, ..self.field.at_start(part, &none) };
            match self.field.mode_rates(modes, &at) {
                Ok(found) => rates.copy_from_slice(&found.rates),
                Err(_) => rates.fill(f64::NAN),
            }
        };
        let before = Place { time: from, state: &before[..count], rates: first.get(..count)? };
        let after = Place { time: to, state: &after[..count], rates: last.get(..count)? };
        jump(&before, &after, &self.tolerances, rates)
    }

    /// The last nanoseconds of slip, along a straight line.
    fn straight(&self, part: &SmoothPart, modes: &[Mode], time: f64, y: &mut [f64]) -> Result<(), Reason> {
        let count = part.first.len();
        let mode_rates = self.field.mode_rates(modes, &self.field.at_start(part, &y[count..]))?;
        let rates = mode_rates.rates.iter().chain(&mode_rates.rates_by);
        let rates: Vec<f64> = rates.copied().collect();
        y.iter_mut().zip(rates).for_each(|(value, rate)| *value += time * rate);
        Ok(())
    }

    /// Carries the derivatives through the events at the end of a part.
    fn at_end(&mut self, part: (usize, &SmoothPart), next: Option<&SmoothPart>, events: Vec<Event>) {
        let (of, part) = part;
        // If a normal force or the friction reaches its limit, but all contacts keep their modes, nothing
        // changes.
        let goes_on = |next: &SmoothPart| events.is_empty() && kinds(part) == kinds(next);
        let guard = part.ended_by.as_ref().filter(|guard| {
            let of_modes = matches!(guard, Guard::NormalForce(_) | Guard::Friction(_));
            !(of_modes && next.is_some_and(goes_on))
        });
        let passed = match (self.motion.undefined.is_some(), guard, next) {
            (true, ..) | (_, Some(Guard::Function(_)), _) => None,
            (_, _, None) => None,
            (false, None, Some(next)) => {
                // Only events that report earlier changes may occur here.
                if kinds(part) != kinds(next) {
                    self.lacks(part.end, (None, Reason::ModesChanged));
                }
                None
            }
            (false, Some(_), Some(next)) => match self.pass(part, next, &events) {
                Ok(passed) => {
                    self.by.copy_from_slice(&passed.by);
                    self.since = part.end;
                    let first = self.motion.events.len();
                    let (junction, events) = (&passed.junction, first..first + events.len());
                    self.keep(|| Piece::Events { part: of, junction: Box::new(junction.clone()), events });
                    Some(passed)
                }
                Err(lacking) => {
                    self.lacks(part.end, lacking);
                    None
                }
            },
        };
        for (index, event) in events.into_iter().enumerate() {
            let of = |passed: &EventDerivatives| EventGradient {
                event: event.clone(),
                time: Some(DVector::from_column_slice(&passed.time[..self.field.k - 1])),
                before: Some(self.matrix(&passed.before)),
                after: passed.after.get(index).map(|by| self.matrix(by)),
            };
            let told = || EventGradient { event: event.clone(), time: None, before: None, after: None };
            let gradient = passed.as_ref().map_or_else(told, of);
            self.motion.events.push(gradient);
        }
    }

    fn pass(
        &mut self,
        part: &SmoothPart,
        next: &SmoothPart,
        events: &[Event],
    ) -> Result<EventDerivatives, NonDifferentiable> {
        let modes = match &part.ended_by {
            Some(Guard::Slip(_)) => self.stopping.clone(),
            _ => self.field.modes(part),
        };
        self.field.pass((part, next), &modes, (&self.by, &mut self.terms), events, self.since)
    }
}

/// Whether a state of the repeated integration agrees with that of the motion.
fn agree(found: &[f64], expected: &[f64]) -> Result<(), Reason> {
    let size = expected.iter().fold(1.0_f64, |size, value| size.max(value.abs()));
    let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / size;
    // NaN agrees with nothing.
    if off <= STATE_AGREEMENT && found.iter().all(|value| value.is_finite()) {
        Ok(())
    } else {
        Err(Reason::Inaccurate(off))
    }
}

/// The closed contacts of a part, and whether they slide.
fn kinds(part: &SmoothPart) -> Vec<(usize, bool)> {
    part.closed.iter().map(|closed| (closed.contact, closed.slides.is_some())).collect()
}
