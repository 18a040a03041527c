//! Motions with contact against closed forms, balances and other computations.
//!
//! One program holds all of them: `cargo test -p hodograph-simulation --test all painleve::`
//! runs those of `tests/painleve.rs`.

mod bipeds;
mod bodies;
mod broad_phase;
mod campaigns;
mod common;
mod contact_families;
mod contact_problem;
mod controller;
mod crates;
mod curvature;
mod discs;
mod driven;

mod edges;
mod energy_under_poisson;
mod exact;
mod examples;
mod exchange;
mod faces;
mod flush;
mod flush_lines;
mod force_jumps;
mod implicit;
mod inclines;
mod late_edges;
mod ledge;
mod logs;
mod many;
mod mechanisms;
mod near_starts;
mod one_contact;
mod one_pass;
mod painleve;
mod poisson;
mod polytopes;
mod poses;
mod refused;
mod roads;
mod rotation;
mod set_in_motion;
mod settling;
mod several;
mod shipped;
mod slip_of_feet;
mod spins;
mod surfaces;
mod table;
mod tangents;
mod tosses;
mod tumbling;
mod units;
mod woodpecker;
