//! Impacts: of one contact, of several one after another or at once, and without collision.

pub(crate) mod impact_at_once;
pub(crate) mod impact_without_collision;
pub(crate) mod impacts;
pub(crate) mod lzb;
pub(crate) mod poisson_at_once;
pub(crate) mod simultaneous_impacts;
pub(crate) mod single_impact;
