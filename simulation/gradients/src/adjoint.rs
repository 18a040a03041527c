//! Derivatives of a few outputs of a motion by many variables, backwards: the transposes of all that carries
//! derivatives forwards, from the last to the first. The cost does not depend on the number of variables.
//!
//! Theory: docs/theory.md, section 19.5.

use std::cell::OnceCell;

use hodograph::State;
use hodograph_interpreter::InterpretedMechanism;
use hodograph_simulation::stepper::{TransposedSystem, transpose};
use hodograph_simulation::{Event, Options, SmoothPart};
use nalgebra::DVector;

use crate::collocation::{self, Collocation, Stretch};
use crate::field::{Direction, Field};
use crate::followed::Followed;
use crate::modes::Mode;
use crate::motion::{Piece, Propagation, Start, seeds};
use crate::transposed::{ModeTape, Place, TransposedField};
use crate::{By, GradientError, MotionGradient, Reason, Sample, Undefined};

/// A derivative along one direction of all variables, carried forwards, agrees with the derivatives that were found
/// backwards to this part of its terms.
const AGREEMENT: f64 = 1e-6;

/// A motion that can be differentiated backwards.
///
/// It was carried forwards along one direction, in which all variables change: where the motion is not
/// differentiable, that direction tells, and each answer is compared with it.
pub struct Adjoint<'m> {
    mechanism: &'m InterpretedMechanism,
    by: Vec<By>,
    /// columns of the derivatives of the start state: one for each variable, and one more
    start: Vec<f64>,
    direction: Direction,
    followed: Followed,
    /// with its derivatives along the direction of all variables
    motion: MotionGradient,
    pieces: Vec<Piece>,
}

impl std::fmt::Debug for Adjoint<'_> {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let events = self.followed.events.len();
        write!(out, "Adjoint by {} variables of a motion with {events} events", self.by.len())
    }
}

/// What is differentiated.
#[derive(Clone, Copy)]
enum Output<'a> {
    /// the sum of the states at the samples, with these weights
    States(&'a [DVector<f64>]),
    /// the time of the event with this index
    Time(usize),
}

impl<'m> Adjoint<'m> {
    /// Simulates the motion from a start state to the last of the `times`, which increase, so that outputs at these
    /// times can be differentiated with respect to each of `by`.
    ///
    /// # Errors
    ///
    /// [`GradientError`]. A motion without derivatives is not an error: see [`Adjoint::undefined`].
    pub fn new(
        mechanism: &'m InterpretedMechanism,
        start: &State<'_>,
        options: Options,
        by: &[By],
        times: &[f64],
    ) -> Result<Self, GradientError> {
        let followed = Followed::new(mechanism, start, options, by, times)?;
        let each: Vec<Direction> = by.iter().map(|&by| vec![(by, 1.0)]).collect();
        let seeds = seeds(mechanism, start, &each);
        let direction: Direction = by.iter().copied().zip(rates()).collect();
        let mut propagation = Propagation::new(&followed, mechanism, start, vec![direction.clone()]);
        propagation.pieces = Some(Vec::new());
        propagation.follow(&followed, Start::Free);
        if let Some(Undefined { reason: reason @ Reason::StartInContact(_), .. }) =
            &mut propagation.motion.undefined
        {
            // Which of the variables it is, the direction of all does not say.
            let mut apart = Propagation::new(&followed, mechanism, start, each);
            if let Err((_, why)) = apart.begin(Start::Free, &followed.parts, &[]) {
                *reason = why;
            }
        }
        let Propagation { motion, pieces, .. } = propagation;
        let pieces = pieces.unwrap_or_default();
        Ok(Adjoint { mechanism, by: by.to_vec(), start: seeds, direction, followed, motion, pieces })
    }

    /// The variables.
    pub fn by(&self) -> &[By] {
        &self.by
    }

    /// The states at the given times.
    pub fn samples(&self) -> &[Sample] {
        &self.followed.samples
    }

    /// The events up to the last of the given times.
    pub fn events(&self) -> &[Event] {
        &self.followed.events
    }

    /// The time and the reason if derivatives end.
    pub fn undefined(&self) -> Option<&Undefined> {
        self.motion.undefined.as_ref()
    }

