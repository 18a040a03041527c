//! The closed contacts in one state: their equations, modes and forces, and the directions of small slip.

pub(crate) mod angles;
pub(crate) mod closed_contacts;
pub(crate) mod forces;
pub(crate) mod lengths;
pub(crate) mod mode_selection;
pub(crate) mod pair;
pub(crate) mod phase;
pub(crate) mod scales;
pub(crate) mod settled_direction;
pub(crate) mod slip_direction;
pub(crate) mod torques;
pub(crate) mod turned_axes;
pub(crate) mod units;
