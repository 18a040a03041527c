//! Impacts of several contacts at once, with friction: by Poisson's hypothesis where it is the law of all of them
//! ([`crate::impact::poisson_at_once`]), else by Moreau's law.
//!
//! Moreau's law: with the velocities v- before and v+ after, the impulses p of all contacts satisfy v+ = v- +
//! W p with the laws of lasting contact for velocities in place of accelerations. Each contact requires
//! v+_n >= -e v-_n and p_n >= 0, one of them with equality, and friction abs(p_tan) <= mu p_n, which opposes
//! the remaining slip (docs/theory.md, section 17.13).

use hodograph::{ComponentKind, Law, State};
use nalgebra::{DVector, Vector2};

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::mode_selection::{Choice, Decision};
use crate::closed::pair::Pair;
use crate::closed::phase::Phase;
use crate::contact_problem::{self, Mode, Problem, Solution, Unsolved};
use crate::impact::poisson_at_once;
use crate::impact::single_impact::{Hit, HitKind};
use crate::integration::motion::Failure;
use crate::state::transition::Transition;
use crate::{ErrorKind, Share, SimulationError};

/// Number of bisections for the part of restitution that does not increase the energy.
const HALVINGS: usize = 40;
/// An energy increase below this, relative to the energies of the normal impulses, counts as rounding.
const ROUNDING: f64 = 1e-12;

/// The implicit time step whose limit ends a jam, relative to the time of the problem; and the factor by
/// which such a step changes the velocities more than the free accelerations would.
const STEP: f64 = 1e-7;
const LARGE: f64 = 100.0;
/// A change of velocity that is so many times smaller than slip does not end it.
const SMALL: f64 = 4.0;
/// At the event of a jam the determinant of the sliding contacts is not yet zero ([`crate::closed::forces::JAM`]);
/// friction is increased by this part in the impact.
const MORE: f64 = 2e-5;
/// The allowed relative violation of the cones by the impulses.
const SHORT: f64 = 1e-9;

/// The impulses of contacts that are struck at once.
struct AtOnce {
    impulse: DVector<f64>,
    velocity: DVector<f64>,
    /// change of kinetic energy, J
    work: f64,
    /// sum of the magnitudes of the terms of the work, J
    scale: f64,
}

impl AtOnce {
    fn with(impulse: DVector<f64>, before: DVector<f64>, velocity: DVector<f64>) -> Self {
        let terms = |i: usize| 0.5 * impulse[i] * (before[i] + velocity[i]);
        let work = (0..velocity.len()).map(terms).sum();
        let scale = (0..velocity.len()).map(|i| terms(i).abs()).sum();
        Self { impulse, velocity, work, scale }
    }
}

/// The outcome for contacts that jam together.
pub(crate) enum Jam {
    Impact(Hit),
    /// They continue in these modes.
    Modes(Choice),
    Unsolved,
}

/// The limit of implicit steps.
enum Outcome {
    Impulses(AtOnce),
    /// The forces are finite.
    Modes(Solution),
}

