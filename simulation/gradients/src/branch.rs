//! Follows a periodic motion through the values of a parameter, and locates the points where the branch or
//! its stability changes.
//!
//! Theory: docs/theory.md, section 20.3.

use hodograph::State;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::Options;
use nalgebra::{DMatrix, DVector};

use crate::By;
use crate::family::set_value;
use crate::orbit::{Found, seek, solve};
use crate::periodic::{Orbit, OrbitError, Periodic};
use crate::shooting::{Nodes, Returned, Task};

/// A periodic motion at a value of the parameter.
#[derive(Clone, Debug)]
pub struct BranchPoint {
    /// the value of the parameter
    pub value: f64,
    /// the motion, with its derivatives by the parameter: NaN where, at the end of the range, it has none
    pub orbit: Orbit,
}

/// A point where a branch or its stability changes.
#[derive(Clone, Debug)]
pub struct Change {
    /// the kind of change
    pub kind: ChangeKind,
    /// the motion at this point
    pub at: BranchPoint,
}

/// The ways in which a branch of periodic motions changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChangeKind {
    /// The branch turns back: a multiplier is 1, and beyond this value the branch has no motion.
    Fold,
    /// A multiplier is -1: motions of twice the period branch off.
    PeriodDoubling,
    /// A multiplier is 1, and another branch crosses.
    Crossing,
}

impl ChangeKind {
    /// The name of the kind: lower case, and stable between versions.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::PeriodDoubling => "period_doubling",
            Self::Crossing => "crossing",
        }
    }
}

/// A branch of periodic motions.
#[derive(Clone, Debug)]
pub struct Branch {
    /// its points, in order
    pub points: Vec<BranchPoint>,
    /// its changes, in the same order
    pub changes: Vec<Change>,
    /// why the branch was not followed to the end of the range, if it was not
    pub ended: Option<String>,
}

/// The first, the greatest and the smallest step, relative to the range.
const FIRST_STEP: f64 = 0.02;
const MAX_STEP: f64 = 0.05;
const MIN_STEP: f64 = 1e-7;
/// The largest number of Newton steps that bring a point onto the branch.
const NEWTON_STEPS: usize = 8;
/// A point lies on the branch if the motion returns to its state up to this relative difference.
const TOLERANCE: f64 = 1e-10;
/// A change is located if its test function has decreased to this part, or after this number of evaluations.
const LOCATED_PART: f64 = 1e-13;
const MAX_EVALUATIONS: usize = 40;

/// Follows the periodic motion next to a start state from the value `from` of a parameter (or of mu or e) to
/// `to`, in at most `most` points. The branch may turn back; it ends where it would leave the range, with the motion at that
/// end of it.
///
/// # Errors
///
/// [`OrbitError`] if the first motion is not found.
pub fn follow_branch(
    mechanism: &InterpretedMechanism,
    start: &State<'_>,
    options: &Options,
    periodic: &Periodic,
    (by, from, to): (By, f64, f64),
    most: usize,
) -> Result<Branch, OrbitError> {
    if !(from.is_finite() && to.is_finite() && from != to) {
        return Err(OrbitError::BadRequest(
            "the range of the parameter must be finite and not empty".to_owned(),
        ));
    }
    let family = Family { mechanism, start, options, periodic, by };
    let (here, surfaces) = family.at(from)?;
    let found = seek(&here, start, &surfaces, periodic, &[by])?;
    let n = start.coordinates.len() + start.speeds.len();
    let size = found.states[..n].iter().fold(f64::MIN_POSITIVE, |size, value| size.max(value.abs()));
    let mut scale: Vec<f64> = found.states[..n].iter().map(|value| value.abs().max(1e-2 * size)).collect();
    scale.push((to - from).abs());
    let mut toward = DVector::zeros(n + 1);
    toward[n] = (to - from).signum();
    let mut point = Point::new(found, from, &scale, &toward);
    let mut branch = Branch { points: vec![point.public()], changes: Vec::new(), ended: None };
    let outside = |value: f64| (value - from) * (value - to) > 0.0;
    let mut h = FIRST_STEP;
    while branch.points.len() < most {
        let reached = family.within(&point, h, (from, to), &scale);
        let (next, made, last) = match reached {
            Ok(reached) => reached,
            Err(error) if h <= MIN_STEP => {
                branch.ended = Some(error.to_string());
                break;
            }
            Err(_) => {
                h *= 0.5;
                continue;
            }
        };
        for kind in [ChangeKind::Fold, ChangeKind::PeriodDoubling, ChangeKind::Crossing] {
            if point.test(kind) * next.test(kind) < 0.0
                && let Some(at) = family.locate(&point, &next, made, &scale, kind)
                && !outside(at.value)
            {
                branch.changes.push(Change { kind, at: at.public() });
            }
        }
        point = next;
        branch.points.push(point.public());
        if last {
            break;
        }
        h = (1.5 * h).min(MAX_STEP);
    }
    Ok(branch)
}

/// The return map of the motions for all values of a parameter.
struct Family<'a> {
    mechanism: &'a InterpretedMechanism,
    start: &'a State<'a>,
    options: &'a Options,
    periodic: &'a Periodic,
    by: By,
}