    /// The derivatives of a function of the states at the given times, whose gradient by the state at each time
    /// (coordinates, then independent speeds) is `weights`. One number for each variable.
    ///
    /// # Errors
    ///
    /// Why there are none. Weights of zero ask for nothing.
    ///
    /// # Panics
    ///
    /// If there is not one vector for each time, with a number for each coordinate and independent speed.
    pub fn of_states(&self, weights: &[DVector<f64>]) -> Result<DVector<f64>, Undefined> {
        let samples = &self.motion.samples;
        assert_eq!(weights.len(), samples.len(), "a vector of weights for each time");
        let mut along = Sum::default();
        for (sample, weights) in samples.iter().zip(weights) {
            assert_eq!(
                weights.len(),
                sample.state.len(),
                "a weight for each coordinate and independent speed"
            );
            match &sample.derivative {
                Some(by) => by.iter().zip(weights.iter()).for_each(|(by, weight)| along.add(by * weight)),
                None if weights.iter().all(|weight| *weight == 0.0) => {}
                None => return Err(self.lacking(sample.time)),
            }
        }
        self.backwards(Output::States(weights), &along)
    }

    /// The derivatives of the time of an event, s per unit of each variable; `None` if the time is only reported (the end
    /// of bounces, rest).
    ///
    /// # Errors
    ///
    /// Why there are none.
    ///
    /// # Panics
    ///
    /// If there is no event with this index.
    pub fn of_time(&self, event: usize) -> Result<Option<DVector<f64>>, Undefined> {
        let time = self.followed.events[event].time;
        let Some(by) = self.motion.events.get(event).and_then(|event| event.time.as_ref()) else {
            let ended = self.undefined().is_some_and(|undefined| undefined.time <= time);
            return if ended { Err(self.lacking(time)) } else { Ok(None) };
        };
        let mut along = Sum::default();
        by.iter().for_each(|by| along.add(*by));
        self.backwards(Output::Time(event), &along).map(Some)
    }

    fn lacking(&self, time: f64) -> Undefined {
        let known = self.undefined().cloned();
        known.unwrap_or(Undefined { time, contact: None, reason: Reason::ModesChanged })
    }

    /// The derivatives of an output by each variable; `along` is its derivative along the direction of all.
    fn backwards(&self, output: Output<'_>, along: &Sum) -> Result<DVector<f64>, Undefined> {
        let Followed { surfaces, sampling, .. } = &self.followed;
        let field = Field::new(self.mechanism, Vec::new(), surfaces.clone(), *sampling);
        let mut field = TransposedField::new(&field);
        let collocation = OnceCell::new();
        let count = self.start.len() / (self.by.len() + 1);
        let mut weights = vec![0.0; count];
        for piece in self.pieces.iter().rev() {
            let done = self.through(piece, output, (&mut field, &collocation), &mut weights);
            done.map_err(|(time, reason)| Undefined { time, contact: None, reason })?;
        }
        let (totals, k) = (field.totals(), self.by.len() + 1);
        let of = |(index, by): (usize, &By)| -> f64 {
            let start: f64 = weights.iter().enumerate().map(|(row, w)| w * self.start[row * k + index]).sum();
            start + totals.by(*by)
        };
        let found: Vec<f64> = self.by.iter().enumerate().map(of).collect();
        let mut again = Sum::default();
        found.iter().zip(&self.direction).for_each(|(by, (_, rate))| again.add(by * rate));
        let off = (along.sum - again.sum).abs() / (along.size + again.size + f64::MIN_POSITIVE);
        // NaN agrees with nothing.
        if off <= AGREEMENT {
            Ok(DVector::from_vec(found))
        } else {
            let time = self.followed.start;
            Err(Undefined { time, contact: None, reason: Reason::Inaccurate(off) })
        }
    }

