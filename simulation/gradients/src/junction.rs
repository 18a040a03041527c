//! Carries derivatives through the events at one time.
//!
//! Theory: docs/theory.md, section 19.2.

use hodograph::{ImpactDerivative, NonSmoothness, ReducedMatrix, Selection, Surface, derivative};
use hodograph_simulation::{CollisionRecord, Event, EventKind, Guard, SmoothPart};
use nalgebra::Vector3;

use crate::Reason;
use crate::field::{At, Field, Together};
use crate::modes::{Hold, Mode};

/// A gap closes with no speed where its rate is this part of the terms that make up the normal velocity.
const GRAZING: f64 = 1e-7;
/// A force is about to vanish with its rate where that changes it by this part in all the time since the last event.
const TANGENT: f64 = 1e-7;
/// Slip may have this part of its terms left across the direction in which it ends.
const ACROSS: f64 = 1e-5;
/// Speeds after a collision agree with those of the motion to this part of the greatest.
const SAME: f64 = 1e-8;
/// What does not change, relative to the terms that make it up.
const NONE: f64 = 1e-12;

/// Why there is no derivative, and at which contact.
pub(crate) type Lacking = (Option<usize>, Reason);

/// What came of the events at one time.
pub(crate) struct Passed {
    /// derivatives of the time of the events (k; the last is 0)
    pub time: Vec<f64>,
    /// derivatives of the state at the events, which move, before them (n + p rows, k columns)
    pub before: Vec<f64>,
    /// the same after each event
    pub after: Vec<Vec<f64>>,
    /// derivatives of the state at the same time, after the events
    pub by: Vec<f64>,
}

/// The end of a part, with this state.
fn at_end<'a>(part: &'a SmoothPart, state: &'a [f64], by: &'a [f64], time_by: &'a [f64]) -> At<'a> {
    At { time: part.end, state, by, time_by, inputs: &part.inputs }
}

/// The start of a part.
pub(crate) fn at_start<'a>(part: &'a SmoothPart, by: &'a [f64]) -> At<'a> {
    At { time: part.start, state: &part.first, by, time_by: &[], inputs: &part.inputs }
}

/// The modes through a part.
pub(crate) fn modes(part: &SmoothPart) -> Vec<Mode> {
    let mode = |closed: &hodograph_simulation::ClosedPart| Mode {
        contact: closed.contact,
        hold: closed.slides.map_or(Hold::Stick, Hold::Slide),
    };
    part.closed.iter().map(mode).collect()
}

