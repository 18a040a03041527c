//! Many collisions at once: their arcs are followed piece by piece, and pieces of the same kind are computed for several
//! collisions by the instructions of one.
//!
//! A collision in work stands in a slot and waits in the queue of the piece that it needs next (`work`). A queue that holds
//! as many as there are lanes is served: `pieces` computes that piece for all of them, `slot` decides for each what comes
//! next, and a collision that has ended gives its slot to another. The formulas are those of single collisions, over
//! other numbers, and so are their bits. What is rare is left to [`solve_real`], which begins the collision anew.
//!
//! [`solve_real`]: super::collision::solve_real
//!
//! Theory: docs/theory.md, section 1.4.

mod pieces;
mod slot;
mod work;

use self::{
    slot::{Collision, Piece},
    work::{Place, SLOTS, Work},
};
use super::{collision::solve_real, gauss16::Panel};
use crate::{Impact, ImpactError, scalar::Together};

/// Solves all collisions; `answer` is called once for each, with its place in the order of the input. The order of the calls
/// means nothing.
pub(crate) fn solve_together<L: Together>(
    collisions: impl IntoIterator<Item = Collision>,
    mut answer: impl FnMut(usize, Result<Impact<f64>, ImpactError<f64>>),
) {
    let mut work = Work::new();
    let mut free: [Place; SLOTS] = core::array::from_fn(|place| place as Place);
    let mut frees = SLOTS;
    let mut panel = Panel::<L>::new(L::zero(), u32::MAX);
    let mut rest = collisions.into_iter().enumerate();
    loop {
        while frees > 0 {
            let Some((index, collision)) = rest.next() else { break };
            frees -= 1;
            let place = free[frees % SLOTS];
            work.slot(place).take(index, &collision);
            work.push::<L>(Piece::Chart, place);
        }
        let Some(piece) = work.next() else { return };
        let group = work.pop::<L>(piece);
        if !matches!(piece, Piece::Conclusion | Piece::Alone) {
            pieces::compute::<L>(piece, &mut work, &group, &mut panel);
            continue;
        }
        for place in group.places.into_iter().take(group.count) {
            let slot = work.slot(place);
            if let Piece::Alone = piece {
                let (matrix, approach, surface) = slot.collision();
                answer(slot.index, solve_real(&matrix, &approach, &surface));
            } else {
                answer(slot.index, slot.concluded());
            }
            free[frees % SLOTS] = place;
            frees += 1;
        }
    }
}
