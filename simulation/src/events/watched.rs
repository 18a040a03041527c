//! What is watched during a step: the functions whose zeros are events.

use crate::closed::phase::Closed;
use crate::state::smooth_parts::Guard;

/// A monitored function of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Watched {
    /// the gap of a contact
    Gap(usize),
    /// the distance of a near contact from the boundary of its face
    Entry(usize),
    /// the distance of a closed contact (index among them) from the boundary of its face
    End(usize),
    /// normal force of a contact (index among the closed ones)
    Normal(usize),
    /// whether friction suffices
    Cone(usize),
    /// slip of a contact along its settled direction, minus the slip at which a step ends
    Slip(usize),
    /// f, the distance of the sliding contacts from a jam
    Jam,
    /// a user's function, times this sign
    User(usize, f64),
}

impl Watched {
    /// Whether its value needs the forces.
    pub fn is_of_forces(self) -> bool {
        matches!(self, Self::Normal(_) | Self::Cone(_) | Self::Slip(_) | Self::Jam)
    }

    /// The function that ends a smooth part; slip that ends does so in a part of its own.
    pub fn guard(self, closed: &[Closed]) -> Option<Guard> {
        Some(match self {
            Self::Gap(contact) => Guard::Gap(contact),
            Self::Entry(contact) => Guard::Face(contact),
            Self::End(place) => Guard::Face(closed[place].contact),
            Self::Normal(place) => Guard::NormalForce(closed[place].contact),
            Self::Cone(place) => Guard::Friction(closed[place].contact),
            Self::Jam => Guard::Jam,
            Self::User(index, _) => Guard::Function(index),
            Self::Slip(_) => return None,
        })
    }
}
