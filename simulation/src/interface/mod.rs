//! What users give to a motion and what it tells them: options, laws of contact, inputs; events and errors.

pub(crate) mod contact_law;
pub(crate) mod drive;
pub(crate) mod error;
pub(crate) mod event;
pub(crate) mod given_law;
pub(crate) mod options;
pub(crate) mod sample_times;
