//! Directions of slip of several contacts by their common motion ([`crate::contact_problem::slip_together`]).

use nalgebra::Vector2;

use crate::closed_contacts::ClosedContacts;
use crate::contact_problem::{self, Mode, is_slow, with_modes};
use crate::forces::{Hold, modes, slips};

/// Which common motions are looked for.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Asked {
    /// those with accelerations so small that directions cannot be computed from differences
    Slow,
    /// all
    Any,
}

/// The modes in which the contacts of `open` slip along one common motion, close to those given; `across` holds the
/// accelerations wanted perpendicular to their directions. `None` if there is no such motion.
pub(crate) fn slip_together(
    support: &ClosedContacts,
    mu: &[f64],
    holds: &[Hold],
    open: &[usize],
    across: &[f64],
    asked: Asked,
) -> Option<Vec<Hold>> {
    if open.len() < 2 {
        return None;
    }
    let (slips, modes) = (slips(holds), modes(holds));
    let problem = support.problem(mu, &slips);
    let force = with_modes(&problem, &modes).ok()?.force;
    if asked == Asked::Slow && !is_slow(&problem, &modes, open, &force) {
        return None;
    }
    let begins = open.iter().all(|&place| support.slip(place) == Vector2::zeros());
    let modes = contact_problem::slip_together(&problem, &modes, open, (!begins).then_some(across), &force)?;
    let hold = |mode: &Mode| match mode {
        Mode::Slide(d) => Hold::Slide(*d),
        _ => Hold::Stick,
    };
    Some(modes.iter().map(hold).collect())
}
