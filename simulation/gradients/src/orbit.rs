//! Finds periodic motions: states to which a motion returns, with their multipliers.
//!
//! Theory: docs/theory.md, section 20.

use std::collections::BTreeSet;
use std::fmt;

use hodograph::{ComponentKind, Mechanism, State};
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Event, EventKind, Options, Progress, Simulation};
use nalgebra::{Complex, DMatrix, DVector};

use crate::closed::Closed;
use crate::motion::{Start, differentiate_from};
use crate::{By, GradientError, Undefined};

/// The end of a period.
#[derive(Clone, Debug, PartialEq)]
pub enum Return {
    /// After this time, s: for motions that are driven in time.
    After(f64),
    /// Just after an event: the `count`-th of this name (`collision`, `stick`, ..) at this contact, or at
    /// any.
    At {
        /// its name: [`EventKind::name`]
        event: String,
        /// index of the contact
        contact: Option<usize>,
        /// number of such events in a period, at least 1
        count: usize,
    },
}

impl Return {
    /// The names of the events that may end a period: those whose times have derivatives.
    pub const EVENTS: [&'static str; 4] = ["collision", "lift_off", "slip", "stick"];
}

/// The definition of a periodic motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// the end of a period
    pub returns: Return,
    /// coordinates that are reset to their initial values after each period: those on which nothing depends,
    /// and those that a symmetry brings back (the next leg, the next spoke)
    pub reset: Vec<usize>,
    /// what a symmetry does to the state that has returned, before that
    pub symmetry: Vec<Exchange>,
    /// the longest period to wait for, s
    pub longest: f64,
}

/// A component of the returned state (coordinates, then independent speeds) takes the place of another one, as those of the
/// other leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exchange {
    /// the component that is replaced
    pub to: usize,
    /// the component whose value it takes
    pub from: usize,
    /// whether its sign is turned
    pub turned: bool,
}

impl Exchange {
    /// The exchange `TO=FROM` or `TO=-FROM` of coordinates or independent speeds of these names.
    ///
    /// # Errors
    ///
    /// A sentence that says what is wrong.
    pub fn named(mechanism: &InterpretedMechanism, text: &str) -> Result<Self, String> {
        let form = || format!("`{text}` is no exchange: give TO=FROM or TO=-FROM, as in q1=q2");
        let (to, from) = text.split_once('=').ok_or_else(form)?;
        let from = from.trim();
        let (turned, from) = from.strip_prefix('-').map_or((false, from), |from| (true, from));
        let n = mechanism.count(ComponentKind::Coordinate);
        let index = |name: &str| {
            let name = name.trim();
            let speed = || mechanism.index(ComponentKind::Speed, name).map(|index| n + index);
            let found = mechanism.index(ComponentKind::Coordinate, name).or_else(speed);
            found.ok_or_else(|| format!("there is no coordinate or independent speed `{name}`"))
        };
        Ok(Exchange { to: index(to)?, from: index(from)?, turned })
    }
}

/// A periodic motion.
#[derive(Clone, Debug)]
pub struct Orbit {
    /// initial coordinates and independent speeds
    pub state: Vec<f64>,
    /// its period, s
    pub period: f64,
    /// its events, in order
    pub events: Vec<Event>,
    /// derivatives of the returned state with respect to the initial state; columns of coordinates that are
    /// reset are zero, and so are derivatives along directions in which initially closed contacts would
    /// separate or slip
    pub matrix: DMatrix<f64>,
    /// the eigenvalues of that matrix, the greatest first
    pub multipliers: Vec<Complex<f64>>,
    /// derivatives of the returned state with respect to each of the given variables (rows as in `matrix`)
    pub by: DMatrix<f64>,
    /// the remaining difference between both states, relative to their size
    pub residual: f64,
}

impl Orbit {
    /// Whether all multipliers lie inside the unit circle.
    pub fn is_stable(&self) -> bool {
        self.multipliers.first().is_none_or(|first| first.norm() < 1.0)
    }
}

/// Why no periodic motion is found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum OrbitError {
    /// A motion cannot be simulated or differentiated.
    Gradient(GradientError),
    /// The motion from the start has no derivative.
    Undefined(Undefined),
    /// The motion does not return within the longest period, s.
    NoReturn(f64),
    /// Newton's method does not converge: the smallest residual so far.
    NotFound(f64),
    /// The task has a mistake.
    BadRequest(String),
}

impl fmt::Display for OrbitError {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gradient(error) => error.fmt(out),
            Self::Undefined(why) => write!(out, "the motion is not differentiable: {why}"),
            Self::NoReturn(longest) => write!(
                out,
                "the motion does not return within {longest} s: begin nearer to the periodic motion, or allow a longer period"
            ),
            Self::NotFound(residual) => write!(
                out,
                "no periodic motion is found: the nearest misses by {residual:e} of the state; begin nearer to one"
            ),
            Self::BadRequest(what) => out.write_str(what),
        }
    }
}

