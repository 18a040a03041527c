//! The return of a motion to its start state, in segments: between nodes at fixed times each segment is a motion of its own,
//! and all of them join if the motion is periodic (multiple shooting).
//!
//! Theory: docs/theory.md, section 20.2.

use hodograph::State;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::{Event, EventKind, Options, Progress, Simulation};
use nalgebra::{Complex, DMatrix, DVector};

use crate::closed::Closed;
use crate::motion::{Start, differentiate_from};
use crate::periodic::{Exchange, Orbit, OrbitError, Periodic, Return};
use crate::{By, Undefined};

/// Nodes lie in the middle parts of this length of as many equal intervals as there are segments.
const MIDDLE: f64 = 0.8;

/// The beginning of a segment.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    /// its time, s
    pub time: f64,
    /// the contacts that are closed there
    closed: Closed,
}

/// The nodes of a motion, the first of which is the start.
#[derive(Clone, Debug)]
pub(crate) struct Nodes(Vec<Node>);

impl Nodes {
    /// One segment, the whole motion.
    pub fn whole(mechanism: &InterpretedMechanism, start: &State<'_>) -> Self {
        Nodes(vec![Node { time: start.time, closed: Closed::new(mechanism, start) }])
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Times and states of the nodes.
    fn with<'s>(&self, states: &'s [f64]) -> impl Iterator<Item = (&Node, &'s [f64])> {
        self.0.iter().zip(states.chunks_exact(states.len() / self.0.len()))
    }
}

/// The return map of one mechanism, in the segments of `nodes`.
pub(crate) struct Task<'a> {
    pub mechanism: &'a InterpretedMechanism,
    pub start: &'a State<'a>,
    pub options: &'a Options,
    pub periodic: &'a Periodic,
    pub by: &'a [By],
    pub nodes: &'a Nodes,
}

/// The end of a segment: its time, s, or the event after which this number of returning events has happened in it.
enum End {
    At(f64),
    Event(usize),
}

/// The motion of a segment: the state at its end, and its derivatives by all coordinates and speeds at its beginning, and by
/// the variables.
struct Segment {
    end: Vec<f64>,
    time: f64,
    events: Vec<Event>,
    matrix: DMatrix<f64>,
    by: DMatrix<f64>,
}

impl<'a> Task<'a> {
    /// Moves the states of all nodes so that contacts which are closed there stay closed.
    pub fn close(&self, states: &mut [f64]) -> Result<(), OrbitError> {
        let size = states.len() / self.nodes.count();
        for (node, state) in self.nodes.0.iter().zip(states.chunks_exact_mut(size)) {
            let at = State { time: node.time, ..*self.start };
            node.closed.close(self.mechanism, &at, state).map_err(|reason| {
                OrbitError::Undefined(Undefined { time: node.time, contact: None, reason })
            })?;
        }
        Ok(())
    }

