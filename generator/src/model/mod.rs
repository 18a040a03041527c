//! The meaning of a model: names resolved, dimensions and physics checked.

pub mod mechanism;
