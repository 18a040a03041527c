//! Decides the modes of closed contacts at events, and records the resulting events.

use hodograph::{ComponentKind, ContactError, ContactMode, Selection, State};
use nalgebra::{DVector, Vector2, Vector3};

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Lacking, hold_good};
use crate::closed::mode_selection::{Choice, Decision, Question};
use crate::closed::pair::Friction;
use crate::closed::phase::{Leaving, Phase, mus};
use crate::integration::motion::{Failure, NO_SLIP};
use crate::state::transition::Transition;
use crate::{ErrorKind, EventKind, SimulationError};

/// The first step after slip begins, relative to the time of the problem.
pub(crate) const FIRST: f64 = 5e-7;

/// Times after which all rates vanish where the mechanism is at rest, relative to the time of the problem.
const STILL: [f64; 3] = [0.0, 1e-4, 1e-2];

/// The condition of a mode that is violated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ending {
    Friction,
    NormalForce,
}

/// Whether contacts without slip are held by static friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    ByStaticFriction,
    /// Static friction is exhausted: only the sliding coefficient counts.
    No,
}

impl Transition<'_> {
    /// Decides the modes after a change of inputs; modes that are still admissible are kept.
    pub(crate) fn keep_or_decide(&mut self) -> Result<(), SimulationError> {
        if self.keeps()? {
            return Ok(());
        }
        let candidates: Vec<usize> =
            (0..self.front.phases.len()).filter(|&i| self.front.phases[i].is_closed()).collect();
        let was = self.front.phases.clone();
        self.decide(&candidates, &was)
    }

    /// Whether the present modes have admissible forces.
    fn keeps(&self) -> Result<bool, SimulationError> {
        let closed = self.closed();
        if closed.is_empty() {
            return Ok(true);
        }
        match self.motion(&closed).evaluate(self.front.t, &self.front.y) {
            Ok(evaluation) => {
                let forces = evaluation.forces.as_ref();
                Ok(forces.is_none_or(|forces| hold_good(forces, &evaluation.holds, &mus(&closed))))
            }
            Err(Failure::Contact(..) | Failure::NoForces) => Ok(false),
            Err(failure) => Err(self.failure(failure)),
        }
    }

    /// Handles a violated condition of the modes: friction is no longer sufficient at a contact, or its
    /// normal force vanishes.
    pub(crate) fn modes_ended(&mut self, contact: usize, by: Ending) -> Result<(), SimulationError> {
        let closed: Vec<usize> =
            (0..self.front.phases.len()).filter(|&i| self.front.phases[i].is_closed()).collect();
        match (closed.len(), by) {
            (1, Ending::Friction) => self.begin_slip(contact),
            (1, Ending::NormalForce) => self.lift_off(contact),
            _ => {
                self.go_past_a_jump()?;
                self.look_ahead(&closed)
            }
        }
    }

    /// Friction of the only closed contact is no longer sufficient.
    fn begin_slip(&mut self, contact: usize) -> Result<(), SimulationError> {
        self.go_past_a_jump()?;
        let was = self.front.phases.clone();
        let before = self.force_of(contact)?;
        let mark = self.mark();
        let decided = self.decide_where(&[contact], &was, Held::No);
        if let Err(SimulationError { kind: ErrorKind::NoForces(_), .. }) = &decided {
            // At the boundary neither sticking nor slipping is admissible: slip begins.
            self.return_to(&mark);
        } else {
            decided?;
        }
        if self.front.phases[contact] == Phase::Stick {
            self.slip_against(contact, &before)?;
        }
        Ok(())
    }

    /// Slip begins opposite to the friction that held the contact.
    fn slip_against(&mut self, contact: usize, force: &Vector3<f64>) -> Result<(), SimulationError> {
        let friction = Vector2::new(force.y, force.z);
        let size = friction.norm();
        if size > 0.0 {
            self.front.phases[contact] = Phase::Slide(-friction / size);
            self.front.next = FIRST * self.front.scales.time;
            self.slips(contact, Selection::Unique)?;
        }
        Ok(())
    }

    /// The normal force of the only closed contact vanishes.
    fn lift_off(&mut self, contact: usize) -> Result<(), SimulationError> {
        self.go_past_a_jump_of(contact)?;
        self.front.phases[contact] = Phase::Open(Leaving::NOW);
        self.front.forces[contact] = Vector3::zeros();
        self.front.resting = false;
        self.push(Some(contact), EventKind::LiftOff { selection: Selection::Unique });
        Ok(())
    }

    /// Slip of these contacts has ended.
    pub(crate) fn slip_ended(&mut self, stopped: &[usize]) -> Result<(), SimulationError> {
        let mut was = self.front.phases.clone();
        for &contact in stopped {
            was[contact] = Phase::Slide(Vector2::zeros());
        }
        let candidates: Vec<usize> = (0..was.len()).filter(|&i| was[i].is_closed()).collect();
        self.decide(&candidates, &was)?;
        self.look_for_rest()
    }

    /// The present force at a contact; the last decided one if it cannot be evaluated.
    pub(crate) fn force_of(&self, contact: usize) -> Result<Vector3<f64>, SimulationError> {
        let closed = self.closed();
        let place = closed.iter().position(|closed| closed.contact == contact);
        let evaluation = self.motion(&closed).evaluate(self.front.t, &self.front.y);
        Ok(match (place, evaluation) {
            (Some(place), Ok(evaluation)) => {
                evaluation.forces.map_or(self.front.forces[contact], |forces| forces.of(place))
            }
            _ => self.front.forces[contact],
        })
    }

    /// Decides the modes of contacts whose gaps are closed and which neither approach nor separate; `was` are
    /// their previous phases.
    pub(crate) fn decide(&mut self, candidates: &[usize], was: &[Phase]) -> Result<(), SimulationError> {
        self.decide_where(candidates, was, Held::ByStaticFriction)
    }

    fn decide_where(
        &mut self,
        candidates: &[usize],
        was: &[Phase],
        held: Held,
    ) -> Result<(), SimulationError> {
        if candidates.is_empty() {
            return Ok(());
        }
        let candidates = &self.mechanism.with_torques(candidates)[..];
        self.front.resting = false;
        // The velocities of contacts without slip are projected, so that their slip is exactly zero. What is projected,
        // an approach too slow for an impact too, changes slip as slow as itself: its direction is that afterwards.
        let mut slips = self.slips_of(candidates)?;
        for _ in 0..=candidates.len() {
            for (&contact, slip) in candidates.iter().zip(&slips) {
                self.front.phases[contact] = slip.map_or(Phase::Stick, Phase::Slide);
            }
            self.correct()?;
            let before = std::mem::replace(&mut slips, self.slips_of(candidates)?);
            if before.iter().zip(&slips).all(|(before, after)| before.is_some() == after.is_some()) {
                break;
            }
        }
        for (&contact, slip) in candidates.iter().zip(&slips) {
            self.front.phases[contact] = slip.map_or(Phase::Stick, Phase::Slide);
        }
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let inputs =
            self.motion(&[]).inputs(self.front.t, &self.front.y).map_err(|failure| self.failure(failure))?;
        let state = State {
            time: self.front.t,
            coordinates: &self.front.y[..n],
            speeds: &self.front.y[n..n + p],
            inputs: &inputs,
        };
        let support = ClosedContacts::loaded(self.mechanism, &state, self.angles, candidates)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let mut friction = self.frictions(candidates, &slips, &support)?;
        if held == Held::No {
            friction.iter_mut().for_each(|friction| friction.sticks = friction.slips);
        }
        let before = self.forces_before(candidates);
        let question = Question { support, slips, friction };
        match question.choose(&before) {
            Ok(choice) => self.apply_and_confirm(candidates, was, (question, choice)),
            Err(lacking) => self.without_forces(candidates, lacking),
        }
    }

    /// If there are no finite forces: an impact without collision of the sliding contact that jams, or of all together.
    pub(crate) fn without_forces(
        &mut self,
        candidates: &[usize],
        lacking: Lacking,
    ) -> Result<(), SimulationError> {
        match lacking {
            Lacking::Contact(
                place,
                ContactError::ImpactWithoutCollision { .. } | ContactError::Jam { .. },
            ) => self.jams(candidates[place]),
            Lacking::Contact(place, error) => {
                Err(self.error(Some(candidates[place]), ErrorKind::Contact(error)))
            }
            Lacking::Common => self.jam_of_all(candidates, self.failure(Failure::NoForces)),
        }
    }

    /// The forces of these contacts when their modes were last decided.
    pub(crate) fn forces_before(&self, contacts: &[usize]) -> DVector<f64> {
        DVector::from_iterator(
            3 * contacts.len(),
            contacts
                .iter()
                .flat_map(|&contact| self.front.forces[contact].iter().copied().collect::<Vec<_>>()),
        )
    }

    /// The coefficients of friction of contacts with these directions of slip.
    pub(crate) fn frictions(
        &self,
        contacts: &[usize],
        slips: &[Option<Vector2<f64>>],
        support: &ClosedContacts,
    ) -> Result<Vec<Friction>, SimulationError> {
        let speed = |i: usize| slips[i].map_or(0.0, |_| support.slip(i).norm());
        contacts.iter().enumerate().map(|(i, &contact)| self.friction(contact, speed(i))).collect()
    }

    /// The directions of slip; `None` without slip.
    pub(crate) fn slips_of(
        &self,
        candidates: &[usize],
    ) -> Result<Vec<Option<Vector2<f64>>>, SimulationError> {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let speeds = &self.front.y[n..n + p];
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let support = ClosedContacts::new(self.mechanism, &state, candidates, false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        Ok(candidates
            .iter()
            .enumerate()
            .map(|(i, &contact)| {
                if self.front.phases[contact] == Phase::Stick {
                    return None;
                }
                let slip = support.slip(i);
                let size = support.velocity_size(i, speeds).max(support.velocity_size(i, &self.front.scale));
                let slowest =
                    (1..3).map(|axis| self.slowest_along(&support, 3 * i + axis)).fold(0.0, f64::max);
                (slip.norm() > (NO_SLIP * size).max(slowest)).then(|| slip / slip.norm())
            })
            .collect())
    }

    /// Applies the chosen modes, and records the changes as events; whether others were possible is told later, if it is
    /// not known ([`Self::tell_selection`]).
    pub(crate) fn apply(
        &mut self,
        candidates: &[usize],
        was: &[Phase],
        choice: &Choice,
    ) -> Result<(), SimulationError> {
        for (place, &contact) in candidates.iter().enumerate() {
            let selection = choice.selection.unwrap_or(Selection::Unknown);
            self.front.forces[contact] = choice.forces[place];
            if let Some(torque) = self.mechanism.torque(contact) {
                self.apply_to_torque(contact, torque, was[contact], choice.decisions[place], selection)?;
                continue;
            }
            match choice.decisions[place] {
                Decision::Separate => {
                    self.front.phases[contact] = Phase::Open(Leaving::NOW);
                    if was[contact].is_closed() {
                        self.push(Some(contact), EventKind::LiftOff { selection });
                    }
                }
                Decision::Stick => {
                    self.front.phases[contact] = Phase::Stick;
                    match was[contact] {
                        Phase::Open(_) => self.begin_contact(contact, selection),
                        Phase::Slide(_) if !self.bounces(contact) => {
                            self.push(Some(contact), EventKind::Stick { selection });
                        }
                        Phase::Slide(_) => {}
                        Phase::Stick => {}
                    }
                }
                Decision::Slide(direction, begins) => {
                    self.front.phases[contact] = Phase::Slide(direction);
                    if begins {
                        self.front.next = self.front.next.min(FIRST * self.front.scales.time);
                    }
                    match was[contact] {
                        Phase::Open(_) => self.begin_contact(contact, selection),
                        _ if begins => self.slips(contact, selection)?,
                        _ => {}
                    }
                }
            }
        }
        Ok(())
    }

    /// Tells the events since this number whether other modes were possible.
    pub(crate) fn tell_selection(&mut self, since: usize, question: &Question, choice: &Choice) {
        let since = since.min(self.events.len());
        if choice.selection.is_some()
            || self.events[since..].iter().all(|event| event.kind.selection().is_none())
        {
            return;
        }
        let selection = question.selection(choice);
        self.events[since..].iter_mut().for_each(|event| event.kind.select(selection));
    }

    fn slips(&mut self, contact: usize, selection: Selection) -> Result<(), SimulationError> {
        self.front.resting = false;
        if let Phase::Slide(d) = self.front.phases[contact]
            && !self.bounces(contact)
        {
            let along = self.along_axes_of_n(contact, d)?;
            self.push(Some(contact), EventKind::Slip { direction: [d.x, d.y], along, selection });
        }
        Ok(())
    }

    /// A tangential direction of a contact along N.x, N.y, N.z.
    pub(crate) fn along_axes_of_n(
        &self,
        contact: usize,
        direction: Vector2<f64>,
    ) -> Result<[f64; 3], SimulationError> {
        let axes = self.mechanism.mechanism.contact_state(contact, &self.here());
        let axes = axes.map_err(|error| self.failure(Failure::State(error)))?;
        Ok((axes.first * direction.x + axes.second * direction.y).into())
    }

    /// Begins a contact; the event is recorded now, or when its bounces have ended.
    fn begin_contact(&mut self, contact: usize, selection: Selection) {
        if self.bounces(contact) {
            return;
        }
        let mode =
            if self.front.phases[contact] == Phase::Stick { ContactMode::Stick } else { ContactMode::Slide };
        self.push(Some(contact), EventKind::Contact { mode, selection });
    }

    /// Records that a contact has begun.
    pub(crate) fn announce_contact(&mut self, contact: usize) {
        self.begin_contact(contact, Selection::Unique);
    }

    /// Checks whether the mechanism is at rest: all closed contacts stick, and nothing moves.
    pub(crate) fn look_for_rest(&mut self) -> Result<(), SimulationError> {
        let closed = self.closed();
        if self.front.resting || closed.is_empty() || closed.iter().any(|closed| closed.slides.is_some()) {
            return Ok(());
        }
        if !self.front.chatter.is_empty() {
            return Ok(());
        }
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let state = State {
            time: self.front.t,
            coordinates: &self.front.y[..n],
            speeds: &self.front.y[n..n + p],
            inputs: &self.front.held,
        };
        let kinetic = self.mechanism.kinetic_energy(&state);
        let still = kinetic.is_ok_and(|kinetic| kinetic <= 1e-22 * self.front.greatest);
        if !still {
            return Ok(());
        }
        let mut y = self.front.y.clone();
        y[n..n + p].fill(0.0);
        self.front.resting = true;
        // Where loads depend on time, rates that vanish now need not do so afterwards.
        let quiet = STILL.iter().all(|after| {
            let later = self.front.t + after * self.front.scales.time;
            let rates = self.motion(&closed).evaluate(later, &y).map(|evaluation| evaluation.rates);
            rates.is_ok_and(|rates| rates[..n + p].iter().all(|rate| *rate == 0.0))
        });
        if quiet {
            self.front.y = y;
            if let Some((step, _)) = self.steps.last_mut() {
                step.corrected(&self.front.y);
            }
            self.push(None, EventKind::Rest);
        } else {
            self.front.resting = false;
        }
        Ok(())
    }
}