    fn state<'s>(&self, time: f64, state: &'s [f64]) -> State<'s>
    where
        'a: 's,
    {
        let (coordinates, speeds) = state.split_at(self.start.coordinates.len());
        State { time, coordinates, speeds, inputs: self.start.inputs }
    }

    fn simulation(&self, state: &State<'_>) -> Result<Simulation<'a>, OrbitError> {
        Simulation::new(self.mechanism, state, self.options.clone())
            .map_err(|error| OrbitError::Gradient(error.into()))
    }

    /// Whether the motion may return at an event, which does not happen at the start.
    fn is_returning(&self, event: &Event) -> bool {
        match &self.periodic.returns {
            Return::After(_) => false,
            Return::At { event: name, contact, .. } => {
                event.kind.name() == name
                    && (contact.is_none() || event.contact == *contact)
                    && event.time > self.start.time
            }
        }
    }

    /// The end of a segment, before which this number of returning events has passed.
    fn end_of(&self, place: usize, passed: usize) -> Result<End, OrbitError> {
        match (self.nodes.0.get(place + 1), &self.periodic.returns) {
            (Some(next), _) => Ok(End::At(next.time)),
            (None, Return::After(period)) => Ok(End::At(self.start.time + period)),
            // The motion may have returned before the last node.
            (None, Return::At { count, .. }) => match count.checked_sub(passed) {
                None | Some(0) => Err(OrbitError::NoReturn(self.periodic.longest)),
                Some(left) => Ok(End::Event(left)),
            },
        }
    }

    /// The time of the end of a segment, and the events up to there, without derivatives.
    fn followed(&self, state: &State<'_>, end: &End) -> Result<(f64, Vec<Event>), OrbitError> {
        let mut simulation = self.simulation(state)?;
        let (until, mut left) = match *end {
            End::At(time) => (time, 0),
            End::Event(left) => (self.start.time + self.periodic.longest, left),
        };
        let mut events = Vec::new();
        loop {
            match simulation.advance(until).map_err(|error| OrbitError::Gradient(error.into()))? {
                Progress::Event(event) if !matches!(event.kind, EventKind::Singular) => {
                    let time = event.time;
                    let returns = self.is_returning(&event);
                    events.push(event);
                    if returns && left == 1 {
                        return Ok((time, events));
                    }
                    left = left.saturating_sub(usize::from(returns));
                }
                Progress::Reached if matches!(end, End::At(_)) => return Ok((until, events)),
                _ => return Err(OrbitError::NoReturn(self.periodic.longest)),
            }
        }
    }

    /// The motion from a state to the end of its segment. Derivatives by coordinates of `fixed` are left zero.
    fn segment(&self, time: f64, state: &[f64], end: &End, fixed: &[usize]) -> Result<Segment, OrbitError> {
        let from = self.state(time, state);
        let (n, count) = (from.coordinates.len(), state.len());
        let until = match *end {
            End::At(time) => time,
            End::Event(_) => self.followed(&from, end)?.0,
        };
        let variables = (0..n).filter(|index| !fixed.contains(index)).map(By::Coordinate);
        let variables: Vec<By> = variables.chain((0..count - n).map(By::Speed)).collect();
        let all: Vec<By> = variables.iter().chain(self.by).copied().collect();
        let found =
            differentiate_from(self.mechanism, &from, self.options.clone(), &all, &[until], Start::Held)?;
        if let Some(why) = found.undefined {
            return Err(OrbitError::Undefined(why));
        }
        let no_return = || OrbitError::NoReturn(self.periodic.longest);
        let (end, derivative) = match end {
            End::At(_) => {
                let last = found.samples.into_iter().next_back().ok_or_else(no_return)?;
                (last.state, last.derivative)
            }
            End::Event(_) => {
                let is_last = |event: &&crate::EventGradient| event.after.is_some();
                let last = found.events.iter().rev().find(is_last).ok_or_else(no_return)?;
                ([&last.event.coordinates[..], &last.event.speeds].concat(), last.after.clone())
            }
        };
        let derivative = derivative.ok_or_else(no_return)?;
        let mut matrix = DMatrix::zeros(count, count);
        for (column, variable) in variables.iter().enumerate() {
            let place = match *variable {
                By::Coordinate(index) => index,
                By::Speed(index) => n + index,
                _ => continue,
            };
            matrix.set_column(place, &derivative.column(column));
        }
        let by = derivative.columns(variables.len(), self.by.len()).into_owned();
        // What a node tells of its contacts is no event of the motion.
        let told = |event: &Event| time > self.start.time && event.time <= time;
        let events = found.events.into_iter().map(|event| event.event).filter(|event| !told(event)).collect();
        Ok(Segment { end, time: until, events, matrix, by })
    }

    /// The return from the states of all nodes.
    pub fn returned(&self, states: &[f64]) -> Result<Returned, OrbitError> {
        let mut segments: Vec<Segment> = Vec::with_capacity(self.nodes.count());
        for (place, (node, state)) in self.nodes.with(states).enumerate() {
            let passed = segments.iter().flat_map(|segment| &segment.events);
            let end = self.end_of(place, passed.filter(|event| self.is_returning(event)).count())?;
            let fixed: &[usize] = if place == 0 { &self.periodic.reset } else { &[] };
            segments.push(self.segment(node.time, state, &end, fixed)?);
        }
        let first = &states[..states.len() / self.nodes.count()];
        if let Some(last) = segments.last_mut() {
            self.bring_back(last, first);
        }
        Ok(Returned::new(segments, states, self.start.time))
    }

    /// What the symmetry and the reset do to the state that has returned.
    fn bring_back(&self, last: &mut Segment, start: &[f64]) {
        let (before, by, matrix) = (last.end.clone(), last.by.clone(), last.matrix.clone());
        for &Exchange { to, from, turned } in &self.periodic.symmetry {
            let sign = if turned { -1.0 } else { 1.0 };
            last.end[to] = sign * before[from];
            last.matrix.set_row(to, &(matrix.row(from) * sign));
            last.by.set_row(to, &(by.row(from) * sign));
        }
        for &index in &self.periodic.reset {
            last.matrix.row_mut(index).fill(0.0);
            last.by.row_mut(index).fill(0.0);
            last.end[index] = start[index];
        }
    }

    /// Nodes for as many segments as are asked for, far from all events, and the states there of the motion in the segments
    /// of now.
    pub fn divided(&self, states: &[f64]) -> Result<(Nodes, Vec<f64>), OrbitError> {
        let (mut end, mut events) = (self.start.time, Vec::new());
        for (place, (node, state)) in self.nodes.with(states).enumerate() {
            let passed = events.iter().filter(|event| self.is_returning(event)).count();
            let until = self.end_of(place, passed)?;
            let (time, own) = self.followed(&self.state(node.time, state), &until)?;
            end = time;
            events.extend(own);
        }
        let times: Vec<f64> = events.iter().map(|event| event.time - self.start.time).collect();
        let first = &states[..states.len() / self.nodes.count()];
        let (mut nodes, mut all) = (vec![self.nodes.0[0].clone()], first.to_vec());
        for time in node_times(&times, end - self.start.time, self.periodic.segments) {
            let time = self.start.time + time;
            let before = self.nodes.with(states).take_while(|(node, _)| node.time <= time).last();
            let Some((node, state)) = before else { continue };
            let mut simulation = self.simulation(&self.state(node.time, state))?;
            simulation.advance_to(time).map_err(|error| OrbitError::Gradient(error.into()))?;
            nodes.push(Node { time, closed: Closed::of(&simulation) });
            all.extend(simulation.coordinates().iter().chain(simulation.speeds()));
        }
        Ok((Nodes(nodes), all))
    }
}