impl std::error::Error for OrbitError {}

impl From<GradientError> for OrbitError {
    fn from(error: GradientError) -> Self {
        Self::Gradient(error)
    }
}

/// Largest numbers of Newton steps, and of halvings of one.
const STEPS: usize = 30;
const HALVINGS: usize = 12;
/// A motion is periodic if it returns to its state up to this relative difference, and Newton's method does
/// not decrease it any more.
const TOLERANCE: f64 = 1e-9;
/// Singular values below this part of the greatest count as zero.
const SINGULAR: f64 = 1e-12;

/// Finds the periodic motion next to a start state by Newton's method with derivatives of the return map, and
/// differentiates it with respect to `by` (parameters, mu, e).
///
/// # Errors
///
/// [`OrbitError`]
pub fn find_orbit(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
    periodic: &Periodic,
    by: &[By],
) -> Result<Orbit, OrbitError> {
    check(mechanism, start, periodic)?;
    let mut state: Vec<f64> = start.coordinates.iter().chain(start.speeds).copied().collect();
    let task = Task { mechanism, start, options, periodic, by, closed: Closed::new(mechanism, start) };
    task.close(&mut state)?;
    let mut here = task.returned(&state)?;
    for _ in 0..STEPS {
        let matrix = &here.matrix - DMatrix::identity(state.len(), state.len());
        let step = solve(&matrix, &-here.difference(&state));
        let mut nearer = None;
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let mut trial: Vec<f64> =
                state.iter().zip(step.iter()).map(|(value, step)| value + part * step).collect();
            task.close(&mut trial)?;
            if let Ok(there) = task.returned(&trial)
                && there.residual < here.residual
            {
                nearer = Some((trial, there));
                break;
            }
            part *= 0.5;
        }
        let Some(found) = nearer else { break };
        (state, here) = found;
    }
    if here.residual > TOLERANCE { Err(OrbitError::NotFound(here.residual)) } else { Ok(here.orbit(state)) }
}

fn check(mechanism: &InterpretedMechanism, start: &State<'_>, periodic: &Periodic) -> Result<(), OrbitError> {
    let bad = |what: &str| Err(OrbitError::BadRequest(what.to_owned()));
    if periodic.reset.iter().any(|&index| index >= mechanism.count(ComponentKind::Coordinate)) {
        return bad("a coordinate that is reset does not exist");
    }
    let count = start.coordinates.len() + start.speeds.len();
    if periodic.symmetry.iter().any(|exchange| exchange.to >= count || exchange.from >= count) {
        return bad("a component that is exchanged does not exist");
    }
    let n = start.coordinates.len();
    if periodic.symmetry.iter().any(|exchange| (exchange.to < n) != (exchange.from < n)) {
        return bad("a coordinate takes the value of a coordinate, and a speed that of a speed");
    }
    let places: BTreeSet<usize> = periodic.symmetry.iter().map(|exchange| exchange.to).collect();
    if places.len() < periodic.symmetry.len() {
        return bad("a component is exchanged twice");
    }
    if !mechanism.quaternions().is_empty() {
        return bad("periodic motions of mechanisms with quaternions are not supported: use angles");
    }
    match periodic.returns {
        Return::After(period) if !(period > 0.0 && period.is_finite()) => {
            bad("the period must be positive and finite")
        }
        Return::At { count: 0, .. } => bad("at least one event must make a period"),
        Return::At { .. } if !(periodic.longest > 0.0 && periodic.longest.is_finite()) => {
            bad("the longest period must be positive and finite")
        }
        _ if start.coordinates.len() != mechanism.count(ComponentKind::Coordinate) => {
            bad("the start state has another number of coordinates")
        }
        _ => Ok(()),
    }
}

/// The least-norm solution of a system that may be singular.
pub(crate) fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    let decomposed = matrix.clone().svd(true, true);
    let least = SINGULAR * decomposed.singular_values.max();
    decomposed.solve(right, least).unwrap_or_else(|_| DVector::zeros(right.len()))
}

/// The return map, which is evaluated at different states.
pub(crate) struct Task<'a> {
    pub mechanism: &'a InterpretedMechanism,
    pub start: &'a State<'a>,
    pub options: &'a Options,
    pub periodic: &'a Periodic,
    pub by: &'a [By],
    /// the contacts that are closed in the start state
    pub closed: Closed,
}

