//! Solves impacts of one contact, or of several that are struck at the same time.

use hodograph::{
    CollisionError, CollisionOutcome, Kind, ReducedMatrix, State, Surface, impact_without_collision,
};
use nalgebra::{Vector2, Vector3};

use crate::closed_contacts::{ClosedContacts, free_acceleration};
use crate::forces::JAM;
use crate::motion::Failure;
use crate::phase::{Leaving, Phase};
use crate::transition::Transition;
use crate::{EventKind, Reason, SimulationError, Struck, Together};

/// Touching contacts approach where their normal velocity, relative to the first approach, is below minus
/// this.
const APPROACH: f64 = 1e-12;
/// Approaches slower than this, relative to the first, end without restitution.
const FADED: f64 = 1e-9;
/// Most impacts at one time.
const MOST: usize = 3000;
/// A gap closes now if it does within this time, s.
const NOW: f64 = 1e-11;
/// All orders are compared of at most so many contacts.
const COMPARED: usize = 4;

/// One of the impacts at a time.
struct Hit {
    contact: usize,
    outcome: CollisionOutcome<f64>,
    before: Vec<f64>,
    after: Vec<f64>,
    /// how long it would go on bouncing, s
    bounces: Option<f64>,
}

impl Transition<'_> {
    /// A gap has closed: its contact collides, and all that touch answer.
    pub(crate) fn strike(&mut self, first: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        let touching = self.touching(Some(first))?;
        self.front.resting = false;
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let speeds = self.front.y[n..n + p].to_vec();
        let approaching = self.approaching(&touching, &speeds, None)?;
        let names = |list: &[usize]| -> Vec<String> {
            list.iter()
                .filter_map(|&contact| self.mechanism.component(Kind::Contact, contact))
                .map(|component| component.name.to_owned())
                .collect()
        };
        if self.options.together == Together::Stop && approaching.len() > 1 {
            let list: Vec<usize> = approaching.iter().map(|(contact, _)| *contact).collect();
            let names = names(&list);
            return Err(self.error(Some(first), Reason::Together(names)));
        }
        if self.settles_into_contact(first)? {
            return Ok(());
        }
        if self.options.together == Together::Lzb
            && let Some(speeds) = self.strike_together(&touching, first)?
        {
            return self.part_or_stay(&touching, &speeds, &was);
        }
        let hits = self.sequence(&touching, &speeds, None)?;
        let spread = self.spread(&touching, &speeds, &hits)?;
        let mut last = speeds;
        for (place, hit) in hits.into_iter().enumerate() {
            self.front.y[n..n + p].copy_from_slice(&hit.after);
            self.front.energy.impacts += hit.outcome.energy_change;
            if let Some(time) = hit.bounces {
                self.front.chatter.retain(|(_, contact)| *contact != hit.contact);
                self.front.chatter.push((self.front.t + time, hit.contact));
            }
            let struck = Struck {
                outcome: hit.outcome,
                speeds_before: hit.before,
                last_bounce: hit.bounces.is_some(),
                spread: if place == 0 { spread } else { None },
            };
            self.push(Some(hit.contact), EventKind::Collision(Box::new(struck)));
            last = hit.after;
        }
        self.part_or_stay(&touching, &last, &was)
    }

    /// After impacts: what parts is open, what stays is decided.
    fn part_or_stay(
        &mut self,
        touching: &[usize],
        speeds: &[f64],
        was: &[Phase],
    ) -> Result<(), SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let support = ClosedContacts::new(self.mechanism, &state, touching, false).map_err(fault)?;
        let mut stay = Vec::new();
        let mut phases = self.front.phases.clone();
        for (place, &contact) in touching.iter().enumerate() {
            let rate = support.velocity[3 * place];
            let size =
                support.velocity_size(place, speeds).max(support.velocity_size(place, &self.front.scale));
            if rate > 1e-11 * size {
                phases[contact] = Phase::Open(Leaving::Bounced);
            } else {
                // Slip may have changed in the impact.
                phases[contact] = Phase::Open(Leaving::NOW);
                stay.push(contact);
            }
        }
        for (contact, phase) in phases.iter().enumerate() {
            if was[contact].is_closed() && matches!(phase, Phase::Open(Leaving::Bounced)) {
                self.front.forces[contact] = nalgebra::Vector3::zeros();
            }
        }
        self.front.phases = phases;
        self.decide(&stay, was)?;
        self.look_for_rest()
    }

    /// Contacts whose gaps are closed, or close now.
    fn touching(&self, first: Option<usize>) -> Result<Vec<usize>, SimulationError> {
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let state = State {
            time: self.front.t,
            coordinates: &self.front.y[..n],
            speeds: &self.front.y[n..n + p],
            inputs: &self.front.held,
        };
        let fault = |error| self.failure(Failure::State(error));
        let size = self.front.y[..n].iter().fold(1e-3_f64, |size, q| size.max(q.abs()));
        let mut touching = Vec::new();
        for contact in 0..self.front.phases.len() {
            if self.surfaces[contact].is_none() {
                continue;
            }
            if self.front.phases[contact].is_closed() || first == Some(contact) {
                touching.push(contact);
                continue;
            }
            let Some(gap) = self.mechanism.gap(contact, &state).map_err(fault)? else { continue };
            let rate = self.mechanism.contact_velocity(contact, &state).map_err(fault)?.x;
            if gap <= 1e-14 * size || (rate < 0.0 && gap < -rate * NOW) {
                touching.push(contact);
            }
        }
        Ok(touching)
    }

    /// The touching contacts that approach, with their speeds of approach, relative to a first one.
    fn approaching(
        &self,
        touching: &[usize],
        speeds: &[f64],
        first: Option<f64>,
    ) -> Result<Vec<(usize, f64)>, SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let support = ClosedContacts::new(self.mechanism, &state, touching, false).map_err(fault)?;
        let mut list = Vec::new();
        for (place, &contact) in touching.iter().enumerate() {
            let rate = support.velocity[3 * place];
            // A contact that lasts has no normal velocity but rounding.
            let rounding = 1e-13 * support.velocity_size(place, speeds);
            let closed = self.front.phases[contact].is_closed();
            let least = first.map_or(0.0, |first| APPROACH * first).max(if closed { rounding } else { 0.0 });
            if rate < -least.max(if first.is_some() { rounding } else { 0.0 }) {
                list.push((contact, -rate));
            }
        }
        Ok(list)
    }

    /// One impact after the other until nothing approaches: the fastest approach first, or in an order of
    /// preference.
    fn sequence(
        &self,
        touching: &[usize],
        speeds: &[f64],
        order: Option<&[usize]>,
    ) -> Result<Vec<Hit>, SimulationError> {
        let mut hits: Vec<Hit> = Vec::new();
        let mut speeds = speeds.to_vec();
        let mut first = None;
        while hits.len() < MOST {
            let approaching = self.approaching(touching, &speeds, first)?;
            let fastest = approaching.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
            let next = match order {
                Some(order) => {
                    order.iter().copied().find(|contact| approaching.iter().any(|(c, _)| c == contact))
                }
                None => approaching.iter().find(|(_, speed)| *speed == fastest).map(|(contact, _)| *contact),
            };
            let Some(contact) = next else { return Ok(hits) };
            let scale = *first.get_or_insert(fastest);
            let faded = hits.len() > touching.len() && fastest < FADED * scale;
            let hit = self.hit(contact, &speeds, faded)?;
            speeds.clone_from(&hit.after);
            hits.push(hit);
        }
        Err(self.error(None, Reason::EventsWithoutEnd(MOST)))
    }

    /// The impact of one contact.
    fn hit(&self, contact: usize, speeds: &[f64], faded: bool) -> Result<Hit, SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let Some(surface) = self.surfaces[contact] else {
            return Err(self.error(Some(contact), Reason::Option("the contact has no surface".to_owned())));
        };
        let fault = |error: CollisionError<f64>| self.error(Some(contact), Reason::Collision(error));
        let solve = |surface: &Surface<f64>| {
            let mut after = speeds.to_vec();
            let outcome = self.mechanism.collide(contact, &state, surface, &mut after).map_err(fault)?;
            Ok((outcome, after))
        };
        let plastic = Surface { e: 0.0, ..surface };
        let (outcome, after) = solve(if faded { &plastic } else { &surface })?;
        let mut hit = Hit { contact, outcome, before: speeds.to_vec(), after, bounces: None };
        // The rule of chatter (theory, 17.7): the next bounce is lower than the tolerance, and the contact is
        // pressed together.
        let (before, rebound) = (-hit.outcome.approach.x, hit.outcome.impact.velocity.x);
        if faded || rebound <= 0.0 || rebound >= before {
            return Ok(hit);
        }
        let pull = self.pull(contact, speeds)?;
        if pull < 0.0 && rebound * rebound / (-2.0 * pull) < self.options.absolute_tolerance {
            let time = 2.0 * rebound / (-pull * (1.0 - rebound / before));
            let (outcome, after) = solve(&plastic)?;
            hit = Hit { contact, outcome, before: speeds.to_vec(), after, bounces: Some(time) };
        }
        Ok(hit)
    }

    /// The normal acceleration of a contact without its own force, while the others that last keep their
    /// modes.
    fn pull(&self, contact: usize, speeds: &[f64]) -> Result<f64, SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let mut y = self.front.y.clone();
        y[n..n + speeds.len()].copy_from_slice(speeds);
        let inputs = self.motion(&[]).inputs(self.front.t, &y).map_err(|failure| self.failure(failure))?;
        let state = State { time: self.front.t, coordinates: &y[..n], speeds, inputs: &inputs };
        let fault = |error| self.failure(Failure::State(error));
        let beta = free_acceleration(self.mechanism, contact, &state).map_err(fault)?.x;
        let others: Vec<_> = self.closed().into_iter().filter(|closed| closed.contact != contact).collect();
        if others.is_empty() {
            return Ok(beta);
        }
        let Ok(evaluation) = self.motion(&others).evaluate(self.front.t, &y) else { return Ok(beta) };
        let Some(forces) = evaluation.forces else { return Ok(beta) };
        let own = ClosedContacts::new(self.mechanism, &state, &[contact], false).map_err(fault)?;
        let rates = forces.rates(&evaluation.support);
        Ok(beta + (own.partials.row(0) * rates)[0])
    }

    /// The greatest difference of a speed between the orders in which contacts struck together may answer.
    fn spread(
        &self,
        touching: &[usize],
        speeds: &[f64],
        hits: &[Hit],
    ) -> Result<Option<f64>, SimulationError> {
        let mut involved: Vec<usize> = hits.iter().map(|hit| hit.contact).collect();
        involved.sort_unstable();
        involved.dedup();
        if involved.len() < 2 || involved.len() > COMPARED || !self.options.compare_orders {
            return Ok(None);
        }
        let Some(chosen) = hits.last() else { return Ok(None) };
        let mut spread = 0.0_f64;
        let rest: Vec<usize> =
            touching.iter().copied().filter(|contact| !involved.contains(contact)).collect();
        for mut order in permutations(&involved) {
            order.extend_from_slice(&rest);
            let Ok(other) = self.sequence(touching, speeds, Some(&order)) else { continue };
            let Some(last) = other.last() else { continue };
            let apart = last.after.iter().zip(&chosen.after).map(|(a, b)| (a - b).abs());
            spread = apart.fold(spread, f64::max);
        }
        Ok(Some(spread))
    }

    /// A sliding contact that no finite force holds suffers an impact with zero speed of approach; all that
    /// touch answer.
    pub(crate) fn impact_without_collision(&mut self, contact: usize) -> Result<(), SimulationError> {
        let was = self.front.phases.clone();
        self.front.crowd += 1;
        if self.front.crowd > MOST {
            return Err(self.error(Some(contact), Reason::EventsWithoutEnd(MOST)));
        }
        let touching = self.touching(Some(contact))?;
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let before = self.front.y[n..n + p].to_vec();
        let (outcome, after) = self.without_collision(contact, &before)?;
        self.front.resting = false;
        self.front.y[n..n + p].copy_from_slice(&after);
        self.front.energy.impacts += outcome.energy_change;
        let struck = Struck { outcome, speeds_before: before, last_bounce: false, spread: None };
        self.push(Some(contact), EventKind::ImpactWithoutCollision(Box::new(struck)));
        match self.approaching(&touching, &after, Some(1.0))?.first() {
            Some(&(other, _)) => self.strike(other),
            None => self.part_or_stay(&touching, &after, &was),
        }
    }

    /// The outcome along n, t, s with t along the slip, and the speeds after.
    fn without_collision(
        &self,
        contact: usize,
        speeds: &[f64],
    ) -> Result<(CollisionOutcome<f64>, Vec<f64>), SimulationError> {
        let n = self.mechanism.count(Kind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let Some(surface) = self.surfaces[contact] else {
            return Err(self.error(Some(contact), Reason::Option("the contact has no surface".to_owned())));
        };
        let fault = |error| self.failure(Failure::State(error));
        let here = self.mechanism.contact_state(contact, &state).map_err(fault)?;
        let speed = here.velocity.y.hypot(here.velocity.z);
        let (cos, sin) = (here.velocity.y / speed, here.velocity.z / speed);
        let reduced = here.reduced.turned(cos, sin);
        let surface = jammed(&reduced, surface);
        let impact = impact_without_collision(&reduced, &Vector2::new(speed, 0.0), &surface)
            .map_err(|error| self.error(Some(contact), Reason::Collision(error.into())))?;
        let (i, j) = (impact.impulse.y, impact.impulse.z);
        let impulse = [impact.impulse.x, i * cos - j * sin, i * sin + j * cos];
        let mut response = vec![0.0; 3 * speeds.len()];
        self.mechanism.response(contact, &state, &mut response).map_err(fault)?;
        let mut after = speeds.to_vec();
        for (speed, row) in after.iter_mut().zip(response.chunks_exact(3)) {
            *speed += row.iter().zip(&impulse).map(|(response, impulse)| response * impulse).sum::<f64>();
        }
        let outcome = CollisionOutcome {
            normal: here.normal,
            tangent: here.first * cos + here.second * sin,
            binormal: here.second * cos - here.first * sin,
            approach: Vector3::new(0.0, speed, 0.0),
            reduced,
            impulse_on_point: here.normal * impulse[0] + here.first * impulse[1] + here.second * impulse[2],
            energy_change: impact.contact_work,
            impact,
        };
        Ok((outcome, after))
    }

    /// Contacts at the start.
    pub(crate) fn begin(&mut self) -> Result<(), SimulationError> {
        let (n, p) = (self.mechanism.count(Kind::Coordinate), self.mechanism.count(Kind::Speed));
        let (q, u) = (self.front.y[..n].to_vec(), self.front.y[n..n + p].to_vec());
        let state = State { time: self.front.t, coordinates: &q, speeds: &u, inputs: &self.front.held };
        let mut strikes = None;
        let mut stay = Vec::new();
        let was = self.front.phases.clone();
        for contact in 0..self.front.phases.len() {
            if self.surfaces[contact].is_none() {
                continue;
            }
            let fault = |error| self.failure(Failure::State(error));
            let Some(gap) = self.mechanism.gap(contact, &state).map_err(fault)? else { continue };
            if gap < -OVERLAP {
                return Err(self.error(Some(contact), Reason::Overlap(gap)));
            }
            if gap > OVERLAP {
                continue;
            }
            let support = ClosedContacts::new(self.mechanism, &state, &[contact], false).map_err(fault)?;
            let rate = support.velocity[0];
            let rounding = 1e-9 * support.velocity_size(0, &u);
            if rate < -rounding {
                // One that is a little open yet closes by itself.
                if gap <= 1e-15 {
                    strikes.get_or_insert(contact);
                }
            } else if rate > rounding {
                self.front.phases[contact] = Phase::Open(Leaving::Bounced);
            } else {
                self.front.phases[contact] = Phase::Open(Leaving::NOW);
                stay.push(contact);
            }
        }
        self.decide(&stay, &was)?;
        match strikes {
            Some(contact) => self.strike(contact),
            None => self.look_for_rest(),
        }
    }
}

/// Bodies overlap where a gap is below minus this at the start, m; contacts below it touch.
const OVERLAP: f64 = 1e-9;

/// All orders of a list.
fn permutations(list: &[usize]) -> Vec<Vec<usize>> {
    if list.len() <= 1 {
        return vec![list.to_vec()];
    }
    let mut all = Vec::new();
    for (place, &head) in list.iter().enumerate() {
        let mut rest = list.to_vec();
        rest.remove(place);
        for mut tail in permutations(&rest) {
            tail.insert(0, head);
            all.push(tail);
        }
    }
    all
}

/// The surface of an impact without collision, t along the slip: where f = m_nn - mu m_nt is not yet zero,
/// but so small that the contact jams, with the friction that makes it as small and negative. It is larger by
/// less than `2 JAM` times m_nn / m_nt.
fn jammed(reduced: &ReducedMatrix<f64>, surface: Surface<f64>) -> Surface<f64> {
    let f = reduced.nn - surface.mu * reduced.nt;
    let least = JAM * reduced.nn;
    // the event is found where f = least, up to the rounding of its search
    if f >= 0.0 && f <= 1.5 * least {
        Surface { mu: (reduced.nn + least) / reduced.nt, ..surface }
    } else {
        surface
    }
}