/// A point of a branch, with the tangent of the branch in the scaled initial state and parameter.
struct Point {
    orbit: Orbit,
    states: Vec<f64>,
    nodes: Nodes,
    value: f64,
    tangent: DVector<f64>,
    /// the test functions that vanish at changes, in the order of the kinds
    tests: [f64; 3],
}

impl Point {
    fn new(found: Found, value: f64, scale: &[f64], toward: &DVector<f64>) -> Self {
        let Found { states, returned, nodes } = found;
        let orbit = returned.orbit(&states, &nodes);
        let n = orbit.state.len();
        let off = &orbit.matrix - DMatrix::identity(n, n);
        let matrix = bordered(&off, &orbit.by, scale, toward);
        let mut last = DVector::zeros(n + 1);
        last[n] = 1.0;
        let tangent = solve(&matrix, &last).normalize();
        let doubling = (&orbit.matrix + DMatrix::identity(n, n)).determinant();
        let crossing = bordered(&off, &orbit.by, scale, &tangent).determinant();
        let tests = [tangent[n], doubling, crossing];
        Point { orbit, states, nodes, value, tangent, tests }
    }

    /// A point without derivatives by the parameter, after which the branch is not followed: it tells of no change.
    fn last(found: Found, value: f64, tangent: DVector<f64>) -> Self {
        let Found { states, returned, nodes } = found;
        let orbit = returned.orbit(&states, &nodes);
        let by = DMatrix::from_element(orbit.state.len(), 1, f64::NAN);
        let orbit = Orbit { by, ..orbit };
        Point { orbit, states, nodes, value, tangent, tests: [f64::NAN; 3] }
    }

    fn test(&self, kind: ChangeKind) -> f64 {
        match kind {
            ChangeKind::Fold => self.tests[0],
            ChangeKind::PeriodDoubling => self.tests[1],
            ChangeKind::Crossing => self.tests[2],
        }
    }

    fn public(&self) -> BranchPoint {
        BranchPoint { value: self.value, orbit: self.orbit.clone() }
    }
}

/// The derivatives of the differences with respect to scaled states and parameter, bordered by a row of the initial state and
/// the parameter.
fn bordered(matrix: &DMatrix<f64>, by: &DMatrix<f64>, scale: &[f64], row: &DVector<f64>) -> DMatrix<f64> {
    let (all, n) = (matrix.nrows(), scale.len() - 1);
    DMatrix::from_fn(all + 1, all + 1, |i, j| match (i == all, j == all) {
        (true, true) => row[n],
        (true, false) => {
            if j < n {
                row[j]
            } else {
                0.0
            }
        }
        (false, true) => by[(i, 0)] * scale[n] / scale[i % n],
        (false, false) => matrix[(i, j)] * scale[j % n] / scale[i % n],
    })
}

