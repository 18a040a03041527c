//! What the integration of a step tells of the forces within it: their functions at its stages, which need no
//! evaluation of their own (docs/theory.md, section 17.12).

use crate::closed::forces::Forces;
use crate::events::force_functions::ForceFunctions;
use crate::events::watched::Watched;
use crate::integration::motion::{Evaluation, Failure, Motion, Room};
use crate::integration::stepper::System;

/// A motion that is integrated, with the functions of the forces at the places of the last step.
pub(crate) struct Stages<'m> {
    motion: &'m Motion<'m>,
    room: Room,
    /// The forces in the last state.
    forces: Option<Forces>,
    seen: [Option<ForceFunctions>; 8],
    /// The first failure.
    pub failed: Option<Failure>,
}

impl<'m> Stages<'m> {
    pub fn new(motion: &'m Motion<'m>) -> Self {
        Self { motion, room: motion.room(), forces: None, seen: Default::default(), failed: None }
    }

    /// The start of the step has been evaluated.
    pub fn starts(&mut self, here: &Evaluation) {
        self.seen[0] = ForceFunctions::of(self.motion.closed, here);
    }

    /// A function at all places of the step that was made last; `None` if it is no function of the forces, or if
    /// its forces are not unique or unknown somewhere.
    pub fn values(&self, what: &Watched) -> Option<[f64; 8]> {
        let mut values = [0.0; 8];
        for (value, seen) in values.iter_mut().zip(&self.seen) {
            *value = seen.as_ref()?.value(what)?;
        }
        Some(values)
    }
}

impl System for Stages<'_> {
    fn rates(&mut self, t: f64, y: &[f64], rates: &mut [f64]) {
        match self.motion.rates(t, y, rates, &mut self.room) {
            Ok(forces) => self.forces = forces,
            Err(failure) => {
                self.forces = None;
                self.failed.get_or_insert(failure);
                rates.fill(f64::NAN);
            }
        }
    }

    fn at_place(&mut self, place: usize) {
        // Of several forces for one motion, the motion takes any; the modes are those of the centre.
        let unique = self.forces.take().filter(|forces| forces.unique);
        self.seen[place] = unique.map(|forces| {
            let (support, holds) = self.room.contacts();
            ForceFunctions::new(self.motion.closed, support, holds, &forces)
        });
    }
}
