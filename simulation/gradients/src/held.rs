//! Contacts that begin to last at an event: what is left of their velocities is taken from the derivatives.
//!
//! Where slip ends that is the rounding of its direction. Contacts of a body that bounce in turn, ever lower, do so
//! infinitely often in a finite time; one plastic impact of all of them replaces the last bounces. The balance of momentum of
//! the whole sequence is linear in the speeds with which it begins, and so is that of the impact: the derivatives differ by
//! terms as small as these speeds.
//!
//! Theory: docs/theory.md, section 19.2.

use hodograph::State;
use hodograph_simulation::{Guard, SmoothPart};
use nalgebra::{DMatrix, DVector};

use crate::Reason;
use crate::by::NonDifferentiable;
use crate::field::Field;
use crate::gaps::{gaps, least};
use crate::modes::{Mode, ModeKind};

/// The plastic impact and that of the motion differ by at most this many times their terms.
const JUMP: f64 = 10.0;
/// The derivatives of the gaps that are left when bounces end change those of the coordinates by at most this part of their
/// terms.
const LEFT_OPEN: f64 = 1e-8;

/// The computed speeds after a collision must agree with those of the motion to this part of the greatest.
pub(crate) const SPEED_AGREEMENT: f64 = 1e-8;
/// A change below this part of its terms counts as zero.
pub(crate) const NEGLIGIBLE: f64 = 1e-12;

/// Contacts that begin to last, or to stick, at an event.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    /// the closed contacts, with the directions of their slip
    pub modes: Vec<Mode>,
    /// the state after (n + p)
    pub state: Vec<f64>,
    /// for the contacts that close without a collision the change of the coordinates that opens each by one, m (n rows)
    pub openings: DMatrix<f64>,
}

/// Whether a contact whose gap ended a part stays closed without a collision: the bounces of several contacts end there.
pub(crate) fn settles(part: &SmoothPart, next: &SmoothPart, collides: bool) -> bool {
    let stays = |contact: usize| next.closed.iter().any(|closed| closed.contact == contact);
    matches!(part.ended_by, Some(Guard::Gap(contact)) if !collides && stays(contact))
}