/// Times of the inner nodes from the start, s: in each interval the one that is farthest from all events.
fn node_times(events: &[f64], period: f64, segments: usize) -> impl Iterator<Item = f64> {
    let length = period / segments as f64;
    (1..segments).map(move |place| {
        let middle = place as f64 * length;
        let (low, high) = (middle - 0.5 * MIDDLE * length, middle + 0.5 * MIDDLE * length);
        let between = events.windows(2).map(|pair| (0.5 * (pair[0] + pair[1])).clamp(low, high));
        let away = |time: f64| events.iter().map(|event| (event - time).abs()).fold(f64::INFINITY, f64::min);
        let farther = |best: f64, time: f64| if away(time) > away(best) { time } else { best };
        between.chain([low, high]).fold(middle, farther)
    })
}

/// A motion over one period.
pub(crate) struct Returned {
    /// the differences between the end of each segment and the beginning of the next one
    off: DVector<f64>,
    period: f64,
    events: Vec<Event>,
    /// derivatives of the end of each segment by its beginning
    matrices: Vec<DMatrix<f64>>,
    /// derivatives of the end of each segment by the variables
    by: Vec<DMatrix<f64>>,
    /// the greatest difference relative to the size of the states
    pub residual: f64,
}

impl Returned {
    fn new(segments: Vec<Segment>, states: &[f64], start: f64) -> Self {
        let period = segments.last().map_or(0.0, |last| last.time - start);
        let first = states.len() / segments.len().max(1);
        let next = states[first..].iter().chain(&states[..first]);
        let ends = segments.iter().flat_map(|segment| &segment.end);
        let off = DVector::from_iterator(states.len(), ends.zip(next).map(|(end, next)| end - next));
        let size = states.iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
        let residual = off.amax() / size;
        let (mut events, mut matrices, mut by) = (Vec::new(), Vec::new(), Vec::new());
        for segment in segments {
            events.extend(segment.events);
            matrices.push(segment.matrix);
            by.push(segment.by);
        }
        Self { off, period, events, matrices, by, residual }
    }

    /// The differences that vanish if the motion is periodic, of all segments.
    pub fn difference(&self) -> &DVector<f64> {
        &self.off
    }

    /// Their derivatives by the states of all nodes.
    pub fn jacobian(&self) -> DMatrix<f64> {
        let (m, n) = (self.matrices.len(), self.off.len() / self.matrices.len());
        let mut all = DMatrix::zeros(m * n, m * n);
        for (place, matrix) in self.matrices.iter().enumerate() {
            let next = (place + 1) % m * n;
            all.view_mut((place * n, place * n), (n, n)).copy_from(matrix);
            for row in 0..n {
                all[(place * n + row, next + row)] -= 1.0;
            }
        }
        all
    }

    /// Their derivatives by the variables.
    pub fn by_variables(&self) -> DMatrix<f64> {
        let (m, n) = (self.by.len(), self.off.len() / self.by.len());
        let mut all = DMatrix::zeros(m * n, self.by[0].ncols());
        for (place, by) in self.by.iter().enumerate() {
            all.rows_mut(place * n, n).copy_from(by);
        }
        all
    }

    /// The periodic motion with these states at the nodes.
    pub fn orbit(self, states: &[f64], nodes: &Nodes) -> Orbit {
        let Self { off, period, events, matrices, by, residual } = self;
        let n = off.len() / matrices.len();
        let mut matrix = DMatrix::identity(n, n);
        let mut all_by = DMatrix::zeros(n, by[0].ncols());
        for (own, own_by) in matrices.iter().zip(&by) {
            matrix = own * matrix;
            all_by = own * all_by + own_by;
        }
        let mut multipliers: Vec<Complex<f64>> = matrix.complex_eigenvalues().iter().copied().collect();
        multipliers.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
        let nodes = nodes.with(states).map(|(node, state)| (node.time, state.to_vec())).collect();
        Orbit {
            state: states[..n].to_vec(),
            nodes,
            period,
            events,
            matrix,
            multipliers,
            by: all_by,
            residual,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::node_times;

    #[test]
    fn nodes_keep_away_from_events() {
        let times = |events: &[f64], segments| node_times(events, 1.0, segments).collect::<Vec<f64>>();
        assert_eq!(times(&[], 1), [0.0; 0]);
        assert_eq!(times(&[], 4), [0.25, 0.5, 0.75]);
        // An event at the middle moves the node to an end of its interval, ..
        assert_eq!(times(&[0.5], 2), [0.3]);
        // .. and between two events it stands in their middle.
        assert_eq!(times(&[0.4, 0.7], 2), [0.55]);
        assert_eq!(times(&[0.31, 0.69], 2), [0.5]);
    }
}
