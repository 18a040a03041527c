//! The monitored functions of a step that follow from forces: normal forces, friction cones, slip that is left, and
//! the distance from a jam.

use smallvec::SmallVec;

use crate::closed::closed_contacts::ClosedContacts;
use crate::closed::forces::{Forces, Hold, JAM, Margins, margins};
use crate::closed::phase::{Closed, mus};
use crate::events::watched::Watched;
use crate::integration::motion::Evaluation;

/// Their values in one state, by closed contact.
pub(crate) struct ForceFunctions {
    /// for each lambda_n, and how far friction is from its limit
    margins: Margins,
    /// slip of settled contacts along their directions, minus the slip at which a step ends, m/s; 1 for others
    slips: SmallVec<[f64; 4]>,
    f: f64,
}

impl ForceFunctions {
    pub fn new(closed: &[Closed], support: &ClosedContacts, holds: &[Hold], forces: &Forces) -> Self {
        let slips =
            closed.iter().enumerate().map(|(place, contact)| match (&contact.turning, &holds[place]) {
                (Some(turning), Hold::Slide(d)) => support.slip(place).dot(d) - turning.least,
                _ => 1.0,
            });
        Self { margins: margins(forces, holds, &mus(closed)), slips: slips.collect(), f: forces.f }
    }

    /// Those of an evaluation; `None` without closed contacts.
    pub fn of(closed: &[Closed], there: &Evaluation) -> Option<Self> {
        there.forces.as_ref().map(|forces| Self::new(closed, &there.support, &there.holds, forces))
    }

    /// The value of a function of the forces; `None` for others.
    pub fn value(&self, what: &Watched) -> Option<f64> {
        Some(match *what {
            Watched::Normal(place) => self.margins[place][0],
            Watched::Cone(place) => self.margins[place][1],
            Watched::Slip(place) => self.slips[place],
            Watched::Jam => self.f - JAM,
            Watched::Gap(_) | Watched::Entry(_) | Watched::End(_) | Watched::User(..) => return None,
        })
    }
}
