//! Impacts: which contacts are struck at a time, in what order, and the consequences.
//!
//! Contacts that approach at one time are struck at once; those that these impulses press together are struck
//! next, until none approaches (docs/theory.md, section 17.13).

use hodograph::{ComponentKind, State};
use nalgebra::{DMatrix, DVector};

use crate::closed::closed_contacts::{Along, ClosedContacts};
use crate::closed::pair::Pair;
use crate::closed::phase::{Leaving, Phase};
use crate::closed::scales::OWN;
use crate::impact::single_impact::{Hit, HitKind};
use crate::integration::motion::Failure;
use crate::random::{next_random, up_to};
use crate::state::transition::Transition;
use crate::{CollisionRecord, ErrorKind, EventKind, ImpactsAtOnce, SimulationError, SimultaneousCollision};

/// A touching contact approaches if its normal velocity, relative to the first approach, is below minus this.
const APPROACH: f64 = 1e-12;
/// Normal velocities below this part of the greatest that the energy of the motion allows are rounding
/// errors.
const ROUNDING: f64 = 1e-15;
/// Approaches slower than this, relative to the first one, have no restitution.
const FADED: f64 = 1e-9;
/// Largest number of impacts at one time.
pub(crate) const MOST: usize = 3000;
/// After this many impacts per touching contact, one plastic impact of all contacts ends the sequence, to
/// which single impacts converge linearly. The second number is for contacts without restitution.
const PATIENCE: [usize; 2] = [24, 2];
/// A gap closes now if it closes within this part of the time of the problem.
const NOW: f64 = 5e-11;
/// All orders of impacts are compared for at most this many contacts.
const COMPARED: usize = 4;

