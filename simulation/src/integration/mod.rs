//! The integration of the motion between events, and small slip on its way to its end.

pub(crate) mod drift;
pub(crate) mod motion;
pub(crate) mod settled_slip;
pub(crate) mod signed_slip;
pub(crate) mod slip_end;
pub mod stepper;