impl Task<'_> {
    /// Moves a state so that contacts which are closed at the start stay closed.
    pub fn close(&self, state: &mut [f64]) -> Result<(), OrbitError> {
        self.closed.close(self.mechanism, self.start, state).map_err(|reason| {
            OrbitError::Undefined(Undefined { time: self.start.time, contact: None, reason })
        })
    }

    /// The time at the end of the period, s.
    fn time(&self, state: &State<'_>) -> Result<f64, OrbitError> {
        let (name, contact, count) = match &self.periodic.returns {
            Return::After(period) => return Ok(state.time + period),
            Return::At { event, contact, count } => (event, contact, count),
        };
        let mut simulation = Simulation::new(self.mechanism, state, self.options.clone())
            .map_err(|error| OrbitError::Gradient(error.into()))?;
        let mut left = *count;
        let until = state.time + self.periodic.longest;
        loop {
            match simulation.advance(until).map_err(|error| OrbitError::Gradient(error.into()))? {
                Progress::Reached => return Err(OrbitError::NoReturn(self.periodic.longest)),
                Progress::Event(event) if matches!(event.kind, EventKind::Singular) => {
                    return Err(OrbitError::NoReturn(self.periodic.longest));
                }
                Progress::Event(event) => {
                    let is_it = event.kind.name() == name
                        && event.time > state.time
                        && (contact.is_none() || event.contact == *contact);
                    left -= usize::from(is_it);
                    if left == 0 {
                        return Ok(event.time);
                    }
                }
            }
        }
    }

    /// The return from a state.
    pub fn returned(&self, state: &[f64]) -> Result<Returned, OrbitError> {
        let (coordinates, speeds) = state.split_at(self.start.coordinates.len());
        let from = State { coordinates, speeds, ..*self.start };
        let (n, count) = (from.coordinates.len(), state.len());
        let time = self.time(&from)?;
        let kept = |index: &usize| !self.periodic.reset.contains(index);
        let variables = (0..n).filter(kept).map(By::Coordinate);
        let variables: Vec<By> = variables.chain((0..count - n).map(By::Speed)).collect();
        let all: Vec<By> = variables.iter().chain(self.by).copied().collect();
        let found =
            differentiate_from(self.mechanism, &from, self.options.clone(), &all, &[time], Start::Held)?;
        if let Some(why) = found.undefined {
            return Err(OrbitError::Undefined(why));
        }
        let (last, derivative) = match self.periodic.returns {
            Return::After(_) => {
                let last = found.samples.last();
                last.map(|sample| (sample.state.clone(), sample.derivative.clone()))
            }
            Return::At { .. } => {
                let last = found.events.iter().rev().find(|event| event.after.is_some());
                last.map(|last| {
                    let state = [&last.event.coordinates[..], &last.event.speeds].concat();
                    (state, last.after.clone())
                })
            }
        }
        .ok_or(OrbitError::NoReturn(self.periodic.longest))?;
        let derivative = derivative.ok_or(OrbitError::NoReturn(self.periodic.longest))?;
        let mut matrix = DMatrix::zeros(count, count);
        let mut by = derivative.columns(variables.len(), self.by.len()).into_owned();
        for (column, variable) in variables.iter().enumerate() {
            let place = match *variable {
                By::Coordinate(index) => index,
                By::Speed(index) => n + index,
                _ => continue,
            };
            matrix.set_column(place, &derivative.column(column));
        }
        let (mut end, before, by_before, matrix_before) = (last.clone(), last, by.clone(), matrix.clone());
        for &Exchange { to, from, turned } in &self.periodic.symmetry {
            let sign = if turned { -1.0 } else { 1.0 };
            end[to] = sign * before[from];
            matrix.set_row(to, &(matrix_before.row(from) * sign));
            by.set_row(to, &(by_before.row(from) * sign));
        }
        for &index in &self.periodic.reset {
            matrix.row_mut(index).fill(0.0);
            by.row_mut(index).fill(0.0);
            end[index] = state[index];
        }
        let size = state.iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
        let off = end.iter().zip(state).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        Ok(Returned {
            end,
            period: time - from.time,
            events: found.events.into_iter().map(|event| event.event).collect(),
            matrix,
            by,
            residual: off / size,
        })
    }
}

/// A motion over one period.
pub(crate) struct Returned {
    end: Vec<f64>,
    period: f64,
    events: Vec<Event>,
    pub matrix: DMatrix<f64>,
    pub by: DMatrix<f64>,
    pub residual: f64,
}

impl Returned {
    /// The difference between its end and its start.
    pub fn difference(&self, state: &[f64]) -> DVector<f64> {
        DVector::from_iterator(state.len(), self.end.iter().zip(state).map(|(end, start)| end - start))
    }

    /// The periodic motion with this state.
    pub fn orbit(self, state: Vec<f64>) -> Orbit {
        let Self { period, events, matrix, by, residual, .. } = self;
        let mut multipliers: Vec<Complex<f64>> = matrix.complex_eigenvalues().iter().copied().collect();
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        Orbit { state, period, events, matrix, multipliers, by, residual }
    }
}
