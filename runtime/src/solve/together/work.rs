//! The slots, and the queues in which they wait for their next piece.

use super::slot::{Piece, Slot};
use crate::scalar::Together;

/// The greatest number of collisions in work.
pub(super) const SLOTS: usize = 32;

/// The slots, and the places of those that wait for each piece.
pub(super) struct Work {
    pub slots: [Slot; SLOTS],
    queues: [[Place; SLOTS]; Piece::COUNT],
    lengths: [u8; Piece::COUNT],
    /// The queues that hold as many as are computed together, one bit for each.
    full: u32,
}

/// The place of a slot.
pub(super) type Place = u8;

/// The places of slots that are computed together, of which the first `count` count.
pub(super) struct Group {
    pub places: [Place; 8],
    pub count: usize,
}

impl Work {
    pub fn new() -> Self {
        let slots = core::array::from_fn(|_| Slot::new());
        Self { slots, queues: [[0; SLOTS]; Piece::COUNT], lengths: [0; Piece::COUNT], full: 0 }
    }

    #[inline(always)]
    pub fn slot(&mut self, place: Place) -> &mut Slot {
        &mut self.slots[usize::from(place) % SLOTS]
    }

    /// The slot of this place waits for this piece.
    #[inline(always)]
    pub fn push<L: Together>(&mut self, piece: Piece, place: Place) {
        let kind = piece as usize;
        let length = usize::from(self.lengths[kind]);
        self.queues[kind][length % SLOTS] = place;
        self.lengths[kind] += 1;
        self.full |= u32::from(length + 1 >= L::COUNT) << kind;
    }

    /// A piece for which as many wait as are computed together, or else one for which most do.
    #[inline(always)]
    pub fn next(&self) -> Option<Piece> {
        if self.full != 0 {
            return Piece::ALL.get(self.full.trailing_zeros() as usize).copied();
        }
        let longest = Piece::ALL.into_iter().zip(self.lengths).max_by_key(|(_, length)| *length);
        longest.filter(|(_, length)| *length > 0).map(|(piece, _)| piece)
    }

    /// Takes so many, if there are as many, from the queue of a piece.
    #[inline(always)]
    pub fn pop<L: Together>(&mut self, piece: Piece) -> Group {
        let kind = piece as usize;
        let length = usize::from(self.lengths[kind]);
        let count = length.min(L::COUNT);
        let left = length - count;
        let queue = &self.queues[kind];
        let places = core::array::from_fn(|lane| queue[(left + if lane < count { lane } else { 0 }) % SLOTS]);
        self.lengths[kind] = left as u8;
        if left < L::COUNT {
            self.full &= !(1 << kind);
        }
        Group { places, count }
    }
}
