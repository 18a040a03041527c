//! Decides modes by the motion just after an event.
//!
//! If friction is exhausted, or a normal force vanishes, the accelerations at the contacts are zero: at that
//! time both the modes before and those after are admissible. A mode is right if its conditions hold for some
//! time after the event (docs/theory.md, section 17.11). So the motion is continued for a short time in the
//! ending modes; the forces that obey the laws there determine the following modes of all contacts together.

use hodograph::State;
use nalgebra::Vector2;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Lacking, relative_margins};
use crate::closed::mode_selection::{Choice, Decision, Question};
use crate::closed::phase::{Closed, Phase, mus};
use crate::integration::motion::{Evaluation, Failure, NO_SLIP};
use crate::integration::stepper::Step;
use crate::state::transition::Transition;
use crate::{EventKind, SimulationError};

/// The first time ahead, relative to the last step, and the factor from one time to the next.
const FIRST: f64 = 1e-7;
const LONGER: f64 = 8.0;
/// The bounds of the last step for this purpose, relative to the time of the problem.
const LEAST: f64 = 5e-6;
const MOST: f64 = 5e-2;
/// Number of times ahead that are tried.
const TRIALS: usize = 8;
/// A condition that has changed by this part of the forces has changed by more than rounding.
const CLEAR: f64 = 1e-10;
/// After this many events without progress, decided modes are confirmed.
const DOUBT: usize = 4;
/// The times ahead, relative to that of the problem, whose directions of beginning slip are extrapolated to the event, and
/// how often shorter ones are tried where the modes are others there.
const DIRECTIONS: [f64; 2] = [4e-6, 1.6e-5];
const NEARER: i32 = 3;
/// Number of modes that are tried before the last ones are accepted.
const ROUNDS: usize = 6;

/// The result of the motion ahead.
enum Ahead {
    /// The modes continue.
    Fit,
    /// The modes end here; the following ones.
    End(Box<(Question, Choice)>),
}

