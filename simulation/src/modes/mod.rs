//! The modes of the closed contacts at the start and at events.

pub(crate) mod look_ahead;
pub(crate) mod mode_changes;
pub(crate) mod past_jam;
pub(crate) mod past_jump;
pub(crate) mod start;
pub(crate) mod torque_modes;
