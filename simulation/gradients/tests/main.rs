//! Derivatives of motions, against closed forms and differences.

mod bounces_end;
mod closed_forms;
mod common;
mod contact_tasks;
mod cost;
mod differences;
mod doubled_ball;
mod doubled_hopper;
mod fits;
mod hopper;
mod orbits;
mod samples;
mod slip_begins;
mod undefined;
mod validation;
