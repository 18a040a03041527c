//! The state of a motion as one value, and what changes it.

pub(crate) mod check;
pub(crate) mod commit;
pub(crate) mod driven_inputs;
pub(crate) mod energy;
pub(crate) mod front;
pub(crate) mod smooth_parts;
pub(crate) mod transition;
