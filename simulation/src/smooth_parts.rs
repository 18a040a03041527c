//! The smooth parts of a motion: what it was between its events, kept on request for who follows the motion once more,
//! with derivatives for instance.

use crate::phase::{Closed, Modes};
use crate::stepper::Step;

/// A part of a motion through which the modes of all contacts stayed the same: a step of the integration, or its part
/// before an event.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothPart {
    /// when it begins, s
    pub start: f64,
    /// when it ends, s
    pub end: f64,
    /// coordinates and independent speeds at its beginning, after the events there
    pub first: Vec<f64>,
    /// coordinates and independent speeds at its end, before the events there
    pub last: Vec<f64>,
    /// the contacts that were closed
    pub closed: Vec<ClosedPart>,
    /// the inputs that were held
    pub inputs: Vec<f64>,
    /// what ended the modes; `None` where they went on
    pub ended_by: Option<Guard>,
}

/// A closed contact through a part of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosedPart {
    /// its number; those from the number of contacts on are torques of rolling and spinning friction
    pub contact: usize,
    /// `None` while it sticks; else the direction in which its slip began, along the two tangential axes of the contact
    /// basis: the direction of slip as long as slip is too small to have one
    pub slides: Option<[f64; 2]>,
}

/// The function whose zero ended a part of a motion.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Guard {
    /// the gap of an open contact
    Gap(usize),
    /// the way of a contact to where its face begins or ends
    Face(usize),
    /// the normal force of a closed contact
    NormalForce(usize),
    /// what is left of the friction that may hold a contact which sticks
    Friction(usize),
    /// the slip of these contacts
    Slip(Vec<usize>),
    /// f of a sliding contact: it jams
    Jam,
    /// a function of [`crate::Options::events`]
    Function(usize),
}

/// The parts so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Parts(Vec<SmoothPart>);

impl Parts {
    /// A step was made, from a state on, to an end that was corrected for drift.
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

    /// A guard ended the last part; none of its own, where slip goes on to its end in a part that follows.
    pub fn end(&mut self, guard: Option<Guard>) {
        if let Some(last) = self.0.last_mut() {
            last.ended_by = guard;
        }
    }

    /// The last part was the end of slip of these contacts, from a state on, in these modes.
    pub fn end_of_slip(&mut self, before: &[f64], closed: &[Closed], stopped: &[usize]) {
        let Some(last) = self.0.last_mut() else { return };
        let count = last.first.len();
        last.first.copy_from_slice(&before[..count]);
        last.closed = closed_parts(closed);
        last.ended_by = Some(Guard::Slip(stopped.to_vec()));
    }

    /// Those of a later transition follow. A part that was tried and replaced by a later one is forgotten.
    pub fn follow(&mut self, later: Parts) {
        for part in later.0 {
            while self.0.last().is_some_and(|last| last.end > part.start) {
                self.0.pop();
            }
            self.0.push(part);
        }
    }

    /// All of them, which are then forgotten.
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
