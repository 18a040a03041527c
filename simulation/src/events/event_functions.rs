//! The functions of a step whose zeros are events: gaps, normal forces, friction cones, and functions of the
//! user.

use hodograph::{ComponentKind, Distance, State, StateError};
use nalgebra::Vector3;
use smallvec::SmallVec;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::phase::{Closed, Leaving, Phase};
use crate::events::event_location::{Slopes, Values};
use crate::events::force_functions::ForceFunctions;
use crate::events::watched::Watched;
use crate::integration::motion::{Evaluation, Failure};
use crate::integration::stepper::{Step, Within};
use crate::state::transition::Transition;
use crate::{ErrorKind, SimulationError};

/// A contact that lifts off counts as open if its gap is above this part of the length of the problem.
pub(crate) const LIFTED: f64 = 5e-11;
/// The accuracy of the gap of a contact that lifts off, computed as the integral of its rate, relative to the
/// length of the problem.
const RISEN: f64 = 1e-11;
/// A contact that has risen so far, relative to the length of the problem, while its gap became less, has a gap that does not
/// belong to its normal.
const FALLEN: f64 = 1e-8;
/// The normal acceleration of a separating contact may be negative by this part of its terms: it is zero up
/// to rounding.
const STILL: f64 = 2e-11;

/// The relative rounding error of forces, and of what follows from them: far below the slack of their conditions.
const ELIMINATED: f64 = 64.0 * f64::EPSILON;

/// Largest total rotation in a piece of a step that is examined at nine points, rad.
const TURN: f64 = 4.0;
/// Largest number of pieces of a step.
const MOST_PIECES: f64 = 500.0;

/// Lists of so many contacts need no memory from the heap.
const FEW: usize = 8;
type Contacts = SmallVec<[usize; FEW]>;
type Distances = SmallVec<[Distance; FEW]>;

/// Nodes and weights of Gauss's rule on [0, 1].
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// A gap has another rate than the normal velocity if, over a time below this part of that of the problem, it changes by
/// this part otherwise, and by this many times its rounding.
const MOMENT: f64 = 1e-6;
const OTHER: f64 = 1e-3;
const MANY: f64 = 100.0;