impl Transition<'_> {
    /// Handles a closed gap: its contact is struck together with all others that approach now.
    pub(crate) fn strike(&mut self, first: usize) -> Result<(), SimulationError> {
        if self.is_undefined(first) {
            return self.end_at(first);
        }
        let was = self.front.phases.clone();
        let touching = self.touching(Some(first))?;
        self.front.resting = false;
        let speeds = self.here().speeds.to_vec();
        if self.options.together == ImpactsAtOnce::Stop {
            let approaching = self.approaching(&touching, &speeds, None)?;
            if approaching.len() > 1 {
                let name = |contact: &usize| self.mechanism.component(ComponentKind::Contact, *contact);
                let names = approaching.iter().filter_map(|(contact, _)| name(contact));
                let names = names.map(|component| component.name.to_owned()).collect();
                return Err(self.error(Some(first), ErrorKind::StruckTogether(names)));
            }
        }
        if self.settles_into_contact(first)? {
            return Ok(());
        }
        if self.options.together == ImpactsAtOnce::Lzb
            && let Some(speeds) = self.strike_together(&touching, first)?
        {
            return self.part_or_stay(&touching, &speeds, &was);
        }
        let hits = self.sequence(&touching, &speeds, None)?;
        let spread = self.spread(&touching, &speeds, &hits)?;
        let mut last = speeds;
        for (place, hit) in hits.into_iter().enumerate() {
            last.clone_from(&hit.after);
            self.take_impact(hit, if place == 0 { spread } else { None })?;
        }
        self.part_or_stay(&touching, &last, &was)
    }

    /// Applies an impact: speeds, energies, bounces that end, and the event.
    pub(crate) fn take_impact(&mut self, hit: Hit, spread: Option<f64>) -> Result<(), SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        self.front.y[n..n + hit.after.len()].copy_from_slice(&hit.after);
        self.drive()?;
        self.front.energy.impacts += hit.energy_change();
        for &(contact, time) in &hit.bounces {
            self.front.chatter.retain(|(_, other)| *other != contact);
            let end = self.front.t + time;
            // A rebound of rounding ends at once: nothing is left to wait for.
            if end > self.front.t {
                self.front.chatter.push((end, contact));
            }
        }
        let last_bounce = !hit.bounces.is_empty();
        match hit.kind {
            HitKind::One(contact, outcome) => {
                let struck =
                    CollisionRecord { outcome: *outcome, speeds_before: hit.before, last_bounce, spread };
                self.push(Some(contact), EventKind::Collision(Box::new(struck)));
            }
            HitKind::Several(shares, energy_change) => {
                let struck =
                    SimultaneousCollision { shares, energy_change, speeds_before: hit.before, spread };
                self.push(None, EventKind::SimultaneousCollision(Box::new(struck)));
            }
        }
        Ok(())
    }

    /// After impacts: separating contacts are open, and the modes of the others are decided.
    pub(crate) fn part_or_stay(
        &mut self,
        touching: &[usize],
        speeds: &[f64],
        was: &[Phase],
    ) -> Result<(), SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
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
            let rounding = (1e-11 * size).max(self.slowest(&support, place));
            if rate > self.unseen(&support, place, speeds, rounding)? {
                phases[contact] = Phase::Open(Leaving::Bounced);
            } else {
                // Slip may have changed in the impact.
                phases[contact] = Phase::Open(Leaving::NOW);
                stay.push(contact);
            }
        }
        for torque in self.mechanism.torques_of(touching) {
            phases[torque] = Phase::Open(Leaving::Apart);
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

    /// The smallest normal velocity of a contact that is more than rounding, m/s, relative to the one that
    /// all kinetic energy so far would give it. A body at rest beside moving ones has only rounding errors.
    pub(crate) fn slowest(&self, support: &ClosedContacts, place: usize) -> f64 {
        self.slowest_along(support, 3 * place)
    }

    /// The same for a component of a velocity.
    pub(crate) fn slowest_along(&self, support: &ClosedContacts, row: usize) -> f64 {
        ROUNDING * (2.0 * self.front.greatest * support.coupled[(row, row)]).sqrt()
    }

    /// The normal velocity up to which a contact counts as at rest: `rounding`, the bound from all velocities,
    /// but at most the greater of the smallest velocity that matters and the rounding error of the terms of
    /// the normal velocity itself. So a body that moves fast along a floor can still collide with it.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Rounding`] if a normal velocity that matters is smaller than the rounding error of its
    /// own terms.
    pub(crate) fn unseen(
        &self,
        support: &ClosedContacts,
        place: usize,
        speeds: &[f64],
        rounding: f64,
    ) -> Result<f64, SimulationError> {
        let slow = self.front.scales.slow;
        if rounding <= slow {
            return Ok(rounding);
        }
        let terms = support.normal_size(place, speeds).max(support.normal_size(place, &self.front.scale));
        let (rate, own) = (support.velocity[3 * place], OWN * terms);
        if own > slow && rate.abs() > slow && rate.abs() < own {
            return Err(
                self.error(Some(support.contacts[place]), ErrorKind::Rounding { velocity: rate, terms })
            );
        }
        Ok(rounding.min(slow.max(own)))
    }

    /// Contacts whose gaps are closed, or close now.
    pub(crate) fn touching(&self, first: Option<usize>) -> Result<Vec<usize>, SimulationError> {
        let (n, p) =
            (self.mechanism.count(ComponentKind::Coordinate), self.mechanism.count(ComponentKind::Speed));
        let state = State {
            time: self.front.t,
            coordinates: &self.front.y[..n],
            speeds: &self.front.y[n..n + p],
            inputs: &self.front.held,
        };
        let fault = |error| self.failure(Failure::State(error));
        let size = self.size_of_coordinates();
        let (mut touching, open): (Vec<usize>, Vec<usize>) = (0..self.front.phases.len())
            .filter(|&contact| self.surfaces[contact].is_some())
            .partition(|&contact| self.front.phases[contact].is_closed() || first == Some(contact));
        for (contact, distance) in self.distances_nearby(open.into_iter(), &state).map_err(fault)? {
            let Some(gap) = distance.gap else { continue };
            if distance.validity.is_some_and(|validity| validity < 0.0) {
                continue;
            }
            let rate = self.mechanism.contact_velocity(contact, &state).map_err(fault)?.x;
            if gap <= 1e-14 * size || (rate < 0.0 && gap < -rate * NOW * self.front.scales.time) {
                touching.push(contact);
            }
        }
        touching.sort_unstable();
        Ok(touching)
    }

    /// The greatest velocity of these contacts, m/s.
    pub(crate) fn greatest_velocity(
        &self,
        contacts: &[usize],
        speeds: &[f64],
    ) -> Result<f64, SimulationError> {
        let state = State { speeds, ..self.here() };
        let support = ClosedContacts::new(self.mechanism, &state, contacts, false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        Ok(support.velocity.amax())
    }

    /// The touching contacts that approach, with their speeds of approach; `first` is the speed of what struck first,
    /// m/s.
    pub(crate) fn approaching(
        &self,
        touching: &[usize],
        speeds: &[f64],
        first: Option<f64>,
    ) -> Result<Vec<(usize, f64)>, SimulationError> {
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let state =
            State { time: self.front.t, coordinates: &self.front.y[..n], speeds, inputs: &self.front.held };
        let fault = |error| self.failure(Failure::State(error));
        let support = ClosedContacts::new(self.mechanism, &state, touching, false).map_err(fault)?;
        let mut list = Vec::new();
        for (place, &contact) in touching.iter().enumerate() {
            let rate = support.velocity[3 * place];
            let rounding = 1e-13 * support.velocity_size(place, speeds);
            let closed = self.front.phases[contact].is_closed() || first.is_some();
            let least = first.map_or(0.0, |first| APPROACH * first);
            let least = least.max(if closed { rounding } else { 0.0 });
            let rounding = least.max(self.slowest(&support, place));
            if rate < -self.unseen(&support, place, speeds, rounding)? {
                list.push((contact, -rate));
            }
        }
        Ok(list)
    }

    /// The touching contacts that approach, and those whose velocities are changed by their impulses.
    fn involved(
        &self,
        touching: &[usize],
        approaching: &[(usize, f64)],
        speeds: &[f64],
    ) -> Result<Vec<usize>, SimulationError> {
        let state = State { speeds, ..self.here() };
        let support = ClosedContacts::new(self.mechanism, &state, touching, false)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let approaches = |place: &usize| approaching.iter().any(|(contact, _)| *contact == touching[*place]);
        let struck: Vec<usize> = (0..touching.len()).filter(approaches).collect();
        Ok(support.coupled_with(&struck, Along::All).into_iter().map(|place| touching[place]).collect())
    }

    /// The impacts at one time, until no contact approaches. With an `order` of preference the contacts are
    /// struck one after the other.
    fn sequence(
        &self,
        touching: &[usize],
        speeds: &[f64],
        order: Option<&[usize]>,
    ) -> Result<Vec<Hit>, SimulationError> {
        let mut hits: Vec<Hit> = Vec::new();
        let mut speeds = speeds.to_vec();
        let mut first = None;
        let plastic = touching.iter().all(|&contact| self.pair(contact).is_none_or(Pair::is_plastic));
        let patience = PATIENCE[usize::from(plastic)] * touching.len();
        while hits.len() < MOST {
            let approaching = self.approaching(touching, &speeds, first)?;
            let fastest = approaching.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
            let scale = *first.get_or_insert(fastest);
            let next: Vec<usize> = match (order, self.options.together) {
                (Some(order), _) => {
                    let approaches = |contact: &usize| approaching.iter().any(|(c, _)| c == contact);
                    order.iter().copied().find(approaches).into_iter().collect()
                }
                (None, ImpactsAtOnce::Sequential) => {
                    let fastest = approaching.iter().find(|(_, speed)| *speed == fastest);
                    fastest.map(|(contact, _)| *contact).into_iter().collect()
                }
                (None, ImpactsAtOnce::Simultaneous) => self.involved(touching, &approaching, &speeds)?,
                (None, ImpactsAtOnce::Sampled(seed)) => {
                    let contacts = approaching.iter().map(|(contact, _)| *contact).collect();
                    drawn(contacts, self.key(seed, hits.len(), &speeds))
                }
                _ => approaching.iter().map(|(contact, _)| *contact).collect(),
            };
            if next.is_empty() {
                return Ok(hits);
            }
            let faded = hits.len() > touching.len() && fastest < FADED * scale;
            let hit = if hits.len() >= patience && touching.len() > 1 {
                let involved = self.involved(touching, &approaching, &speeds)?;
                match self.plastic_impact(&involved, &speeds) {
                    // It is proven that no contact approaches, up to the remaining slip. The bound of an
                    // approach is relative to the first one, and may be smaller than the accuracy of that
                    // proof.
                    Ok(last) => {
                        hits.push(last);
                        return Ok(hits);
                    }
                    unsolved => match self.without_room(&involved, &speeds) {
                        Some(error) => return Err(error),
                        None => unsolved,
                    },
                }
            } else {
                self.hit(&next, &speeds, faded)
            };
            let hit = match hit {
                // Simultaneous impulses without a certificate are not accepted; then the fastest contact is
                // struck alone.
                Err(SimulationError { kind: ErrorKind::NoForces(_), .. }) => {
                    let fastest = approaching.iter().max_by(|a, b| a.1.total_cmp(&b.1));
                    let alone = fastest.map_or(next[0], |(contact, _)| *contact);
                    self.hit(&[alone], &speeds, faded)?
                }
                hit => hit?,
            };
            speeds.clone_from(&hit.after);
            hits.push(hit);
        }
        Err(self.error(None, self.without_end(MOST)))
    }

    /// What the draw of a group of contacts depends on: the seed, the time, the speeds, and the number of impacts before it at
    /// this time. So the same motion makes the same draws, wherever it is continued from.
    fn key(&self, seed: u64, before: usize, speeds: &[f64]) -> u64 {
        let words = [before as u64, self.front.t.to_bits()].into_iter();
        words.chain(speeds.iter().map(|speed| speed.to_bits())).fold(seed, |mut key, word| {
            key ^= word;
            next_random(&mut key)
        })
    }

    /// The dependence of the outcome on the order in which contacts struck at the same time are struck
    /// successively: the greatest kinetic energy of the difference from the accepted outcome, J. Computed
    /// only on request.
    fn spread(
        &self,
        touching: &[usize],
        speeds: &[f64],
        hits: &[Hit],
    ) -> Result<Option<f64>, SimulationError> {
        if !self.options.compare_orders {
            return Ok(None);
        }
        let mut involved: Vec<usize> = hits.iter().flat_map(Hit::contacts).collect();
        involved.sort_unstable();
        involved.dedup();
        if involved.len() < 2 || involved.len() > COMPARED {
            return Ok(None);
        }
        let Some(chosen) = hits.last() else { return Ok(None) };
        let p = speeds.len();
        let mut mass = vec![0.0; p * p];
        self.mechanism
            .mass_matrix(&self.here(), &mut mass)
            .map_err(|error| self.failure(Failure::State(error)))?;
        let mass = DMatrix::from_row_slice(p, p, &mass);
        let mut spread = 0.0_f64;
        let rest: Vec<usize> =
            touching.iter().copied().filter(|contact| !involved.contains(contact)).collect();
        for mut order in permutations(&involved) {
            order.extend_from_slice(&rest);
            let Ok(other) = self.sequence(touching, speeds, Some(&order)) else { continue };
            let Some(last) = other.last() else { continue };
            let apart = DVector::from_fn(p, |i, _| last.after[i] - chosen.after[i]);
            spread = spread.max(0.5 * apart.dot(&(&mass * &apart)));
        }
        Ok(Some(spread))
    }
}

/// A random part of these contacts: first its size is drawn, then its members.
fn drawn(mut contacts: Vec<usize>, mut key: u64) -> Vec<usize> {
    if contacts.len() < 2 {
        return contacts;
    }
    let size = 1 + up_to(contacts.len() - 1, &mut key);
    for place in 0..size {
        let other = place + up_to(contacts.len() - 1 - place, &mut key);
        contacts.swap(place, other);
    }
    contacts.truncate(size);
    contacts.sort_unstable();
    contacts
}

/// All permutations of a list.
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
