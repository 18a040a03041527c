//! Grazing: keeps the least distance of the turning points of v_n from a value that ends compression or
//! restitution. Where a turning point just reaches such a value the outcome jumps.
//!
//! Theory: docs/theory.md, section 14.

use crate::scalar::Real;

/// The turning points of v_n so far, in units where v_n1 = -1.
#[derive(Clone, Copy)]
pub(crate) struct Grazing<T> {
    rising: bool,
    last: T,
    target: T,
    /// The least distance so far of a turning point from zero, or of a maximum from Newton's target.
    pub nearest: T,
}

impl<T: Real> Grazing<T> {
    /// Before any turning point. `target` is that of Newton's law, and zero for the others.
    #[inline]
    pub fn new(target: T) -> Self {
        Self { rising: true, last: -T::one(), target, nearest: T::one() }
    }

    /// Before any turning point, where v_n begins at zero and falls.
    #[inline]
    pub fn falling() -> Self {
        Self { rising: false, last: T::zero(), ..Self::new(T::zero()) }
    }

    /// v_n changed to `to` without a turning point on the way.
    #[inline(always)]
    pub fn moved(&mut self, to: T) {
        if T::INLINED { self.moved_here(to) } else { self.moved_apart(to) }
    }

    #[inline(never)]
    fn moved_apart(&mut self, to: T) {
        self.moved_here(to);
    }

    #[inline(always)]
    fn moved_here(&mut self, to: T) {
        let from = self.last;
        self.last = to;
        if to == from || (to > from) == self.rising {
            return;
        }
        self.rising = to > from;
        let to_target = if self.rising { from.abs() } else { (from - self.target).abs() };
        self.missed(from.abs());
        self.missed(to_target);
    }

    /// An event was reached or missed by this relative distance.
    #[inline]
    pub fn missed(&mut self, distance: T) {
        if distance < self.nearest {
            self.nearest = distance;
        }
    }
}
