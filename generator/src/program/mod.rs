//! Straight-line programs: what is computed, in which order, at which stage.

pub mod graph;
pub mod routine;
