//! Events within a step: what is watched, where it is zero, and what follows.

pub(crate) mod broad_phase;
pub(crate) mod ends;
pub(crate) mod event_functions;
pub(crate) mod event_handling;
pub(crate) mod event_location;
pub(crate) mod event_time;
pub(crate) mod force_functions;
pub(crate) mod rattling;
pub(crate) mod rounding_of_functions;
pub(crate) mod scheduled_events;
pub(crate) mod singular;
pub(crate) mod stage_values;
pub(crate) mod time_step;
pub(crate) mod watched;
