//! Sweeps against generated code, the tool by its commands, and clusters of it.
//!
//! One program holds all of them, for each would link the query engine: `cargo test --test all cluster::` runs those
//! of `tests/cluster.rs`.

mod cluster;
mod common;
mod functions;
mod models;
mod motions;
mod sql;
mod tool;