impl Transition<'_> {
    /// Decides the modes that follow those of these contacts, which have ended or seem to have.
    pub(crate) fn look_ahead(&mut self, contacts: &[usize]) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        let closed = self.closed();
        let mut last: Option<Step> = None;
        for trial in 0..TRIALS {
            let Some(step) = self.part(&closed, self.ahead(trial)) else { break };
            let Some((clear, fits)) = self.clear(&closed, &step) else { break };
            last = Some(step.clone());
            if !clear {
                continue;
            }
            if fits {
                break;
            }
            return match self.chosen_at(contacts, &was, &step)? {
                // Nothing changes: the conditions are violated by no more than the errors of the state.
                Ok((_, choice)) if self.go_on(contacts, &choice) => break,
                Ok((question, mut choice)) => {
                    self.find_directions(&closed, contacts, &was, &mut choice);
                    self.begin_from_rest(contacts, &choice)?;
                    self.apply_and_confirm(contacts, &was, (question, choice))
                }
                Err(lacking) => self.without_forces(contacts, lacking),
            };
        }
        // The conditions hold ahead, or are violated as little as here: the modes continue.
        match last {
            Some(mut step) => self.commit(&mut step),
            None => self.decide(contacts, &was),
        }
    }

    /// Finds the directions in which slip begins together: the limit of those at two times ahead. Just after the event all
    /// accelerations are as small as rounding, and the directions that follow from them are not known.
    fn find_directions(&self, closed: &[Closed], contacts: &[usize], was: &[Phase], choice: &mut Choice) {
        let beginning = choice.decisions.iter().filter(|decision| decision.begins().is_some()).count();
        if beginning < 2 {
            return;
        }
        for shorter in 0..NEARER {
            let ahead = DIRECTIONS.map(|ahead| ahead * self.front.scales.time / LONGER.powi(2 * shorter));
            let at = |time: f64| -> Option<Vec<Decision>> {
                let step = self.part(closed, time)?;
                let (question, choice) = self.chosen_at(contacts, was, &step).ok()?.ok()?;
                Some(question.with_exact_directions(choice).decisions)
            };
            let [Some(first), Some(second)] = ahead.map(at) else { continue };
            let share = ahead[0] / (ahead[1] - ahead[0]);
            let limits = choice.decisions.iter().zip(first.iter().zip(&second)).map(
                |(decided, (first, second))| match (decided, first.begins(), second.begins()) {
                    (Decision::Slide(_, true), Some(first), Some(second)) => {
                        let limit = first + (first - second) * share;
                        Some(Decision::Slide(limit.normalize(), true))
                    }
                    _ => (decided.is_of_kind(first) && decided.is_of_kind(second)).then_some(*decided),
                },
            );
            if let Some(limits) = limits.collect::<Option<Vec<Decision>>>() {
                choice.decisions = limits;
                return;
            }
        }
    }

    /// Applies modes that were just decided, and confirms them where events are frequent: they must hold a little later,
    /// too.
    pub(crate) fn apply_and_confirm(
        &mut self,
        contacts: &[usize],
        was: &[Phase],
        (mut question, mut choice): (Question, Choice),
    ) -> Result<(), SimulationError> {
        let mut since = self.events.len();
        self.apply(contacts, was, &choice)?;
        let rounds = if contacts.len() < 2 || self.front.crowd < DOUBT { 0 } else { ROUNDS };
        for round in 0..rounds {
            match self.modes_ahead(contacts, was, round)? {
                Ahead::Fit => break,
                Ahead::End(next) => {
                    (question, choice) = *next;
                    self.forget_mode_events(contacts);
                    self.front.phases.clone_from_slice(was);
                    self.begin_from_rest(contacts, &choice)?;
                    since = self.events.len();
                    self.apply(contacts, was, &choice)?;
                }
            }
        }
        self.tell_selection(since, &question, &choice);
        Ok(())
    }

    /// Whether the present modes are still admissible a little later, and the admissible ones.
    fn modes_ahead(&self, contacts: &[usize], was: &[Phase], round: usize) -> Result<Ahead, SimulationError> {
        let closed = self.closed();
        let Some(step) = self.part(&closed, self.ahead(round / 2)) else { return Ok(Ahead::Fit) };
        let fits = self.clear(&closed, &step).is_none_or(|(_, fits)| fits);
        if fits && self.opened(contacts, &step)? {
            return Ok(Ahead::Fit);
        }
        let chosen = self.chosen_at(contacts, was, &step)?;
        Ok(chosen.map_or(Ahead::Fit, |chosen| Ahead::End(Box::new(chosen))))
    }

    /// New slip begins from zero, since a rounding error of the previous slip would have a direction.
    fn begin_from_rest(&mut self, contacts: &[usize], choice: &Choice) -> Result<(), SimulationError> {
        for (&contact, decision) in contacts.iter().zip(&choice.decisions) {
            if matches!(decision, Decision::Slide(_, true) | Decision::Stick) {
                self.front.phases[contact] = Phase::Stick;
            }
        }
        self.correct()
    }

    /// Whether contacts that have opened do not approach again. A rate that projections have left here, where it
    /// is zero, is not that of the motion.
    fn opened(&self, contacts: &[usize], step: &Step) -> Result<bool, SimulationError> {
        for &contact in contacts {
            if !self.front.phases[contact].is_closed()
                && self.gap_at(step, contact)?.1 < -self.left_at_lift_off(contact)
            {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// The time ahead: it increases with the number of events without progress.
    fn ahead(&self, trial: usize) -> f64 {
        let scale = self.front.next.clamp(LEAST * self.front.scales.time, MOST * self.front.scales.time);
        let crowd = (self.front.crowd / 8).min(4);
        FIRST * scale * LONGER.powi((trial + crowd) as i32) + 64.0 * f64::EPSILON * self.front.t.abs()
    }

    /// Whether the conditions of the modes differ from zero at the end of a step by more than rounding, and
    /// whether they hold.
    fn clear(&self, closed: &[Closed], step: &Step) -> Option<(bool, bool)> {
        let evaluation = self.motion(closed).evaluate(step.t + step.h, &step.end).ok()?;
        let Some(forces) = &evaluation.forces else { return Some((true, true)) };
        let forward = slips_forward(closed, &evaluation);
        let relative = relative_margins(forces, &evaluation.holds, &mus(closed), forces.rounding / CLEAR);
        let fits = forward && relative.iter().all(|margin| *margin >= 0.0);
        let violated = relative.iter().any(|margin| *margin < -CLEAR);
        let near = relative.iter().any(|margin| margin.abs() <= CLEAR);
        Some((!forward || violated || !near, fits))
    }

    /// The modes that the state at the end of a step requires; `was` are the phases before the event. A contact that
    /// has opened since has the slip that it had: it does not begin from rest if it closes again.
    pub(crate) fn chosen_at(
        &self,
        contacts: &[usize],
        was: &[Phase],
        step: &Step,
    ) -> Result<Result<(Question, Choice), Lacking>, SimulationError> {
        let motion = self.motion(&[]);
        let (q, u) = motion.split(&step.end);
        let time = step.t + step.h;
        let inputs = motion.inputs(time, &step.end).map_err(|failure| self.failure(failure))?;
        let state = State { time, coordinates: q, speeds: u, inputs: &inputs };
        let support = ClosedContacts::loaded(self.mechanism, &state, self.angles, contacts)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let settled = self.settled_directions(step);
        let slips: Vec<Option<Vector2<f64>>> = contacts
            .iter()
            .enumerate()
            .map(|(i, &contact)| {
                let slip = support.slip(i);
                let size = support.velocity_size(i, u).max(support.velocity_size(i, &self.front.scale));
                let slips = slip.norm() > NO_SLIP * size;
                let now = self.front.phases[contact];
                match if now.is_closed() { now } else { was[contact] } {
                    // Slip that began here against its direction counts as zero.
                    Phase::Slide(began) => {
                        let known = settled.iter().find(|(other, _)| *other == contact);
                        (slips && slip.dot(&began) > 0.0)
                            .then(|| known.map_or_else(|| slip / slip.norm(), |(_, direction)| *direction))
                    }
                    Phase::Stick => None,
                    Phase::Open(_) => slips.then(|| slip / slip.norm()),
                }
            })
            .collect();
        let friction = self.frictions(contacts, &slips, &support)?;
        let question = Question { support, slips, friction };
        let choice = question.choose(&self.forces_before(contacts));
        Ok(choice.map(|choice| (question, choice)))
    }

    /// Whether these decisions are the present modes.
    pub(crate) fn go_on(&self, contacts: &[usize], choice: &Choice) -> bool {
        contacts.iter().zip(&choice.decisions).all(|(&contact, decision)| {
            matches!(
                (self.front.phases[contact], decision),
                (Phase::Stick, Decision::Stick) | (Phase::Slide(_), Decision::Slide(_, false))
            )
        })
    }

    /// The contacts whose directions of slip follow from the state, and these directions at the end of a
    /// step, with which the conditions of the modes are evaluated.
    fn settled_directions(&self, step: &Step) -> Vec<(usize, Vector2<f64>)> {
        let closed = self.closed();
        if closed.iter().all(Closed::has_own_direction) {
            return Vec::new();
        }
        let Ok(there) = self.motion(&closed).evaluate(step.t + step.h, &step.end) else { return Vec::new() };
        let settled = closed.iter().zip(&there.holds).filter(|(contact, _)| !contact.has_own_direction());
        settled.filter_map(|(contact, hold)| Some((contact.contact, hold.direction()?))).collect()
    }

    /// Removes the events of the modes of these contacts at this time.
    fn forget_mode_events(&mut self, contacts: &[usize]) {
        let now = self.front.t;
        self.events.retain(|event| {
            let of_mode = matches!(
                event.kind,
                EventKind::Slip { .. }
                    | EventKind::Stick { .. }
                    | EventKind::LiftOff { .. }
                    | EventKind::Contact { .. }
                    | EventKind::Roll { .. }
                    | EventKind::RollEnds { .. }
                    | EventKind::Spin { .. }
                    | EventKind::SpinEnds { .. }
            );
            !(of_mode
                && event.time == now
                && event.contact.is_some_and(|contact| contacts.contains(&contact)))
        });
    }
}

/// Whether slip that began goes in the direction in which it began.
fn slips_forward(closed: &[Closed], evaluation: &Evaluation) -> bool {
    closed
        .iter()
        .enumerate()
        .all(|(i, contact)| contact.slides.is_none_or(|began| evaluation.support.slip(i).dot(&began) >= 0.0))
}