impl Field<'_> {
    /// The end of the bounces of the contacts that are closed in the next part.
    pub fn settling(&self, part: &SmoothPart, next: &SmoothPart) -> Result<Held, NonDifferentiable> {
        let found = self.all_at_once(part, next).map_err(|why| (None, why))?;
        found.ok_or((None, Reason::ModesChanged))
    }

    /// `None` if a plastic impact of all closed contacts does not give the speeds of the motion.
    fn all_at_once(&self, part: &SmoothPart, next: &SmoothPart) -> Result<Option<Held>, Reason> {
        let n = self.n;
        let none = vec![0.0; part.last.len() * self.k];
        let mut modes = self.modes(next);
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let after = self.contact_terms(&contacts, &self.at_start(next, &none)).map_err(Reason::State)?;
        let directions = Field::directions(&modes, &after, &next.first[n..]);
        for (mode, direction) in modes.iter_mut().zip(directions) {
            if let Some(along) = direction {
                mode.kind = ModeKind::Along(along);
            }
        }
        let before = self.contact_terms(&contacts, &self.at_end(part, &part.last, &none, &[]));
        let before = before.map_err(Reason::State)?;
        let balance = self.balance(&modes, &before, &part.last[n..])?;
        let velocity = DVector::from_iterator(
            balance.unknowns.len(),
            balance.unknowns.iter().map(|unknown| before.value(before.velocity(unknown.place, unknown.axis))),
        );
        let impulses = balance.solver.solve(&velocity).ok_or(Reason::ForcesNotUnique)?;
        let greatest = part.last[n..].iter().fold(f64::MIN_POSITIVE, |size, u| size.max(u.abs()));
        // The impact of the motion may have left out an impulse that pulls; the sequence as a whole has none.
        let agrees = (0..self.p).all(|speed| {
            let (mut change, mut size) = (0.0, 0.0_f64);
            for (column, impulse) in balance.columns.iter().zip(&impulses) {
                change += column[speed] * impulse;
                size += (column[speed] * impulse).abs();
            }
            let off = part.last[n + speed] - change - next.first[n + speed];
            off.abs() <= JUMP * size + SPEED_AGREEMENT * greatest
        });
        if !agrees {
            return Ok(None);
        }
        let (coordinates, speeds) = next.first.split_at(n);
        let state = State { time: part.end, coordinates, speeds, inputs: &part.inputs };
        let (_, gradient) = gaps(self.mechanism, &contacts, &state)?;
        let one = DMatrix::identity(contacts.len(), contacts.len());
        let openings = least(&gradient, &one).ok_or(Reason::ForcesNotUnique)?;
        Ok(Some(Held { modes, state: next.first.clone(), openings }))
    }

    /// The contacts that are closed in the next part after some of them have stopped; `None` if their forces are not unique.
    pub fn stopped(&self, stopped: &[usize], next: &SmoothPart) -> Option<Held> {
        let mut modes = self.modes(next);
        for mode in &mut modes {
            if stopped.contains(&mode.contact) {
                mode.kind = ModeKind::Stick;
            }
        }
        let contacts: Vec<usize> = modes.iter().map(|mode| mode.contact).collect();
        let none = vec![0.0; next.first.len() * self.k];
        let terms = self.contact_terms(&contacts, &self.at_start(next, &none)).ok()?;
        let speeds = &next.first[self.n..];
        self.balance(&modes, &terms, speeds).ok()?;
        let directions = Field::directions(&modes, &terms, speeds);
        for (mode, direction) in modes.iter_mut().zip(directions) {
            if let Some(along) = direction {
                mode.kind = ModeKind::Along(along);
            }
        }
        Some(Held { modes, state: next.first.clone(), openings: DMatrix::zeros(self.n, 0) })
    }

    /// Derivatives of the state of which contacts take what is left of their velocities, in place of those before; `time` are
    /// those of the time. `terms` sums up the magnitudes of the terms of derivatives.
    pub fn hold(
        &self,
        part: &SmoothPart,
        held: &Held,
        (by, time): (&mut [f64], &[f64]),
        terms: &mut [f64],
    ) -> Result<(), Reason> {
        let (n, p, k) = (self.n, self.p, self.k);
        // The contacts stay closed.
        let mut opened = DMatrix::zeros(held.openings.ncols(), k);
        for (row, mode) in held.modes.iter().take(held.openings.ncols()).enumerate() {
            let (_, gap_by) =
                self.gap(mode.contact, &self.at_end(part, &held.state, by, time)).map_err(Reason::State)?;
            opened.row_mut(row).copy_from_slice(&gap_by);
        }
        let change = &held.openings * &opened;
        for (place, by) in by[..n * k].iter_mut().enumerate() {
            let change = change[(place / k, place % k)];
            if change.abs() > LEFT_OPEN * (terms[place] + f64::MIN_POSITIVE) {
                return Err(Reason::Settling);
            }
            *by -= change;
            terms[place] += change.abs();
        }
        // They do not separate, and those that stick do not slip.
        let contacts: Vec<usize> = held.modes.iter().map(|mode| mode.contact).collect();
        let at = self.at_end(part, &held.state, by, time);
        let contact_terms = self.contact_terms(&contacts, &at).map_err(Reason::State)?;
        let balance = self.balance(&held.modes, &contact_terms, &held.state[n..])?;
        // Rounding is left as it is: a derivative that is zero stays so.
        let velocity = DMatrix::from_fn(balance.unknowns.len(), k, |row, d| {
            let unknown = &balance.unknowns[row];
            let place = (unknown.place, unknown.axis);
            let left = contact_terms.by(contact_terms.velocity(place.0, place.1))[d];
            let rounding = NEGLIGIBLE * self.terms(&contact_terms, place, (&at, terms), d);
            if left.abs() > rounding { left } else { 0.0 }
        });
        let impulses = balance.solver.solve(&velocity).ok_or(Reason::ForcesNotUnique)?;
        for speed in 0..p {
            for d in 0..k {
                let place = (n + speed) * k + d;
                for (row, column) in balance.columns.iter().enumerate() {
                    let change = column[speed] * impulses[(row, d)];
                    by[place] -= change;
                    terms[place] += change.abs();
                }
            }
        }
        Ok(())
    }
}