impl Transition<'_> {
    /// Determines the outcome for contacts that jam together, although none of them would jam alone.
    pub(crate) fn impact_of_a_jam(&self, contacts: &[usize], speeds: &[f64]) -> Result<Jam, SimulationError> {
        let state = State { speeds, ..self.here() };
        let support = ClosedContacts::new(self.mechanism, &state, contacts, true)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let mu = contacts.iter().enumerate().map(|(i, &contact)| {
            let slip = support.slip(i).norm();
            Ok((1.0 + MORE) * self.friction(contact, slip)?.slips)
        });
        let mu = mu.collect::<Result<Vec<f64>, SimulationError>>()?;
        let h = self.step_of_a_jam(contacts, &support);
        Ok(match impulses_of_a_jam(&support, &mu, h) {
            Some(Outcome::Impulses(outcome)) => {
                Jam::Impact(self.hit_by(contacts, &support, speeds, &outcome, Vec::new())?)
            }
            Some(Outcome::Modes(solution)) if self.differs(contacts, &solution.modes) => {
                Jam::Modes(self.choice_of(contacts, &solution, h))
            }
            _ => Jam::Unsolved,
        })
    }

    /// The implicit step whose limit ends a jam of these contacts: so short that the accelerations without forces change no
    /// slip by more than a small part of it. Else slow slip would end by the step itself, not by the jam.
    fn step_of_a_jam(&self, contacts: &[usize], support: &ClosedContacts) -> f64 {
        let sliding =
            (0..contacts.len()).filter(|&i| matches!(self.front.phases[contacts[i]], Phase::Slide(_)));
        let slowest = sliding.map(|i| support.slip(i).norm()).fold(f64::INFINITY, f64::min);
        let longest = STEP * self.front.scales.time;
        longest.min(slowest / (SMALL * LARGE * support.beta.amax()))
    }

    /// Whether these modes differ from those of the contacts.
    fn differs(&self, contacts: &[usize], modes: &[Mode]) -> bool {
        contacts.iter().zip(modes).any(|(&contact, mode)| {
            !matches!(
                (self.front.phases[contact], mode),
                (Phase::Stick, Mode::Stick) | (Phase::Slide(_), Mode::Slide(_))
            )
        })
    }

    /// The modes after an implicit step over this time.
    fn choice_of(&self, contacts: &[usize], solution: &Solution, h: f64) -> Choice {
        let decision = |(&contact, mode): (&usize, &Mode)| match mode {
            Mode::Separate => Decision::Separate,
            Mode::Stick => Decision::Stick,
            Mode::Slide(direction) => Decision::Slide(*direction, self.front.phases[contact] == Phase::Stick),
        };
        let decisions = contacts.iter().zip(&solution.modes).map(decision).collect();
        let forces = (0..contacts.len()).map(|i| ClosedContacts::three(&solution.force, i) / h).collect();
        Choice::among_unknown(decisions, forces)
    }

    /// The impact of these contacts at once; `faded` ones have no restitution.
    pub(crate) fn impact_at_once(
        &self,
        contacts: &[usize],
        speeds: &[f64],
        faded: bool,
    ) -> Result<Hit, SimulationError> {
        let support = self.struck_support(contacts, speeds)?;
        let before: Vec<f64> = (0..contacts.len()).map(|i| -support.velocity[3 * i]).collect();
        let mut restitution = vec![0.0; contacts.len()];
        if !faded {
            for ((e, &contact), before) in restitution.iter_mut().zip(contacts).zip(&before) {
                *e = self.surface_in_impact(contact, *before)?.e;
            }
        }
        // The restitution of each contact; by Poisson's hypothesis it depends on all of them.
        let mut rebound: Vec<f64> = restitution.iter().zip(&before).map(|(e, before)| e * before).collect();
        if self.by_poisson(contacts) && restitution.iter().any(|&e| e > 0.0) {
            let outcome = two_phases(&support, &self.mus_in_impacts(contacts), &restitution)
                .map_err(|unsolved| self.without_impulses(contacts, unsolved))?;
            rebound = (0..contacts.len()).map(|i| outcome.velocity[3 * i]).collect();
        }
        let mut bounces = Vec::new();
        for (i, &contact) in contacts.iter().enumerate() {
            let bounds = restitution[i] > 0.0 && before[i] > 0.0 && rebound[i] > 0.0;
            if bounds && let Some(time) = self.last_bounce(contact, speeds, before[i], rebound[i])? {
                restitution[i] = 0.0;
                bounces.push((contact, time));
            }
        }
        self.at_once(contacts, &support, speeds, &restitution, bounces)
    }

    /// The plastic impact of these contacts at once, after which none approaches.
    pub(crate) fn plastic_impact(&self, contacts: &[usize], speeds: &[f64]) -> Result<Hit, SimulationError> {
        let support = self.struck_support(contacts, speeds)?;
        self.at_once(contacts, &support, speeds, &vec![0.0; contacts.len()], Vec::new())
    }

    /// The error of contacts that approach by prescribed motion and leave what lies between them no room: no impulses
    /// stop all of them, not even without friction. `None` if some do.
    pub(crate) fn without_room(&self, contacts: &[usize], speeds: &[f64]) -> Option<SimulationError> {
        // Without speeds no contact approaches, unless motion is prescribed: impulses that stop all are possible then.
        let at_rest = self.struck_support(contacts, &vec![0.0; speeds.len()]).ok()?;
        if (0..contacts.len()).all(|i| at_rest.velocity[3 * i] >= 0.0) {
            return None;
        }
        let support = self.struck_support(contacts, speeds).ok()?;
        let none = vec![0.0; contacts.len()];
        if solve(&support, &none, &none).is_ok() {
            return None;
        }
        let name = |&contact: &usize| self.mechanism.component(ComponentKind::Contact, contact);
        let names: Vec<&str> = contacts.iter().filter_map(name).map(|component| component.name).collect();
        let message = format!(
            "{} leave what lies between them no room: prescribed motion makes some of them approach, and no impulses stop all",
            names.join(", ")
        );
        Some(self.error(None, ErrorKind::NoForces(message)))
    }

    fn struck_support(&self, contacts: &[usize], speeds: &[f64]) -> Result<ClosedContacts, SimulationError> {
        let state = State { speeds, ..self.here() };
        ClosedContacts::new(self.mechanism, &state, contacts, false)
            .map_err(|error| self.failure(Failure::State(error)))
    }

    fn at_once(
        &self,
        contacts: &[usize],
        support: &ClosedContacts,
        speeds: &[f64],
        restitution: &[f64],
        bounces: Vec<(usize, f64)>,
    ) -> Result<Hit, SimulationError> {
        let (mu, poisson) = (self.mus_in_impacts(contacts), self.by_poisson(contacts));
        let solve = |share: f64| {
            let e: Vec<f64> = restitution.iter().map(|e| share * e).collect();
            let solved = if poisson { two_phases(support, &mu, &e) } else { solve(support, &mu, &e) };
            solved.map_err(|unsolved| self.without_impulses(contacts, unsolved))
        };
        let mut outcome = solve(1.0)?;
        if outcome.work > ROUNDING * outcome.scale {
            // Both laws may increase the energy with friction and different e; then the greatest part of the
            // restitution that does not is taken. Without restitution the energy never increases.
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                let trial = solve(middle)?;
                if trial.work > 0.0 { high = middle } else { low = middle }
            }
            outcome = solve(low)?;
        }
        self.hit_by(contacts, support, speeds, &outcome, bounces)
    }

    /// Whether all of these contacts have Poisson's hypothesis.
    fn by_poisson(&self, contacts: &[usize]) -> bool {
        contacts
            .iter()
            .all(|&contact| self.pair(contact).is_some_and(|pair| pair.surface.law == Law::Poisson))
    }

    fn mus_in_impacts(&self, contacts: &[usize]) -> Vec<f64> {
        contacts.iter().map(|&contact| self.pair(contact).map_or(0.0, Pair::mu_in_impacts)).collect()
    }

    fn without_impulses(&self, contacts: &[usize], unsolved: Unsolved) -> SimulationError {
        let message = format!("the contacts that strike at once have no impulses: {unsolved}");
        self.error(Some(contacts[0]), ErrorKind::NoForces(message))
    }

    /// The impact with these impulses.
    fn hit_by(
        &self,
        contacts: &[usize],
        support: &ClosedContacts,
        speeds: &[f64],
        outcome: &AtOnce,
        bounces: Vec<(usize, f64)>,
    ) -> Result<Hit, SimulationError> {
        let change = &support.response * &outcome.impulse;
        let after: Vec<f64> =
            speeds.iter().zip(change.iter()).map(|(speed, change)| speed + change).collect();
        let state = State { speeds, ..self.here() };
        let mut shares = Vec::with_capacity(contacts.len());
        for (i, &contact) in contacts.iter().enumerate() {
            let basis = self
                .mechanism
                .contact_state(contact, &state)
                .map_err(|error| self.failure(Failure::State(error)))?;
            let p = ClosedContacts::three(&outcome.impulse, i);
            let (before, velocity) =
                (ClosedContacts::three(&support.velocity, i), ClosedContacts::three(&outcome.velocity, i));
            shares.push(Share {
                contact,
                impulse: p.x,
                impulse_on_point: basis.normal * p.x + basis.first * p.y + basis.second * p.z,
                approach: before.x,
                separation: velocity.x,
                work: 0.5 * p.dot(&(before + velocity)),
            });
        }
        let kind = HitKind::Several(shares, self.energy_change(speeds, &after)?);
        Ok(Hit { kind, before: speeds.to_vec(), after, bounces })
    }
}