impl Field<'_> {
    /// The events at the end of a part. `by` are derivatives of the state just before them, at the same time; `modes` are
    /// those through the part; `next` is the part that follows; `since` is the time of the events before.
    pub fn pass(
        &self,
        (part, next): (&SmoothPart, &SmoothPart),
        modes: &[Mode],
        by: &[f64],
        events: &[Event],
        since: f64,
    ) -> Result<Passed, Lacking> {
        let k = self.k;
        for event in events {
            let selection = event.kind.selection();
            if matches!(selection, Some(Selection::SeveralModes | Selection::Indeterminate)) {
                return Err((event.contact, Reason::SeveralModes));
            }
        }
        let before = self.moving(modes, &at_end(part, &part.last, by, &[])).map_err(|why| (None, why))?;
        // Along the last direction time goes on.
        let mut flow = vec![0.0; k];
        flow[k - 1] = 1.0;
        let mut along = by.to_vec();
        for (row, rate) in along.chunks_exact_mut(k).zip(&before.rates) {
            row[k - 1] = *rate;
        }
        let slopes = self.guard(part, modes, &at_end(part, &part.last, &along, &flow), since)?;
        let mut time: Vec<f64> = slopes.iter().map(|slope| -slope / slopes[k - 1]).collect();
        time[k - 1] = 0.0;
        let (mut there, mut sizes) = (by.to_vec(), by.to_vec());
        for ((row, size), rate) in there.chunks_exact_mut(k).zip(sizes.chunks_exact_mut(k)).zip(&before.rates)
        {
            for ((by, size), time) in row.iter_mut().zip(size).zip(&time) {
                *by += rate * time;
                *size = size.abs() + (rate * time).abs();
            }
        }
        if let Some(Guard::Slip(stopped)) = &part.ended_by {
            self.stops(stopped, &at_end(part, &part.last, &there, &time), &sizes)?;
        }
        let (mut now, mut after) = (there.clone(), Vec::with_capacity(events.len()));
        self.check_impacts(part, next, events)?;
        for event in events {
            if let EventKind::Collision(struck) = &event.kind {
                let contact = event.contact.unwrap_or(0);
                let mut state = part.last[..self.n].to_vec();
                state.extend_from_slice(&struck.speeds_before);
                let speeds = self.collide(contact, struck, event, &at_end(part, &state, &now, &time));
                now[self.n * k..].copy_from_slice(&speeds.map_err(|why| (Some(contact), why))?);
            }
            after.push(now.clone());
        }
        let modes = self::modes(next);
        let going = self.moving(&modes, &at_start(next, &now)).map_err(|why| (None, why))?;
        for ((row, size), rate) in now.chunks_exact_mut(k).zip(sizes.chunks_exact_mut(k)).zip(&going.rates) {
            for ((by, size), time) in row.iter_mut().zip(size).zip(&time) {
                *by -= rate * time;
                *size += (rate * time).abs();
            }
        }
        let apart = self.moved_apart(&modes, &at_start(next, &now), &sizes).map_err(|why| (None, why))?;
        if let Some((contact, _, left)) = apart
            && left > ACROSS
        {
            return Err((Some(contact), Reason::Inaccurate(left)));
        }
        Ok(Passed { time, before: there, after, by: now })
    }

    /// How the function that ended a part changes along the directions; the last one is its rate.
    fn guard(&self, part: &SmoothPart, modes: &[Mode], at: &At<'_>, since: f64) -> Result<Vec<f64>, Lacking> {
        let last = self.k - 1;
        let place = |contact: usize| {
            let found = modes.iter().position(|mode| mode.contact == contact);
            found.ok_or((Some(contact), Reason::ModesChanged))
        };
        let state = |error| (None, Reason::State(error));
        match part.ended_by.as_ref().ok_or((None, Reason::ModesChanged))? {
            Guard::Gap(contact) => {
                let (_, by) = self.gap(*contact, at).map_err(state)?;
                let together = self.together(&[*contact], at).map_err(state)?;
                let size = together.velocity_size(0, 0, &at.state[self.n..]);
                if by[last] >= -GRAZING * size {
                    return Err((Some(*contact), Reason::Grazing));
                }
                Ok(by)
            }
            Guard::NormalForce(contact) => {
                let moving = self.moving(modes, at).map_err(|why| (Some(*contact), why))?;
                let size = moving.forces.iter().map(|force| force[0].value.abs()).fold(0.0, f64::max);
                let by = moving.forces[place(*contact)?][0].by.clone();
                tangency(*contact, by, size, part.end - since)
            }
            Guard::Friction(contact) => {
                let moving = self.moving(modes, at).map_err(|why| (Some(*contact), why))?;
                let [normal, first, second] = &moving.forces[place(*contact)?];
                let mu = self.surface(*contact).ok_or((Some(*contact), Reason::ModesChanged))?.mu;
                // (mu lambda_n)^2 - lambda_t^2 - lambda_s^2
                let by: Vec<f64> = (0..self.k)
                    .map(|d| {
                        let is = self.by.get(d).is_some_and(|by| by.is_friction_of(*contact));
                        let by_mu = if is { mu * normal.value * normal.value } else { 0.0 };
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
                let moving = self.moving(modes, at).map_err(|why| (Some(contact), why))?;
                let Some(along) = moving.directions[place] else {
                    return Err((Some(contact), Reason::ModesChanged));
                };
                let together = &moving.together;
                let part =
                    |axis: usize, d: usize| along[axis] * together.by(together.velocity(place, 1 + axis))[d];
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

    /// Slip that has ended has no part across the direction in which it ended.
    fn stops(&self, stopped: &[usize], at: &At<'_>, sizes: &[f64]) -> Result<(), Lacking> {
        for &contact in stopped {
            let together = self.together(&[contact], at).map_err(|error| (None, Reason::State(error)))?;
            for axis in 1..3 {
                for (d, left) in together.by(together.velocity(0, axis)).iter().enumerate() {
                    if left.abs() > ACROSS * self.terms(&together, (0, axis), (at, sizes), d) {
                        return Err((Some(contact), Reason::SlipTurns));
                    }
                }
            }
        }
        Ok(())
    }

    /// The size of the terms that make up the derivative of the velocity of a contact along a direction; `sizes` are those
    /// of the derivatives of the state.
    fn terms(
        &self,
        together: &Together,
        (place, axis): (usize, usize),
        (at, sizes): (&At<'_>, &[f64]),
        d: usize,
    ) -> f64 {
        let (n, p, k) = (self.n, self.p, self.k);
        let by = |index: usize| sizes[index * k + d];
        let partial = |speed: usize| together.value(together.partial(place, axis, speed)).abs();
        let own: f64 = (0..p).map(|speed| partial(speed) * by(n + speed)).sum();
        let turning = (0..n).map(by).fold(0.0, f64::max);
        let speed: f64 = (0..3).map(|axis| together.velocity_size(place, axis, &at.state[n..])).sum();
        own + turning * speed
    }

    /// By how much the closed contacts part, and those that stick slip, along the directions: the contact and the direction
    /// with the greatest part of the terms that make it up. Gaps are looked at, too.
    pub fn moved_apart(
        &self,
        modes: &[Mode],
        at: &At<'_>,
        sizes: &[f64],
    ) -> Result<Option<(usize, usize, f64)>, Reason> {
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        if contacts.is_empty() {
            return Ok(None);
        }
        let together = self.together(&contacts, at).map_err(Reason::State)?;
        let mut worst: Option<(usize, usize, f64)> = None;
        let mut see = |contact: usize, d: usize, left: f64, size: f64| {
            let part = if left == 0.0 { 0.0 } else { left.abs() / (size + f64::MIN_POSITIVE) };
            if worst.is_none_or(|(_, _, before)| part > before) {
                worst = Some((contact, d, part));
            }
        };
        for (place, mode) in modes.iter().enumerate() {
            let axes = if mode.hold == Hold::Stick { 3 } else { 1 };
            for axis in 0..axes {
                for (d, &left) in together.by(together.velocity(place, axis)).iter().enumerate() {
                    see(mode.contact, d, left, self.terms(&together, (place, axis), (at, sizes), d));
                }
            }
            let (_, gap) = self.gap(mode.contact, at).map_err(Reason::State)?;
            for (d, &left) in gap.iter().enumerate() {
                let size = (0..self.n).map(|index| sizes[index * self.k + d]).fold(0.0, f64::max);
                see(mode.contact, d, left, size);
            }
        }
        Ok(worst)
    }

    /// Collisions that are no function of the state before, smooth in it.
    fn check_impacts(&self, part: &SmoothPart, next: &SmoothPart, events: &[Event]) -> Result<(), Lacking> {
        let closed = |contact: usize| part.closed.iter().any(|closed| closed.contact == contact);
        let mut opened: Vec<usize> = Vec::new();
        for event in events {
            match &event.kind {
                EventKind::SimultaneousCollision(_) => return Err((event.contact, Reason::AtOnce)),
                EventKind::ImpactWithoutCollision(_) => return Err((event.contact, Reason::Jam)),
                EventKind::Collision(_) => {
                    opened.extend(event.contact.filter(|contact| !closed(*contact)));
                }
                _ => {}
            }
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
        Ok(())
    }

    /// The derivatives of the speeds after a collision (p rows, k columns).
    fn collide(
        &self,
        contact: usize,
        struck: &CollisionRecord,
        event: &Event,
        at: &At<'_>,
    ) -> Result<Vec<f64>, Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        let together = self.together(&[contact], at).map_err(Reason::State)?;
        // The inputs of the solver: approach, reduced matrix, mu, e.
        let axes = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
        let mut matrix = [0.0; 6];
        let mut by: Vec<[f64; 11]> = vec![[0.0; 11]; k];
        for (entry, (row, column)) in axes.into_iter().enumerate() {
            for speed in 0..p {
                let (v, r) = (together.partial(0, row, speed), together.response(0, column, speed));
                matrix[entry] += together.value(v) * together.value(r);
                for (d, by) in by.iter_mut().enumerate() {
                    by[3 + entry] +=
                        together.by(v)[d] * together.value(r) + together.value(v) * together.by(r)[d];
                }
            }
        }
        for (d, by) in by.iter_mut().enumerate() {
            for (axis, by) in by.iter_mut().take(3).enumerate() {
                *by = together.by(together.velocity(0, axis))[d];
            }
            let variable = self.by.get(d);
            by[9] = if variable.is_some_and(|by| by.is_friction_of(contact)) { 1.0 } else { 0.0 };
            by[10] = if variable.is_some_and(|by| by.is_restitution_of(contact)) { 1.0 } else { 0.0 };
        }
        let approach = Vector3::from_fn(|axis, _| together.value(together.velocity(0, axis)));
        let surface = self.surface(contact).ok_or(Reason::ModesChanged)?;
        let response = |speed: usize, axis: usize| together.response(0, axis, speed);
        let after = |hit: &ImpactDerivative<f64>| -> Vec<f64> {
            let push = |speed: usize| {
                (0..3)
                    .map(|axis| together.value(response(speed, axis)) * hit.impact.impulse[axis])
                    .sum::<f64>()
            };
            (0..p).map(|speed| at.state[n + speed] + push(speed)).collect()
        };
        // The last bounce, and those that have faded, are without restitution.
        let plastic = Surface { e: 0.0, ..surface };
        let surfaces = if struck.last_bounce { vec![plastic] } else { vec![surface, plastic] };
        let greatest =
            event.speeds.iter().chain(&struck.speeds_before).fold(0.0_f64, |size, u| size.max(u.abs()));
        let mut difference = f64::INFINITY;
        for surface in surfaces {
            let Ok(hit) = derivative(&ReducedMatrix::from(matrix), &approach, &surface) else { continue };
            let off = after(&hit).iter().zip(&event.speeds).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            difference = difference.min(off / greatest);
            if off > SAME * greatest {
                continue;
            }
            self.smooth(contact, &hit, &by, &approach, surface.mu)?;
            let restitution = if surface.e == 0.0 && struck.last_bounce { 0.0 } else { 1.0 };
            let mut speeds = at.by[n * k..].to_vec();
            for (d, by) in by.iter_mut().enumerate() {
                by[10] *= restitution;
                let impulse = hit.impulse * nalgebra::SVector::<f64, 11>::from(*by);
                for speed in 0..p {
                    let change = |axis: usize| {
                        let index = response(speed, axis);
                        together.by(index)[d] * hit.impact.impulse[axis]
                            + together.value(index) * impulse[axis]
                    };
                    speeds[speed * k + d] += change(0) + change(1) + change(2);
                }
            }
            return Ok(speeds);
        }
        Err(Reason::Inaccurate(difference))
    }

    /// Whether the outcome is differentiable along all directions.
    fn smooth(
        &self,
        contact: usize,
        hit: &ImpactDerivative<f64>,
        by: &[[f64; 11]],
        approach: &Vector3<f64>,
        mu: f64,
    ) -> Result<(), Reason> {
        let Some(why) = hit.non_smoothness else { return Ok(()) };
        if why != NonSmoothness::NoSlip {
            return Err(Reason::Impact(why));
        }
        // Without slip there is a derivative along what makes none, and where there is no friction.
        let by_mu = self.by.iter().any(|by| by.is_friction_of(contact));
        let slips = |by: &[f64; 11]| {
            let size = by[0].abs() + approach.x.abs();
            by[1].abs().max(by[2].abs()) > NONE * size
        };
        let smooth = if mu == 0.0 { !by_mu } else { !by.iter().any(slips) };
        if smooth { Ok(()) } else { Err(Reason::Impact(why)) }
    }
}

/// The derivatives of a function that ends a mode, of this size and over this time; `Tangency` where its rate vanishes, too.
fn tangency(contact: usize, by: Vec<f64>, size: f64, time: f64) -> Result<Vec<f64>, Lacking> {
    let rate = by.last().copied().unwrap_or(0.0);
    if rate.abs() * time > TANGENT * size { Ok(by) } else { Err((Some(contact), Reason::Tangency)) }
}