impl Transition<'_> {
    /// The functions to be monitored over the next time `h`, and bounds of their rounding errors. Pairs of shapes that
    /// stay `apart`, by their first contacts, need none.
    pub(crate) fn watched(&self, closed: &[Closed], h: f64, apart: &[usize]) -> (Vec<Watched>, Vec<f64>) {
        let (mut watched, mut noise) = (Vec::new(), Vec::new());
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let phases = self.front.phases.iter().enumerate();
        let near: Vec<usize> =
            phases.filter(|(_, phase)| **phase == Phase::Open(Leaving::Near)).map(|(near, _)| near).collect();
        let (held, beside) = (self.held(&near).unwrap_or_default(), self.beside(&near));
        for (contact, phase) in self.front.phases.iter().enumerate() {
            if self.first_of_pair(contact).is_some_and(|first| apart.contains(&first)) {
                continue;
            }
            if let Phase::Open(leaving) = phase
                && self.surfaces[contact].is_some()
                && !held.contains(&contact)
            {
                watched.push(Watched::Gap(contact));
                let rate = || self.rounding_of_rate(contact);
                noise.push(match *leaving {
                    Leaving::Bounced => rate(),
                    Leaving::Lifted { risen, .. } if risen > 0.0 => h * rate(),
                    Leaving::Lifted { .. } => rate() + self.left_at_lift_off(contact),
                    Leaving::Apart | Leaving::Near => self.rounding_of_gap(contact).max(self.left_of_loops()),
                });
            }
            if beside.contains(&contact) {
                watched.push(Watched::Entry(contact));
                noise.push(self.rounding_of_gap(contact));
            }
        }
        // Forces have the rounding of their elimination, and follow the direction of slip, which slow slip has with a
        // rounding error.
        let turned = self.rounding_of_directions(closed).max(ELIMINATED);
        let force = self.front.forces.iter().map(Vector3::norm).fold(0.0, f64::max);
        for (place, contact) in closed.iter().enumerate() {
            if self.ends(contact.contact) {
                watched.push(Watched::End(place));
                noise.push(self.rounding_of_gap(contact.contact));
            }
            // A torque shares the normal force of its contact.
            if self.mechanism.torque(contact.contact).is_none() {
                watched.push(Watched::Normal(place));
                noise.push(turned * force);
            }
            if contact.slides.is_none() {
                watched.push(Watched::Cone(place));
                noise.push(2.0 * turned * force.powi(2));
            }
            if contact.turning.is_some() {
                watched.push(Watched::Slip(place));
                noise.push(self.rounding_of_velocity(contact.contact)[0]);
            }
        }
        if closed.iter().any(|contact| contact.slides.is_some()) {
            watched.push(Watched::Jam);
            noise.push(turned);
        }
        let (q, u) = (&self.front.y[..n], &self.front.y[n..n + self.mechanism.count(ComponentKind::Speed)]);
        for (index, function) in self.options.events.iter().enumerate() {
            let value = function(self.front.t, q, u);
            watched.push(Watched::User(index, if value < 0.0 { -1.0 } else { 1.0 }));
            noise.push(self.rounding_of_function(function, value));
        }
        (watched, noise)
    }

    /// The values of the monitored functions at a time after the front, where the evaluation is known; `at`
    /// gives the states in between.
    pub(crate) fn values(
        &self,
        closed: &[Closed],
        watched: &[Watched],
        after: f64,
        here: Option<&Evaluation>,
        at: &mut dyn FnMut(f64) -> Within,
    ) -> Result<Values, Failure> {
        let y = at(after);
        let motion = self.motion(closed);
        let t = self.front.t + after;
        let (q, u) = motion.split(&y);
        let inputs = motion.inputs(t, &y)?;
        let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
        let distances = self.distances(closed, watched, &state)?;
        let mut of_forces = None;
        if watched.iter().any(|what| what.is_of_forces()) {
            // Directions that follow from the state change the forces.
            let known = here.filter(|_| after == 0.0 && closed.iter().all(Closed::has_own_direction));
            let guess = here.and_then(|here| here.forces.as_ref());
            let evaluated = if known.is_none() { Some(motion.evaluate_near(t, &y, guess)?) } else { None };
            of_forces = known.or(evaluated.as_ref()).and_then(|there| ForceFunctions::of(closed, there));
        }
        let mut value = |what: &Watched| match *what {
            Watched::Gap(contact) => {
                match self.front.phases[contact] {
                    Phase::Open(Leaving::Bounced) => self.mean_rate(contact, after, at),
                    // The gap by integration of its rate, from the time when it was zero at the front;
                    // minus the rounding error of its acceleration.
                    Phase::Open(Leaving::Lifted { risen, rounding }) => {
                        let mean = self.mean_rate(contact, after, at)? + 0.5 * rounding * after;
                        Ok(if risen > 0.0 { risen + after * mean } else { mean })
                    }
                    _ => {
                        let gap = distances[contact].gap.unwrap_or(1.0);
                        Ok(gap - self.watched_from(contact))
                    }
                }
            }
            Watched::Entry(contact) => Ok(self.low() - self.validity_in(contact, &distances)),
            Watched::End(place) => Ok(self.validity_in(closed[place].contact, &distances)),
            Watched::Normal(_) | Watched::Cone(_) | Watched::Slip(_) | Watched::Jam => {
                Ok(of_forces.as_ref().and_then(|functions| functions.value(what)).unwrap_or(1.0))
            }
            Watched::User(index, sign) => match (self.options.events[index])(t, q, u) {
                // One that is not comes to no zero, and steps would be shortened for ever.
                value if !value.is_finite() => Err(Failure::Input(format!(
                    "the event function {index} is {value} at t = {t} s: it must be finite"
                ))),
                value => Ok(sign * value),
            },
        };
        let mut values = Values::with_capacity(watched.len());
        for what in watched {
            values.push(value(what)?);
        }
        Ok(values)
    }

    /// The rates of the monitored functions at a time after the front, where they are known: those of gaps
    /// that are monitored by their values.
    pub(crate) fn slopes(&self, watched: &[Watched], after: f64, y: &[f64]) -> Slopes {
        let motion = self.motion(&[]);
        let t = self.front.t + after;
        let (q, u) = motion.split(y);
        let Ok(inputs) = motion.inputs(t, y) else { return Slopes::from_elem(None, watched.len()) };
        let state = State { time: t, coordinates: q, speeds: u, inputs: &inputs };
        let known = |what: &Watched| match *what {
            Watched::Gap(contact) => {
                (self.front.phases[contact] == Phase::Open(Leaving::Apart)).then_some(contact)
            }
            _ => None,
        };
        let apart: Contacts = watched.iter().filter_map(known).collect();
        if apart.is_empty() {
            return Slopes::from_elem(None, watched.len());
        }
        let mut distances = Distances::from_elem(Distance::default(), apart.len());
        let mut velocities = SmallVec::<[Vector3<f64>; FEW]>::from_elem(Vector3::zeros(), apart.len());
        if self.mechanism.gaps(&apart, &state, &mut distances).is_err()
            || self.mechanism.contact_velocities(&apart, &state, &mut velocities).is_err()
        {
            return Slopes::from_elem(None, watched.len());
        }
        let mut found = apart.iter().zip(distances.iter().zip(&velocities));
        let rate = |what: &Watched| {
            known(what)?;
            let (&contact, (distance, velocity)) = found.next()?;
            // beside a face the gap has another rate
            let beside = self.ends(contact) && distance.validity.is_some_and(|validity| validity <= 0.0);
            (!beside).then_some(velocity.x)
        };
        watched.iter().map(rate).collect()
    }

    /// The distances, by contact, of those that are monitored by them.
    fn distances(
        &self,
        closed: &[Closed],
        watched: &[Watched],
        state: &State<'_>,
    ) -> Result<Distances, StateError> {
        let by_distance = |what: &Watched| match *what {
            Watched::Gap(contact) => match self.front.phases[contact] {
                Phase::Open(Leaving::Bounced | Leaving::Lifted { .. }) => None,
                _ => Some(contact),
            },
            Watched::Entry(contact) => Some(contact),
            Watched::End(place) => Some(closed[place].contact),
            _ => None,
        };
        let mut asked: Contacts = watched.iter().filter_map(by_distance).collect();
        if asked.is_empty() {
            return Ok(Distances::new());
        }
        asked.sort_unstable();
        asked.dedup();
        let mut found = Distances::from_elem(Distance::default(), asked.len());
        self.mechanism.gaps(&asked, state, &mut found)?;
        let mut distances = Distances::from_elem(Distance::default(), self.front.phases.len());
        asked.iter().zip(found).for_each(|(&contact, distance)| distances[contact] = distance);
        Ok(distances)
    }

    /// How far a contact is within what touches there; infinity where that does not end.
    fn validity_in(&self, contact: usize, distances: &[Distance]) -> f64 {
        let validity = distances[contact].validity.filter(|_| self.ends(contact));
        validity.unwrap_or(f64::INFINITY)
    }

    /// The total rotation in a step beyond what nine points resolve. `None` for a step that would need too
    /// many pieces.
    pub(crate) fn turns(&self, closed: &[Closed], step: &Step) -> Option<f64> {
        let (n, motion) = (self.mechanism.count(ComponentKind::Coordinate), self.motion(closed));
        if self.angles.are_none() {
            return Some(0.0);
        }
        let mut fastest = 0.0_f64;
        for (time, y) in [(step.t, step.start()), (step.t + step.h, &step.end[..])] {
            let (q, u) = motion.split(y);
            let inputs = motion.inputs(time, y).ok()?;
            let state = State { time, coordinates: q, speeds: u, inputs: &inputs };
            let mut rates = vec![0.0; n];
            self.mechanism.coordinate_rates(&state, &mut rates).ok()?;
            fastest = fastest.max(self.angles.turned(&rates));
        }
        let turns = fastest * step.h / TURN;
        (turns <= MOST_PIECES).then_some(turns)
    }

    /// The mean rate of a gap since the front, where it was zero, by Gauss's five-point rule. It has the sign
    /// of the gap, but not its rounding error, which a short time would amplify; and it does not vanish at
    /// the front.
    fn mean_rate(
        &self,
        contact: usize,
        after: f64,
        at: &mut dyn FnMut(f64) -> Within,
    ) -> Result<f64, Failure> {
        self.mean_rate_from(self.front.t, contact, after, at)
    }

    fn mean_rate_from(
        &self,
        start: f64,
        contact: usize,
        after: f64,
        at: &mut dyn FnMut(f64) -> Within,
    ) -> Result<f64, Failure> {
        Ok(mean(&self.rates_from(start, contact, after, at)?))
    }

    /// The rates of a gap at Gauss's five places in the time after a start.
    fn rates_from(
        &self,
        start: f64,
        contact: usize,
        after: f64,
        at: &mut dyn FnMut(f64) -> Within,
    ) -> Result<[f64; 5], Failure> {
        let motion = self.motion(&[]);
        let mut rates = [0.0; 5];
        for (rate, (place, _)) in rates.iter_mut().zip(GAUSS) {
            let after = place * after;
            let y = at(after);
            let (q, u) = motion.split(&y);
            let inputs = motion.inputs(start + after, &y)?;
            let state = State { time: start + after, coordinates: q, speeds: u, inputs: &inputs };
            *rate = self.mechanism.contact_velocity(contact, &state)?.x;
        }
        Ok(rates)
    }

    /// Whether the gaps of contacts that lift off are the integrals of their rates with sufficient accuracy;
    /// a step in which a body rotates far is too long for this.
    pub(crate) fn leaving_is_known(&self, step: &Step) -> Result<bool, SimulationError> {
        let h = step.h;
        let leaves = |contact: &usize| {
            matches!(self.front.phases[*contact], Phase::Open(Leaving::Bounced | Leaving::Lifted { .. }))
        };
        for contact in (0..self.front.phases.len()).filter(leaves) {
            // Near a jam there may be no states within a step.
            let Ok(rates) = self.rates_from(self.front.t, contact, h, &mut |after| step.at(after / h)) else {
                return Ok(false);
            };
            let mean = mean(&rates);
            let (before, _) = self.gap_in(step.t, step.start(), contact)?;
            let (gap, _) = self.gap_at(step, contact)?;
            let rounding = (4.0 * self.rounding_of_gap(contact)).max(RISEN * self.front.scales.length);
            let off = (gap - before - h * mean).abs();
            // Beyond the features that touched, the gap is how far it is from them.
            if off > rounding && !self.valid_at_end(step, contact)? {
                continue;
            }
            // A vertex that leaves a corner is within reach of the face beside it, and closes no gap on its way out.
            if off > rounding && self.ends(contact) && rates.iter().all(|&rate| rate > 0.0) {
                continue;
            }
            let is_short = h < MOMENT * self.front.scales.time;
            // A vertex may have another face at the end, behind the edge between: shorter steps end between the two.
            if off > MANY * rounding && off > OTHER * h * mean.abs() && is_short && !self.ends(contact) {
                let rate = (gap - before) / h;
                return Err(self.error(Some(contact), ErrorKind::GapRate { rate, velocity: mean }));
            }
            if off > rounding {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Whether a contact is within the features that touch at the end of a step.
    fn valid_at_end(&self, step: &Step, contact: usize) -> Result<bool, SimulationError> {
        if !self.ends(contact) {
            return Ok(true);
        }
        let motion = self.motion(&[]);
        let (time, (q, u)) = (step.t + step.h, motion.split(&step.end));
        let inputs = motion.inputs(time, &step.end).map_err(|failure| self.failure(failure))?;
        self.is_valid(contact, &State { time, coordinates: q, speeds: u, inputs: &inputs })
    }

    /// Whether a contact that lifts off and returns at the end of a step is clearly open in between.
    pub(crate) fn rises(&self, step: &Step, contact: usize) -> Result<bool, SimulationError> {
        let (gap, _) = self.gap_in(step.t + 0.5 * step.h, &step.at(0.5), contact)?;
        Ok(gap > LIFTED * self.front.scales.length)
    }

    /// Gap and normal velocity of a contact at the end of a step.
    pub(crate) fn gap_at(&self, step: &Step, contact: usize) -> Result<(f64, f64), SimulationError> {
        self.gap_in(step.t + step.h, &step.end, contact)
    }

    fn gap_in(&self, time: f64, y: &[f64], contact: usize) -> Result<(f64, f64), SimulationError> {
        let motion = self.motion(&[]);
        let (q, u) = motion.split(y);
        let inputs = motion.inputs(time, y).map_err(|failure| self.failure(failure))?;
        let state = State { time, coordinates: q, speeds: u, inputs: &inputs };
        let fault = |error| self.failure(Failure::State(error));
        let gap = self.mechanism.gap(contact, &state).map_err(fault)?.unwrap_or(1.0);
        Ok((gap, self.mechanism.contact_velocity(contact, &state).map_err(fault)?.x))
    }

    /// Marks contacts that were about to lift off as open once their gaps are open; the step has just been
    /// accepted.
    pub(crate) fn arm(&mut self, step: &Step) -> Result<(), SimulationError> {
        for contact in 0..self.front.phases.len() {
            let before = match self.front.phases[contact] {
                Phase::Open(Leaving::Bounced) if step.h > 0.0 => 0.0,
                Phase::Open(Leaving::Lifted { risen, .. }) => risen,
                Phase::Open(Leaving::Near) => {
                    if self.gap_at(step, contact)?.0 > 2.0 * self.low() {
                        self.front.phases[contact] = Phase::Open(Leaving::Apart);
                    }
                    continue;
                }
                _ => continue,
            };
            let (gap, _) = self.gap_at(step, contact)?;
            let lifted =
                if self.ends(contact) { 2.0 * self.low() } else { LIFTED * self.front.scales.length };
            if gap > lifted {
                self.front.phases[contact] = Phase::Open(Leaving::Apart);
                continue;
            }
            let risen = self.risen(contact, before, step)?;
            let far = (4.0 * MANY * self.rounding_of_gap(contact)).max(FALLEN * self.front.scales.length);
            if let Leaving::Lifted { risen, .. } = risen
                && risen > far
                && gap < -0.5 * risen
                && step.h > 0.0
                && !self.ends(contact)
            {
                // In short steps each is too small to tell.
                let (start, velocity) = self.gap_in(step.t, step.start(), contact)?;
                let rate = (gap - start) / step.h;
                return Err(self.error(Some(contact), ErrorKind::GapRate { rate, velocity }));
            }
            self.front.phases[contact] = Phase::Open(risen);
        }
        Ok(())
    }

    /// The state of a contact that lifts off, after a step.
    fn risen(&self, contact: usize, before: f64, step: &Step) -> Result<Leaving, SimulationError> {
        let (step_start, h) = (step.t, step.h);
        let mut at = |after: f64| step.at(if h > 0.0 { after / h } else { 1.0 });
        let mean = self.mean_rate_from(step_start, contact, h, &mut at);
        let risen = before + h * mean.map_err(|failure| self.failure(failure))?;
        Ok(Leaving::Lifted { risen: risen.max(0.0), rounding: 0.0 })
    }

    /// Determines the rounding errors of the accelerations of contacts that lift off here.
    pub(crate) fn weigh_lifted(&mut self, here: &Evaluation) -> Result<(), SimulationError> {
        let lifted: Vec<usize> = (0..self.front.phases.len())
            .filter(|&contact| matches!(self.front.phases[contact], Phase::Open(Leaving::Lifted { .. })))
            .collect();
        if lifted.is_empty() {
            return Ok(());
        }
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let speeds = &self.front.y[n..n + self.mechanism.count(ComponentKind::Speed)];
        let inputs =
            self.motion(&[]).inputs(self.front.t, &self.front.y).map_err(|failure| self.failure(failure))?;
        let state = State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &inputs };
        let support = ClosedContacts::new(self.mechanism, &state, &lifted, true)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let pressed = here.forces.as_ref().map_or(0.0, |forces| {
            here.support.beta.amax() + (here.support.coupled.abs() * forces.lambda.abs()).amax()
        });
        for (place, &contact) in lifted.iter().enumerate() {
            let size = support.beta.fixed_rows::<3>(3 * place).amax() + pressed;
            if let Phase::Open(Leaving::Lifted { rounding, .. }) = &mut self.front.phases[contact] {
                *rounding = STILL * size;
            }
        }
        Ok(())
    }
}

/// The mean of rates at Gauss's places.
fn mean(rates: &[f64; 5]) -> f64 {
    rates.iter().zip(GAUSS).map(|(rate, (_, weight))| weight * rate).sum()
}