    /// Takes the weights of the state after a piece of the motion to those of the state before it.
    fn through(
        &self,
        piece: &Piece,
        output: Output<'_>,
        (field, collocation): (&mut TransposedField<'_>, &OnceCell<Collocation<'m>>),
        weights: &mut [f64],
    ) -> Result<(), (f64, Reason)> {
        let still = weights.iter().all(|weight| *weight == 0.0);
        match piece {
            Piece::Sample(index) => {
                if let Output::States(of) = output {
                    weights.iter_mut().zip(of[*index].iter()).for_each(|(weight, of)| *weight += of);
                }
                Ok(())
            }
            Piece::Events { part, junction, events } => {
                let of_time = matches!(output, Output::Time(event) if events.contains(&event));
                if still && !of_time {
                    return Ok(());
                }
                let part = &self.followed.parts[*part];
                let done = field.of_junction(part, junction, weights, if of_time { 1.0 } else { 0.0 });
                done.map_err(|why| (part.end, why))
            }
            _ if still => Ok(()),
            Piece::Step { part, t, h, state } => {
                let part = &self.followed.parts[*part];
                let mut rates = Rates { modes: field.field.modes(part), field, part, tapes: Vec::new() };
                transpose(&mut rates, (*t, state), *h, weights).map_err(|why| (*t, why))
            }
            Piece::Collocation { part, stages } => {
                let part = &self.followed.parts[*part];
                let Followed { surfaces, sampling, tolerances, .. } = &self.followed;
                let make = || Collocation::new(self.mechanism, surfaces.clone(), *sampling);
                let collocation = collocation.get_or_init(make);
                let stretch = Stretch::new(field.field, part, &field.field.modes(part), tolerances);
                let done = stretch.and_then(|stretch| {
                    collocation::transpose(collocation, field, &stretch, stages, weights)
                });
                done.map_err(|why| (stages.t, why))
            }
            Piece::Straight { part, time, modes } => {
                let part = &self.followed.parts[*part];
                let mut rates = Rates { modes: modes.clone(), field, part, tapes: Vec::new() };
                let mut change = vec![0.0; weights.len()];
                let found = rates.rates(0, part.start, &part.first, &mut change);
                let of_rates: Vec<f64> = weights.iter().map(|weight| time * weight).collect();
                let found = found.and_then(|()| rates.transpose(0, &of_rates, &mut change));
                found.map_err(|why| (part.start, why))?;
                weights.iter_mut().zip(change).for_each(|(weight, change)| *weight += change);
                Ok(())
            }
        }
    }
}

/// The rates within a part.
struct Rates<'a, 'f> {
    field: &'a mut TransposedField<'f>,
    modes: Vec<Mode>,
    part: &'a SmoothPart,
    /// of each stage
    tapes: Vec<ModeTape>,
}

impl TransposedSystem for Rates<'_, '_> {
    type Error = Reason;

    fn rates(&mut self, stage: usize, t: f64, y: &[f64], rates: &mut [f64]) -> Result<(), Reason> {
        let place =
            Place { time: t, state: y, inputs: &self.part.inputs, row: self.field.row(self.part.start) };
        let tape = self.field.mode_rates(&self.modes, &place)?;
        rates.copy_from_slice(&tape.rates);
        self.tapes.truncate(stage);
        self.tapes.push(tape);
        Ok(())
    }

    fn transpose(&mut self, stage: usize, weights: &[f64], by_state: &mut [f64]) -> Result<(), Reason> {
        let tape = self.tapes.get(stage).ok_or(Reason::ModesChanged)?;
        let by = self.field.of_mode_rates(&self.modes, tape, weights, &[])?;
        by_state.copy_from_slice(&by.state);
        Ok(())
    }
}

/// A sum, and that of the magnitudes of its terms.
#[derive(Default)]
struct Sum {
    sum: f64,
    size: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.size += term.abs();
    }
}

/// Rates of the variables along the direction of all: between 1/2 and 1 with either sign, without a pattern.
fn rates() -> impl Iterator<Item = f64> {
    let mut bits = 0x9e37_79b9_7f4a_7c15_u64;
    std::iter::repeat_with(move || {
        bits ^= bits << 13;
        bits ^= bits >> 7;
        bits ^= bits << 17;
        let size = 0.5 + (bits >> 12) as f64 / (1_u64 << 53) as f64;
        if bits & 1 == 0 { size } else { -size }
    })
}
