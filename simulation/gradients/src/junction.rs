//! Carries derivatives through events that happen at one time.
//!
//! Theory: docs/theory.md, section 19.2.

use hodograph::{
    ImpactDerivative, NonSmoothness, ReducedMatrix, Selection, Surface, derivative,
    derivative_without_collision,
};
use hodograph_simulation::{CollisionRecord, Event, EventKind, Guard, SmoothPart};
use nalgebra::{SMatrix, SVector, Vector3};

use crate::Reason;
use crate::by::NonDifferentiable;
use crate::field::{At, ContactTerms, Field};
use crate::held::{Held, NEGLIGIBLE, SPEED_AGREEMENT, settles};
use crate::modes::{Mode, ModeKind};

/// A gap closes without normal velocity if its rate is below this part of the terms of the normal velocity.
const GRAZING: f64 = 1e-7;
/// A force vanishes together with its rate if the rate changes it by less than this part during the time
/// since the last event.
const TANGENT: f64 = 1e-7;
/// The component of slip perpendicular to the direction in which slip ends may be at most this part of its
/// terms.
const TRANSVERSE_SLIP: f64 = 1e-5;
/// The terms of a derivative by a parameter count as no smaller than this part of what is differentiated, over the parameter:
/// where a mass cancels, the derivative and its terms are both rounding.
const NOTHING: f64 = 1e-9;

/// The derivatives at the events at one time.
pub(crate) struct EventDerivatives {
    /// derivatives of the time of the events (k; the last is 0)
    pub time: Vec<f64>,
    /// derivatives of the state at the (moving) time of the events, before them (n + p rows, k columns)
    pub before: Vec<f64>,
    /// the same after each event
    pub after: Vec<Vec<f64>>,
    /// derivatives of the state at the fixed time, after the events
    pub by: Vec<f64>,
    /// what the transpose needs
    pub junction: Junction,
}

/// What takes derivatives through the events at one time, whatever the directions.
#[derive(Clone, Debug)]
pub(crate) struct Junction {
    /// the modes before
    pub modes: Vec<Mode>,
    /// rate of the function that ended the part
    pub guard_rate: f64,
    /// rates of the state before and after (n + p)
    pub rates_before: Vec<f64>,
    pub rates_after: Vec<f64>,
    /// contacts that begin to last without a collision, or to stick
    pub held: Option<Held>,
    /// the collisions, one after the other
    pub collisions: Vec<Struck>,
}

/// A collision, or an impact without one, with its derivative.
#[derive(Clone, Debug)]
pub(crate) struct Struck {
    pub contact: usize,
    /// the state before (n + p)
    pub state: Vec<f64>,
    /// along n, t, s, N s
    pub impulse: Vector3<f64>,
    /// its derivative by approach (3), reduced matrix (6), mu and e
    pub impulse_by: SMatrix<f64, 3, ARGUMENTS>,
}

/// Number of arguments of the impact solver that have derivatives: approach (3), the upper half of the reduced matrix
/// by rows (6), mu and e.
pub(crate) const ARGUMENTS: usize = 11;
/// Rows and columns of the entries of the reduced matrix among these arguments.
pub(crate) const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