/// The impulses without restitution that end a jam: the limit of the implicit steps v+ = v- + W p + h beta
/// for h -> 0, with friction against the remaining slip; or the modes of these steps if their forces are
/// finite.
fn impulses_of_a_jam(support: &ClosedContacts, mu: &[f64], h: f64) -> Option<Outcome> {
    let k = support.len();
    let mut velocity = support.velocity.clone();
    for i in 0..k {
        // Closed contacts neither separate nor approach.
        velocity[3 * i] = 0.0;
    }
    let none: Vec<Option<Vector2<f64>>> = vec![None; k];
    let stepped = &velocity + h * &support.beta;
    let problem = Problem { w: &support.coupled, beta: &stepped, mu, slip: &none, noise: None };
    let step = contact_problem::solve(&problem, None).ok()?;
    let problem = Problem { beta: &velocity, ..problem };
    let limit =
        contact_problem::with_modes(&problem, &step.modes).ok().filter(|found| found.margin >= -SHORT);
    let Some(limit) = limit else { return Some(Outcome::Modes(step)) };
    let after = &support.coupled * &limit.force + &velocity;
    let change = (&after - &velocity).amax();
    Some(if change > LARGE * h * support.beta.amax() {
        Outcome::Impulses(AtOnce::with(limit.force, velocity, after))
    } else {
        Outcome::Modes(step)
    })
}

/// The impulses by Poisson's hypothesis.
fn two_phases(support: &ClosedContacts, mu: &[f64], e: &[f64]) -> Result<AtOnce, Unsolved> {
    let impulse = poisson_at_once::impulses(support, mu, e)?;
    let velocity = &support.coupled * &impulse + &support.velocity;
    Ok(AtOnce::with(impulse, support.velocity.clone(), velocity))
}

/// The impulses by Moreau's law, for these coefficients of restitution.
fn solve(support: &ClosedContacts, mu: &[f64], e: &[f64]) -> Result<AtOnce, Unsolved> {
    let mut wanted = support.velocity.clone();
    for (i, e) in e.iter().enumerate() {
        wanted[3 * i] += e * support.velocity[3 * i].min(0.0);
    }
    let none: Vec<Option<Vector2<f64>>> = vec![None; support.len()];
    let problem = Problem { w: &support.coupled, beta: &wanted, mu, slip: &none, noise: None };
    let solution = contact_problem::solve(&problem, None)?;
    let velocity = &support.coupled * &solution.force + &support.velocity;
    Ok(AtOnce::with(solution.force, support.velocity.clone(), velocity))
}
