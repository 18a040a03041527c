//! Ends a motion if the contact point of a closed contact, or of one that is struck, is not determined by the coordinates.
//!
//! The lowest point of a disc is undefined when the disc lies flat; before, the contact point runs around the
//! rim ever faster, or it jumps to the other side. A motion ends there: the impact of a whole face or line would
//! follow (docs/theory.md, section 17.16).

use hodograph::{ComponentKind, State, StateError};

use crate::closed::phase::Closed;
use crate::closed::turned_axes::{turn_of_tangents, turned};
use crate::integration::motion::{Failure, Motion};
use crate::integration::stepper::{Step, Tolerances};
use crate::state::transition::Transition;
use crate::{EventKind, SimulationError};

/// Steps that are shorter than the longest one so far by this factor are examined.
const SHORT: f64 = 1e-2;
/// The contact point is undefined if changes of the coordinates by their tolerances change its partial
/// velocities by this part.
const CHANGED: f64 = 1e-2;
/// Number of bisections of a step that distinguish a jump from a rotation.
const HALVINGS: usize = 30;
/// A contact that is struck is undefined if changes of the coordinates by this part, or by this much in m or rad, change it so:
/// ten times what rounding leaves of a time and of coordinates. Coarser tolerances say nothing of where the motion is.
const ROUNDING: f64 = 1e-12;

impl Transition<'_> {
    /// The contact at which the motion ends in this step, if any.
    pub(crate) fn singular(&self, closed: &[Closed], step: &Step) -> Option<usize> {
        let longest = self.front.steps.2;
        if step.h > SHORT * longest {
            return None;
        }
        self.undefined(closed, step.t + step.h, &step.end, Some(step.start()))
    }

    /// Whether the point of a contact that is struck is undefined at the front: a rim that meets a face flush. Corners that
    /// meet are no such point: each has a contact of its own.
    pub(crate) fn is_undefined(&self, contact: usize) -> bool {
        let motion = self.motion(&[]);
        let rounding = Tolerances { relative: ROUNDING, absolute: ROUNDING };
        let changes = self.changes(&motion, contact, (self.front.t, &self.front.y), None, &rounding);
        !self.ends(contact) && changes.is_ok_and(|changes| changes > CHANGED)
    }

    /// The closed contact whose point is undefined at the front.
    pub(crate) fn singular_here(&self, closed: &[Closed]) -> Option<usize> {
        self.undefined(closed, self.front.t, &self.front.y, None)
    }

    /// The closed contact whose point the coordinates do not determine in a state, or whose point jumps
    /// between the previous state and this one.
    fn undefined(&self, closed: &[Closed], t: f64, y: &[f64], before: Option<&[f64]>) -> Option<usize> {
        let motion = self.motion(&[]);
        // A face or an edge that has ended there may have given way to another, with another normal.
        let (q, u) = motion.split(y);
        let there = State { time: t, coordinates: q, speeds: u, inputs: &self.front.held };
        let own = |contact: &usize| {
            self.mechanism.torque(*contact).is_none()
                && self.validity(*contact, &there).is_ok_and(|validity| validity >= 0.0)
        };
        closed.iter().map(|closed| closed.contact).filter(own).find(|&contact| {
            let changes = self.changes(&motion, contact, (t, y), before, &self.tolerances());
            changes.is_ok_and(|changes| changes > CHANGED)
        })
    }

    /// The relative change of the partial velocities of a contact under changes of the coordinates by tolerances, or in a jump
    /// since the previous state.
    fn changes(
        &self,
        motion: &Motion<'_>,
        contact: usize,
        (t, y): (f64, &[f64]),
        before: Option<&[f64]>,
        tolerances: &Tolerances,
    ) -> Result<f64, StateError> {
        let (q, u) = motion.split(y);
        let p = self.mechanism.count(ComponentKind::Speed);
        let partials = |q: &[f64]| {
            let mut numbers = vec![0.0; 3 * p];
            let state = State { time: t, coordinates: q, speeds: u, inputs: &self.front.held };
            self.mechanism.partial_velocities(contact, &state, &mut numbers).map(|()| numbers)
        };
        let here = partials(q)?;
        let size = here.iter().fold(0.0_f64, |size, number| size.max(number.abs()));
        // Tangential axes that are chosen by the normal may jump where the point does not.
        let part = |one: &[f64], other: &[f64]| {
            let turned = turned(one, turn_of_tangents(one, other));
            let apart = turned.iter().zip(other).map(|(a, b)| (a - b).abs());
            apart.fold(0.0, f64::max) / size
        };
        let mut most = 0.0_f64;
        if let Some(before) = before {
            let (mut from, mut to) = (motion.split(before).0.to_vec(), q.to_vec());
            let (mut first, mut last) = (partials(&from)?, here.clone());
            // A change that remains after all bisections is a jump.
            for _ in 0..HALVINGS {
                if part(&first, &last) <= CHANGED {
                    break;
                }
                let middle: Vec<f64> = from.iter().zip(&to).map(|(a, b)| 0.5 * (a + b)).collect();
                let between = partials(&middle)?;
                if part(&first, &between) > part(&between, &last) {
                    (to, last) = (middle, between);
                } else {
                    (from, first) = (middle, between);
                }
            }
            most = part(&first, &last);
        }
        // Two directions, since a point may be determined along one of them.
        for sign in [1.0, -1.0] {
            let moved: Vec<f64> = q
                .iter()
                .enumerate()
                .map(|(index, q)| {
                    let way = if index % 2 == 0 { 1.0 } else { sign };
                    q + way * (tolerances.absolute + tolerances.relative * q.abs())
                })
                .collect();
            most = most.max(part(&partials(&moved)?, &here));
        }
        Ok(most)
    }

    /// Ends the motion at a contact at the present time.
    pub(crate) fn end_at(&mut self, contact: usize) -> Result<(), SimulationError> {
        self.front.ended = Some(contact);
        self.push(Some(contact), EventKind::Singular);
        Ok(())
    }

    /// Ends the motion with a step at whose end the contact point is undefined. Nothing is projected, since
    /// the velocity of such a point is undefined.
    pub(crate) fn end_with(&mut self, contact: usize, step: &Step) -> Result<(), SimulationError> {
        let modes = self.modes();
        self.front.t = step.t + step.h;
        self.front.y.copy_from_slice(&step.end);
        self.drive()?;
        self.steps.push((step.clone(), modes));
        let n = self.mechanism.count(ComponentKind::Coordinate);
        let mut q = self.front.y[..n].to_vec();
        self.mechanism.normalise(&mut q).map_err(|error| self.failure(Failure::State(error)))?;
        self.front.y[..n].copy_from_slice(&q);
        self.end_at(contact)
    }
}
