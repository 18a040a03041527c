//! Derivatives of motions, against closed forms and differences.

mod closed_forms;
mod common;
mod cost;
mod differences;
mod fits;
mod orbits;
mod samples;
mod undefined;
mod validation;