impl Family<'_> {
    /// The mechanism and the surfaces for a value of the parameter.
    fn at(&self, value: f64) -> Result<(InterpretedMechanism, Options), OrbitError> {
        let (mut mechanism, mut options) = (self.mechanism.clone(), self.options.clone());
        set_value(&mut mechanism, &mut options, self.by, value).map_err(OrbitError::BadRequest)?;
        Ok((mechanism, options))
    }

    /// What a motion at a value of the parameter returns.
    fn with<R>(
        &self,
        nodes: &Nodes,
        value: f64,
        by: &[By],
        ask: impl FnOnce(&Task<'_>) -> Result<R, OrbitError>,
    ) -> Result<R, OrbitError> {
        let (mechanism, options) = self.at(value)?;
        let Self { start, periodic, .. } = *self;
        ask(&Task { mechanism: &mechanism, start, options: &options, periodic, by, nodes })
    }

    /// The return from these states, which are moved so that closed contacts stay closed, with derivatives by `by`.
    fn returned(
        &self,
        nodes: &Nodes,
        states: &mut [f64],
        value: f64,
        by: &[By],
    ) -> Result<Returned, OrbitError> {
        self.with(nodes, value, by, |task| {
            task.close(states)?;
            task.returned(states)
        })
    }

    /// The point of the branch at the distance `h` along the tangent, or, where that is outside of the range, the point at its
    /// end; with the distance, and whether it is the end.
    fn within(
        &self,
        from: &Point,
        h: f64,
        range: (f64, f64),
        scale: &[f64],
    ) -> Result<(Point, f64, bool), OrbitError> {
        let end = |value: f64| {
            let (least, greatest) = (range.0.min(range.1), range.0.max(range.1));
            Some(value.clamp(least, greatest)).filter(|end| *end != value)
        };
        let n = from.orbit.state.len();
        let mut ahead = from.value + h * from.tangent[n] * scale[n];
        if end(ahead).is_none() {
            let next = self.step(from, h, scale)?;
            match end(next.value) {
                None => return Ok((next, h, false)),
                // the correction has left the range
                Some(_) => ahead = next.value,
            }
        }
        let limit = end(ahead).unwrap_or(ahead);
        let part = (limit - from.value) / (ahead - from.value);
        Ok((self.at_end(from, part * h, limit, scale)?, part * h, true))
    }

    /// The nodes, states and value at the distance `h` along the tangent.
    fn ahead(&self, from: &Point, h: f64, scale: &[f64]) -> Result<(Nodes, Vec<f64>, f64), OrbitError> {
        let n = from.orbit.state.len();
        // Times of events change along the branch, and nodes keep away from them.
        let (nodes, mut states) = if from.nodes.count() > 1 {
            self.with(&from.nodes, from.value, &[self.by], |task| task.divided(&from.states))?
        } else {
            (from.nodes.clone(), from.states.clone())
        };
        let ahead = |place: usize, value: f64| value + h * from.tangent[place] * scale[place];
        states.iter_mut().take(n).enumerate().for_each(|(place, value)| *value = ahead(place, *value));
        Ok((nodes, states, ahead(n, from.value)))
    }

    /// The last point, at the value at which the range ends, next to the distance `h` along the tangent. It needs no derivative
    /// by the parameter, which a motion at the end of what is possible may not have (without friction, for instance).
    fn at_end(&self, from: &Point, h: f64, value: f64, scale: &[f64]) -> Result<Point, OrbitError> {
        let (nodes, mut states, _) = self.ahead(from, h, scale)?;
        let mut before = f64::INFINITY;
        let mut steps = 0;
        let returned = loop {
            let here = self.returned(&nodes, &mut states, value, &[])?;
            let settled = here.residual >= 0.5 * before || here.residual < 1e-14;
            if here.residual <= TOLERANCE && (settled || steps == NEWTON_STEPS) {
                break here;
            }
            if steps == NEWTON_STEPS {
                return Err(OrbitError::NotFound(here.residual));
            }
            before = here.residual;
            steps += 1;
            let change = solve(&here.jacobian(), &-here.difference());
            states.iter_mut().zip(change.iter()).for_each(|(value, change)| *value += change);
        };
        match self.returned(&nodes, &mut states, value, &[self.by]) {
            Ok(returned) => Ok(Point::new(Found { states, returned, nodes }, value, scale, &from.tangent)),
            Err(_) => Ok(Point::last(Found { states, returned, nodes }, value, from.tangent.clone())),
        }
    }

    /// The point of the branch at the distance `h` along the tangent.
    fn step(&self, from: &Point, h: f64, scale: &[f64]) -> Result<Point, OrbitError> {
        let n = from.orbit.state.len();
        let (nodes, mut states, mut value) = self.ahead(from, h, scale)?;
        let mut before = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            let here = self.returned(&nodes, &mut states, value, &[self.by])?;
            if here.residual <= TOLERANCE && (here.residual >= 0.5 * before || here.residual < 1e-14) {
                let found = Found { states, returned: here, nodes };
                return Ok(Point::new(found, value, scale, &from.tangent));
            }
            before = here.residual;
            let all = states.len();
            // The correction is perpendicular to the tangent.
            let mut right = DVector::zeros(all + 1);
            here.difference()
                .iter()
                .enumerate()
                .for_each(|(place, off)| right[place] = -off / scale[place % n]);
            let matrix = bordered(&here.jacobian(), &here.by_variables(), scale, &from.tangent);
            let change = solve(&matrix, &right);
            states
                .iter_mut()
                .enumerate()
                .for_each(|(place, value)| *value += change[place] * scale[place % n]);
            value += change[all] * scale[n];
        }
        let here = self.returned(&nodes, &mut states, value, &[self.by])?;
        if here.residual > TOLERANCE {
            return Err(OrbitError::NotFound(here.residual));
        }
        Ok(Point::new(Found { states, returned: here, nodes }, value, scale, &from.tangent))
    }

    /// The point between two others where the test function of a change vanishes, by false position.
    fn locate(
        &self,
        from: &Point,
        to: &Point,
        length: f64,
        scale: &[f64],
        kind: ChangeKind,
    ) -> Option<Point> {
        let (mut low, mut high) = ((0.0, from.test(kind)), (length, to.test(kind)));
        let size = low.1.abs().max(high.1.abs());
        let (mut best, mut stayed): (Option<Point>, Option<bool>) = (None, None);
        for _ in 0..MAX_EVALUATIONS {
            let h = (low.0 * high.1 - high.0 * low.1) / (high.1 - low.1);
            let Ok(there) = self.step(from, h, scale) else { break };
            let test = there.test(kind);
            let done = test.abs() <= LOCATED_PART * size;
            if best.as_ref().is_none_or(|best| test.abs() < best.test(kind).abs()) {
                best = Some(there);
            }
            if done {
                break;
            }
            // An end that stays twice would stay forever (Illinois method).
            let is_high = test * high.1 > 0.0;
            if is_high {
                high = (h, test);
                low.1 *= if stayed == Some(true) { 0.5 } else { 1.0 };
            } else {
                low = (h, test);
                high.1 *= if stayed == Some(false) { 0.5 } else { 1.0 };
            }
            stayed = Some(is_high);
        }
        best
    }
}
