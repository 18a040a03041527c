//! The smooth parts of a motion between its events. They are recorded on request, for users that integrate
//! the motion again, with derivatives for instance.

use crate::closed::phase::{Closed, Modes};
use crate::integration::stepper::Step;

/// A part of a motion with constant modes of all contacts: a step of the integration, or its part before an
/// event.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothPart {
    /// initial time, s
    pub start: f64,
    /// final time, s
    pub end: f64,
    /// initial coordinates and independent speeds, after the events there
    pub first: Vec<f64>,
    /// final coordinates and independent speeds, before the events there
    pub last: Vec<f64>,
    /// the contacts that were closed
    pub closed: Vec<ClosedPart>,
    /// the inputs that were constant
    pub inputs: Vec<f64>,
    /// the function that ended the modes; `None` if they continued
    pub ended_by: Option<Guard>,
}

/// A closed contact during a part of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedPart {
    /// its index; indices from the number of contacts on are torques of rolling and spinning friction
    pub contact: usize,
    /// `None` while it sticks; else the direction in which its slip began, along the two tangential axes of
    /// the contact basis, which is the direction of slip as long as slip is too small to have one
    pub slides: Option<[f64; 2]>,
}

/// The function whose zero ended a part of a motion.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Guard {
    /// the gap of an open contact
    Gap(usize),
    /// the distance of a contact from the boundary of its face
    Face(usize),
    /// the normal force of a closed contact
    NormalForce(usize),
    /// the remaining friction of a sticking contact
    Friction(usize),
    /// the slip of these contacts
    Slip(Vec<usize>),
    /// f of a sliding contact, which jams
    Jam,
    /// a function of [`crate::Options::events`]
    Function(usize),
}

/// The parts so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parts(Vec<SmoothPart>);

impl Parts {
    /// Adds a step that started from a state, with its end corrected for drift.
    pub fn add(&mut self, step: &Step, modes: &Modes, end: &[f64]) {
        let count = end.len();
        self.0.push(SmoothPart {
            start: step.t,
            end: step.t + step.h,
            first: step.start()[..count].to_vec(),
            last: end.to_vec(),
            closed: closed_parts(&modes.closed),
            inputs: modes.held.clone(),
            ended_by: None,
        });
    }

    /// Sets the function that ended the last part; `None` if slip continues to its end in a separate part.
    pub fn end(&mut self, guard: Option<Guard>) {
        if let Some(last) = self.0.last_mut() {
            last.ended_by = guard;
        }
    }

    /// Adds the end of slip of these contacts as a part, from a state in these modes.
    pub fn end_of_slip(&mut self, before: &[f64], closed: &[Closed], stopped: &[usize]) {
        let Some(last) = self.0.last_mut() else { return };
        let count = last.first.len();
        last.first.copy_from_slice(&before[..count]);
        last.closed = closed_parts(closed);
        last.ended_by = Some(Guard::Slip(stopped.to_vec()));
    }

    /// Their number.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// Keeps the first parts only.
    pub fn shorten(&mut self, count: usize) {
        self.0.truncate(count);
    }

    /// Appends the parts of a later transition. A part that was tried and replaced is dropped.
    pub fn follow(&mut self, later: Parts) {
        for part in later.0 {
            while self.0.last().is_some_and(|last| last.end > part.start) {
                self.0.pop();
            }
            self.0.push(part);
        }
    }

    /// Returns all parts and removes them.
    pub fn take(&mut self) -> Vec<SmoothPart> {
        std::mem::take(&mut self.0)
    }
}

fn closed_parts(closed: &[Closed]) -> Vec<ClosedPart> {
    let part = |closed: &Closed| ClosedPart {
        contact: closed.contact,
        slides: closed.slides.map(|direction| [direction.x, direction.y]),
    };
    closed.iter().map(part).collect()
}
