//! Forces of several contacts at once: a problem of numbers that knows nothing of mechanisms.
//!
//! k closed contacts have the accelerations a = W lambda + beta, three components (n, t, s) each; W = V (mass
//! matrix)^-1 V^T is positive semidefinite, often singular. Signorini's law asks lambda_n >= 0, a_n >= 0 and
//! lambda_n a_n = 0 of each contact. Coulomb's law asks friction -mu lambda_n d of a contact that slips along d,
//! and of one that does not slip abs(lambda_tan) <= mu lambda_n, with a_tan = 0 or friction
//! -mu lambda_n a_tan / abs(a_tan). Nothing assumes that a is an acceleration: with v+ = W p + v- it is the
//! impact of all contacts at once, and beta = v- + e v-_n n asks for v+_n = -e v-_n.
//!
//! * [`solve`] finds forces and proves them by a certificate, or refuses.
//! * [`with_modes`] computes the forces of modes that are known; where many forces give the same motion, the
//!   analytic centre of those that the laws allow. [`rest`] asks whether nothing needs to begin to slip.
//! * [`enumerate`] lists the solutions of few contacts in all modes; of more, [`another`] looks for one other.
//!
//! Theory: docs/theory.md, section 17.10.

mod another;
mod barrier;
mod centre;
mod certified;
mod common_slip;
mod cone;
mod directions;
mod edge;
mod enumerate;
mod jam;
mod jam_distance;
mod linear;
mod motion;
mod natural_map;
mod near;
mod prescribed;
mod pressed;
mod problem;
mod solve;
mod sparse;
mod squares;
mod without_jam;

pub use self::{
    another::another,
    certified::certificate,
    directions::MOST_ENUMERATED,
    enumerate::enumerate,
    natural_map::natural_residual,
    prescribed::{Admissible, Impossible, rest, with_modes, with_modes_near},
    problem::{Mode, Problem, Solution, Solutions, Unsolved},
    solve::solve,
};
pub(crate) use self::{
    common_slip::slip_together,
    motion::is_slow,
    near::nearly,
    prescribed::{UNHELD, Wanted, found, nearest_to_jam},
    without_jam::solve_without_jam,
};