impl Field<'_> {
    /// The state at the start of a part, with its derivatives.
    pub fn at_start<'a>(&self, part: &'a SmoothPart, by: &'a [f64]) -> At<'a> {
        let row = self.row(part.start);
        At { time: part.start, state: &part.first, by, time_by: &[], inputs: &part.inputs, row }
    }

    /// The state at the end of a part, with its derivatives.
    pub fn at_end<'a>(
        &self,
        part: &'a SmoothPart,
        state: &'a [f64],
        by: &'a [f64],
        time_by: &'a [f64],
    ) -> At<'a> {
        At { time: part.end, state, by, time_by, inputs: &part.inputs, row: self.row(part.start) }
    }

    /// Carries derivatives through the events at the end of a part. `by` are the derivatives of the state
    /// just before them, at the fixed time; `modes` are the modes during the part; `next` is the following
    /// part; `since` is the time of the previous events. `terms` sums up the magnitudes of the terms of derivatives.
    pub fn pass(
        &self,
        (part, next): (&SmoothPart, &SmoothPart),
        modes: &[Mode],
        (by, terms): (&[f64], &mut [f64]),
        events: &[Event],
        since: f64,
    ) -> Result<EventDerivatives, NonDifferentiable> {
        let k = self.k;
        for event in events {
            let selection = event.kind.selection();
            if matches!(selection, Some(Selection::SeveralModes | Selection::Indeterminate)) {
                return Err((event.contact, Reason::SeveralModes));
            }
        }
        let before =
            self.mode_rates(modes, &self.at_end(part, &part.last, by, &[])).map_err(|why| (None, why))?;
        // The last direction is time.
        let mut flow = vec![0.0; k];
        flow[k - 1] = 1.0;
        let mut along = by.to_vec();
        for (row, rate) in along.chunks_exact_mut(k).zip(&before.rates) {
            row[k - 1] = *rate;
        }
        let slopes = self.guard(part, modes, &self.at_end(part, &part.last, &along, &flow), since)?;
        let mut time: Vec<f64> = slopes.iter().map(|slope| -slope / slopes[k - 1]).collect();
        time[k - 1] = 0.0;
        let mut there = by.to_vec();
        for (sum, rates) in terms.iter_mut().zip(&before.terms_by) {
            *sum += rates * (part.end - since);
        }
        for (index, (row, sums)) in there.chunks_exact_mut(k).zip(terms.chunks_exact_mut(k)).enumerate() {
            for ((by, sum), time) in row.iter_mut().zip(sums).zip(&time) {
                *sum += by.abs() + before.terms[index] * time.abs();
                *by += before.rates[index] * time;
            }
        }
        if let Some(Guard::Slip(stopped)) = &part.ended_by {
            self.check_stop((part, modes), stopped, &self.at_end(part, &part.last, &there, &time), terms)?;
        }
        let (mut now, mut after) = (there.clone(), Vec::with_capacity(events.len()));
        let mut collisions = Vec::new();
        let mut held = self.check_impacts(part, next, events)?;
        let mut speeds = &part.last[self.n..];
        if held.is_some() {
            speeds = &next.first[self.n..];
        } else if let (Some(Guard::Slip(stopped)), false) = (&part.ended_by, events.iter().any(strikes)) {
            held = self.stopped(stopped, next);
        }
        if let Some(held) = &held {
            let closes = match part.ended_by {
                Some(Guard::Gap(contact)) => Some(contact),
                _ => None,
            };
            self.hold(part, held, (&mut now, &time), terms).map_err(|why| (closes, why))?;
        }
        for event in events {
            if let EventKind::Collision(struck) | EventKind::ImpactWithoutCollision(struck) = &event.kind {
                let contact = event.contact.unwrap_or(0);
                let mut state = part.last[..self.n].to_vec();
                state.extend_from_slice(&struck.speeds_before);
                let at = self.at_end(part, &state, &now, &time);
                let found = self.collide(contact, struck, event, &at, terms);
                let (speeds_by, struck) = found.map_err(|why| (Some(contact), why))?;
                now[self.n * k..].copy_from_slice(&speeds_by);
                collisions.push(struck);
                speeds = &event.speeds;
            }
            after.push(now.clone());
        }
        // No jump of the speeds is left out.
        let off = difference(speeds, &next.first[self.n..], &part.last[self.n..]);
        if off > SPEED_AGREEMENT {
            return Err((None, Reason::Inaccurate(off)));
        }
        let modes_after = self.modes(next);
        let going = self.mode_rates(&modes_after, &self.at_start(next, &now)).map_err(|why| (None, why))?;
        for (index, (row, sums)) in now.chunks_exact_mut(k).zip(terms.chunks_exact_mut(k)).enumerate() {
            for ((by, sum), time) in row.iter_mut().zip(sums).zip(&time) {
                *by -= going.rates[index] * time;
                *sum += going.terms[index] * time.abs();
            }
        }
        let apart = self.separation(&modes_after, &self.at_start(next, &now), terms, part.end - since);
        let apart = apart.map_err(|why| (None, why))?;
        if let Some((contact, d, left)) = apart
            && left > TRANSVERSE_SLIP
        {
            let plastic = self.surface(contact).is_some_and(|surface| surface.e == 0.0);
            let bounces = plastic && self.by_restitution(d, contact) != 0.0 && events.iter().any(strikes);
            return Err((Some(contact), if bounces { Reason::Plastic } else { Reason::Inaccurate(left) }));
        }
        let junction = Junction {
            modes: modes.to_vec(),
            guard_rate: slopes[k - 1],
            rates_before: before.rates,
            rates_after: going.rates,
            held,
            collisions,
        };
        Ok(EventDerivatives { time, before: there, after, by: now, junction })
    }

    /// The derivatives of the function that ended a part along the directions; the last one is its rate.
    fn guard(
        &self,
        part: &SmoothPart,
        modes: &[Mode],
        at: &At<'_>,
        since: f64,
    ) -> Result<Vec<f64>, NonDifferentiable> {
        let last = self.k - 1;
        let place = |contact: usize| {
            let found = modes.iter().position(|mode| mode.contact == contact);
            found.ok_or((Some(contact), Reason::ModesChanged))
        };
        let state = |error| (None, Reason::State(error));
        match part.ended_by.as_ref().ok_or((None, Reason::ModesChanged))? {
            Guard::Gap(contact) => {
                let (_, by) = self.gap(*contact, at).map_err(state)?;
                let contact_terms = self.contact_terms(&[*contact], at).map_err(state)?;
                let size = contact_terms.velocity_size(0, 0, &at.state[self.n..]);
                if by[last] >= -GRAZING * size {
                    return Err((Some(*contact), Reason::Grazing));
                }
                Ok(by)
            }
            Guard::NormalForce(contact) => {
                let mode_rates = self.mode_rates(modes, at).map_err(|why| (Some(*contact), why))?;
                let size = mode_rates.forces.iter().map(|force| force[0].value.abs()).fold(0.0, f64::max);
                let by = mode_rates.forces[place(*contact)?][0].by.clone();
                tangency(*contact, by, size, part.end - since)
            }
            Guard::Friction(contact) => {
                let mode_rates = self.mode_rates(modes, at).map_err(|why| (Some(*contact), why))?;
                let [normal, first, second] = &mode_rates.forces[place(*contact)?];
                let mu = self.surface(*contact).ok_or((Some(*contact), Reason::ModesChanged))?.mu;
                // (mu lambda_n)^2 - lambda_t^2 - lambda_s^2
                let by: Vec<f64> = (0..self.k)
                    .map(|d| {
                        let by_mu = self.by_friction(d, *contact) * mu * normal.value * normal.value;
                        let held = first.value * first.by[d] + second.value * second.by[d];
                        2.0 * (by_mu + mu * mu * normal.value * normal.by[d] - held)
                    })
                    .collect();
                let size = 2.0 * (mu * normal.value).powi(2);
                tangency(*contact, by, size, part.end - since)
            }
            Guard::Slip(stopped) => {
                let [contact] = stopped[..] else { return Err((None, Reason::AtOnce)) };
                let place = place(contact)?;
                let mode_rates = self.mode_rates(modes, at).map_err(|why| (Some(contact), why))?;
                let Some(along) = mode_rates.directions[place] else {
                    return Err((Some(contact), Reason::ModesChanged));
                };
                let contact_terms = &mode_rates.contact_terms;
                let part = |axis: usize, d: usize| {
                    along[axis] * contact_terms.by(contact_terms.velocity(place, 1 + axis))[d]
                };
                let by: Vec<f64> = (0..self.k).map(|d| part(0, d) + part(1, d)).collect();
                if by[last] >= 0.0 {
                    return Err((Some(contact), Reason::Tangency));
                }
                Ok(by)
            }
            Guard::Jam => Err((None, Reason::Jam)),
            _ => Err((None, Reason::ModesChanged)),
        }
    }

    /// Checks that slip ends in its own direction: its perpendicular component must vanish.
    fn check_stop(
        &self,
        (part, modes): (&SmoothPart, &[Mode]),
        stopped: &[usize],
        at: &At<'_>,
        sizes: &[f64],
    ) -> Result<(), NonDifferentiable> {
        let none = vec![0.0; part.first.len() * self.k];
        let rounding = self.rounding_of_directions(modes, &self.at_start(part, &none));
        let most = TRANSVERSE_SLIP + rounding.map_err(|why| (None, why))?;
        for &contact in stopped {
            let contact_terms =
                self.contact_terms(&[contact], at).map_err(|error| (None, Reason::State(error)))?;
            for axis in 1..3 {
                for (d, left) in contact_terms.by(contact_terms.velocity(0, axis)).iter().enumerate() {
                    if left.abs() > most * self.terms(&contact_terms, (0, axis), (at, sizes), d) {
                        return Err((Some(contact), Reason::SlipTurns));
                    }
                }
            }
        }
        Ok(())
    }

    /// The sum of the magnitudes of the terms in the derivative of a contact velocity along a direction;
    /// `sizes` are those of the derivatives of the state.
    pub fn terms(
        &self,
        contact_terms: &ContactTerms,
        (place, axis): (usize, usize),
        (at, sizes): (&At<'_>, &[f64]),
        d: usize,
    ) -> f64 {
        let (n, p, k) = (self.n, self.p, self.k);
        let by = |index: usize| sizes[index * k + d];
        let partial = |speed: usize| contact_terms.value(contact_terms.partial(place, axis, speed)).abs();
        let own: f64 = (0..p).map(|speed| partial(speed) * by(n + speed)).sum();
        let turning = (0..n).map(by).fold(0.0, f64::max);
        let speed: f64 = (0..3).map(|axis| contact_terms.velocity_size(place, axis, &at.state[n..])).sum();
        own + turning * speed + NOTHING * self.relative[d] * speed
    }

    /// The relative rates at which closed contacts separate, and sticking ones slip, along the directions:
    /// the contact and the direction with the greatest rate relative to its terms. Gaps are included; `time` is that
    /// since the previous events.
    pub fn separation(
        &self,
        modes: &[Mode],
        at: &At<'_>,
        sizes: &[f64],
        time: f64,
    ) -> Result<Option<(usize, usize, f64)>, Reason> {
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        if contacts.is_empty() {
            return Ok(None);
        }
        let contact_terms = self.contact_terms(&contacts, at).map_err(Reason::State)?;
        let mut worst: Option<(usize, usize, f64)> = None;
        let mut see = |contact: usize, d: usize, left: f64, size: f64| {
            let part = if left == 0.0 { 0.0 } else { left.abs() / (size + f64::MIN_POSITIVE) };
            if worst.is_none_or(|(_, _, before)| part > before) {
                worst = Some((contact, d, part));
            }
        };
        for (place, mode) in modes.iter().enumerate() {
            let axes = if mode.kind == ModeKind::Stick { 3 } else { 1 };
            for axis in 0..axes {
                for (d, &left) in contact_terms.by(contact_terms.velocity(place, axis)).iter().enumerate() {
                    see(mode.contact, d, left, self.terms(&contact_terms, (place, axis), (at, sizes), d));
                }
            }
            let (_, gap) = self.gap(mode.contact, at).map_err(Reason::State)?;
            for (d, &left) in gap.iter().enumerate() {
                let size = (0..self.n).map(|index| sizes[index * self.k + d]).fold(0.0, f64::max);
                // What rounding leaves of a velocity moves the contact.
                let size = size + time * self.terms(&contact_terms, (place, 0), (at, sizes), d);
                let greatest = at.state[..self.n].iter().fold(0.0_f64, |greatest, q| greatest.max(q.abs()));
                see(mode.contact, d, left, size + NOTHING * self.relative[d] * greatest);
            }
        }
        Ok(worst)
    }

    /// Checks that the impacts are collisions of single contacts, which are smooth functions of the state
    /// before; returns the end of the bounces of several contacts, if there is no collision because of that.
    fn check_impacts(
        &self,
        part: &SmoothPart,
        next: &SmoothPart,
        events: &[Event],
    ) -> Result<Option<Held>, NonDifferentiable> {
        let closed = |contact: usize| part.closed.iter().any(|closed| closed.contact == contact);
        let mut opened: Vec<usize> = Vec::new();
        for event in events {
            match &event.kind {
                EventKind::SimultaneousCollision(_) => return Err((event.contact, Reason::AtOnce)),
                EventKind::ImpactWithoutCollision(_) if matches!(part.ended_by, Some(Guard::Jam)) => {
                    return Err((event.contact, Reason::Jam));
                }
                EventKind::Collision(_) => {
                    opened.extend(event.contact.filter(|contact| !closed(*contact)));
                }
                _ => {}
            }
        }
        if settles(part, next, events.iter().any(strikes)) {
            return self.settling(part, next).map(Some);
        }
        opened.sort_unstable();
        opened.dedup();
        if opened.len() > 1 {
            return Err((None, Reason::AtOnce));
        }
        if let Some(Guard::Gap(contact)) = part.ended_by
            && opened.first() != Some(&contact)
        {
            let stays = next.closed.iter().any(|closed| closed.contact == contact);
            return Err((Some(contact), if stays { Reason::Settling } else { Reason::Grazing }));
        }
        Ok(None)
    }

    /// The derivatives of the speeds after an impact (p rows, k columns), and the impact. `terms` as in [`Self::pass`].
    fn collide(
        &self,
        contact: usize,
        struck: &CollisionRecord,
        event: &Event,
        at: &At<'_>,
        terms: &mut [f64],
    ) -> Result<(Vec<f64>, Struck), Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let contact_terms = self.contact_terms(&[contact], at).map_err(Reason::State)?;
        let mut matrix = [0.0; 6];
        let mut by: Vec<[f64; ARGUMENTS]> = vec![[0.0; ARGUMENTS]; k];
        for (entry, (row, column)) in ENTRIES.into_iter().enumerate() {
            for speed in 0..p {
                let (v, r) = (contact_terms.partial(0, row, speed), contact_terms.response(0, column, speed));
                matrix[entry] += contact_terms.value(v) * contact_terms.value(r);
                for (d, by) in by.iter_mut().enumerate() {
                    by[3 + entry] += contact_terms.by(v)[d] * contact_terms.value(r)
                        + contact_terms.value(v) * contact_terms.by(r)[d];
                }
            }
        }
        for (d, by) in by.iter_mut().enumerate() {
            for (axis, by) in by.iter_mut().take(3).enumerate() {
                *by = contact_terms.by(contact_terms.velocity(0, axis))[d];
            }
            by[9] = self.by_friction(d, contact);
            by[10] = self.by_restitution(d, contact);
        }
        let approach = Vector3::from_fn(|axis, _| contact_terms.value(contact_terms.velocity(0, axis)));
        let surface = self.surface(contact).ok_or(Reason::ModesChanged)?;
        let response = |speed: usize, axis: usize| contact_terms.response(0, axis, speed);
        let after = |hit: &ImpactDerivative<f64>| -> Vec<f64> {
            let push = |speed: usize| {
                (0..3)
                    .map(|axis| contact_terms.value(response(speed, axis)) * hit.impact.impulse[axis])
                    .sum::<f64>()
            };
            (0..p).map(|speed| at.state[n + speed] + push(speed)).collect()
        };
        // The last bounce of a sequence has no restitution.
        let plastic = Surface { e: 0.0, ..surface };
        let surfaces = if struck.last_bounce { vec![plastic] } else { vec![surface, plastic] };
        let greatest =
            event.speeds.iter().chain(&struck.speeds_before).fold(0.0_f64, |size, u| size.max(u.abs()));
        let mut difference = f64::INFINITY;
        for surface in surfaces {
            let matrix = ReducedMatrix::from(matrix);
            let hit = match &event.kind {
                EventKind::ImpactWithoutCollision(_) => {
                    derivative_without_collision(&matrix, &approach.yz(), &surface)
                }
                _ => derivative(&matrix, &approach, &surface),
            };
            let Ok(hit) = hit else { continue };
            let off = after(&hit).iter().zip(&event.speeds).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            difference = difference.min(off / greatest);
            if off > SPEED_AGREEMENT * greatest {
                continue;
            }
            self.smooth(contact, &hit, &by, &approach, surface.mu)?;
            let mut impulse_by = hit.impulse;
            if surface.e == 0.0 && struck.last_bounce {
                impulse_by.column_mut(10).fill(0.0);
            }
            let mut speeds = at.by[n * k..].to_vec();
            for (d, by) in by.iter().enumerate() {
                let by = SVector::<f64, ARGUMENTS>::from(*by);
                let (impulse, sizes) = (impulse_by * by, impulse_by.abs() * by.abs());
                for speed in 0..p {
                    for axis in 0..3 {
                        let index = response(speed, axis);
                        let turned = contact_terms.by(index)[d] * hit.impact.impulse[axis];
                        speeds[speed * k + d] += turned + contact_terms.value(index) * impulse[axis];
                        terms[(n + speed) * k + d] +=
                            turned.abs() + contact_terms.value(index).abs() * sizes[axis];
                    }
                }
            }
            let state = at.state.to_vec();
            return Ok((speeds, Struck { contact, state, impulse: hit.impact.impulse, impulse_by }));
        }
        Err(Reason::Inaccurate(difference))
    }

    /// Whether the outcome is differentiable along all directions.
    fn smooth(
        &self,
        contact: usize,
        hit: &ImpactDerivative<f64>,
        by: &[[f64; ARGUMENTS]],
        approach: &Vector3<f64>,
        mu: f64,
    ) -> Result<(), Reason> {
        let Some(why) = hit.non_smoothness else { return Ok(()) };
        if why != NonSmoothness::NoSlip {
            return Err(Reason::Impact(why));
        }
        // Without slip there is a derivative along directions that cause none, and without friction.
        let by_mu = (0..self.k).any(|d| self.by_friction(d, contact) != 0.0);
        let slips = |by: &[f64; ARGUMENTS]| {
            let size = by[0].abs() + approach.x.abs();
            by[1].abs().max(by[2].abs()) > NEGLIGIBLE * size
        };
        let smooth = if mu == 0.0 { !by_mu } else { !by.iter().any(slips) };
        if smooth { Ok(()) } else { Err(Reason::Impact(why)) }
    }
}

/// Whether an event is an impact that is differentiated.
fn strikes(event: &Event) -> bool {
    matches!(event.kind, EventKind::Collision(_) | EventKind::ImpactWithoutCollision(_))
}

/// The greatest difference between the entries of two lists, relative to the greatest of these and of those before.
fn difference(a: &[f64], b: &[f64], before: &[f64]) -> f64 {
    let all = a.iter().chain(b).chain(before);
    let greatest = all.fold(f64::MIN_POSITIVE, |size, x| size.max(x.abs()));
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / greatest
}

/// The derivatives of a function that ends a mode, given its scale and duration; the error `Tangency` if its
/// rate vanishes.
fn tangency(contact: usize, by: Vec<f64>, size: f64, time: f64) -> Result<Vec<f64>, NonDifferentiable> {
    let rate = by.last().copied().unwrap_or(0.0);
    if rate.abs() * time > TANGENT * size { Ok(by) } else { Err((Some(contact), Reason::Tangency)) }
}
