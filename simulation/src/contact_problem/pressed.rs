//! The contacts that press, where none begins to slip: every choice of them is tried.
//!
//! The forces of sliding contacts are found by Newton's method from one start, which may end next to a motion that just
//! misses the laws, as that of a box that slides on all its corners and begins to tip.
//!
//! Theory: docs/theory.md, section 17.10.

use super::{Mode, Problem, Solution, certified::with_certificate};

/// The greatest number of contacts for which all choices are tried.
const MOST: u32 = 10;

/// A motion in which contacts slide as they did, stick or separate, with the most contacts that press; none for
/// more than [`MOST`] contacts.
pub(super) fn pressed(problem: &Problem<'_>) -> Option<Solution> {
    let k = u32::try_from(problem.contacts()).ok().filter(|&k| k <= MOST)?;
    (0..=k).rev().find_map(|count| {
        let mut choices = (0..1_u32 << k).filter(|choice| choice.count_ones() == count);
        choices.find_map(|choice| {
            let mode = |(i, slip): (usize, &Option<_>)| match slip {
                _ if choice >> i & 1 == 0 => Mode::Separate,
                Some(direction) => Mode::Slide(*direction),
                None => Mode::Stick,
            };
            let modes: Vec<Mode> = problem.slip.iter().enumerate().map(mode).collect();
            with_certificate(problem, &modes)
        })
    })
}
